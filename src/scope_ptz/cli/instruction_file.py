"""Read instruction files, which contain one JSON object per line."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from scope_ptz.errors import InputError


class InstructionLine(BaseModel):
    """A line in an instruction file. Additional fields are ignored, so that task files can also be used."""

    model_config = ConfigDict(strict=True)

    instruction: str
    presets: list[str] = []


def read_instructions(source: Path) -> Iterator[tuple[int, InstructionLine | InputError]]:
    """Yield the number of each non-empty line, and its parsed content or an error.

    Args:
        source: The file; "-" means standard input.

    Raises:
        InputError: The file cannot be read.
    """
    for number, line in enumerate(_lines(source), 1):
        if line.strip():
            yield number, _parse(line)


def _parse(line: str) -> InstructionLine | InputError:
    try:
        return InstructionLine.model_validate_json(line)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(str(part) for part in first["loc"])
        return InputError(f"{f'{where}: ' if where else ''}{first['msg']}.")


def _lines(source: Path) -> Iterator[str]:
    try:
        if str(source) == "-":
            yield from sys.stdin
            return
        with source.open(encoding="utf-8") as file:
            yield from file
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{source} cannot be read: {error}.") from error
