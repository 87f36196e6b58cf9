"""An evaluation from its first sample to its last, however often it is broken off in between.

The log of an evaluation is the record of what is done. One that was killed is found again by its identity, a digest of everything
that decides its results; what it holds is taken over, and only the rest is run.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from inspect_ai import Task, eval_async
from inspect_ai._eval.loader import resolve_task_args
from inspect_ai._eval.task.task import PreviousTask
from inspect_ai.log import EvalLog, EvalLogInfo, read_eval_log_sample_async
from inspect_ai.log._recover import RecoveryNotAvailable, recover_eval_log_async
from inspect_ai.model import Model
from inspect_ai.util._display import init_display_type

from scope_ptz.bench.engine.annotations import check_beside, put_away
from scope_ptz.bench.engine.cards import AGENT_SOURCE, CARD, card_of
from scope_ptz.bench.engine.file_lock import lock_file
from scope_ptz.bench.engine.logs import DECIDES, read_evaluation, read_header, runs_in, uuids_in
from scope_ptz.bench.engine.sampling import sample_name
from scope_ptz.bench.scoring.trials import Evaluation, RunCard
from scope_ptz.errors import InputError, OutputError, TraceError

IDENTITY = "identity"
SUPERSEDED = "superseded"
"""Folder of logs whose runs another log has taken over."""

QUIET = "error"


@dataclass(frozen=True, slots=True)
class Found:
    """A log of the very evaluation that is wanted. ``runs``: by task and epoch, whether they need not be made again."""

    path: Path
    header: EvalLog
    runs: Mapping[tuple[str, int], bool]

    @property
    def done(self) -> int:
        return sum(self.runs.values())

    @property
    def finished(self) -> bool:
        """Whether nothing is left to do: a few broken runs do not fail a log, and are to be made again all the same."""
        return self.header.status == "success" and all(self.runs.values())


@dataclass(frozen=True, slots=True)
class Setting:
    """How an evaluation is run, beside its task. ``planner``: None for other people's agents; ``judge``: None for checks alone."""

    log_dir: Path
    planner: Model | None
    eyes: Model
    judge: Model | None
    concurrency: int
    identity: str
    card: RunCard


def identity_of(*parts: Any) -> str:
    """Names an evaluation by everything that decides its results."""
    return hashlib.sha256(json.dumps(parts, sort_keys=True, default=str).encode()).hexdigest()[:16]


async def find(log_dir: Path, identity: str) -> list[Found]:
    """The logs of an evaluation in a folder, the one that got furthest first. What a killed program had finished and not yet
    written is written now, into a log beside its own."""
    for log in _logs_of(log_dir, identity):
        if log.header.status == "started":
            with suppress(RecoveryNotAvailable):
                await recover_eval_log_async(str(log.path), cleanup=True)
    return sorted(_logs_of(log_dir, identity), key=lambda log: (log.finished, log.done), reverse=True)


def _logs_of(log_dir: Path, identity: str) -> list[Found]:
    logs = []
    for path in sorted(log_dir.glob("*.eval")):
        try:
            log = found(path)
        except TraceError:
            continue  # nothing that can be gone on with
        if (log.header.eval.metadata or {}).get(IDENTITY) == identity:
            logs.append(log)
    return logs


def found(path: Path) -> Found:
    """A log to go on with. Raises ``TraceError``."""
    return Found(path, read_header(path), runs_in(path))


def earlier(log_dir: Path, planner: str, eyes: str) -> list[Evaluation]:
    """Evaluations of a pair of which there are logs in a folder. A run that stands in several, because it was taken over, is in
    the first of them only."""
    told, seen = [], set[str]()
    for path in sorted(log_dir.glob("*.eval")):
        try:
            card = card_of(read_header(path), None)
            if (card.planner.name, card.perception.name) != (planner, eyes):
                continue
            names = {sample_name(*run): uuid for run, uuid in uuids_in(path).items()}
            evaluation = read_evaluation(path)
        except TraceError:
            continue  # what cannot be read tells nothing
        new = tuple(t for t in evaluation.trials if names.get(t.sample) is None or names[t.sample] not in seen)
        seen |= {uuid for uuid in names.values() if uuid is not None}
        if new:
            told.append(evaluation.model_copy(update={"trials": new}))
    return told


