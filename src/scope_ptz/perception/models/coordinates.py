"""Convert the coordinates in model replies to boxes and points in [0, 1].

Models use pixels of the image as they resized it (Qwen2.5-VL), thousandths (Qwen3-VL, Qwen3.5, and Gemini with y first),
percent (Molmo) or fractions (Moondream). Invalid boxes and points are dropped with a note, and boxes that extend beyond the frame
are clipped.
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

MAX_LOCATIONS = 300
"""Maximum number of boxes or points per reply. Longer lists are usually repetitions."""

MAX_ASPECT = 200.0
"""Maximum ratio of the longer to the shorter side that Qwen-VL processors accept."""


@dataclass(frozen=True, slots=True)
class Convention:
    """A model family's coordinate format.

    Attributes:
        space: The unit of the coordinates. "guess" infers it from the largest number in a reply.
        factor: The resized image's sides are multiples of this number of pixels; None for models without such a factor.
            If the coordinates are pixels, frames are resized before they are sent, so that the model does not resize them again.
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


def get_convention(name: str) -> Convention:
    """Return a convention by name.

    Raises:
        UnknownNameError: There is no such convention.
    """
    if name not in CONVENTIONS:
        raise UnknownNameError("coordinate convention", name, CONVENTIONS)
    return CONVENTIONS[name]


def smart_resize(width: int, height: int, *, factor: int, min_pixels: int, max_pixels: int) -> tuple[int, int]:
    """Return the size (width, height) to which Qwen-VL processors resize an image.

    Width and height are multiples of ``factor``, and their product is within the limits. The arithmetic matches ``smart_resize`` in
    the Qwen-VL image processors. An image with the returned size is not resized again.

    Raises:
        PerceptionError: The processors reject the aspect ratio.
    """
    if min(width, height) < 1 or max(width, height) / min(width, height) > MAX_ASPECT:
        raise PerceptionError(
            f"A picture of {width}x{height} is too narrow for a model. Its aspect ratio may be at most {MAX_ASPECT:.0f}:1."
        )
    new_width, new_height = max(factor, round(width / factor) * factor), max(factor, round(height / factor) * factor)
    if new_width * new_height > max_pixels:
        shrink = math.sqrt(width * height / max_pixels)
        new_width = max(factor, math.floor(width / shrink / factor) * factor)
        new_height = max(factor, math.floor(height / shrink / factor) * factor)
    elif new_width * new_height < min_pixels:
        grow = math.sqrt(min_pixels / (width * height))
        new_width, new_height = math.ceil(width * grow / factor) * factor, math.ceil(height * grow / factor) * factor
    return new_width, new_height


def fit_size(width: int, height: int, max_pixels: int) -> tuple[int, int]:
    """Return the size (width, height) scaled down to at most ``max_pixels`` pixels, with the same aspect ratio."""
    shrink = math.sqrt(width * height / max_pixels)
    return (width, height) if shrink <= 1 else (max(1, math.floor(width / shrink)), max(1, math.floor(height / shrink)))


@dataclass(frozen=True, slots=True)
class RawLocation:
    """A box (four numbers) or a point (two numbers) in a reply, in the model's coordinate convention."""

    numbers: tuple[float, ...]
    label: str | None = None
    score: float | None = None
    named: bool = False
    """Whether the reply names each number ("x_min": ...), so that their order does not depend on the convention."""

    @property
    def is_box(self) -> bool:
        return len(self.numbers) == 4


@dataclass(frozen=True, slots=True)
class ReplyLocations:
    """The boxes and points in a reply, in reply order.

    Attributes:
        notes: Corrections to the reply, and omissions from it.
        complete: False if the reply may have contained more locations.
    """

    boxes: tuple[Box, ...] = ()
    points: tuple[Point, ...] = ()
    notes: tuple[str, ...] = ()
    complete: bool = True


def locations_in_frame(
    locations: Iterable[RawLocation], convention: Convention, image_size: tuple[int, int], limit: int = MAX_LOCATIONS
) -> ReplyLocations:
    """Convert the boxes and points in a reply to [0, 1].

    Entries that are not finite, have no area, lie outside the frame or are repeated are dropped and counted in the notes.

    Args:
        locations: The locations in the reply.
        convention: The model's coordinate convention.
        image_size: Width and height of the image that the model received.
        limit: Maximum number of boxes or points to keep.

    Raises:
        PerceptionError: The reply names objects, but none has a usable box or point (kind "malformed").
    """
    raw = list(locations)
    scale_x, scale_y = _scale(raw, convention.space, image_size)
    counts: Counter[str] = Counter()
    boxes: dict[tuple[float, ...], Box] = {}
    points: dict[tuple[float, ...], Point] = {}
    for location in raw:
        if len(location.numbers) not in (2, 4):
            counts["without coordinates"] += 1
            continue
        numbers = _swap_axes(location.numbers) if convention.y_first and not location.named else location.numbers
        if not all(map(math.isfinite, numbers)):
            counts["not finite"] += 1
        else:
            unit = [v / (scale_x if i % 2 == 0 else scale_y) for i, v in enumerate(numbers)]
            if location.is_box:
                _add_location(_box(unit, location, counts), boxes, counts)
            else:
                _add_location(_point(unit, location, counts), points, counts)
    if raw and not boxes and not points:
        raise PerceptionError(f"None of the locations in the reply is in the picture ({_counts_text(counts)}).", kind="malformed")
    return _limit_locations(list(boxes.values()), list(points.values()), counts, limit)


