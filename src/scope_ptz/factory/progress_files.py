"""Write the progress of an evaluation to files, so that another program can follow it."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import IO, TYPE_CHECKING

from scope_ptz.bench.engine.file_lock import lock_file
from scope_ptz.bench.reports.progress_state import (
    LOCK_FILE,
    STATE_FILE,
    TRIALS_FILE,
    ProgressState,
    RunningTask,
)
from scope_ptz.bench.reports.running_score import score_fields
from scope_ptz.errors import InputError, OutputError
from scope_ptz.factory.evaluation_options import EvaluationPlan, EvaluationProgress, EvaluationResult

if TYPE_CHECKING:
    from scope_ptz.bench.engine.entries import Entry
    from scope_ptz.bench.scoring.trials import Trial

MAX_NOTES = 20  # maximum number of notes in the state; older notes are dropped


class ProgressFiles(EvaluationProgress):
    """Writes ``progress.json`` (the state, replaced as a whole) and ``trials.jsonl`` (one finished run per line) to a folder.

    The file ``progress.lock`` is locked until ``close`` is called or the process ends for any reason.

    Args:
        folder: The folder, which is created if needed.

    Raises:
        InputError: Another evaluation is writing to the folder.
        OutputError: The folder cannot be written to.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._trials: dict[str, Trial] = {}
        self._running: dict[str, RunningTask] = {}
        self._notes: list[str] = []
        self._started_s, self._finished_before, self._failed = time.monotonic(), 0, False
        self._state = ProgressState(pid=os.getpid(), runs=0)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._lock: IO[str] = (folder / LOCK_FILE).open("w")
        except OSError as error:
            raise OutputError(f"The progress cannot be written to {folder}: {error.strerror}. Choose another folder.") from error
        if not lock_file(self._lock):
            self._lock.close()
            raise InputError(
                f"Another evaluation is writing its progress to {folder}. Wait until it ends, or choose another folder."
            )
        self._write()

    def close(self) -> None:
        """Release the lock."""
        self._lock.close()

    def note(self, text: str) -> None:
        self._notes = [*self._notes, text][-MAX_NOTES:]
        self._write()

    def planned(self, plan: EvaluationPlan) -> None:
        self._state = self._state.model_copy(update={"runs": plan.runs})
        self._started_s, self._finished_before = time.monotonic(), len(plan.finished)
        self._replace_trials({trial.sample: trial for trial in plan.finished})
        self._write()

    def run_began(self, sample: str, entry: Entry) -> None:
        facts = entry.facts
        self._running[sample] = RunningTask(task=facts.id, instruction=facts.instruction, since=datetime.now(UTC))
        self._write()

    def run_ended(self, sample: str, trial: Trial) -> None:
        self._running.pop(sample, None)
        again = sample in self._trials
        self._trials[sample] = trial
        if again:
            self._replace_trials(self._trials)
        else:
            self._try_to_write(lambda: self._append(trial))
        self._write()

    def closed(self) -> None:
        self._running.clear()
        self._write()

    def finish(self, result: EvaluationResult) -> None:
        """Store the final result, as read from the log. Call this when the evaluation has ended without an error."""
        evaluation = result.evaluation
        self._state = self._state.model_copy(update={"runs": evaluation.wanted, "log": Path(evaluation.log).name, "finished": True})
        self._replace_trials({trial.sample: trial for trial in evaluation.trials})
        self._write()

    def _seconds_left(self) -> float | None:
        new = len(self._trials) - self._finished_before
        if new < 1 or self._state.finished:
            return None
        return (time.monotonic() - self._started_s) / new * max(self._state.runs - len(self._trials), 0)

    def _write(self) -> None:
        state = self._state.model_copy(
            update={
                **score_fields(tuple(self._trials.values())),
                "running": tuple(self._running.values()),
                "seconds_left": self._seconds_left(),
                "notes": tuple(self._notes),
            }
        )
        self._try_to_write(lambda: self._replace(STATE_FILE, state.model_dump_json()))

    def _replace_trials(self, trials: dict[str, Trial]) -> None:
        self._trials = dict(trials)
        self._try_to_write(lambda: self._replace(TRIALS_FILE, "".join(f"{trial.model_dump_json()}\n" for trial in trials.values())))

    def _append(self, trial: Trial) -> None:
        with (self._folder / TRIALS_FILE).open("a", encoding="utf-8") as file:
            file.write(f"{trial.model_dump_json()}\n")

    def _replace(self, name: str, text: str) -> None:
        new = self._folder / f".{name}.new"
        new.write_text(text, "utf-8")
        new.replace(self._folder / name)

    def _try_to_write(self, write: Callable[[], None]) -> None:
        """Write a file. A failure is only reported as a note, because a full disk must not stop the evaluation."""
        try:
            write()
        except OSError as error:
            if not self._failed:
                self._notes.append(f"The progress cannot be written: {error.strerror}.")
            self._failed = True


class ProgressGroup(EvaluationProgress):
    """Forwards progress to several receivers."""

    def __init__(self, *receivers: EvaluationProgress) -> None:
        self._receivers = receivers

    def note(self, text: str) -> None:
        for receiver in self._receivers:
            receiver.note(text)

    def planned(self, plan: EvaluationPlan) -> None:
        for receiver in self._receivers:
            receiver.planned(plan)

    def closed(self) -> None:
        for receiver in self._receivers:
            receiver.closed()

    def run_began(self, sample: str, entry: Entry) -> None:
        for receiver in self._receivers:
            receiver.run_began(sample, entry)

    def run_ended(self, sample: str, trial: Trial) -> None:
        for receiver in self._receivers:
            receiver.run_ended(sample, trial)
