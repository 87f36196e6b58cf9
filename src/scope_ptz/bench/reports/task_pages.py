"""The content of the page of a failed task: the instruction, the expected answer, and every failed trial step by step."""

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
"""Maximum width of a stored frame in pixels. Panoramas may be twice as wide."""
MAX_PIXELS = 64_000_000
MAX_TEXT_CHARS = 2_000


class StoredRun(Protocol):
    """A stored run: its trace, and its pictures by their names in the trace."""

    @property
    def trace(self) -> Trace:
        """The trace of the run."""
        ...

    def picture(self, name: str) -> bytes | None:
        """Return a picture; None if it was not stored."""
        ...


OpenSample = Callable[[Evaluation, Trial], StoredRun]


@dataclass(frozen=True, slots=True)
class PageCall:
    """A call on the page. ``frame`` is the path of its picture, ``replies`` are the answers of perception."""

    call: str
    result: str
    failed: bool
    pose: str
    replies: tuple[str, ...]
    frame: str | None


@dataclass(frozen=True, slots=True)
class PageStep:
    """A step on the page. ``view`` is the frame that the planner was shown."""

    number: int
    thought: str
    calls: tuple[PageCall, ...]
    view: str | None = None


@dataclass(frozen=True, slots=True)
class FailedRun:
    """A failed trial on the page. ``missing`` says why its trajectory cannot be shown."""

    run: ReportRun
    trial: Trial
    steps: tuple[PageStep, ...] = ()
    first_frame: str | None = None
    missing: str = ""


@dataclass(frozen=True, slots=True)
class TaskPage:
    """The page of a failed task."""

    task: str
    file: str
    evidence: tuple[str, ...]
    runs: tuple[FailedRun, ...]

    @property
    def facts(self) -> Any:
        """The facts about the task."""
        return self.runs[0].trial.task


def page_files(evaluations: Sequence[Evaluation]) -> dict[str, str]:
    """Return the path of each failed task's page in the report's folder. Paths contain no unescaped text from logs."""
    failed = {t.task.id for e in evaluations for t in e.trials if t.headline in ("incorrect", "unscored")}
    return {task: f"tasks/{file_name(task)}" for task in sorted(failed)}


def file_name(task: str) -> str:
    """Return a safe and stable file name that is unique to the task."""
    readable = re.sub(r"[^a-z0-9]+", "-", task.lower()).strip("-")[:60]
    return f"{readable or 'task'}-{hashlib.sha256(task.encode()).hexdigest()[:10]}.html"


class FrameStore:
    """Stores the pictures of a report, resized, under the hash of their content, so that equal pictures are stored once."""

    def __init__(self, folder: Path, shown_as: str) -> None:
        self._folder, self._shown_as = folder, shown_as
        self._known: dict[str, str | None] = {}

    def keep(self, content: bytes | None) -> str | None:
        """Store a picture.

        Returns:
            Its path as used on pages; None if there is no picture or it cannot be decoded.
        """
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
                if picture.width * picture.height > MAX_PIXELS:
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
    """Return one function per page that builds it, so that the pictures of only one page are in memory."""
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
        return FailedRun(run, trial, missing="This report was made without trajectories.")
    try:
        sample = open_sample(run.evaluation, trial)
        trace = sample.trace
        return FailedRun(run, trial, _steps(trace, sample, frames), _stored_frame(trace.started.frame, sample, frames))
    except ScopeError as error:
        return FailedRun(run, trial, missing=f"The log does not contain the trajectory: {error}")


def _stored_frame(name: str | None, sample: StoredRun, frames: FrameStore) -> str | None:
    return None if name is None else frames.keep(sample.picture(name))


def _steps(trace: Trace, sample: StoredRun, frames: FrameStore) -> tuple[PageStep, ...]:
    shown = []
    for decided in trace.decisions:
        calls = tuple(_call(called, sample, frames) for called in trace.calls if called.step == decided.step)
        decision = decided.decision
        thought = "; ".join(part for part in (getattr(decision, "thought", ""), decision.reasoning) if part)
        shown.append(PageStep(decided.step, cut(thought), calls, _stored_frame(decided.view, sample, frames)))
    return tuple(shown)


