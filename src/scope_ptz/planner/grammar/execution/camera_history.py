"""The camera's earlier positions, according to the conversation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from scope_ptz.geometry import Pose

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn, ToolOutcome


@dataclass(frozen=True, slots=True)
class VisitedPlace:
    """A place where the camera stood: at a preset, at home, or only at a pose."""

    pose: Pose
    preset: str | None = None
    home: bool = False


@dataclass(frozen=True, slots=True)
class Whereabouts:
    """Where the camera has been.

    Attributes:
        preset: The preset where the camera still stands.
        before: Where it stood before the last turn that moved it.
    """

    preset: str | None = None
    before: VisitedPlace | None = None


def whereabouts(conversation: Sequence[PastTurn]) -> Whereabouts:
    """Return where the camera has been, from the results of earlier turns."""
    if not conversation:
        return Whereabouts()
    from scope_ptz.tools.registry import TOOLS

    here: VisitedPlace | None = None
    before: VisitedPlace | None = None
    for turn in conversation:
        at_start = here
        for outcome in (o for exchange in turn.exchanges for o in exchange.outcomes):
            pose = _pose(outcome.result)
            if outcome.error is not None or pose is None or outcome.call.name not in TOOLS.moving:
                continue
            at_start = at_start or _before(outcome, pose)
            before = at_start or before
            name = outcome.call.arguments.get("name")
            here = VisitedPlace(
                pose, str(name) if outcome.call.name == "go_to_preset" else None, home=outcome.call.name == "go_home"
            )
    return Whereabouts(here.preset if here else None, before)


def _pose(result: dict[str, Any] | None) -> Pose | None:
    pose = (result or {}).get("pose")
    return Pose(pose["pan_deg"], pose["tilt_deg"], pose["zoom"]) if isinstance(pose, dict) else None


def _before(outcome: ToolOutcome, after: Pose) -> VisitedPlace | None:
    """Return where a first relative move started, if its arguments determine it; None for a clamped move."""
    arguments = outcome.call.arguments
    if outcome.call.name != "adjust_ptz" or (outcome.result or {}).get("clamped") or arguments.get("zoom_limit"):
        return None
    factor = arguments.get("zoom_factor", 1 + arguments.get("zoom_percent", 0) / 100)
    return VisitedPlace(after.turned(-arguments.get("pan_deg", 0), -arguments.get("tilt_deg", 0)).zoomed(1 / factor))
