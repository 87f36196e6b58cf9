"""Run an evaluation, and resume it after interruptions.

An interrupted evaluation is resumed from its log, which is found by its identity: a digest of everything that affects the results.
The completed runs of the log are taken over, and only the others are run.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from inspect_ai import Task, eval_async
from inspect_ai.log import EvalLog, EvalLogInfo, read_eval_log_sample_async
from inspect_ai.model import Model

from scope_ptz.bench.engine.annotations import check_beside, put_away
from scope_ptz.bench.engine.file_lock import lock_file
from scope_ptz.bench.engine.inspect_internals import PreviousTask, recover_log, resumed_task, silence_display
from scope_ptz.bench.engine.logs import DECIDES, read_evaluation, read_header, runs_in, uuids_in
from scope_ptz.bench.engine.run_cards import AGENT_SOURCE, CARD, card_of
from scope_ptz.bench.engine.samples import sample_name
from scope_ptz.bench.scoring.trials import Evaluation, RunCard
from scope_ptz.errors import InputError, OutputError, TraceError

IDENTITY = "identity"
SUPERSEDED = "superseded"
"""Folder for logs whose runs another log has taken over."""

LOG_LEVEL = "error"


@dataclass(frozen=True, slots=True)
class StoredLog:
    """A log of the requested evaluation. ``runs`` maps task and epoch to whether the run is complete."""

    path: Path
    header: EvalLog
    runs: Mapping[tuple[str, int], bool]

    @property
    def done(self) -> int:
        """Number of complete runs."""
        return sum(self.runs.values())

    @property
    def finished(self) -> bool:
        """Whether nothing is left to run. Status "success" is not enough, because a log with it may contain broken runs."""
        return self.header.status == "success" and all(self.runs.values())


@dataclass(frozen=True, slots=True)
class EngineSetup:
    """How the engine runs a task.

    Attributes:
        log_dir: Folder for the log.
        planner: The planner's model; None for external agents.
        perception: The perception's model.
        judge: The judge's model; None to apply only the checks.
        concurrency: Number of concurrent runs.
        identity: The identity of the evaluation.
        card: Run card for the log.
        realtime: Record events while a run is in progress, so that a killed evaluation loses no finished run. This slows runs
            down, so it is worthwhile only for expensive runs.
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

    Runs that a killed program had finished but not written are first recovered into a log of their own.
    """
    for log in _logs_of(log_dir, identity):
        if log.header.status == "started":
            await recover_log(log.path)
    return sorted(_logs_of(log_dir, identity), key=lambda log: (log.finished, log.done), reverse=True)


def _logs_of(log_dir: Path, identity: str) -> list[StoredLog]:
    logs = []
    for path in sorted(log_dir.glob("*.eval")):
        try:
            log = stored_log(path)
        except TraceError:
            continue  # A damaged log cannot be resumed.
        if (log.header.eval.metadata or {}).get(IDENTITY) == identity:
            logs.append(log)
    return logs


def stored_log(path: Path) -> StoredLog:
    """Return a log to resume. Raises ``TraceError``."""
    return StoredLog(path, read_header(path), runs_in(path))


def earlier_evaluations(log_dir: Path, planner: str, perception: str) -> list[Evaluation]:
    """Return the evaluations of a pair in a folder. A run that several logs contain is returned only once."""
    found, seen = [], set[str]()
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
            found.append(evaluation.model_copy(update={"trials": new}))
    return found


def log_of_other_source(log_dir: Path, agent: str, source: str, tasks: str) -> Path | None:
    """Return the newest log of the same tasks and agent with another version of the agent's source; None if there is none.

    ``source`` and ``tasks`` are digests.
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
def exclusive(log_dir: Path, identity: str) -> Iterator[None]:
    """Prevent a second program from running the same evaluation. Raises ``InputError`` or ``OutputError``."""
    try:
        log_dir.mkdir(parents=True, exist_ok=True)
        lock = (log_dir / f".{identity}.lock").open("w")
    except OSError as error:
        raise OutputError(f"The log folder {log_dir} cannot be written: {error.strerror}. Choose another with --out.") from error
    with lock:
        if not lock_file(lock):
            raise InputError(f"This evaluation is running already and writes to {log_dir}.")
        yield


async def run(task: Task, setup: EngineSetup, before: Sequence[StoredLog]) -> Path:
    """Run a task, take over the runs of earlier logs, and return the path of the log. A cancelled evaluation keeps its log.

    Args:
        task: The task.
        setup: How to run it.
        before: Logs of the same evaluation, the most complete first.

    Raises:
        OutputError: The evaluation was stopped before there was a log.
        TraceError: The evaluation failed as a whole.
    """
    check_beside([old.path for old in before])
    silence_display()
    stored_card = (before[0].header.eval.metadata or {}).get(CARD) if before else None
    card = RunCard.model_validate(stored_card) if stored_card else setup.card
    named = (before[0].header.eval.metadata or {}).get(DECIDES) if before else None
    logs = await eval_async(
        await _resumed(task, before) if before else task,
        model=setup.planner or setup.perception,
        model_roles=_roles(setup),
        metadata={CARD: card.model_dump(mode="json"), IDENTITY: setup.identity, **({DECIDES: named} if named else {})},
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
        left = _logs_of(setup.log_dir, setup.identity)
        if not left:
            raise OutputError(f"The evaluation was stopped before it wrote a log to {setup.log_dir}.")
        return max(left, key=lambda log: log.done).path
    (log,) = logs
    if log.error is not None and not (log.results and log.results.completed_samples):
        raise TraceError(f"The evaluation failed: {log.error.message}")
    written = Path(log.location)
    if log.status in ("success", "error"):
        put_away([old.path for old in before if old.path.name != written.name], written, written.parent / SUPERSEDED)
    return written


async def _resumed(task: Task, before: Sequence[StoredLog]) -> PreviousTask:
    """Return a task that takes over the complete runs of earlier logs. Runs of several logs are read into memory."""
    best, *others = before
    known = {run for run, complete in best.runs.items() if complete}
    further = [(log, run) for log in others for run, complete in log.runs.items() if complete and run not in known]
    header, info = best.header, _info(best.path, best.header)
    if further:
        sources = dict([*((run, best) for run in known), *((run, log) for log, run in further)])
        whole = [await read_eval_log_sample_async(str(log.path), name, epoch) for (name, epoch), log in sources.items()]
        header = header.model_copy(update={"samples": whole})
    return resumed_task(task, header, None if further else info)


def _roles(setup: EngineSetup) -> Mapping[str, Model | list[Model] | str | list[str]]:
    roles = {"planner": setup.planner, "eyes": setup.perception, "judge": setup.judge}
    return {role: model for role, model in roles.items() if model is not None}


def _info(path: Path, header: EvalLog) -> EvalLogInfo:
    return EvalLogInfo(
        name=str(path), type="file", size=path.stat().st_size, mtime=path.stat().st_mtime, task=header.eval.task,
        task_id=header.eval.task_id, suffix=None,
    )  # fmt: skip