def _call(called: Called, sample: StoredRun, frames: FrameStore) -> PageCall:
    outcome = called.outcome
    arguments = ", ".join(f"{key}={json.dumps(value, ensure_ascii=False)}" for key, value in outcome.call.arguments.items())
    failed = outcome.error is not None
    result = outcome.error if outcome.error is not None else _message(outcome.result)
    pose = f"pan {called.pose.pan_deg:.1f}°, tilt {called.pose.tilt_deg:.1f}°, zoom {called.pose.zoom:.2f}x"
    replies = tuple(
        cut(
            f"{reply.kind}{f' “{reply.asked}”' if reply.asked else ''}: {reply.error or _seen(reply.result)} ({reply.wall_s:.2f} s)"
        )
        for reply in called.replies
    )
    return PageCall(
        cut(f"{outcome.call.name}({arguments})"), cut(result), failed, pose, replies, _stored_frame(called.frame, sample, frames)
    )


def _message(result: Mapping[str, Any] | None) -> str:
    if result is None:
        return "nothing"
    for key in ("message", "text", "answer", "caption"):
        if isinstance(result.get(key), str) and result[key]:
            return str(result[key])
    return _in_words(result)


def _seen(result: Mapping[str, Any] | None) -> str:
    """Return the reply of perception as text, with places in percent of the frame."""
    for key, one in (("boxes", "box"), ("points", "point")):
        places = result.get(key) if result else None
        if isinstance(places, list | tuple) and result is not None:
            number = f"{len(places)} {one if len(places) == 1 else key}" if places else f"no {one}"
            more = "" if result.get("complete", True) else ", and more than these"
            where = "; ".join(_place(place) for place in places)
            return f"{number}{more}{f': {where}' if where else ''}{_notes(result)}"
    return _message(result) + _notes(result or {})


def _place(place: Any) -> str:
    """Return a box or a point in percent of the frame. Other values are returned as text."""
    if not isinstance(place, Mapping):
        return _in_words(place)
    sides = [_percent(place, axis) for axis in "xy"]
    if None in sides:
        return _in_words(place)
    score = place.get("score")
    parts = [str(place["label"])] if place.get("label") else []
    parts += [f"score {score:.2f}"] if isinstance(score, int | float) else []
    return f"{' '.join([*parts, 'at'])} {sides[0]} from the left, {sides[1]} from the top"


def _percent(place: Mapping[str, Any], axis: str) -> str | None:
    ends = [place[name] for name in (axis, f"{axis}_min", f"{axis}_max") if isinstance(place.get(name), int | float)]
    return "–".join(f"{100 * end:.0f}" for end in ends) + "%" if ends else None


def _notes(result: Mapping[str, Any]) -> str:
    notes = result.get("notes")
    return f" ({'; '.join(map(str, notes))})" if isinstance(notes, list | tuple) and notes else ""


def _in_words(value: Any) -> str:
    """Return data as text, without empty values. Numbers have four significant digits."""
    if isinstance(value, Mapping):
        parts = {str(key).replace("_", " "): part for key, part in value.items() if part not in (None, "", [], {}, ())}
        return "; ".join(f"{key}: {_in_words(part)}" for key, part in parts.items()) or "nothing"
    if isinstance(value, list | tuple):
        return ", ".join(f"({_in_words(part)})" if isinstance(part, Mapping) else _in_words(part) for part in value) or "nothing"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def cut(text: str) -> str:
    """Return a text shortened to fit a page."""
    return text if len(text) <= MAX_TEXT_CHARS else f"{text[:MAX_TEXT_CHARS]} … ({len(text):,} characters)"


def evidence_lines(task: Task | None) -> tuple[str, ...]:
    """Return the evidence of a task, one line per view; empty if the task itself is not available."""
    lines = []
    if task is not None and not task.evidence:
        return ("none: the answer does not depend on any view",)
    for view in task.evidence if task else ():
        aim = view.aim
        items = ", ".join(f"{i.instance}{'' if i.value is None else f' = {i.value}'}" for i in view.items) or "no items"
        whole = "; everything in it counts" if view.whole else ""
        lines.append(
            f"{aim.viewpoint}, pan {aim.pan_deg:g}°, tilt {aim.tilt_deg:g}°, zoom {aim.zoom:g}x, {view.scope}: {items}{whole}"
        )
    return tuple(lines)
