"""Files of JSON lines that grow: a line is written whole or, after a break, counts as never written."""

from __future__ import annotations

from pathlib import Path

from scope_ptz.errors import InputError, OutputError


def whole_lines(path: Path) -> list[tuple[int, str]]:
    """The finished lines of a file that are not blank, with their numbers; none when there is no file. Raises ``InputError``."""
    try:
        *lines, _ = path.read_bytes().decode("utf-8").split("\n")
    except FileNotFoundError:
        return []
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is no text: {error.reason} at byte {error.start}.") from error
    return [(number, line) for number, line in enumerate(lines, 1) if line.strip()]


def append_line(path: Path, line: str) -> None:
    """Add a line; one before it that was never finished is taken away. Raises ``OutputError``."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("a+b") as file:
            file.truncate(_finished(file.seek(0, 2), path))
            file.write(line.encode("utf-8") + b"\n")
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror}.") from error


def _finished(size: int, path: Path, step: int = 4096) -> int:
    """How many bytes at the start of a file are finished lines."""
    with path.open("rb") as file:
        at = size
        while at > 0:
            start = max(0, at - step)
            file.seek(start)
            found = file.read(at - start).rfind(b"\n")
            if found != -1:
                return start + found + 1
            at = start
    return 0