_WITHOUT_LOCATION = ("not finite", "without coordinates")
"""Names of the counts of entries without usable coordinates. If one of these counts is not zero, the list is incomplete."""


def _limit_locations(boxes: list[Box], points: list[Point], counts: Counter[str], limit: int) -> ReplyLocations:
    notes = [f"Among the locations in the reply: {_counts_text(counts)}."] if counts else []
    within = max(len(boxes), len(points)) <= limit
    complete = within and not any(counts[kind] for kind in _WITHOUT_LOCATION)
    if not within:
        notes.append(f"The reply names {max(len(boxes), len(points))} things; the first {limit} are kept.")
    return ReplyLocations(tuple(boxes[:limit]), tuple(points[:limit]), tuple(notes), complete)


def _counts_text(counts: Counter[str]) -> str:
    return ", ".join(f"{number} {kind}" for kind, number in sorted(counts.items()))


def _scale(locations: Sequence[RawLocation], space: Space, image_size: tuple[int, int]) -> tuple[float, float]:
    """Return the divisors that convert the x and y coordinates in a reply to [0, 1]."""
    fixed = {"unit": 1.0, "percent": 100.0, "thousand": 1000.0}
    if space == "guess":
        space = _guess_space(locations, image_size)
    if space in fixed:
        return fixed[space], fixed[space]
    return float(image_size[0]), float(image_size[1])


def _guess_space(locations: Sequence[RawLocation], image_size: tuple[int, int]) -> Space:
    """Infer the unit of all coordinates in a reply from the largest one.

    Up to 1 means fractions, up to 1000 means thousandths (as the prompt requests), and up to the image size means pixels.
    """
    finite = [abs(v) for location in locations for v in location.numbers if math.isfinite(v)]
    largest = max(finite, default=0.0)
    if largest <= 1.0:
        return "unit"
    if largest <= 1000.0:
        return "thousand"
    if largest <= max(image_size) * 1.05:
        return "pixels"
    width, height = image_size
    raise PerceptionError(
        f"The reply's coordinates reach {largest:.0f} in a picture of {width}x{height}: the coordinate convention is unknown.",
        kind="malformed",
    )


def _swap_axes(numbers: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(v for i in range(0, len(numbers), 2) for v in (numbers[i + 1], numbers[i]))


def _box(unit: list[float], location: RawLocation, counts: Counter[str]) -> Box | None:
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
    return Box(x_min=x_min, y_min=y_min, x_max=x_max, y_max=y_max, label=location.label, score=_score(location.score))


BORDER_TOLERANCE = 0.02
"""Maximum distance outside the frame, as a fraction of its size, at which a point still counts as on the border."""


def _point(unit: list[float], location: RawLocation, counts: Counter[str]) -> Point | None:
    x, y = unit
    if not (-BORDER_TOLERANCE <= x <= 1 + BORDER_TOLERANCE and -BORDER_TOLERANCE <= y <= 1 + BORDER_TOLERANCE):
        counts["outside the picture"] += 1
        return None
    if not (0 <= x <= 1 and 0 <= y <= 1):
        counts["cut at the border"] += 1
    return Point(x=min(max(x, 0.0), 1.0), y=min(max(y, 0.0), 1.0), label=location.label)


def _score(score: float | None) -> float | None:
    return score if score is not None and 0.0 <= score <= 1.0 else None


_Location = TypeVar("_Location", Box, Point)


def _add_location(location: _Location | None, locations: dict[tuple[float, ...], _Location], counts: Counter[str]) -> None:
    """Add a box or point, unless it has already been added."""
    if location is None:
        return
    numbers = (
        (location.x, location.y)
        if isinstance(location, Point)
        else (location.x_min, location.y_min, location.x_max, location.y_max)
    )
    key = tuple(round(v, 3) for v in numbers)
    if key in locations:
        counts["repeated"] += 1
    else:
        locations[key] = location
