"""Build the pages about failed tasks: instruction, expected answer, evidence, and each failed trial step by step."""

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
"""Maximum width and height of a stored frame in pixels. Panoramas may be twice as wide."""
MAX_PIXELS = 64_000_000
"""Maximum number of pixels in a picture. Larger pictures are not shown."""
MAX_TEXT_CHARS = 2_000
"""Maximum length of each text on a page, in characters. Longer text is truncated."""


class OpenedRun(Protocol):
    """A stored run that provides its trace and pictures."""

    @property
    def trace(self) -> Trace:
        """The trace of the run."""
        ...

    def picture(self, name: str) -> bytes | None:
        """Return a picture by its name in the trace; None if it was not stored."""
        ...


OpenSample = Callable[[Evaluation, Trial], OpenedRun]
"""Function that opens the stored run of a trial."""


@dataclass(frozen=True, slots=True)
class PageCall:
    """A tool call as text for a page.

    Attributes:
        call: The tool and its arguments.
        result: The result or the error.
        failed: Whether the call failed.
        pose: The camera's pose after the call.
        replies: The perception replies.
        frame: Path of the call's picture; None if there is no picture.
    """

    call: str
    result: str
    failed: bool
    pose: str
    replies: tuple[str, ...]
    frame: str | None


@dataclass(frozen=True, slots=True)
class PageStep:
    """A planner step on a page. ``view`` is the path of the frame that was shown to the planner, if any."""

    number: int
    thought: str
    calls: tuple[PageCall, ...]
    view: str | None = None


@dataclass(frozen=True, slots=True)
class FailedRun:
    """A failed trial on a page.

    Attributes:
        run: The run in the report.
        trial: The trial.
        steps: The planner steps.
        first_frame: Path of the first frame; None if it was not stored.
        omission_reason: Why the steps cannot be shown; empty if they are shown.
    """

    run: ReportRun
    trial: Trial
    steps: tuple[PageStep, ...] = ()
    first_frame: str | None = None
    omission_reason: str = ""


@dataclass(frozen=True, slots=True)
class TaskPage:
    """The content of a page about a failed task.

    Attributes:
        task: The task's id.
        file: Path of the page, relative to the report folder.
        evidence: The evidence for the task, one line per view.
        runs: The failed trials.
    """

    task: str
    file: str
    evidence: tuple[str, ...]
    runs: tuple[FailedRun, ...]

    @property
    def facts(self) -> Any:
        """The task's properties, such as its instruction and expected answer."""
        return self.runs[0].trial.task


def page_files(evaluations: Sequence[Evaluation]) -> dict[str, str]:
    """Return the paths of the pages about failed tasks, relative to the report folder, by task id.

    Task ids, which come from logs, are converted to safe file names.
    """
    failed = {t.task.id for e in evaluations for t in e.trials if t.headline in ("incorrect", "unscored")}
    return {task: f"tasks/{file_name(task)}" for task in sorted(failed)}


def file_name(task: str) -> str:
    """Return a safe file name for the page about a task. The name is unique and depends only on the task id."""
    readable = re.sub(r"[^a-z0-9]+", "-", task.lower()).strip("-")[:60]
    return f"{readable or 'task'}-{hashlib.sha256(task.encode()).hexdigest()[:10]}.html"


class FrameStore:
    """Stores the pictures of a report at reduced size. Identical pictures are stored only once, named by the hash of their content.

    Args:
        folder: Folder for the pictures.
        link_prefix: Path of the folder for links on the pages.
    """

    def __init__(self, folder: Path, link_prefix: str) -> None:
        self._folder, self._link_prefix = folder, link_prefix
        self._links: dict[str, str | None] = {}

    def add(self, content: bytes | None) -> str | None:
        """Store a picture, and return its path for links on the pages.

        Returns:
            The path, or None if the picture is missing, too large or cannot be decoded.
        """
        if not content:
            return None
        digest = hashlib.sha256(content).hexdigest()[:24]
        if digest not in self._links:
            self._links[digest] = self._write(content, digest)
        return self._links[digest]

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
        return f"{self._link_prefix}/{digest}.jpg"


def task_pages(
    runs: Sequence[ReportRun],
    files: Mapping[str, str],
    open_sample: OpenSample | None,
    frames: FrameStore,
    tasks: Mapping[str, Task],
) -> list[Callable[[], TaskPage]]:
    """Return, for each page, a function that builds the page.

    The caller builds one page at a time, so that the pictures of only one page are in memory.

    Args:
        runs: The runs in the report.
        files: The paths of the pages about failed tasks, by task id.
        open_sample: Function that opens the stored run of a trial; None to omit the steps.
        frames: The store for the pictures.
        tasks: The tasks by id, for the evidence.
    """
    failed: dict[str, list[tuple[ReportRun, Trial]]] = defaultdict(list)
    for run in runs:
        for trial in run.evaluation.trials:
            if trial.task.id in files and trial.headline in ("incorrect", "unscored"):
                failed[trial.task.id].append((run, trial))

    def build(task: str) -> TaskPage:
        failed_runs = tuple(_failed_run(run, trial, open_sample, frames) for run, trial in failed[task])
        return TaskPage(task, files[task], evidence_lines(tasks.get(task)), failed_runs)

    return [partial(build, task) for task in sorted(failed)]


def _failed_run(run: ReportRun, trial: Trial, open_sample: OpenSample | None, frames: FrameStore) -> FailedRun:
    if open_sample is None:
        return FailedRun(run, trial, omission_reason="This report was written without trajectories.")
    try:
        sample = open_sample(run.evaluation, trial)
        trace = sample.trace
        return FailedRun(run, trial, _steps(trace, sample, frames), _stored_frame(trace.started.frame, sample, frames))
    except ScopeError as error:
        return FailedRun(run, trial, omission_reason=f"The log does not contain the trajectory: {error}")


