"""Start, monitor, cancel, resume and remove evaluations, each in its own process. Only one runs at a time."""

from __future__ import annotations

import logging
import os
import secrets
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

from scope_ptz.bench.reports.progress_state import STATE_FILE, ProgressState
from scope_ptz.errors import InputError, OutputError, TraceError, UnknownNameError
from scope_ptz.serve.site.benchmark.evaluation_folder import EvaluationFolder, EvaluationRecord, State, last_message
from scope_ptz.serve.site.errors import EvaluationRunningError
from scope_ptz.serve.site.pairs import DEFAULT_PAIR

FOLDER = "evaluations"
"""Name of the folder, inside the runs folder, that contains the evaluations."""
KILL_AFTER_S = 20.0
"""Seconds that a cancelled evaluation has to write its log. If it is still running after that, it is killed."""
NICENESS = 10
"""Nice value for evaluation processes, so that live video has priority over them."""

ReportState = Literal["none", "making", "ready", "failed"]
logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class EvaluationStatus:
    """An evaluation's current status.

    Attributes:
        record: The stored record.
        state: The evaluation's state.
        progress: Counts and scores so far; None if none have been stored yet.
        message: The error message if the evaluation failed; empty otherwise.
        can_resume: Whether the evaluation has ended and has missing or broken runs.
        report: The report's state.
        report_message: The error message if writing the report failed; empty otherwise.
    """

    record: EvaluationRecord
    state: State
    progress: ProgressState | None
    message: str
    can_resume: bool
    report: ReportState
    report_message: str


@dataclass(frozen=True, slots=True)
class EvaluationRequest:
    """The options for a new evaluation. The names must already be validated.

    Attributes:
        pair: The pair of models.
        split: The dataset split.
        limit: Maximum number of tasks; None for all.
        categories: The categories; all if empty.
    """

    pair: str
    split: str
    limit: int | None = None
    categories: tuple[str, ...] = ()


