"""Read JSON Lines files and append to them. A last line that was not written completely is ignored."""

from __future__ import annotations

from pathlib import Path

from scope_ptz.errors import InputError, OutputError


def complete_lines(path: Path) -> list[tuple[int, str]]:
    """Return the complete, non-blank lines of a file with their line numbers. A missing file has no lines.

    Raises:
        InputError: The file cannot be read.
    """
    try:
        *lines, _ = path.read_bytes().decode("utf-8").split("\n")
    except FileNotFoundError:
        return []
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is not UTF-8 text: {error.reason} at byte {error.start}.") from error
    return [(number, line) for number, line in enumerate(lines, 1) if line.strip()]


def append_line(path: Path, line: str) -> None:
    """Append a line to a file. An incomplete last line is removed first.

    Raises:
        OutputError: The file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("a+b") as file:
            file.truncate(_complete_size_bytes(file.seek(0, 2), path))
            file.write(line.encode("utf-8") + b"\n")
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror}.") from error


def _complete_size_bytes(size: int, path: Path, chunk_bytes: int = 4096) -> int:
    """Return the total size in bytes of the complete lines of a file."""
    with path.open("rb") as file:
        end = size
        while end > 0:
            start = max(0, end - chunk_bytes)
            file.seek(start)
            newline = file.read(end - start).rfind(b"\n")
            if newline != -1:
                return start + newline + 1
            end = start
    return 0
