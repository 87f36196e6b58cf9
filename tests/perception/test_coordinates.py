"""Coordinates of every convention become [0, 1], and the resize arithmetic is that of the models."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from scope_ptz.errors import PerceptionError, UnknownNameError
from scope_ptz.perception.models.coordinates import (
    CONVENTIONS,
    MAX_LOCATIONS,
    RawLocation,
    fit_size,
    get_convention,
    locations_in_frame,
    smart_resize,
)

sides = st.integers(1, 9000)
factors = st.sampled_from([28, 32])
budgets = st.sampled_from([(56 * 56, 1280 * 28 * 28), (4 * 28 * 28, 16384 * 28 * 28), (65536, 2048 * 32 * 32)])
SENT = (1288, 728)


@given(sides, sides, factors, budgets)
def test_resized_sides_are_multiples_within_the_budget(width: int, height: int, factor: int, budget: tuple[int, int]) -> None:
    assume(max(width, height) / min(width, height) <= 200)
    low, high = budget
    new_width, new_height = smart_resize(width, height, factor=factor, min_pixels=low, max_pixels=high)
    assert new_width % factor == 0 and new_height % factor == 0 and min(new_width, new_height) >= factor
    # Each side has at least one factor of pixels. A very long picture exceeds the budget for this reason.
    if min(new_width, new_height) > factor:
        assert new_width * new_height <= high
    assert new_width * new_height >= low


@given(sides, sides, factors, budgets)
def test_a_resized_picture_keeps_its_size(width: int, height: int, factor: int, budget: tuple[int, int]) -> None:
    assume(max(width, height) / min(width, height) <= 150)
    low, high = budget
    once = smart_resize(width, height, factor=factor, min_pixels=low, max_pixels=high)
    assume(min(once) > factor and max(once) / min(once) <= 200)
    assert smart_resize(*once, factor=factor, min_pixels=low, max_pixels=high) == once


@given(st.integers(200, 4000), st.integers(200, 4000), factors)
def test_resizing_keeps_the_aspect_ratio_within_one_step(width: int, height: int, factor: int) -> None:
    new_width, new_height = smart_resize(width, height, factor=factor, min_pixels=56 * 56, max_pixels=1280 * 28 * 28)
    scale = new_width / width
    assert abs(height * scale - new_height) <= factor * (1 + height / width)


@pytest.mark.parametrize(
    ("size", "factor", "expected"),
    [((1280, 720), 28, (1288, 728)), ((1280, 720), 32, (1280, 704)), ((640, 480), 28, (644, 476)), ((50, 20), 28, (112, 56))],
)
def test_known_sizes(size: tuple[int, int], factor: int, expected: tuple[int, int]) -> None:
    """Computed by hand from the published arithmetic, including Python's rounding to even."""
    assert smart_resize(*size, factor=factor, min_pixels=3136, max_pixels=12845056) == expected


@pytest.mark.parametrize("size", [(0, 10), (4020, 20), (1, 500)])
def test_pictures_that_are_too_narrow_are_errors(size: tuple[int, int]) -> None:
    with pytest.raises(PerceptionError, match="too narrow"):
        smart_resize(*size, factor=28, min_pixels=3136, max_pixels=12845056)


@given(sides, sides, st.integers(64 * 64, 4_000_000))
def test_fit_respects_the_budget_and_never_enlarges(width: int, height: int, budget: int) -> None:
    new_width, new_height = fit_size(width, height, budget)
    assert new_width <= width and new_height <= height and min(new_width, new_height) >= 1
    if min(new_width, new_height) > 1:
        assert new_width * new_height <= budget


unit = st.floats(0, 1)
boxes = st.tuples(unit, unit, unit, unit).map(lambda v: (min(v[0], v[2]), min(v[1], v[3]), max(v[0], v[2]), max(v[1], v[3])))


def written(box: tuple[float, ...], name: str) -> tuple[float, ...]:
    """A box as a model of that convention writes it."""
    style = get_convention(name)
    scale = {"unit": (1.0, 1.0), "percent": (100.0, 100.0), "thousand": (1000.0, 1000.0), "guess": (1000.0, 1000.0), "pixels": SENT}
    new_width, new_height = scale[style.space]
    numbers = [v * (new_width if i % 2 == 0 else new_height) for i, v in enumerate(box)]
    return (numbers[1], numbers[0], numbers[3], numbers[2]) if style.y_first else tuple(numbers)


@pytest.mark.parametrize("name", sorted(CONVENTIONS))
@given(box=boxes)
def test_every_convention_gives_back_the_box(name: str, box: tuple[float, float, float, float]) -> None:
    assume(box[2] - box[0] > 0.01 and box[3] - box[1] > 0.01)
    (found,) = locations_in_frame([RawLocation(written(box, name))], get_convention(name), SENT).boxes
    assert (found.x_min, found.y_min, found.x_max, found.y_max) == pytest.approx(box, abs=1e-9)


