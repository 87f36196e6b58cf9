"""Convert the coordinates in model replies to boxes and points in [0, 1].

Models use pixels of the image as they resized it (Qwen2.5-VL), thousandths (Qwen3-VL, Qwen3.5, and Gemini with y first),
percent (Molmo) or fractions (Moondream). Invalid boxes and points are dropped with a note, and boxes that exceed the frame are
clipped.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar

from scope_ptz.errors import PerceptionError, UnknownNameError
from scope_ptz.perception.base import Box, Point

Space = Literal["unit", "percent", "thousand", "pixels", "guess"]

MAX_THINGS = 300
"""Maximum number of boxes or points per reply. Longer lists are usually repetitions."""

MAX_ASPECT = 200.0
"""The largest ratio of the longer to the shorter side that the Qwen-VL resize accepts."""


@dataclass(frozen=True, slots=True)
class Convention:
    """The coordinate format of a model family.

    Attributes:
        space: The unit of the coordinates. "guess" infers it from the largest number in a reply.
        factor: The model resizes images to multiples of this many pixels; None if it has no such factor. If the coordinates
            are pixels, frames are resized before they are sent, so that the model does not resize them again.
        y_first: Whether boxes are ``[y, x, y, x]`` and points ``[y, x]``.
        box_key: The JSON key of a box.
        point_key: The JSON key of a point.
    """

    name: str
    space: Space
    factor: int | None = None
    y_first: bool = False
    box_key: str = "bbox_2d"
    point_key: str = "point_2d"


CONVENTIONS = {
    convention.name: convention
    for convention in (
        Convention("unit", "unit", box_key="bbox", point_key="point"),
        Convention("thousand", "thousand"),
        Convention("percent", "percent", box_key="bbox", point_key="point"),
        Convention("pixels", "pixels"),
        Convention("qwen2.5-vl", "pixels", factor=28),
        Convention("qwen3-vl", "thousand", factor=32),
        Convention("qwen3.5", "thousand", factor=32),
        Convention("gemini", "thousand", y_first=True, box_key="box_2d", point_key="point"),
        Convention("generic", "guess"),
    )
}


def convention(name: str) -> Convention:
    """Return a convention by name.

    Raises:
        UnknownNameError: There is no such convention.
    """
    if name not in CONVENTIONS:
        raise UnknownNameError("coordinate convention", name, CONVENTIONS)
    return CONVENTIONS[name]


def smart_resize(width: int, height: int, *, factor: int, min_pixels: int, max_pixels: int) -> tuple[int, int]:
    """Return the size (width, height) to which Qwen-VL processors resize an image.

    Width and height are multiples of ``factor``, and their product is within the limits. The arithmetic is that of ``smart_resize``
    in the Qwen-VL image processors. An image of the returned size is not resized again.

    Raises:
        PerceptionError: The processors reject the aspect ratio.
    """
    if min(width, height) < 1 or max(width, height) / min(width, height) > MAX_ASPECT:
        raise PerceptionError(
            f"A picture of {width}x{height} is too narrow for a model. Its sides may differ by at most 1:{MAX_ASPECT:.0f}."
        )
    wide, high = max(factor, round(width / factor) * factor), max(factor, round(height / factor) * factor)
    if wide * high > max_pixels:
        shrink = math.sqrt(width * height / max_pixels)
        wide = max(factor, math.floor(width / shrink / factor) * factor)
        high = max(factor, math.floor(height / shrink / factor) * factor)
    elif wide * high < min_pixels:
        grow = math.sqrt(min_pixels / (width * height))
        wide, high = math.ceil(width * grow / factor) * factor, math.ceil(height * grow / factor) * factor
    return wide, high


def fit(width: int, height: int, max_pixels: int) -> tuple[int, int]:
    """Return the size (width, height) scaled down to at most ``max_pixels`` pixels, with the same aspect ratio."""
    shrink = math.sqrt(width * height / max_pixels)
    return (width, height) if shrink <= 1 else (max(1, math.floor(width / shrink)), max(1, math.floor(height / shrink)))


@dataclass(frozen=True, slots=True)
class RawThing:
    """An object in a reply: four numbers (a box) or two (a point), in the model's convention."""

    numbers: tuple[float, ...]
    label: str | None = None
    score: float | None = None
    named: bool = False
    """Whether the reply names each number ("x_min": ...), so that their order needs no convention."""

    @property
    def is_box(self) -> bool:
        return len(self.numbers) == 4


@dataclass(frozen=True, slots=True)
class ReplyPlaces:
    """The boxes and points of a reply, in the order of the reply.

    Attributes:
        notes: Corrections and omissions.
        complete: False if the reply may name more objects.
    """

    boxes: tuple[Box, ...] = ()
    points: tuple[Point, ...] = ()
    notes: tuple[str, ...] = ()
    complete: bool = True