def of_other_source(log_dir: Path, agent: str, source: str, tasks: str) -> Path | None:
    """The newest log of these ``tasks`` (their digest) by an agent of this name with code of another digest; None without any."""
    for path in sorted(log_dir.glob("*.eval"), reverse=True):
        try:
            card = card_of(read_header(path), None)
        except TraceError:
            continue  # what cannot be read tells nothing
        if (card.agent, card.dataset_digest) == (agent, tasks) and card.sampling.get(AGENT_SOURCE) != source:
            return path
    return None


@contextmanager
def alone(log_dir: Path, identity: str) -> Iterator[None]:
    """Keeps a second program from doing the same evaluation at the same time. Raises ``InputError`` or ``OutputError``."""
    try:
        log_dir.mkdir(parents=True, exist_ok=True)
        lock = (log_dir / f".{identity}.lock").open("w")
    except OSError as error:
        raise OutputError(f"The log folder {log_dir} cannot be written: {error.strerror}. Choose another with --out.") from error
    with lock:
        if not lock_file(lock):
            raise InputError(f"This very evaluation is running already, into {log_dir}.")
        yield


async def run(task: Task, setting: Setting, before: Sequence[Found]) -> Path:
    """Run a task, taking over what the logs ``before`` hold; the path of the log. An evaluation that is cancelled leaves its log
    behind.

    Raises ``OutputError`` when it was stopped before there was one, ``TraceError`` when it failed as a whole.
    """
    check_beside([old.path for old in before])
    init_display_type("none")
    told = (before[0].header.eval.metadata or {}).get(CARD) if before else None
    card = RunCard.model_validate(told) if told else setting.card
    named = (before[0].header.eval.metadata or {}).get(DECIDES) if before else None
    logs = await eval_async(
        await _going_on(task, before) if before else task,
        model=setting.planner or setting.eyes,
        model_roles=_roles(setting),
        metadata={CARD: card.model_dump(mode="json"), IDENTITY: setting.identity, **({DECIDES: named} if named else {})},
        log_dir=str(setting.log_dir),
        log_format="eval",
        log_images=True,
        log_header_only=True,
        log_level=QUIET,
        max_samples=setting.concurrency,
        score_display=False,
        ctl_server=False,
    )
    if not logs:  # it was cancelled
        left = _logs_of(setting.log_dir, setting.identity)
        if not left:
            raise OutputError(f"The evaluation was stopped before it had written a log into {setting.log_dir}.")
        return max(left, key=lambda log: log.done).path
    (log,) = logs
    if log.error is not None and not (log.results and log.results.completed_samples):
        raise TraceError(f"The evaluation failed: {log.error.message}")
    written = Path(log.location)
    if log.status in ("success", "error"):
        put_away([old.path for old in before if old.path.name != written.name], written, written.parent / SUPERSEDED)
    return written


async def _going_on(task: Task, before: Sequence[Found]) -> PreviousTask:
    """A task with what was done of it. Runs that only a lesser log holds are read into memory with all others."""
    best, *lesser = before
    known = {run for run, stays in best.runs.items() if stays}
    further = [(log, run) for log in lesser for run, stays in log.runs.items() if stays and run not in known]
    header, info = best.header, _info(best.path, best.header)
    if further:
        places = dict([*((run, best) for run in known), *((run, log) for log, run in further)])
        whole = [await read_eval_log_sample_async(str(log.path), name, epoch) for (name, epoch), log in places.items()]
        header = header.model_copy(update={"samples": whole})
    return PreviousTask(
        id=header.eval.task_id, task=task, task_args=resolve_task_args(task), model=None, model_roles=None, sandbox=None,
        log=header, log_info=None if further else info,
    )  # fmt: skip


def _roles(setting: Setting) -> Mapping[str, Model | list[Model] | str | list[str]]:
    roles = {"planner": setting.planner, "eyes": setting.eyes, "judge": setting.judge}
    return {role: model for role, model in roles.items() if model is not None}


def _info(path: Path, header: EvalLog) -> EvalLogInfo:
    return EvalLogInfo(
        name=str(path), type="file", size=path.stat().st_size, mtime=path.stat().st_mtime, task=header.eval.task,
        task_id=header.eval.task_id, suffix=None,
    )  # fmt: skip