numbers = st.floats(allow_nan=True, allow_infinity=True, width=64)
raw_locations_strategy = st.lists(
    st.one_of(st.tuples(*[numbers] * 4), st.tuples(*[numbers] * 2), st.lists(numbers, max_size=6).map(tuple)), max_size=20
)


@pytest.mark.parametrize("name", sorted(CONVENTIONS))
@given(raw=raw_locations_strategy)
def test_any_numbers_become_valid_locations_or_an_error(name: str, raw: list[tuple[float, ...]]) -> None:
    try:
        found = locations_in_frame([RawLocation(n) for n in raw], get_convention(name), SENT)
    except PerceptionError as error:
        assert error.kind == "malformed" and raw
        return
    for box in found.boxes:
        assert 0 <= box.x_min < box.x_max <= 1 and 0 <= box.y_min < box.y_max <= 1
    assert all(0 <= p.x <= 1 and 0 <= p.y <= 1 for p in found.points)
    assert len(found.boxes) + len(found.points) <= len(raw)
    assert bool(found.boxes or found.points) or not raw


def test_boxes_beyond_the_border_are_clipped_and_noted() -> None:
    found = locations_in_frame([RawLocation((-50, 100, 1500, 600))], get_convention("qwen2.5-vl"), SENT)
    assert found.boxes[0].x_min == 0 and found.boxes[0].x_max == 1
    assert "1 cut at the border" in found.notes[0]


def test_invalid_locations_are_dropped_and_counted() -> None:
    things = [(10, 10, 500, 500), (math.nan, 0, 5, 5), (5, 5, 5, 90), (1200, 10, 1500, 90), (10, 10, 500, 500), (1, 2, 3)]
    found = locations_in_frame([RawLocation(t) for t in things], get_convention("thousand"), SENT)
    assert len(found.boxes) == 1
    for what in ("1 not finite", "1 without an area", "1 outside the picture", "1 repeated", "1 without coordinates"):
        assert what in found.notes[0]


def test_an_object_without_a_location_makes_the_result_incomplete() -> None:
    cone, lost = RawLocation((10, 10, 500, 500)), RawLocation((math.nan, 0, 5, 5))
    assert not locations_in_frame([cone, lost], get_convention("thousand"), SENT).complete
    assert not locations_in_frame([cone, RawLocation(())], get_convention("thousand"), SENT).complete
    # Locations outside the picture and repeated locations are not counted as missing.
    assert locations_in_frame([cone, cone, RawLocation((1200, 10, 1500, 90))], get_convention("thousand"), SENT).complete


@pytest.mark.parametrize("numbers", [(1500, 10, 1900, 90), (math.nan,) * 4, (math.inf, 1), (5, 5, 5, 5), ()])
def test_a_reply_without_any_valid_location_is_an_error(numbers: tuple[float, ...]) -> None:
    with pytest.raises(PerceptionError) as caught:
        locations_in_frame([RawLocation(numbers)], get_convention("thousand"), SENT)
    assert caught.value.kind == "malformed"


def test_too_many_objects_are_truncated_and_incomplete() -> None:
    found = locations_in_frame(
        [RawLocation((x, y)) for x in range(0, 1000, 40) for y in range(0, 1000, 50)], get_convention("thousand"), SENT
    )
    assert len(found.points) == MAX_LOCATIONS and not found.complete
    assert "500 things" in found.notes[-1]


def test_swapped_corners_are_corrected() -> None:
    (box,) = locations_in_frame([RawLocation((900, 800, 100, 200))], get_convention("thousand"), SENT).boxes
    assert (box.x_min, box.y_min, box.x_max, box.y_max) == (0.1, 0.2, 0.9, 0.8)


def test_numbers_with_names_may_be_in_any_order() -> None:
    (box,) = locations_in_frame([RawLocation((100, 200, 300, 400), named=True)], get_convention("gemini"), SENT).boxes
    assert box.x_min == 0.1


@pytest.mark.parametrize(
    ("box", "expected"),
    [((0.1, 0.2, 0.5, 0.6), 0.1), ((100, 200, 500, 600), 0.1), ((128.8, 72.8, 1280, 700), 0.1), ((0, 0, 1, 1), 0.0)],
)
def test_the_convention_of_a_reply_is_guessed_from_its_largest_number(box: tuple[float, ...], expected: float) -> None:
    assert locations_in_frame([RawLocation(box)], get_convention("generic"), SENT).boxes[0].x_min == pytest.approx(expected)


def test_numbers_beyond_the_picture_are_an_error() -> None:
    with pytest.raises(PerceptionError, match="convention is unknown"):
        locations_in_frame([RawLocation((10, 10, 5000, 600))], get_convention("generic"), SENT)


def test_invalid_scores_are_dropped() -> None:
    found = locations_in_frame([RawLocation((1, 1, 9, 9), score=s) for s in (7.0,)], get_convention("thousand"), SENT)
    assert found.boxes[0].score is None


def test_an_unknown_convention_is_an_error() -> None:
    with pytest.raises(UnknownNameError, match="qwen3-vl"):
        get_convention("qwen3")
