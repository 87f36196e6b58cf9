"""An evaluation's folder, with its record, progress files, logs and report."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from scope_ptz.bench.engine.file_lock import lock_file
from scope_ptz.bench.reports.progress_state import LOCK_FILE, STATE_FILE, TRIALS_FILE, ProgressState
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.errors import OutputError, TraceError

RECORD_FILE = "evaluation.json"
MAX_MESSAGE_CHARS = 1_000  # longer error messages are truncated
_PREFIX = "scope: "
"""The prefix of each message that the command line prints to stderr."""

State = Literal["running", "finished", "cancelled", "failed", "interrupted"]
"""An evaluation's state. ``failed``: its process ended with an error. ``interrupted``: it was killed, or the machine shut down."""


class EvaluationRecord(BaseModel):
    """An evaluation's stored record: its options, the client that started it, and its process's exit code.

    Attributes:
        id: Name of the evaluation's folder.
        pair: The pair of models.
        split: The dataset split.
        limit: Maximum number of tasks; None for all.
        categories: The categories; all if empty.
        started: When the evaluation was first started.
        resumed: How many times it was resumed.
        actor: Name of the client that started it.
        cancelled: Whether a client cancelled it.
        exit_code: Exit code of the last process; None while the process is running, or if the server ended before the process did.
    """

    model_config = ConfigDict(frozen=True)

    id: str
    pair: str
    split: str
    limit: int | None = None
    categories: tuple[str, ...] = ()
    started: datetime
    resumed: int = 0
    actor: str = ""
    cancelled: bool = False
    exit_code: int | None = None


class EvaluationFolder:
    """An evaluation's files. No part of a path comes from a request.

    Args:
        path: The folder.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.progress = path / "progress"
        self.logs = path / "logs"
        self.report = path / "report"
        self.errors = path / "errors.txt"
        self.output = path / "output.txt"
        self.report_errors = path / "report-errors.txt"

    def record(self) -> EvaluationRecord:
        """Return the record.

        Raises:
            TraceError: The record is missing or damaged.
        """
        try:
            return EvaluationRecord.model_validate_json((self.path / RECORD_FILE).read_bytes())
        except (OSError, ValidationError) as error:
            raise TraceError(
                f"The record of the evaluation {self.path.name} is missing or damaged. Remove its folder from the runs folder."
            ) from error

    def write(self, record: EvaluationRecord) -> None:
        """Replace the record.

        Raises:
            OutputError: The record cannot be written.
        """
        new_file = self.path / f".{RECORD_FILE}.new"
        try:
            new_file.write_text(record.model_dump_json() + "\n", "utf-8")
            new_file.replace(self.path / RECORD_FILE)
        except OSError as error:
            raise OutputError(f"The evaluation cannot be written to {self.path}: {error.strerror}.") from error

    def is_locked(self) -> bool:
        """Return whether a process is running the evaluation, including a process that an earlier server started."""
        try:
            with (self.progress / LOCK_FILE).open("r+") as file:
                return not lock_file(file)
        except OSError:
            return False

    def state(self) -> ProgressState | None:
        """Return the evaluation's progress; None if none has been stored yet."""
        try:
            return ProgressState.model_validate_json((self.progress / STATE_FILE).read_bytes())
        except (OSError, ValidationError):
            return None

    def trials(self) -> list[Trial]:
        """Return the finished runs. Lines that are incomplete or invalid are skipped."""
        try:
            lines = (self.progress / TRIALS_FILE).read_bytes().split(b"\n")
        except OSError:
            return []
        trials = []
        for line in lines[:-1]:
            try:
                trials.append(Trial.model_validate_json(line))
            except ValidationError:
                continue
        return trials

    def newest_log(self) -> Path | None:
        """Return the most recently modified log; None if there is none."""
        logs = [(modification_time_s(path), path) for path in self.logs.glob("*.eval")]
        return max(logs)[1] if logs else None

    def report_page(self) -> Path | None:
        """Return the report's first page; None if there is no report or if it is older than the log."""
        page, log = self.report / "index.html", self.newest_log()
        return page if page.is_file() and log is not None and modification_time_s(page) >= modification_time_s(log) else None

    def report_file(self, part: str, name: str) -> Path | None:
        """Return a report file; None if it does not exist.

        ``part`` and ``name`` come from a request, so they are compared with the existing names and never become part of a path.
        """
        folder = next(
            (candidate for candidate in (self.report / known for known in ("tasks", "frames", "tables")) if candidate.name == part),
            None,
        )
        if folder is None or not folder.is_dir():
            return None
        return next(
            (
                candidate
                for candidate in folder.iterdir()
                if candidate.name == name and candidate.is_file() and not candidate.is_symlink()
            ),
            None,
        )


def modification_time_s(path: Path) -> float:
    """Return the modification time of a file in seconds since 1970; 0 if it does not exist, which happens while logs are merged."""
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0


def last_message(path: Path) -> str:
    """Return the last line in a command's stderr file, without the message prefix; empty if there is none."""
    try:
        text = path.read_text("utf-8", errors="replace")[-20_000:]
    except OSError:
        return ""
    lines = [line for line in text.splitlines() if line.strip()]
    return lines[-1].removeprefix(_PREFIX)[:MAX_MESSAGE_CHARS] if lines else ""
