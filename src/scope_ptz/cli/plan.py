"""``scope plan``: show the tool calls for an instruction, or for each line of a file, without moving the camera."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.table import Column, Table
from rich.text import Text

from scope_ptz.cli.display import arguments_text, sanitize, shorten
from scope_ptz.cli.exit import BAD_INPUT, print_error, put_json
from scope_ptz.errors import InputError
from scope_ptz.planner.grammar.execution.outline import OutlineBlock, OutlineCall
from scope_ptz.planner.limits import MAX_INSTRUCTION_CHARS
from scope_ptz.planner.plan import Plan
from scope_ptz.planner.plan import plan as make_plan

_INDENT = 5


@dataclass(frozen=True, slots=True)
class InstructionLine:
    """A line in an instruction file. Additional fields are ignored, so that task files can also be used."""

    instruction: str
    presets: list[str] = field(default_factory=list)


def plan(instruction: str | None, presets: str | None, source: Path | None, *, as_json: bool) -> int:
    """Plan one instruction or an instruction file, and return the exit code."""
    if (instruction is None) == (source is None):
        raise InputError("Give either an instruction, or an instruction file with --from.")
    if source is not None:
        if presets is not None:
            raise InputError("--presets cannot be used with --from. Give the presets of each instruction in the file.")
        return _plan_file(source, as_json=as_json)
    names = [name.strip() for name in (presets or "").split(",") if name.strip()]
    _show(_checked_plan(instruction or "", names), as_json=as_json)
    return 0


def _plan_file(source: Path, *, as_json: bool) -> int:
    code = 0
    for number, line in read_instructions(source):
        try:
            if isinstance(line, InputError):
                raise line
            _show(_checked_plan(line.instruction, line.presets), as_json=as_json)
        except InputError as error:
            print_error(f"{source}, line {number}: {error}")
            code = BAD_INPUT
    return code


def read_instructions(source: Path) -> Iterator[tuple[int, InstructionLine | InputError]]:
    """Yield the number of each non-empty line, and its parsed content or an error.

    Args:
        source: The file; "-" means standard input.

    Raises:
        InputError: The file cannot be read.
    """
    from pydantic import TypeAdapter, ValidationError

    adapter = TypeAdapter(InstructionLine)
    for number, line in enumerate(_lines(source), 1):
        if not line.strip():
            continue
        try:
            yield number, adapter.validate_json(line, strict=True)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            where = ".".join(str(part) for part in first["loc"])
            yield number, InputError(f"{f'{where}: ' if where else ''}{first['msg']}.")


def _lines(source: Path) -> Iterator[str]:
    try:
        if str(source) == "-":
            yield from sys.stdin
            return
        with source.open(encoding="utf-8") as file:
            yield from file
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{source} cannot be read: {error}.") from error


def _checked_plan(instruction: str, presets: list[str]) -> Plan:
    """Plan an instruction. Raises ``InputError`` if it is empty or too long."""
    if not instruction.strip():
        raise InputError("The instruction is empty. Describe what the camera should do.")
    if len(instruction) > MAX_INSTRUCTION_CHARS:
        raise InputError(f"The instruction is longer than {MAX_INSTRUCTION_CHARS} characters.")
    return make_plan(instruction, presets)


def _show(result: Plan, *, as_json: bool) -> None:
    if as_json:
        put_json(result.as_dict())
        return
    console = Console(highlight=False)
    console.print(Text.assemble(("› ", "bold cyan"), (sanitize(shorten(result.instruction)), "bold")))
    number = 0
    for line in result.outline.lines:
        numbered = isinstance(line, OutlineCall) or not line.heading.startswith(("otherwise", "if that never"))
        number += numbered
        _show_line(console, line, f"{number:3d}  " if numbered else " " * _INDENT)
    if result.clarification is not None:
        console.print(Text(sanitize(shorten(result.clarification)), style="yellow"))


def _show_line(console: Console, line: OutlineCall | OutlineBlock, prefix: str) -> None:
    """Print a line of the outline, with its inner lines indented below it. Long lines are wrapped with their indentation."""
    grid = Table.grid(Column(width=len(prefix), no_wrap=True), Column())
    if isinstance(line, OutlineCall):
        grid.add_row(Text(prefix, "cyan"), Text.assemble((line.name, "bold"), f"({arguments_text(line.arguments)})"))
    else:
        grid.add_row(Text(prefix, "cyan"), Text(sanitize(line.heading), "yellow"))
    console.print(grid)
    for inner in line.lines if isinstance(line, OutlineBlock) else ():
        _show_line(console, inner, " " * (len(prefix) + 4))
