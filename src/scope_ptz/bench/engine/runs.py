"""Run evaluations, and resume them after interruptions.

An interrupted evaluation is resumed from its log. The log is found by the identity of the evaluation, a digest of everything that
affects its results. Complete runs in the log are reused, and only the other runs are executed.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from inspect_ai import Task, eval_async
from inspect_ai.log import EvalLog, EvalLogInfo, read_eval_log_sample_async
from inspect_ai.model import Model

from scope_ptz.bench.engine.annotations import archive_logs, check_labels
from scope_ptz.bench.engine.file_lock import lock_file
from scope_ptz.bench.engine.inspect_internals import PreviousTask, recover_log, resumed_task, silence_display
from scope_ptz.bench.engine.logs import DECIDING_JUDGE_KEY, read_evaluation, read_header, run_completion, uuids_in
from scope_ptz.bench.engine.run_cards import AGENT_SOURCE, CARD, card_of
from scope_ptz.bench.engine.stored_run import sample_name
from scope_ptz.bench.scoring.trials import Evaluation, RunCard
from scope_ptz.errors import InputError, OutputError, TraceError

IDENTITY = "identity"
"""Key for the identity of the evaluation in a log's metadata."""
SUPERSEDED_FOLDER = "superseded"
"""Name of the folder for logs whose runs have been carried over to another log."""

LOG_LEVEL = "error"
"""Minimum level of Inspect's own log messages."""
TRACE_LEVEL = "INFO"
"""Level of Inspect's own trace file, unless INSPECT_TRACE_LEVEL is set. At Inspect's default level, every call is written to it."""


@dataclass(frozen=True, slots=True)
class StoredLog:
    """A log and the state of its runs.

    Attributes:
        path: Path of the log.
        header: Header of the log.
        runs: Whether each run is complete, by task and epoch.
    """

    path: Path
    header: EvalLog
    runs: Mapping[tuple[str, int], bool]

    @property
    def complete_runs(self) -> int:
        """Number of complete runs."""
        return sum(self.runs.values())

    @property
    def finished(self) -> bool:
        """Whether every run is complete. Even a log with the status "success" may contain incomplete runs."""
        return self.header.status == "success" and all(self.runs.values())


@dataclass(frozen=True, slots=True)
class EngineSetup:
    """The settings for running a task.

    Attributes:
        log_dir: Folder for the log.
        planner: Inspect model of the planner; None for external agents.
        perception: Inspect model of the perception backend.
        judge: Inspect model of the judge; None to run only the checks.
        concurrency: Number of concurrent runs.
        identity: The identity of the evaluation.
        card: Run card for the log.
        realtime: Whether to write events while a run is in progress, so that finished runs are not lost if the evaluation is
            killed. This slows runs down, so it is worthwhile only for expensive runs.
    """

    log_dir: Path
    planner: Model | None
    perception: Model
    judge: Model | None
    concurrency: int
    identity: str
    card: RunCard
    realtime: bool = True


def identity_of(*parts: Any) -> str:
    """Return the identity of an evaluation: a digest of everything that affects its results."""
    return hashlib.sha256(json.dumps(parts, sort_keys=True, default=str).encode()).hexdigest()[:16]


async def find_logs(log_dir: Path, identity: str) -> list[StoredLog]:
    """Return the logs of an evaluation in a folder, the most complete first.

    If the program was killed, the runs that had finished but were missing from the log are first recovered into a separate log.
    """
    for log in _logs_of(log_dir, identity):
        if log.header.status == "started":
            await recover_log(log.path)
    return sorted(_logs_of(log_dir, identity), key=lambda log: (log.finished, log.complete_runs), reverse=True)


def _logs_of(log_dir: Path, identity: str) -> list[StoredLog]:
    logs = []
    for path in sorted(log_dir.glob("*.eval")):
        try:
            log = read_stored_log(path)
        except TraceError:
            continue  # A damaged log cannot be resumed.
        if (log.header.eval.metadata or {}).get(IDENTITY) == identity:
            logs.append(log)
    return logs


def read_stored_log(path: Path) -> StoredLog:
    """Read the log at a path. Raises ``TraceError``."""
    return StoredLog(path, read_header(path), run_completion(path))


def earlier_evaluations(log_dir: Path, planner: str, perception: str) -> list[Evaluation]:
    """Read the evaluations of a pair from the logs in a folder. A run that is in several logs is returned only once."""
    evaluations, seen = [], set[str]()
    for path in sorted(log_dir.glob("*.eval")):
        try:
            card = card_of(read_header(path), None)
            if (card.planner.name, card.perception.name) != (planner, perception):
                continue
            names = {sample_name(*run): uuid for run, uuid in uuids_in(path).items()}
            evaluation = read_evaluation(path)
        except TraceError:
            continue  # A damaged log is skipped.
        new = tuple(t for t in evaluation.trials if names.get(t.sample) is None or names[t.sample] not in seen)
        seen |= {uuid for uuid in names.values() if uuid is not None}
        if new:
            evaluations.append(evaluation.model_copy(update={"trials": new}))
    return evaluations