def _stored_frame(name: str | None, sample: OpenedRun, frames: FrameStore) -> str | None:
    return None if name is None else frames.add(sample.picture(name))


def _steps(trace: Trace, sample: OpenedRun, frames: FrameStore) -> tuple[PageStep, ...]:
    steps = []
    for decided in trace.decisions:
        calls = tuple(_page_call(called, sample, frames) for called in trace.calls if called.step == decided.step)
        decision = decided.decision
        thought = "; ".join(part for part in (getattr(decision, "thought", ""), decision.reasoning) if part)
        steps.append(PageStep(decided.step, truncate(thought), calls, _stored_frame(decided.view, sample, frames)))
    return tuple(steps)


def _page_call(called: Called, sample: OpenedRun, frames: FrameStore) -> PageCall:
    outcome = called.outcome
    arguments = ", ".join(f"{key}={json.dumps(value, ensure_ascii=False)}" for key, value in outcome.call.arguments.items())
    failed = outcome.error is not None
    result = outcome.error if outcome.error is not None else _message(outcome.result)
    pose = f"pan {called.pose.pan_deg:.1f}°, tilt {called.pose.tilt_deg:.1f}°, zoom {called.pose.zoom:.2f}x"
    replies = tuple(
        truncate(
            f"{reply.kind}{f' “{reply.asked}”' if reply.asked else ''}: {reply.error or _reply_text(reply.result)} "
            f"({reply.wall_s:.2f} s)"
        )
        for reply in called.replies
    )
    return PageCall(
        truncate(f"{outcome.call.name}({arguments})"),
        truncate(result),
        failed,
        pose,
        replies,
        _stored_frame(called.frame, sample, frames),
    )


def _message(result: Mapping[str, Any] | None) -> str:
    if result is None:
        return "nothing"
    for key in ("message", "text", "answer", "caption"):
        if isinstance(result.get(key), str) and result[key]:
            return str(result[key])
    return _value_text(result)


def _reply_text(result: Mapping[str, Any] | None) -> str:
    """Format a perception reply as text, with positions in percent of the frame."""
    for plural, singular in (("boxes", "box"), ("points", "point")):
        shapes = result.get(plural) if result else None
        if isinstance(shapes, list | tuple) and result is not None:
            count = f"{len(shapes)} {singular if len(shapes) == 1 else plural}" if shapes else f"no {singular}"
            more = "" if result.get("complete", True) else " (the list is incomplete)"
            positions = "; ".join(_shape_text(shape) for shape in shapes)
            return f"{count}{more}{f': {positions}' if positions else ''}{_notes(result)}"
    return _message(result) + _notes(result or {})


def _shape_text(shape: Any) -> str:
    """Format a box or point as text, with its position in percent of the frame. Other values are formatted without a position."""
    if not isinstance(shape, Mapping):
        return _value_text(shape)
    extents = [_percent(shape, axis) for axis in "xy"]
    if None in extents:
        return _value_text(shape)
    score = shape.get("score")
    parts = [str(shape["label"])] if shape.get("label") else []
    parts += [f"score {score:.2f}"] if isinstance(score, int | float) else []
    return f"{' '.join([*parts, 'at'])} {extents[0]} from the left, {extents[1]} from the top"


def _percent(shape: Mapping[str, Any], axis: str) -> str | None:
    """Format the position of a point or the extent of a box along an axis, in percent; return None if it is missing."""
    ends = [shape[name] for name in (axis, f"{axis}_min", f"{axis}_max") if isinstance(shape.get(name), int | float)]
    return "–".join(f"{100 * end:.0f}" for end in ends) + "%" if ends else None


def _notes(result: Mapping[str, Any]) -> str:
    notes = result.get("notes")
    return f" ({'; '.join(map(str, notes))})" if isinstance(notes, list | tuple) and notes else ""


def _value_text(value: Any) -> str:
    """Format JSON data as text, without empty values and with four significant digits."""
    if isinstance(value, Mapping):
        parts = {str(key).replace("_", " "): part for key, part in value.items() if part not in (None, "", [], {}, ())}
        return "; ".join(f"{key}: {_value_text(part)}" for key, part in parts.items()) or "nothing"
    if isinstance(value, list | tuple):
        return (
            ", ".join(f"({_value_text(part)})" if isinstance(part, Mapping) else _value_text(part) for part in value) or "nothing"
        )
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def truncate(text: str) -> str:
    """Truncate text to ``MAX_TEXT_CHARS``, and add a note with its full length."""
    return text if len(text) <= MAX_TEXT_CHARS else f"{text[:MAX_TEXT_CHARS]} … ({len(text):,} characters)"


def evidence_lines(task: Task | None) -> tuple[str, ...]:
    """Return the evidence for a task, one line per view, or no lines if the task is not available."""
    lines = []
    if task is not None and not task.evidence:
        return ("none: the answer does not depend on any view",)
    for view in task.evidence if task else ():
        aim = view.aim
        items = ", ".join(f"{i.instance}{'' if i.value is None else f' = {i.value}'}" for i in view.items) or "no items"
        whole = "; the answer depends on everything in this view" if view.whole else ""
        lines.append(
            f"{aim.viewpoint}, pan {aim.pan_deg:g}°, tilt {aim.tilt_deg:g}°, zoom {aim.zoom:g}x, {view.scope}: {items}{whole}"
        )
    return tuple(lines)
