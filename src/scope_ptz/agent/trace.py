"""Read and write trace files: one JSON record per line. Each line is flushed immediately, so that a crash loses no records."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import IO

from pydantic import ValidationError

from scope_ptz.agent.records import FORMAT_VERSION, RECORD, Called, Decided, Ended, Started
from scope_ptz.errors import OutputError, TraceError
from scope_ptz.regular_files import NotARegularFileError, read_regular_file

FILE_NAME = "trace.jsonl"


class TraceWriter:
    """A listener that writes each record to a new file. Raises ``OutputError`` if the file cannot be written."""

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            self._file: IO[str] = path.open("x", encoding="utf-8")
        except OSError as error:
            raise OutputError(f"The trace {path} cannot be written: {error.strerror}.") from error

    def __call__(self, record: Started | Decided | Called | Ended) -> None:
        try:
            self._file.write(record.model_dump_json() + "\n")
            self._file.flush()
        except OSError as error:
            raise OutputError(f"The trace {self._path} cannot be written: {error.strerror}.") from error

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> TraceWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


@dataclass(frozen=True, slots=True)
class Trace:
    """A recorded run.

    Attributes:
        folder: The folder with the run's pictures; ``Path()`` for a run that was kept in memory.
        ended: The end of the run; None if the program was killed before the run ended.
    """

    folder: Path
    started: Started
    decisions: tuple[Decided, ...]
    calls: tuple[Called, ...]
    ended: Ended | None


def picture_path(folder: Path, name: str) -> Path:
    """Return the path of a picture that a trace names.

    Raises:
        TraceError: The name points outside the run folder.
    """
    path = (folder / name).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise TraceError(f"The trace in {folder} names a picture outside its own folder: {name}.")
    return path


def picture_names(trace: Trace) -> dict[str, int | None]:
    """Return the names of a trace's pictures in order, each with the position of its call, or None for the view at the start."""
    found: dict[str, int | None] = {} if trace.started.frame is None else {trace.started.frame: None}
    for position, call in enumerate(trace.calls):
        result = call.outcome.result or {}
        names = [*(result.get("frames") or ()), result.get("file"), call.frame]
        for name in names:
            if isinstance(name, str) and name:
                found.setdefault(name, position)
    return found


def read_trace(run: Path) -> Trace:
    """Read a trace. An incomplete last line, which a killed program can leave behind, is ignored.

    Args:
        run: A run folder, or the trace file itself.

    Returns:
        The recorded run.

    Raises:
        TraceError: The file is missing, damaged, or not a trace.
    """
    path = run / FILE_NAME if run.is_dir() else run
    try:
        lines = read_regular_file(path).decode("utf-8", errors="replace").split("\n")
    except NotARegularFileError as error:
        raise TraceError(f"{path} is not a regular file, so it is not the trace of a run.") from error
    except OSError as error:
        raise TraceError(f"There is no trace at {path} ({error.strerror}).") from error
    last_line = lines.pop()  # the text after the last newline: empty, or an incomplete line
    records = [_parse(line, number, path) for number, line in enumerate(lines, 1) if line.strip()]
    if not records or not isinstance(records[0], Started):
        raise TraceError(
            f"{path} does not begin with a header{' (it was cut off)' if last_line else ''}, so it is not the trace of a run."
        )
    if any(isinstance(record, Started) for record in records[1:]) or any(isinstance(r, Ended) for r in records[:-1]):
        raise TraceError(f"{path} contains more than one run, or continues after its end.")
    return trace_of(records, path.parent)


def trace_of(records: Sequence[Started | Decided | Called | Ended], folder: Path) -> Trace:
    """Create a trace from one run's records.

    Args:
        records: The records in order. The first one is the header.
        folder: The folder with the pictures; ``Path()`` for a run that was kept in memory.

    Returns:
        The recorded run.

    Raises:
        TraceError: The first record is not a header.
    """
    if not records or not isinstance(records[0], Started):
        raise TraceError("The first record of a run must be a header; these records do not begin with one.")
    return Trace(
        folder=folder,
        started=records[0],
        decisions=tuple(r for r in records if isinstance(r, Decided)),
        calls=tuple(r for r in records if isinstance(r, Called)),
        ended=records[-1] if isinstance(records[-1], Ended) else None,
    )


def _parse(line: str, number: int, path: Path) -> Started | Decided | Called | Ended:
    try:
        content = json.loads(line)
    except ValueError as error:
        raise TraceError(f"{path}, line {number} is damaged: {error}.") from error
    version = content.get("format") if isinstance(content, dict) else None
    if number == 1 and isinstance(version, int) and version > FORMAT_VERSION:
        raise TraceError(f"{path} has format {version}; this program reads {FORMAT_VERSION}. Install a newer scope-ptz.")
    try:
        return RECORD.validate_python(content)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(str(part) for part in first["loc"])
        raise TraceError(f"{path}, line {number} is not a record of a run: {where}: {first['msg']}.") from error
