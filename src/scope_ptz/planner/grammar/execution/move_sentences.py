"""Phrase what the camera did: moves, the limits that ended them, and how long it followed a thing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from scope_ptz import english
from scope_ptz.geometry import Pose, wrap_pan_deg
from scope_ptz.planner.grammar.execution.answer_sentences import count_word, number
from scope_ptz.planner.grammar.execution.camera_history import ZOOM_TOLERANCE

WENT_BACK_TO = "I went back:"
"""How the report of a return begins."""


def move_text(arguments: Mapping[str, Any]) -> str:
    """Describe a relative move in the past tense: "panned right 20 degrees and tilted down 10 degrees"."""
    parts = []
    if pan := _rounded(arguments.get("pan_deg", 0)):
        parts.append(f"panned {'right' if pan > 0 else 'left'} {degrees(pan)}")
    if tilt := _rounded(arguments.get("tilt_deg", 0)):
        parts.append(f"tilted {'up' if tilt > 0 else 'down'} {degrees(tilt)}")
    if factor := arguments.get("zoom_factor"):
        times = _rounded(factor if factor >= 1 else 1 / factor)
        parts += [f"zoomed {'in' if factor >= 1 else 'out'} {number(times)}x"] if times != 1 else []
    if percent := arguments.get("zoom_percent"):
        parts.append(f"zoomed {'in' if percent > 0 else 'out'} by {number(abs(percent))}%")
    if limit := arguments.get("zoom_limit"):
        parts.append(f"zoomed all the way {limit}")
    return english.listing(parts) or _DID_NOT_MOVE


_DID_NOT_MOVE = "did not move"


def _rounded(value: float) -> float:
    return round(value, 2)


def report_of_move(arguments: Mapping[str, Any], made: Mapping[str, Any], result: Mapping[str, Any], shortfall: str) -> str:
    """Describe a relative move: "I panned right 20 degrees", or why the camera stayed where it is.

    Args:
        arguments: The move that was asked for.
        made: The move that the camera made.
        result: The result of the call.
        shortfall: Why the move ended early, as ``shortfall_text`` returns it; empty if it did not.
    """
    done = move_text(made)
    if done != _DID_NOT_MOVE or not shortfall or result.get("held_back_by"):
        return f"I {done}{shortfall}"
    limits = [limit for axis in result["clamped"] if (limit := _limit_text(axis, arguments))]
    return f"I did not move: the camera is already {english.listing(limits)}" if limits else f"I {done}{shortfall}"


def report_of_return(place: str, shortfall: str = "") -> str:
    """State that the camera went back: "I went back: the camera is at preset yard again".

    Args:
        place: Where the camera is now: a preset, the home view or a pose, in words.
        shortfall: Why the camera did not get all the way back, as ``shortfall_text`` returns it; empty if it did.
    """
    return (
        f"I went back{shortfall}; the camera is now at {place}" if shortfall else f"{WENT_BACK_TO} the camera is at {place} again"
    )


def _limit_text(axis: str, arguments: Mapping[str, Any]) -> str:
    """Return where the camera is at an axis's limit: "zoomed out as far as it can go"; empty if the move does not use the axis."""
    if axis == "zoom":
        if not any(name.startswith("zoom") for name in arguments):
            return ""
        zooms_in = arguments.get("zoom_factor", 1) > 1 or arguments.get("zoom_percent", 0) > 0
        return f"zoomed {'in' if zooms_in or arguments.get('zoom_limit') == 'in' else 'out'} as far as it can go"
    angle_deg = arguments.get(f"{axis}_deg", 0)
    verb, directions = ("turned", ("right", "left")) if axis == "pan" else ("tilted", ("up", "down"))
    return f"{verb} {directions[0 if angle_deg > 0 else 1]} as far as it can go" if angle_deg else ""


def degrees(value: float) -> str:
    """Return an angle without its sign, with the word "degree" or "degrees"."""
    return f"{number(round(abs(value), 2))} {'degree' if abs(value) == 1 else 'degrees'}"


def moves_text(arguments: Mapping[str, Any], times: int) -> str:
    """Describe the moves of a loop: "two pans of 15 degrees to the right"."""
    plural = "" if times == 1 else "s"
    pan, tilt = arguments.get("pan_deg"), arguments.get("tilt_deg")
    if pan and not tilt and len(arguments) == 1:
        return f"{count_word(times)} pan{plural} of {degrees(pan)} to the {'right' if pan > 0 else 'left'}"
    if tilt and not pan and len(arguments) == 1:
        return f"{count_word(times)} tilt{plural} of {degrees(tilt)} {'up' if tilt > 0 else 'down'}"
    return f"{count_word(times)} move{plural}"


def time_in_view(share: float, duration_s: float) -> str:
    """Return how much of a duration a thing was in view: "the whole time", "nearly the whole time", "for about 4 seconds of that".

    Args:
        share: The fraction of the duration.
        duration_s: The duration in seconds.
    """
    if round(share, 2) == 1:
        return "the whole time"
    if share >= _NEARLY_ALL:
        return "nearly the whole time"
    seconds = round(share * duration_s)
    if not seconds:
        return "for less than a second of that"
    return f"for about {seconds} second{'' if seconds == 1 else 's'} of that"


_NEARLY_ALL = 0.9

_LEAST_ZOOM_CHANGE = 1.1
"""Smallest factor between two magnifications that a report of a move mentions."""


def zoom_text(before: float, after: float) -> str:
    """Return a change of the magnification that nobody asked for: "in from 1x to 5x". Empty for a change that hardly shows."""
    if max(before, after) < _LEAST_ZOOM_CHANGE * min(before, after):
        return ""
    return f"{'in' if after > before else 'out'} from {number(round(before, 1))}x to {number(round(after, 1))}x"


def shortfall_text(result: Mapping[str, Any]) -> str:
    """Return the words that state why a move ended early (a site rule or a camera limit); empty if it did not."""
    if held_back_by := result.get("held_back_by"):
        return f", held back by {held_back_by}"
    clamped = result.get("clamped", ())
    if not clamped:
        return ""
    return f", as far as the {limits_text(clamped)}"


def limits_text(axes: Sequence[str]) -> str:
    """Return the limits of the axes with their verb: "zoom limit allows", "pan and tilt limits allow"."""
    return f"{english.listing(list(axes))} {'limit allows' if len(axes) == 1 else 'limits allow'}"


def offset_text(reference: Pose, pose: Pose) -> str:
    """Return where a pose looks, seen from another one, as words before its name: "20 degrees to the left of", "closer at"."""
    pan_deg, tilt_deg = wrap_pan_deg(pose.pan_deg - reference.pan_deg), pose.tilt_deg - reference.tilt_deg
    if ways := _ways_text(round(pan_deg), round(tilt_deg)):
        return ways
    if abs(pose.zoom / reference.zoom - 1) >= ZOOM_TOLERANCE:
        return "closer at" if pose.zoom > reference.zoom else "wider at"
    return _ways_text(_rounded(pan_deg), _rounded(tilt_deg)) or "at"


def _ways_text(pan_deg: float, tilt_deg: float) -> str:
    """Return two angles in words before the name of a place: "20 degrees to the left of and 5 degrees below"; empty for 0."""
    sides = ((pan_deg, "to the left of", "to the right of"), (tilt_deg, "below", "above"))
    return " and ".join(
        f"{degrees(angle_deg)} {after if angle_deg > 0 else before}" for angle_deg, before, after in sides if angle_deg
    )