def places_in_frame(
    things: Iterable[RawThing], convention: Convention, sent: tuple[int, int], limit: int = MAX_THINGS
) -> ReplyPlaces:
    """Return the boxes and points of a reply in [0, 1].

    Entries that are non-finite, without area, outside the frame or repeated are dropped and counted in the notes.

    Args:
        things: The objects in the reply.
        convention: The model's coordinate convention.
        sent: Width and height of the image that the model received.
        limit: Maximum number of boxes or points to keep.

    Raises:
        PerceptionError: The reply names objects, but none has a usable box or point (kind "malformed").
    """
    raw = list(things)
    scale_x, scale_y = _scale(raw, convention.space, sent)
    counts: Counter[str] = Counter()
    boxes: dict[tuple[float, ...], Box] = {}
    points: dict[tuple[float, ...], Point] = {}
    for thing in raw:
        if len(thing.numbers) not in (2, 4):
            counts["no place"] += 1
            continue
        numbers = _swap_axes(thing.numbers) if convention.y_first and not thing.named else thing.numbers
        if not all(map(math.isfinite, numbers)):
            counts["not finite"] += 1
        else:
            unit = [v / (scale_x if i % 2 == 0 else scale_y) for i, v in enumerate(numbers)]
            if thing.is_box:
                _add_place(_box(unit, thing, counts), boxes, counts)
            else:
                _add_place(_point(unit, thing, counts), points, counts)
    if raw and not boxes and not points:
        raise PerceptionError(f"None of the places in the reply lie in the picture ({_counts_text(counts)}).", kind="malformed")
    return _limited(list(boxes.values()), list(points.values()), counts, limit)


_WITHOUT_PLACE = ("not finite", "no place")
"""Kinds of entries without usable coordinates. If there are any, the list is incomplete."""


def _limited(boxes: list[Box], points: list[Point], counts: Counter[str], limit: int) -> ReplyPlaces:
    notes = [f"Among the places in the reply: {_counts_text(counts)}."] if counts else []
    within = max(len(boxes), len(points)) <= limit
    complete = within and not any(counts[kind] for kind in _WITHOUT_PLACE)
    if not within:
        notes.append(f"The reply names {max(len(boxes), len(points))} things; the first {limit} are kept.")
    return ReplyPlaces(tuple(boxes[:limit]), tuple(points[:limit]), tuple(notes), complete)


def _counts_text(counts: Counter[str]) -> str:
    return ", ".join(f"{number} {kind}" for kind, number in sorted(counts.items()))


def _scale(things: Sequence[RawThing], space: Space, sent: tuple[int, int]) -> tuple[float, float]:
    """Return the divisors that convert the x and y coordinates of a reply to [0, 1]."""
    fixed = {"unit": 1.0, "percent": 100.0, "thousand": 1000.0}
    if space == "guess":
        space = _guess(things, sent)
    if space in fixed:
        return fixed[space], fixed[space]
    return float(sent[0]), float(sent[1])


def _guess(things: Sequence[RawThing], sent: tuple[int, int]) -> Space:
    """Infer the unit of all coordinates in a reply from the largest one.

    Up to 1 means fractions, up to 1000 means thousandths (as the prompt requests), and up to the image size means pixels.
    """
    finite = [abs(v) for t in things for v in t.numbers if math.isfinite(v)]
    largest = max(finite, default=0.0)
    if largest <= 1.0:
        return "unit"
    if largest <= 1000.0:
        return "thousand"
    if largest <= max(sent) * 1.05:
        return "pixels"
    raise PerceptionError(
        f"The reply's coordinates reach {largest:.0f} in a picture of {sent[0]}x{sent[1]}: the coordinate convention is unknown.",
        kind="malformed",
    )


def _swap_axes(numbers: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(v for i in range(0, len(numbers), 2) for v in (numbers[i + 1], numbers[i]))


def _box(unit: list[float], thing: RawThing, counts: Counter[str]) -> Box | None:
    low_x, high_x = sorted((unit[0], unit[2]))
    low_y, high_y = sorted((unit[1], unit[3]))
    if high_x <= low_x or high_y <= low_y:
        counts["without an area"] += 1
        return None
    if high_x <= 0 or high_y <= 0 or low_x >= 1 or low_y >= 1:
        counts["outside the picture"] += 1
        return None
    if (unit[0], unit[1]) != (low_x, low_y):
        counts["with swapped corners"] += 1
    x_min, y_min, x_max, y_max = (min(max(v, 0.0), 1.0) for v in (low_x, low_y, high_x, high_y))
    if (x_min, y_min, x_max, y_max) != (low_x, low_y, high_x, high_y):
        counts["cut at the border"] += 1
    if x_max <= x_min or y_max <= y_min:
        counts["without an area"] += 1
        return None
    return Box(x_min=x_min, y_min=y_min, x_max=x_max, y_max=y_max, label=thing.label, score=_score(thing.score))


BORDER_SLACK = 0.02
"""Distance outside the frame, as a fraction of its size, up to which a point counts as on the border."""


def _point(unit: list[float], thing: RawThing, counts: Counter[str]) -> Point | None:
    x, y = unit
    if not (-BORDER_SLACK <= x <= 1 + BORDER_SLACK and -BORDER_SLACK <= y <= 1 + BORDER_SLACK):
        counts["outside the picture"] += 1
        return None
    if not (0 <= x <= 1 and 0 <= y <= 1):
        counts["cut at the border"] += 1
    return Point(x=min(max(x, 0.0), 1.0), y=min(max(y, 0.0), 1.0), label=thing.label)


def _score(score: float | None) -> float | None:
    return score if score is not None and 0.0 <= score <= 1.0 else None


_Place = TypeVar("_Place", Box, Point)


def _add_place(place: _Place | None, places: dict[tuple[float, ...], _Place], counts: Counter[str]) -> None:
    """Add a box or point, unless the reply contains it already."""
    if place is None:
        return
    numbers = (place.x, place.y) if isinstance(place, Point) else (place.x_min, place.y_min, place.x_max, place.y_max)
    key = tuple(round(v, 3) for v in numbers)
    if key in places:
        counts["repeated"] += 1
    else:
        places[key] = place
