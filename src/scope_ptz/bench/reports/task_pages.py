"""What stands on the page of a failed task: what was asked and expected, and every trial that failed, step by step."""

from __future__ import annotations

import hashlib
import io
import json
import re
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Protocol

from scope_ptz.agent.records import Called
from scope_ptz.agent.trace import Trace
from scope_ptz.bench.reports.report_runs import ReportRun
from scope_ptz.bench.scoring.trials import Evaluation, Trial
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import ScopeError

FRAME_WIDTH = 640
MOST_PIXELS = 64_000_000
MOST_TEXT = 2_000


class StoredRun(Protocol):
    """What a log keeps of one run: its trace, and its pictures by the names that the trace uses."""

    @property
    def trace(self) -> Trace: ...

    def picture(self, name: str) -> bytes | None: ...


OpenSample = Callable[[Evaluation, Trial], StoredRun]


@dataclass(frozen=True, slots=True)
class CallShown:
    """``frame``: path of its picture relative to the report's folder."""

    call: str
    said: str
    failed: bool
    pose: str
    replies: tuple[str, ...]
    frame: str | None


@dataclass(frozen=True, slots=True)
class StepShown:
    number: int
    thought: str
    calls: tuple[CallShown, ...]
    view: str | None = None


@dataclass(frozen=True, slots=True)
class FailedRun:
    """``missing``: why the trajectory cannot be shown."""

    run: ReportRun
    trial: Trial
    steps: tuple[StepShown, ...] = ()
    first_frame: str | None = None
    missing: str = ""


@dataclass(frozen=True, slots=True)
class TaskPage:
    task: str
    file: str
    evidence: tuple[str, ...]
    runs: tuple[FailedRun, ...]

    @property
    def facts(self) -> Any:
        return self.runs[0].trial.task


def page_files(evaluations: Sequence[Evaluation]) -> dict[str, str]:
    """The page of each task that failed, relative to the report's folder. Names are made here: nothing of a log is ever a path."""
    failed = {t.task.id for e in evaluations for t in e.trials if t.headline in ("incorrect", "unscored")}
    return {task: f"tasks/{file_name(task)}" for task in sorted(failed)}


def file_name(task: str) -> str:
    """A harmless file name, stable and unlike any other task's."""
    readable = re.sub(r"[^a-z0-9]+", "-", task.lower()).strip("-")[:60]
    return f"{readable or 'task'}-{hashlib.sha256(task.encode()).hexdigest()[:10]}.html"


class FrameStore:
    """Pictures of the report: decoded, made small and written again under the hash of what came, so that none is kept twice."""

    def __init__(self, folder: Path, shown_as: str) -> None:
        self._folder, self._shown_as = folder, shown_as
        self._known: dict[str, str | None] = {}

    def keep(self, content: bytes | None) -> str | None:
        """Where the picture stands, as pages refer to it; None when there is none or it cannot be read."""
        if not content:
            return None
        digest = hashlib.sha256(content).hexdigest()[:24]
        if digest not in self._known:
            self._known[digest] = self._write(content, digest)
        return self._known[digest]

    def _write(self, content: bytes, digest: str) -> str | None:
        from PIL import Image

        try:
            with Image.open(io.BytesIO(content), formats=("JPEG", "PNG", "WEBP")) as picture:
                if picture.width * picture.height > MOST_PIXELS:
                    return None
                small = picture.convert("RGB")
        except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
            return None
        small.thumbnail((FRAME_WIDTH * 2 if small.width > 3 * small.height else FRAME_WIDTH, FRAME_WIDTH))
        self._folder.mkdir(parents=True, exist_ok=True)
        small.save(self._folder / f"{digest}.jpg", quality=82, optimize=True)
        return f"{self._shown_as}/{digest}.jpg"


def task_pages(
    runs: Sequence[ReportRun],
    files: Mapping[str, str],
    open_sample: OpenSample | None,
    frames: FrameStore,
    tasks: Mapping[str, Task],
) -> list[Callable[[], TaskPage]]:
    """Pages, made one at a time when they are called for, because pictures take memory."""
    failed: dict[str, list[tuple[ReportRun, Trial]]] = defaultdict(list)
    for run in runs:
        for trial in run.evaluation.trials:
            if trial.task.id in files and trial.headline in ("incorrect", "unscored"):
                failed[trial.task.id].append((run, trial))

    def page(task: str) -> TaskPage:
        shown = tuple(_failed_run(run, trial, open_sample, frames) for run, trial in failed[task])
        return TaskPage(task, files[task], evidence_lines(tasks.get(task)), shown)

    return [partial(page, task) for task in sorted(failed)]


def _failed_run(run: ReportRun, trial: Trial, open_sample: OpenSample | None, frames: FrameStore) -> FailedRun:
    if open_sample is None:
        return FailedRun(run, trial, missing="Trajectories were left out of this report.")
    try:
        sample = open_sample(run.evaluation, trial)
        trace = sample.trace
        return FailedRun(run, trial, _steps(trace, sample, frames), _kept(trace.started.frame, sample, frames))
    except ScopeError as error:
        return FailedRun(run, trial, missing=f"The log does not give the trajectory: {error}")