def log_with_other_source(log_dir: Path, agent: str, source: str, tasks: str) -> Path | None:
    """Return the newest log of the same tasks and agent with a different agent source; None if there is none.

    Args:
        log_dir: Folder of the logs.
        agent: Name of the external agent.
        source: Digest of the agent's current source.
        tasks: Digest of the tasks.
    """
    for path in sorted(log_dir.glob("*.eval"), reverse=True):
        try:
            card = card_of(read_header(path), None)
        except TraceError:
            continue  # A damaged log is skipped.
        if (card.agent, card.dataset_digest) == (agent, tasks) and card.sampling.get(AGENT_SOURCE) != source:
            return path
    return None


@contextmanager
def evaluation_lock(log_dir: Path, identity: str) -> Iterator[None]:
    """Lock an evaluation, so that no other program can run it at the same time.

    Raises:
        InputError: Another program is running the evaluation.
        OutputError: The log folder cannot be written to.
    """
    try:
        log_dir.mkdir(parents=True, exist_ok=True)
        lock = (log_dir / f".{identity}.lock").open("w")
    except OSError as error:
        raise OutputError(
            f"The log folder {log_dir} cannot be written to: {error.strerror}. Choose another folder with --out."
        ) from error
    with lock:
        if not lock_file(lock):
            raise InputError(f"This evaluation is already running and writing to {log_dir}. Wait until it ends, or stop it.")
        yield


async def run(task: Task, setup: EngineSetup, earlier: Sequence[StoredLog]) -> Path:
    """Run a task, reusing the complete runs in earlier logs, and return the path of the log.

    If the evaluation is cancelled, return the path of its partial log.

    Args:
        task: The task.
        setup: The settings of the engine.
        earlier: Logs of the same evaluation, the most complete first.

    Raises:
        OutputError: The evaluation was cancelled before it wrote a log.
        TraceError: The evaluation failed without completing a run.
    """
    check_labels([log.path for log in earlier])
    silence_display()
    stored_card = (earlier[0].header.eval.metadata or {}).get(CARD) if earlier else None
    card = RunCard.model_validate(stored_card) if stored_card else setup.card
    deciding_judge = (earlier[0].header.eval.metadata or {}).get(DECIDING_JUDGE_KEY) if earlier else None
    metadata = {CARD: card.model_dump(mode="json"), IDENTITY: setup.identity}
    if deciding_judge:
        metadata[DECIDING_JUDGE_KEY] = deciding_judge
    os.environ.setdefault("INSPECT_TRACE_LEVEL", TRACE_LEVEL)
    logs = await eval_async(
        await _resume_task(task, earlier) if earlier else task,
        model=setup.planner or setup.perception,
        model_roles=_model_roles(setup),
        metadata=metadata,
        log_dir=str(setup.log_dir),
        log_format="eval",
        log_images=True,
        log_header_only=True,
        log_realtime=setup.realtime,
        log_level=LOG_LEVEL,
        max_samples=setup.concurrency,
        score_display=False,
        ctl_server=False,
    )
    if not logs:  # The evaluation was cancelled.
        partial_logs = _logs_of(setup.log_dir, setup.identity)
        if not partial_logs:
            raise OutputError(f"The evaluation was stopped before it wrote a log to {setup.log_dir}.")
        return max(partial_logs, key=lambda log: log.complete_runs).path
    (log,) = logs
    if log.error is not None and not (log.results and log.results.completed_samples):
        raise TraceError(f"The evaluation failed: {log.error.message}")
    log_path = Path(log.location)
    if log.status in ("success", "error"):
        archive_logs([old.path for old in earlier if old.path.name != log_path.name], log_path, log_path.parent / SUPERSEDED_FOLDER)
    return log_path


async def _resume_task(task: Task, earlier: Sequence[StoredLog]) -> PreviousTask:
    """Return a task that reuses the complete runs in earlier logs.

    If these runs are in several logs, their samples are read into memory.
    """
    best, *others = earlier
    best_runs = {run for run, complete in best.runs.items() if complete}
    other_runs = [(log, run) for log in others for run, complete in log.runs.items() if complete and run not in best_runs]
    header, info = best.header, _log_info(best.path, best.header)
    if other_runs:
        sources = dict([*((run, best) for run in best_runs), *((run, log) for log, run in other_runs)])
        samples = [await read_eval_log_sample_async(str(log.path), name, epoch) for (name, epoch), log in sources.items()]
        header = header.model_copy(update={"samples": samples})
    return resumed_task(task, header, None if other_runs else info)


def _model_roles(setup: EngineSetup) -> Mapping[str, Model | list[Model] | str | list[str]]:
    roles = {"planner": setup.planner, "eyes": setup.perception, "judge": setup.judge}
    return {role: model for role, model in roles.items() if model is not None}


def _log_info(path: Path, header: EvalLog) -> EvalLogInfo:
    return EvalLogInfo(
        name=str(path), type="file", size=path.stat().st_size, mtime=path.stat().st_mtime, task=header.eval.task,
        task_id=header.eval.task_id, suffix=None,
    )  # fmt: skip