class Evaluations:
    """A server's evaluations. The methods block, so call them in worker threads.

    Args:
        runs_dir: The runs folder.
        program: The beginning of the command line that runs ``scope``, to which the arguments are added.
    """

    def __init__(self, runs_dir: Path, program: Sequence[str] = (sys.executable, "-m", "scope_ptz.cli")) -> None:
        self.root = runs_dir / FOLDER
        self._program = tuple(program)
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._reports: dict[str, subprocess.Popen[bytes]] = {}
        self._report_failures: dict[str, str] = {}
        self._start_lock = threading.Lock()

    def ids(self) -> list[str]:
        """Return the ids of all evaluations, newest first."""
        if not self.root.is_dir():
            return []
        return sorted((path.name for path in self.root.iterdir() if path.is_dir() and not path.is_symlink()), reverse=True)

    def folder(self, evaluation: str) -> EvaluationFolder:
        """Return an evaluation's folder.

        Raises:
            UnknownNameError: There is no such evaluation.
        """
        known = next((name for name in self.ids() if name == evaluation), None)
        if known is None:
            raise UnknownNameError("evaluation", evaluation[:120], ())
        return EvaluationFolder(self.root / known)

    def all(self) -> list[EvaluationStatus]:
        """Return the status of each evaluation, newest first. Evaluations with a damaged record are skipped."""
        statuses = []
        for name in self.ids():
            try:
                statuses.append(self._status(EvaluationFolder(self.root / name)))
            except TraceError:
                continue
        return statuses

    def status(self, evaluation: str) -> EvaluationStatus:
        """Return an evaluation's current status.

        Raises:
            UnknownNameError: There is no such evaluation.
            TraceError: Its record is damaged.
        """
        return self._status(self.folder(evaluation))

    def _status(self, folder: EvaluationFolder) -> EvaluationStatus:
        record = folder.record()
        running = self._is_running(folder)
        progress = folder.state()
        state = _state(record, progress, running=running)
        complete = progress is not None and progress.finished and not progress.broken and progress.done >= progress.runs
        report, report_message = self._report_state(folder)
        return EvaluationStatus(
            record=record,
            state=state,
            progress=progress,
            message=last_message(folder.errors) if state == "failed" else "",
            can_resume=not running and not complete,
            report=report,
            report_message=report_message,
        )

    def running(self) -> str | None:
        """Return the id of the evaluation in progress; None if there is none."""
        return next((name for name in self.ids() if self._is_running(EvaluationFolder(self.root / name))), None)

    def start(self, request: EvaluationRequest, actor: str) -> str:
        """Start an evaluation and return its id.

        Raises:
            EvaluationRunningError: Another evaluation is in progress.
            OutputError: The folder cannot be written to, or the process cannot be started.
        """
        with self._start_lock:
            self._check_idle()
            now = datetime.now(UTC)
            name = f"{now:%Y%m%dT%H%M%SZ}-{request.split}-{secrets.token_hex(3)}"
            folder = EvaluationFolder(self.root / name)
            record = EvaluationRecord(
                id=name,
                pair=request.pair,
                split=request.split,
                limit=request.limit,
                categories=request.categories,
                started=now,
                actor=actor,
            )
            try:
                folder.path.mkdir(parents=True)
            except OSError as error:
                raise OutputError(f"The evaluation cannot be written to {self.root}: {error.strerror}.") from error
            folder.write(record)
            self._launch(folder, record)
        return name

    def resume(self, evaluation: str) -> None:
        """Resume an evaluation that has ended: run its missing and broken runs.

        Raises:
            UnknownNameError: There is no such evaluation.
            TraceError: Its record is damaged.
            EvaluationRunningError: An evaluation is in progress.
            InputError: No run is missing or broken.
        """
        with self._start_lock:
            self._check_idle()
            status, folder = self.status(evaluation), self.folder(evaluation)
            if not status.can_resume:
                raise InputError("This evaluation is complete: no run is missing or broken. Start a new one to repeat its tasks.")
            record = status.record.model_copy(update={"resumed": status.record.resumed + 1, "cancelled": False, "exit_code": None})
            folder.write(record)
            (folder.progress / STATE_FILE).unlink(missing_ok=True)  # the old state would report the evaluation as finished
            self._launch(folder, record)

    def cancel(self, evaluation: str) -> None:
        """Cancel an evaluation. Finished runs stay in its log. If it has already ended, the call has no effect.

        Raises:
            UnknownNameError: There is no such evaluation.
        """
        folder = self.folder(evaluation)
        if not self._is_running(folder):
            return
        folder.write(folder.record().model_copy(update={"cancelled": True}))
        self._signal(folder, signal.SIGTERM)
        threading.Thread(target=self._kill_later, args=(folder,), daemon=True).start()

    def remove(self, evaluation: str) -> None:
        """Remove an evaluation that has ended, with its logs and report.

        Raises:
            UnknownNameError: There is no such evaluation.
            EvaluationRunningError: The evaluation is in progress, or its report is being written.
        """
        folder = self.folder(evaluation)
        with self._start_lock:
            if self._is_running(folder) or evaluation in self._reports:
                raise EvaluationRunningError(evaluation)
            shutil.rmtree(folder.path, ignore_errors=True)

    def make_report(self, evaluation: str) -> None:
        """Start writing an evaluation's report, unless the report is up to date or already being written.

        Raises:
            UnknownNameError: There is no such evaluation.
            InputError: No run has finished yet.
        """
        folder = self.folder(evaluation)
        with self._start_lock:
            if evaluation in self._reports or folder.report_page() is not None:
                return
            log = folder.newest_log()
            if log is None or folder.state() is None or not folder.trials():
                raise InputError("No run of this evaluation has finished yet. Create the report after the first run.")
            self._report_failures.pop(evaluation, None)
            command = [*self._program, "bench", "report", str(log.resolve()), "--out", str(folder.report.resolve())]
            process = _spawn(command, folder.path / "report-output.txt", folder.report_errors)
            self._reports[evaluation] = process
        threading.Thread(target=self._watch_report, args=(folder, process), daemon=True).start()

    def close(self) -> None:
        """Stop writing reports, and log the id of an evaluation that continues without the server."""
        for process in list(self._reports.values()):
            process.terminate()
        if (name := self.running()) is not None:
            logger.warning("The evaluation %s continues in its own process. Start the server again to follow it.", name)

    def _check_idle(self) -> None:
        if (running := self.running()) is not None:
            raise EvaluationRunningError(running)

    def _is_running(self, folder: EvaluationFolder) -> bool:
        process = self._processes.get(folder.path.name)
        return (process is not None and process.poll() is None) or folder.is_locked()

    def _launch(self, folder: EvaluationFolder, record: EvaluationRecord) -> None:
        command = [*self._program, "bench", "run", "--split", record.split]
        command += ["--out", str(folder.logs.resolve()), "--progress", str(folder.progress.resolve())]
        command += [] if record.pair == DEFAULT_PAIR else ["--pair", record.pair]
        command += [] if record.limit is None else ["--limit", str(record.limit)]
        for category in record.categories:
            command += ["--category", category]
        process = _spawn(command, folder.output, folder.errors)
        self._processes[record.id] = process
        threading.Thread(target=self._watch, args=(folder, process), daemon=True).start()

    def _watch(self, folder: EvaluationFolder, process: subprocess.Popen[bytes]) -> None:
        code = process.wait()
        try:
            folder.write(folder.record().model_copy(update={"exit_code": code}))
        except (TraceError, OutputError) as error:
            logger.warning("The exit code of an evaluation was not recorded: %s", error)

    def _watch_report(self, folder: EvaluationFolder, process: subprocess.Popen[bytes]) -> None:
        if process.wait() != 0:
            self._report_failures[folder.path.name] = last_message(folder.report_errors) or "The report could not be written."
        self._reports.pop(folder.path.name, None)

    def _report_state(self, folder: EvaluationFolder) -> tuple[ReportState, str]:
        name = folder.path.name
        if name in self._reports:
            return "making", ""
        if name in self._report_failures:
            return "failed", self._report_failures[name]
        return ("ready" if folder.report_page() is not None else "none"), ""

    def _signal(self, folder: EvaluationFolder, signal_number: int) -> None:
        process = self._processes.get(folder.path.name)
        if process is not None and process.poll() is None:
            process.send_signal(signal_number)
        elif folder.is_locked() and (state := folder.state()) is not None:
            # Another server started this process. While the lock is held, the process exists, so its process id cannot be reused.
            with suppress(ProcessLookupError):
                os.kill(state.pid, signal_number)

    def _kill_later(self, folder: EvaluationFolder) -> None:
        deadline = time.monotonic() + KILL_AFTER_S
        while time.monotonic() < deadline:
            time.sleep(0.2)
            if not self._is_running(folder):
                return
        self._signal(folder, getattr(signal, "SIGKILL", signal.SIGTERM))


def _state(record: EvaluationRecord, progress: ProgressState | None, *, running: bool) -> State:
    if running:
        return "running"
    if progress is not None and progress.finished:
        return "finished"
    if record.cancelled:
        return "cancelled"
    return "failed" if record.exit_code is not None and record.exit_code > 0 else "interrupted"


def _spawn(command: Sequence[str], output: Path, errors: Path) -> subprocess.Popen[bytes]:
    """Start a command in a separate session, so that Ctrl-C does not interrupt it together with the server.

    Args:
        command: The command line.
        output: The file for stdout.
        errors: The file for stderr.

    Raises:
        OutputError: The command cannot be started.
    """
    try:
        with output.open("wb") as out, errors.open("wb") as err:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=err, start_new_session=True)
    except OSError as error:
        raise OutputError(f"The evaluation cannot be started: {error.strerror}.") from error
    if hasattr(os, "setpriority"):
        with suppress(ProcessLookupError):  # the process has already ended
            os.setpriority(os.PRIO_PROCESS, process.pid, NICENESS)
    return process
