"""Spatial relations between things, in the picture and in the world.

- *left / right of*: the centre of the box lies further left / right. *Above / below*: the centre lies higher / lower, and the boxes
overlap horizontally, with a tolerance of a tenth of the frame.
- *behind / in front of*: further from / nearer to the camera by half a metre or more, and the boxes overlap horizontally, with a
tolerance of a twentieth of the frame.
- *in front of a building*: also before a front that the camera sees from the side: at most 4 m from it, and seen against it.
- *near, next to, facing*: at most 4 m apart in the world; a part that touches or overlaps its whole is not near it.
- *on, in, at, of*: a part of the other thing, or smaller, within its footprint and resting on or in it.
- *on the left*: the centre lies in the left 40% of the frame; *in the left half*: in the left 50%; *in a corner*: in the 40% bands
of both sides; *in the middle*: in the middle 40% horizontally, but not in the top or
bottom tenth.
- *in the foreground*, *in the distance*: the nearest and furthest third of the depth in view, on a logarithmic scale.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from scope_ptz import english
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.ground_truth.thing_facts import facts, key_words
from scope_ptz.perception.ground_truth.view import Thing, View

BACKGROUND_CONCEPTS = frozenset({"surface", "sky"})
"""Background concepts, which do not count as objects."""

BUILDING_CONCEPTS = frozenset({"building", "shop"})
"""Things with a front, before which people stand."""

OUTSIDE_CONCEPTS = BUILDING_CONCEPTS | {"cabin", "gate", "door", "vehicle", "machine"}
"""Things outside which people are if they are near."""

NEAR_M = 4.0  # maximum gap between things that are next to each other
ON_TOLERANCE_M = 0.3  # tolerance when testing whether one thing stands on another
FLAT_M = 0.5  # things lower than this are flat, such as a road
DEPTH_STEP_M = 0.5  # minimum distance difference at which one thing is behind another
SIDE_BAND = 0.4  # fraction of the frame that counts as a side
SIDE_TOLERANCE = 0.05  # tolerance for horizontal overlap, as a fraction of the frame


def is_in_region(view: View, thing: Thing, region: tree.Region) -> bool:
    """Return whether a thing lies in a part of the frame."""
    x, y = thing.box.centre
    side_fraction = 0.5 if region.half else SIDE_BAND
    checks: dict[str, Callable[[], bool]] = {
        "left": lambda: x < side_fraction,
        "right": lambda: x > 1 - side_fraction,
        "top": lambda: y < side_fraction,
        "bottom": lambda: y > 1 - side_fraction,
        "middle": lambda: abs(x - 0.5) <= SIDE_BAND / 2 and (len(region.sides) > 1 or abs(y - 0.5) <= SIDE_BAND),
        "near": lambda: thing.distance_m <= _depth_m(view, 1 / 3),
        "far": lambda: thing.distance_m >= _depth_m(view, 2 / 3),
    }
    return all(checks[side]() for side in region.sides)


def _depth_m(view: View, fraction: float) -> float:
    """Return the distance at a fraction of the way from the nearest to the furthest thing in view, on a logarithmic scale."""
    distances = [t.distance_m for t in view.top_level() if not t.concepts & BACKGROUND_CONCEPTS]
    near, far = min(distances), max(distances)
    return float(near * (far / near) ** fraction)


def relation_holds(view: View, a: Thing, kind: tree.RelationKind, b: Thing) -> bool:
    """Return whether a relation holds between two things."""
    (ax, ay), (bx, by) = a.box.centre, b.box.centre
    is_part = view.belongs(a.id, b.id) or view.belongs(b.id, a.id)
    match kind:
        case "left":
            return ax < bx and not is_part
        case "right":
            return ax > bx and not is_part
        case "above":
            return ay < by and _overlap_horizontally(a, b, 0.1)
        case "below":
            return ay > by and _overlap_horizontally(a, b, 0.1)
        case "front" if _stands_before(a, b):
            return not is_part
        case "front":
            return not is_part and a.distance_m <= b.distance_m - DEPTH_STEP_M and _overlap_horizontally(a, b, SIDE_TOLERANCE)
        case "behind":
            return (
                not is_part
                and not _stands_before(a, b)
                and a.distance_m >= b.distance_m + DEPTH_STEP_M
                and _overlap_horizontally(a, b, SIDE_TOLERANCE)
            )
        case "near" | "facing":
            return a.gap_m(b) <= NEAR_M and (not is_part or a.gap_m(b) > 0)  # the signal beside a dock door, which is its part
        case "on":
            return view.belongs(a.id, b.id) or _rests_on(a, b)


def is_outside(preposition: str) -> bool:
    """Return whether a preposition is "outside", alone or with other words ("just outside", "outside of")."""
    return "outside" in preposition.split()


def _stands_before(a: Thing, b: Thing) -> bool:
    """Return whether ``a`` stands before the front of the building ``b``, which the camera sees from the side.

    Its nearest corner may be nearer to the camera than ``a``. But ``a`` would be hidden if it were behind the building.
    """
    if not b.concepts & BUILDING_CONCEPTS or a.concepts & (BUILDING_CONCEPTS | BACKGROUND_CONCEPTS) or a.gap_m(b) > NEAR_M:
        return False
    x, y = a.box.centre
    return b.box.x_min <= x <= b.box.x_max and b.box.y_min <= y <= b.box.y_max


def _overlap_horizontally(a: Thing, b: Thing, tolerance: float) -> bool:
    return a.box.x_min <= b.box.x_max + tolerance and b.box.x_min <= a.box.x_max + tolerance


def _rests_on(a: Thing, b: Thing) -> bool:
    """Return whether ``a`` rests on ``b``.

    ``a`` must be the smaller of the two, with its centre within the footprint of ``b``. Its base must lie between the base and the
    top of ``b``, with a tolerance, and above the base of ``b`` unless ``b`` is flat like a road.
    """
    centre_m = (a.low_m + a.high_m)[:2] / 2
    is_within = bool(np.all(centre_m >= b.low_m[:2] - ON_TOLERANCE_M) and np.all(centre_m <= b.high_m[:2] + ON_TOLERANCE_M))
    lowest_m, highest_m = (
        b.low_m[2] if b.high_m[2] - b.low_m[2] < FLAT_M else b.low_m[2] + ON_TOLERANCE_M,
        b.high_m[2] + ON_TOLERANCE_M,
    )
    return is_within and bool(lowest_m - ON_TOLERANCE_M / 2 <= a.low_m[2] <= highest_m) and _volume_m3(a) < _volume_m3(b)


def stands_above(a: Thing, b: Thing) -> bool:
    """Return whether ``a`` is in the world above ``b``: over its footprint, and no lower than its top."""
    overlap = bool(np.all(a.low_m[:2] < b.high_m[:2]) and np.all(b.low_m[:2] < a.high_m[:2]))
    return a is not b and overlap and bool(a.low_m[2] >= b.high_m[2] - ON_TOLERANCE_M)


def _volume_m3(thing: Thing) -> float:
    return float(np.prod(np.maximum(thing.high_m - thing.low_m, 0.1)))


def distance_to_corner(thing: Thing, sides: Sequence[str]) -> float:
    """Return the distance from a thing to a corner, a side or the centre of the frame, as a fraction of the frame size."""
    x, y = thing.box.centre
    to_x = 0.0 if "left" in sides else 1.0 if "right" in sides else 0.5
    to_y = 0.0 if "top" in sides else 1.0 if "bottom" in sides else 0.5
    return float(np.hypot(x - to_x, y - to_y))


def is_facing(thing: Thing, side: str) -> bool | None:
    """Return whether a thing faces a side; None if the scene does not state that."""
    for key, value in facts(thing):
        if set(key_words(key)) & {"direction", "facing", "heading", "pointing", "orientation", "arrow"}:
            return side in english.letters(str(value)).split()
    return None


def visible_pixels(thing: Thing) -> int:
    """Return a thing's number of visible pixels."""
    return thing.sighting.pixels


def rank_key(key: tree.OrderKey) -> Callable[[Thing], float]:
    """Return the sort key for a superlative. The thing with the lowest value matches best."""
    keys: dict[str, Callable[[Thing], float]] = {
        "left": lambda t: t.box.centre[0],
        "right": lambda t: -t.box.centre[0],
        "top": lambda t: t.box.centre[1],
        "bottom": lambda t: -t.box.centre[1],
        "nearest": lambda t: t.distance_m,
        "furthest": lambda t: -t.distance_m,
        "biggest": lambda t: -_diagonal_m(t),
        "smallest": _diagonal_m,
        "looks biggest": lambda t: -float(visible_pixels(t)),
        "looks smallest": lambda t: float(visible_pixels(t)),
        "tallest": lambda t: -float(t.high_m[2] - t.low_m[2]),
        "widest": lambda t: -float(max(t.high_m[:2] - t.low_m[:2])),
    }
    return keys[key]


def _diagonal_m(thing: Thing) -> float:
    """Return the diagonal of a thing's box in the world, a measure of size that also works for flat things."""
    return float(((thing.high_m - thing.low_m) ** 2).sum() ** 0.5)
