"""Extensions of Typer: commands with groups of options, and command groups that start fast."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import wraps
from inspect import Parameter, Signature, signature
from typing import Any, get_type_hints

import typer
from typer.core import TyperGroup

from scope_ptz.cli.exit import exit_on_error


def command(function: Callable[..., int | None]) -> Callable[..., None]:
    """Convert a function with option groups to a function that Typer can register.

    An option group is a frozen dataclass whose fields are annotated with ``typer.Option``. A parameter that is annotated with such
    a dataclass is expanded to one keyword parameter per field, as in the flat signature that Typer expects::

        @app.command()
        @command
        def ask(instruction: Instruction, session: SessionFlags, models: PairFlags, as_json: JsonOption = False) -> int:
            ...

    If such a parameter has a default, it must be an instance of the group, which contains the default values of the options.

    The function's return value becomes the exit code. SCOPE's errors are converted to one line on stderr and an exit code (see
    ``scope_ptz.cli.exit``). If the parameter ``as_json`` is set, errors are also printed as JSON.
    """
    hints = get_type_hints(function, include_extras=True)
    groups: dict[str, type[Any]] = {}
    parameters: list[Parameter] = []
    for parameter in signature(function).parameters.values():
        annotation = hints[parameter.name]
        if isinstance(annotation, type) and is_dataclass(annotation):
            groups[parameter.name] = annotation
            parameters += _expand_group(annotation, None if parameter.default is Parameter.empty else parameter.default)
        else:
            parameters.append(parameter.replace(annotation=annotation, kind=Parameter.KEYWORD_ONLY))

    @wraps(function)
    def run(**values: Any) -> None:
        with exit_on_error(as_json=bool(values.get("as_json"))):
            group_values = {
                name: annotation(**{f.name: values.pop(f.name) for f in fields(annotation)}) for name, annotation in groups.items()
            }
            if code := function(**values, **group_values):
                sys.exit(code)

    del run.__wrapped__
    run.__signature__ = Signature(parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {p.name: p.annotation for p in parameters}
    return run


def _expand_group(group: type[Any], defaults: Any) -> list[Parameter]:
    hints = get_type_hints(group, include_extras=True)
    return [
        Parameter(
            field.name,
            Parameter.KEYWORD_ONLY,
            default=field.default if defaults is None else getattr(defaults, field.name),
            annotation=hints[field.name],
        )
        for field in fields(group)
    ]


class LazyGroup(TyperGroup):
    """A command group that imports its commands when one of them is used or listed. Subclasses define ``load_app``."""

    def load_app(self) -> typer.Typer:
        """Import the commands, and return the app that contains them."""
        raise NotImplementedError

    def list_commands(self, ctx: Any) -> list[str]:
        self._load()
        return super().list_commands(ctx)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        self._load()
        return super().get_command(ctx, cmd_name)

    def _load(self) -> None:
        if not self.commands:
            self.commands.update(typer.main.get_group(self.load_app()).commands)


class LeanGroup(TyperGroup):
    """A command group that skips unnecessary conversions of parameter values, including those of its commands.

    Typer validates every parameter with pydantic, even if no value was given. Importing pydantic and building the validators takes
    longer than everything else that ``scope tools`` does.
    """

    def get_params(self, ctx: Any) -> Any:
        return _skip_conversions(super().get_params(ctx))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        command = super().get_command(ctx, cmd_name)
        if command is not None and not isinstance(command, LeanGroup) and "get_params" not in vars(command):
            original = command.get_params
            vars(command)["get_params"] = lambda context: _skip_conversions(original(context))
        return command


def _skip_conversions(parameters: list[Any]) -> list[Any]:
    for parameter in parameters:
        if not isinstance(parameter.process_value, _Conversion):
            parameter.process_value = _Conversion(parameter)
    return parameters


class _Conversion:
    """Converts the value of a parameter, but skips None, strings of text parameters, and numeric defaults."""

    def __init__(self, parameter: Any) -> None:
        self._parameter, self._convert = parameter, parameter.process_value
        self._single = parameter.nargs == 1 and not getattr(parameter, "multiple", False)
        self._is_text = getattr(getattr(parameter, "type_descriptor", None), "annotation", None) is str

    def __call__(self, ctx: Any, value: Any) -> Any:
        parameter = self._parameter
        if not self._is_converted(value):
            return self._convert(ctx, value)
        if value is None and not self._single:
            value = ()
        return value if parameter.callback is None else parameter.callback(ctx, parameter, value)

    def _is_converted(self, value: Any) -> bool:
        if value is None:
            return not self._parameter.required
        if not self._single:
            return False
        if type(value) is str and self._is_text:
            return True
        return type(value) in (int, float) and value == self._parameter.default
