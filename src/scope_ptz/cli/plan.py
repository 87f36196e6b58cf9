"""``scope plan``: what would be done, without moving anything."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError
from rich.console import Console
from rich.text import Text

from scope_ptz.cli.display import arguments_text, plain
from scope_ptz.cli.endings import BAD_INPUT, complain, put_json
from scope_ptz.errors import InputError
from scope_ptz.planner.plan import plan as make_plan


class _Line(BaseModel):
    """One line of a file of instructions. Other fields are allowed, so that a test set can be given as it is."""

    model_config = ConfigDict(strict=True)

    instruction: str
    presets: list[str] = []


def plan(instruction: str | None, presets: str | None, source: Path | None, *, as_json: bool) -> int:
    """Plan one instruction or a file of them; the exit code."""
    if (instruction is None) == (source is None):
        raise InputError("Give an instruction, or a file of them with --from.")
    if source is not None:
        if presets is not None:
            raise InputError("With --from the presets stand in the file, one list a line.")
        return _plan_file(source, as_json=as_json)
    names = [name.strip() for name in (presets or "").split(",") if name.strip()]
    _show(_planned(instruction or "", names), as_json=as_json)
    return 0


def _plan_file(source: Path, *, as_json: bool) -> int:
    code = 0
    for number, line in enumerate(_lines(source), 1):
        if not line.strip():
            continue
        try:
            given = _Line.model_validate_json(line)
            _show(_planned(given.instruction, given.presets), as_json=as_json)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            where = ".".join(str(part) for part in first["loc"])
            complain(f"{source}, line {number}: {f'{where}: ' if where else ''}{first['msg']}.")
            code = BAD_INPUT
        except InputError as error:
            complain(f"{source}, line {number}: {error}")
            code = BAD_INPUT
    return code


def _lines(source: Path) -> Iterator[str]:
    if str(source) == "-":
        yield from sys.stdin
        return
    try:
        with source.open(encoding="utf-8") as file:
            yield from file
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{source} cannot be read: {error}.") from error


def _planned(instruction: str, presets: list[str]) -> dict[str, Any]:
    if not instruction.strip():
        raise InputError("The instruction is empty. Say what the camera should do.")
    return make_plan(instruction, presets).as_dict()


def _show(planned: dict[str, Any], *, as_json: bool) -> None:
    if as_json:
        put_json(planned)
        return
    console = Console(highlight=False)
    console.print(Text.assemble(("› ", "bold cyan"), (plain(planned["instruction"]), "bold")))
    for number, call in enumerate(planned["calls"], 1):
        line = Text.assemble((f"{number:3d}  ", "cyan"), (call["name"], "bold"), f"({arguments_text(call['arguments'])})")
        console.print(line)
    if planned["clarification"] is not None:
        console.print(Text(plain(planned["clarification"]), style="yellow"))
