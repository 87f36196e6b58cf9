"""A participant's journal: every message from the agent, written to disk before the engine receives it.

A host that was killed resumes from the journal when it is restarted. For a run in progress, the recorded messages are sent to the
engine again, and the agent continues where it stopped. No task is attempted twice.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from scope_ptz.errors import InputError, OutputError

JOURNAL_FILE = "journal.jsonl"


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Received(_Entry):
    """A message from the agent in a run. A run's first message is its ``hello``."""

    type: Literal["received"] = "received"
    run: str
    line: str


class Ended(_Entry):
    """The agent's part in a run has ended."""

    type: Literal["ended"] = "ended"
    run: str


class Done(_Entry):
    """The evaluation is finished, and its submission is signed."""

    type: Literal["done"] = "done"
    submission: Path


_ENTRY: TypeAdapter[Received | Ended | Done] = TypeAdapter(Annotated[Received | Ended | Done, Field(discriminator="type")])


class Journal:
    """One participant's journal.

    Args:
        folder: The participant's folder.

    Raises:
        InputError: The journal is damaged.
        OutputError: The journal cannot be written.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / JOURNAL_FILE
        self._received: dict[str, list[str]] = {}
        self._ended: set[str] = set()
        self.submission: Path | None = None
        self._read()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
        except OSError as error:
            raise OutputError(f"The journal {self.path} cannot be written: {error.strerror}.") from error

    @property
    def attempted(self) -> int:
        """Number of runs that have begun."""
        return len(self._ended | self._received.keys())

    @property
    def ended(self) -> int:
        """Number of runs in which the agent's part has ended."""
        return len(self._ended)

    def messages(self, run: str) -> tuple[str, ...]:
        """Return the agent's messages in a run; empty if the run has not begun."""
        return tuple(self._received.get(run, ()))

    def has_ended(self, run: str) -> bool:
        """Return whether the agent's part in a run has ended."""
        return run in self._ended

    def record(self, run: str, line: str) -> None:
        """Record a message from the agent before it is delivered."""
        self._write(Received(run=run, line=line))
        self._received.setdefault(run, []).append(line)

    def record_end(self, run: str) -> None:
        """Record that the agent's part in a run has ended."""
        if run not in self._ended:
            self._write(Ended(run=run))
            self._ended.add(run)

    def record_done(self, submission: Path) -> None:
        """Record that the evaluation is finished."""
        self._write(Done(submission=submission))
        self.submission = submission

    def close(self) -> None:
        """Close the file."""
        os.close(self._file)

    def _read(self) -> None:
        try:
            content = self.path.read_bytes()
        except FileNotFoundError:
            return
        except OSError as error:
            raise InputError(f"The journal {self.path} cannot be read: {error.strerror}.") from error
        complete_lines = content[: content.rfind(b"\n") + 1]
        if len(complete_lines) < len(content):  # the host was killed while it was writing the last line
            self._truncate(len(complete_lines))
        for number, line in enumerate(complete_lines.splitlines(), 1):
            try:
                self._apply(_ENTRY.validate_json(line))
            except ValidationError as error:
                raise InputError(f"Line {number} of the journal {self.path} is damaged. Restore the file from a copy.") from error

    def _apply(self, entry: Received | Ended | Done) -> None:
        if isinstance(entry, Received):
            self._received.setdefault(entry.run, []).append(entry.line)
        elif isinstance(entry, Ended):
            self._ended.add(entry.run)
        else:
            self.submission = entry.submission

    def _truncate(self, size: int) -> None:
        try:
            os.truncate(self.path, size)
        except OSError as error:
            raise OutputError(f"The journal {self.path} cannot be repaired: {error.strerror}.") from error

    def _write(self, entry: Received | Ended | Done) -> None:
        try:
            line = json.dumps(entry.model_dump(mode="json")).encode() + b"\n"
            size = os.fstat(self._file).st_size
            complete = os.write(self._file, line) == len(line)
            os.fsync(self._file)
        except OSError as error:
            raise OutputError(f"The journal {self.path} cannot be written: {error.strerror}.") from error
        if not complete:
            self._truncate(size)
            raise OutputError(f"The journal {self.path} cannot be written: the disk is full.")
