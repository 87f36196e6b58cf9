"""The executable checks that score a run. Each function checks one aspect of the run against the task."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from scope_ptz.bench.answers import Declined, Unreadable, agrees, parse_answer
from scope_ptz.bench.scoring.coverage import uncovered_part
from scope_ptz.bench.scoring.episode import CameraPosition, Episode
from scope_ptz.bench.scoring.required_calls import missing_in_any_order, missing_in_order
from scope_ptz.bench.tasks.expected import ActionOnly
from scope_ptz.bench.tasks.task import FinalPose, RunOutcome, Task
from scope_ptz.geometry import Perspective, direction, wrap_pan_deg

CheckName = Literal["outcome", "answer", "coverage", "pose", "calls", "forbidden", "pictures", "framing"]
SAME_ANGLE_DEG = 0.5
"""Maximum difference in pan or tilt, in degrees, between poses that are considered equal."""
SAME_ZOOM_RATIO = 0.03
"""Maximum relative difference in zoom between poses that are considered equal."""


@dataclass(frozen=True, slots=True)
class CheckResult:
    """The result of a check. ``passed`` is None if the check cannot decide, because the answer is unreadable."""

    name: CheckName
    passed: bool | None
    reason: str


def run_checks(task: Task, episode: Episode) -> tuple[CheckResult, ...]:
    """Run all checks that apply to a task, in a fixed order."""
    results = (check(task, episode) for check in _CHECKS)
    return tuple(result for result in results if result is not None)


def check_outcome(task: Task, episode: Episode) -> CheckResult:
    """Check that the run ended with the required outcome: an answer, a clarifying question or a refusal."""
    required: tuple[RunOutcome, ...] = task.behaviour.outcomes
    passed = episode.outcome in required
    return CheckResult("outcome", passed, "as wanted" if passed else f"ended {episode.outcome}, not {' or '.join(required)}")


def check_answer(task: Task, episode: Episode) -> CheckResult | None:
    """Check that the parsed final answer agrees with the expected answer."""
    if isinstance(task.expected, ActionOnly):
        return None
    if episode.outcome not in ("answered", "clarification", "refused"):
        return CheckResult("answer", False, "there is no answer")
    parsed = parse_answer(task.expected, episode.answer)
    passed = agrees(task.expected, parsed)
    if isinstance(parsed, Unreadable):
        return CheckResult("answer", None, f"cannot be read: {parsed.reason}")
    stated = "declined" if isinstance(parsed, Declined) else f"read as {_value_text(parsed.value)}"
    return CheckResult("answer", passed, stated if passed else f"{stated}, which is not what is expected")


def _value_text(value: object) -> str:
    return (
        ", ".join(sorted(value)) or "none"
        if isinstance(value, frozenset) and all(isinstance(v, str) for v in value)
        else str(value)
    )


def check_coverage(task: Task, episode: Episode) -> CheckResult | None:
    """Check that successful observations cover the evidence for the answer."""
    required = [view for view in task.evidence if view.must_look]
    if not required:
        return None
    gaps = [gap for view in required if (gap := uncovered_part(view, episode.observations)) is not None]
    return CheckResult("coverage", not gaps, "; ".join(gaps) or "everything asked about was looked at")


def check_pose(task: Task, episode: Episode) -> CheckResult | None:
    """Check that the camera ended at the required pose."""
    final = task.behaviour.final
    if final is None:
        return None
    differences = pose_difference(final, episode.final)
    return CheckResult("pose", not differences, "; ".join(differences) or "the final pose is as wanted")


def pose_difference(required: FinalPose, actual: CameraPosition) -> list[str]:
    """Return descriptions of the differences from the required pose. The list is empty if the pose is within tolerance."""
    differences = []
    if actual.viewpoint != required.viewpoint:
        differences.append(f"at viewpoint {actual.viewpoint}, not {required.viewpoint}")
    pan = abs(wrap_pan_deg(actual.pose.pan_deg - required.pan_deg))
    tilt = abs(actual.pose.tilt_deg - required.tilt_deg)
    zoom = abs(actual.pose.zoom / required.zoom - 1)
    if pan > required.tolerance_deg + 1e-6:
        differences.append(f"pan is off by {pan:.2f} degrees")
    if tilt > required.tolerance_deg + 1e-6:
        differences.append(f"tilt is off by {tilt:.2f} degrees")
    if zoom > required.zoom_share + 1e-6:
        differences.append(f"zoom is off by {zoom:.1%}")
    return differences


def check_calls(task: Task, episode: Episode) -> CheckResult | None:
    """Check that the required calls succeeded, in the required order if the task specifies one."""
    behaviour = task.behaviour
    if not behaviour.calls:
        return None
    missing = (missing_in_order if behaviour.order == "ordered" else missing_in_any_order)(behaviour.calls, episode.calls)
    return CheckResult("calls", missing is None, missing or "every required call was made")


def check_forbidden(task: Task, episode: Episode) -> CheckResult | None:
    """Check that no forbidden tool was used, and that no forbidden change remained at the end."""
    forbidden = task.behaviour.forbidden
    if not forbidden.tools and not forbidden.changes:
        return None
    used = sorted({call.name for call in episode.calls if call.succeeded and call.name in forbidden.tools})
    changed = [change for change in changed_properties(episode.start, episode.final) if change in forbidden.changes]
    violations = [f"{name} was called" for name in used] + [f"{name} was changed" for name in changed]
    return CheckResult("forbidden", not violations, "; ".join(violations) or "nothing forbidden happened")


def changed_properties(before: CameraPosition, after: CameraPosition) -> list[str]:
    """Return the names of the properties (viewpoint, pan, tilt, zoom) that differ between two camera positions."""
    start, end = before.pose, after.pose
    differences = {
        "viewpoint": before.viewpoint != after.viewpoint,
        "pan": abs(wrap_pan_deg(start.pan_deg - end.pan_deg)) > SAME_ANGLE_DEG,
        "tilt": abs(start.tilt_deg - end.tilt_deg) > SAME_ANGLE_DEG,
        "zoom": abs(end.zoom / start.zoom - 1) > SAME_ZOOM_RATIO,
    }
    return [name for name, differs in differences.items() if differs]


def check_pictures(task: Task, episode: Episode) -> CheckResult | None:
    """Check that the requested number of pictures was taken and, if their existence is recorded, that the files exist."""
    required = task.behaviour.pictures
    if required is None:
        return None
    lost = [picture.file for picture in episode.pictures if picture.exists is False]
    if lost:
        return CheckResult("pictures", False, f"missing: {', '.join(lost)}")
    taken = len({picture.file for picture in episode.pictures})
    return CheckResult("pictures", taken == required, f"{taken} of {required} pictures were taken")


def check_framing(task: Task, episode: Episode) -> CheckResult | None:
    """Check that the target is centred in the final view, and that its size is within the required limits."""
    framing = task.behaviour.framing
    if framing is None:
        return None
    if episode.final.viewpoint != framing.viewpoint:
        return CheckResult("framing", False, f"the camera is at {episode.final.viewpoint}, not {framing.viewpoint}")
    fill, offset = framing_of(framing.outline_deg, episode)
    wrong = []
    if not framing.min_fill - 1e-6 <= fill <= framing.max_fill + 1e-6:
        wrong.append(f"{framing.instance} fills {fill:.0%} of the frame")
    if offset > framing.max_offset + 1e-6:
        wrong.append(f"{framing.instance} is {offset:.1%} off the middle")
    return CheckResult("framing", not wrong, "; ".join(wrong) or f"{framing.instance} fills {fill:.0%} of the frame, in the middle")


def framing_of(outline_deg: Sequence[tuple[float, float]], episode: Episode) -> tuple[float, float]:
    """Return the size and offset of an outline in the final view.

    Args:
        outline_deg: Directions (pan, tilt) along the outline.
        episode: The run.

    Returns:
        The width or height of the outline, whichever is larger, and its horizontal or vertical offset from the centre, whichever
        is larger, as fractions of the frame's width or height. Both are infinite if part of the outline is behind the camera.
    """
    pose = episode.final.pose
    view = Perspective(pose.pan_deg, pose.tilt_deg, episode.optics.hfov_deg(pose.zoom), 1600, round(1600 / episode.aspect))
    outline = np.array(outline_deg, dtype=np.float64)
    points = view.points(direction(outline[:, 0], outline[:, 1]))
    if np.isnan(points).any():
        return float("inf"), float("inf")
    low, high = points.min(axis=0), points.max(axis=0)
    return float((high - low).max()), float(np.abs((low + high) / 2 - 0.5).max())


_CHECKS: tuple[Callable[[Task, Episode], CheckResult | None], ...] = (
    check_outcome, check_answer, check_coverage, check_pose, check_calls, check_forbidden, check_pictures, check_framing,
)  # fmt: skip
