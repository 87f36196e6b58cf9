"""Command groups that skip unnecessary conversions of parameter values.

Typer validates every parameter with pydantic, even if no value was given. Importing pydantic and building the validators takes
longer than everything else that ``scope tools`` does.
"""

from __future__ import annotations

from typing import Any

from typer.core import TyperGroup


class LeanGroup(TyperGroup):
    """A command group that skips unnecessary conversions of parameter values, including those of its commands."""

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
