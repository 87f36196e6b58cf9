"""Option groups in the signatures of commands, their defaults, and exit codes."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from inspect import signature
from pathlib import Path
from typing import Annotated

import pytest
import typer
from typer.core import TyperGroup
from typer.testing import CliRunner

from scope_ptz.cli.options import JsonOption, ModelFlags, PairFlags, SessionFlags
from scope_ptz.cli.typer_extensions import LeanGroup, command
from scope_ptz.errors import InputError, PlannerError


@dataclass(frozen=True, kw_only=True)
class Sizes:
    """Two options for the tests."""

    width: Annotated[int, typer.Option("--width", rich_help_panel="Sizes")] = 3
    names: Annotated[list[str] | None, typer.Option("--name")] = None


SMALL = Sizes(width=1)


def run(function: object, *arguments: str) -> tuple[int, str]:
    app = typer.Typer(pretty_exceptions_enable=False)
    app.command()(command(function))  # type: ignore[arg-type]
    result = CliRunner().invoke(app, arguments)
    return result.exit_code, result.output


def test_a_group_arrives_as_one_object() -> None:
    def show(label: str, sizes: Sizes, as_json: JsonOption = False) -> None:
        typer.echo(f"{label} {sizes.width} {sizes.names} {as_json}")

    assert run(show, "a") == (0, "a 3 None False\n")
    assert run(show, "a", "--width", "5", "--name", "x", "--name", "y", "--json") == (0, "a 5 ['x', 'y'] True\n")
    assert run(show, "a", "--width", "wide")[0] == 2


def test_a_command_can_override_defaults() -> None:
    def show(sizes: Sizes = SMALL) -> None:
        typer.echo(str(sizes.width))

    assert run(show) == (0, "1\n")


def test_the_returned_number_is_the_exit_code() -> None:
    assert run(lambda: 4)[0] == 4
    assert run(lambda: None)[0] == 0


@pytest.mark.parametrize(("error", "code"), [(InputError("Wrong."), 2), (PlannerError("Broken."), 1), (KeyboardInterrupt(), 130)])
def test_errors_have_exit_codes(error: BaseException, code: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scope_ptz.cli.exit._ignore_interrupts", lambda: None)

    def fail() -> None:
        raise error

    assert run(fail)[0] == code


def test_every_model_flag_reaches_the_options() -> None:
    flags = PairFlags(
        planner="a", perception="b", pair="c", planner_url="d", perception_url="e", planner_model="f", perception_model="g",
        planner_option=["h=1"], perception_option=["i=2"], reader="j", detector="k", timeout=1.5,
    )  # fmt: skip
    options = flags.options()
    assert (options.planner, options.perception, options.pair, options.timeout_s) == ("a", "b", "c", 1.5)
    assert (options.planner_options, options.perception_options) == (("h=1",), ("i=2",))
    assert ModelFlags().options("x").pair == "x"


def test_names_of_options_are_unique_within_a_command() -> None:
    def show(session: SessionFlags, models: PairFlags) -> None: ...

    names = list(signature(command(show)).parameters)
    assert len(set(names)) == len(names)
    assert names.index("pair") < names.index("planner")


@pytest.mark.parametrize("arguments", [
    "", "--help", "show", "show a", "show a b", "show a --level", "show a --level 3", "show a --level 5", "show a --level x",
    "show a --level 99", "show a --file f", "show a --name x --name y", "show a --share 0.5", "show a --share 1", "show a --on",
    "show a --off --loud", "show '' --text ''", "show a --text é --no-such", "--loudly show a", "--loudly", "show --help", "shwo a",
])  # fmt: skip
def test_skipping_unneeded_conversions_does_not_change_results(arguments: str) -> None:
    def make_app(cls: type[TyperGroup]) -> typer.Typer:
        app = typer.Typer(cls=cls, pretty_exceptions_enable=False)

        @app.callback()
        def root(loudly: Annotated[bool, typer.Option("--loudly", callback=lambda value: value)] = False) -> None:
            typer.echo(f"loudly {loudly!r}")

        @app.command()
        def show(
            label: str,
            level: Annotated[int, typer.Option("--level", min=1, max=9)] = 5,
            share: Annotated[float | None, typer.Option("--share", min=0.0)] = None,
            text: Annotated[str | None, typer.Option("--text")] = None,
            file: Annotated[Path | None, typer.Option("--file")] = None,
            names: Annotated[list[str] | None, typer.Option("--name")] = None,
            on: Annotated[bool | None, typer.Option("--on/--off")] = None,
            loud: Annotated[bool, typer.Option("--loud")] = False,
        ) -> None:
            typer.echo(repr((label, level, share, text, file, names, on, loud)))

        return app

    lean, plain = (CliRunner().invoke(make_app(cls), shlex.split(arguments)) for cls in (LeanGroup, TyperGroup))
    assert (lean.exit_code, lean.output) == (plain.exit_code, plain.output)