def _kept(name: str | None, sample: StoredRun, frames: FrameStore) -> str | None:
    return None if name is None else frames.keep(sample.picture(name))


def _steps(trace: Trace, sample: StoredRun, frames: FrameStore) -> tuple[StepShown, ...]:
    shown = []
    for decided in trace.decisions:
        calls = tuple(_call(called, sample, frames) for called in trace.calls if called.step == decided.step)
        decision = decided.decision
        thought = "; ".join(part for part in (getattr(decision, "thought", ""), decision.reasoning) if part)
        shown.append(StepShown(decided.step, cut(thought), calls, _kept(decided.view, sample, frames)))
    return tuple(shown)


def _call(called: Called, sample: StoredRun, frames: FrameStore) -> CallShown:
    outcome = called.outcome
    arguments = ", ".join(f"{key}={json.dumps(value, ensure_ascii=False)}" for key, value in outcome.call.arguments.items())
    failed = outcome.error is not None
    said = outcome.error if outcome.error is not None else _message(outcome.result)
    pose = f"pan {called.pose.pan_deg:.1f}°, tilt {called.pose.tilt_deg:.1f}°, zoom {called.pose.zoom:.2f}x"
    replies = tuple(
        cut(
            f"{reply.kind}{f' “{reply.asked}”' if reply.asked else ''}: {reply.error or _seen(reply.result)} ({reply.wall_s:.2f} s)"
        )
        for reply in called.replies
    )
    return CallShown(
        cut(f"{outcome.call.name}({arguments})"), cut(said), failed, pose, replies, _kept(called.frame, sample, frames)
    )


def _message(result: Mapping[str, Any] | None) -> str:
    if result is None:
        return "nothing"
    for key in ("message", "text", "answer", "caption"):
        if isinstance(result.get(key), str) and result[key]:
            return str(result[key])
    return _in_words(result)


def _seen(result: Mapping[str, Any] | None) -> str:
    """What the eyes said: places in percent of the frame, texts as they are. Who was asked, how often and the raw reply are left to
    the log."""
    for key, one in (("boxes", "box"), ("points", "point")):
        places = result.get(key) if result else None
        if isinstance(places, list | tuple) and result is not None:
            number = f"{len(places)} {one if len(places) == 1 else key}" if places else f"no {one}"
            more = "" if result.get("complete", True) else ", and more than these"
            where = "; ".join(_place(place) for place in places)
            return f"{number}{more}{f': {where}' if where else ''}{_notes(result)}"
    return _message(result) + _notes(result or {})


def _place(place: Any) -> str:
    """A box or a point: from left and from top, in percent of the frame. What is neither is told as it is."""
    if not isinstance(place, Mapping):
        return _in_words(place)
    sides = [_percent(place, axis) for axis in "xy"]
    if None in sides:
        return _in_words(place)
    score = place.get("score")
    said = [str(place["label"])] if place.get("label") else []
    said += [f"score {score:.2f}"] if isinstance(score, int | float) else []
    return f"{' '.join([*said, 'at'] if said else ['at'])} {sides[0]} from the left, {sides[1]} from the top"


def _percent(place: Mapping[str, Any], axis: str) -> str | None:
    ends = [place[name] for name in (axis, f"{axis}_min", f"{axis}_max") if isinstance(place.get(name), int | float)]
    return "–".join(f"{100 * end:.0f}" for end in ends) + "%" if ends else None


def _notes(result: Mapping[str, Any]) -> str:
    notes = result.get("notes")
    return f" ({'; '.join(map(str, notes))})" if isinstance(notes, list | tuple) and notes else ""


def _in_words(value: Any) -> str:
    """Data as a person reads it: names with their values, figures of four digits, nothing of what is empty."""
    if isinstance(value, Mapping):
        told = {str(key).replace("_", " "): part for key, part in value.items() if part not in (None, "", [], {}, ())}
        return "; ".join(f"{key}: {_in_words(part)}" for key, part in told.items()) or "nothing"
    if isinstance(value, list | tuple):
        return ", ".join(f"({_in_words(part)})" if isinstance(part, Mapping) else _in_words(part) for part in value) or "nothing"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def cut(text: str) -> str:
    """A text that fits a page."""
    return text if len(text) <= MOST_TEXT else f"{text[:MOST_TEXT]} … ({len(text):,} characters)"


def evidence_lines(task: Task | None) -> tuple[str, ...]:
    """What the expected answer rests on, as far as the task itself is at hand."""
    lines = []
    if task is not None and not task.evidence:
        return ("none: the answer rests on no view",)
    for view in task.evidence if task else ():
        aim = view.aim
        items = ", ".join(f"{i.instance}{'' if i.value is None else f' = {i.value}'}" for i in view.items) or "nothing of the kind"
        whole = "; everything in it counts" if view.whole else ""
        lines.append(
            f"{aim.viewpoint}, pan {aim.pan_deg:g}°, tilt {aim.tilt_deg:g}°, zoom {aim.zoom:g}x, {view.scope}: {items}{whole}"
        )
    return tuple(lines)
