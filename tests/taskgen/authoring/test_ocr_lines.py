"""Lines of text that belong together are read from top to bottom, and other combinations are not used."""

from __future__ import annotations

from scope_ptz.simulator.models import SceneText
from scope_ptz.simulator.truth import BoxTuple, TextSighting
from scope_ptz.taskgen.authoring.categories.ocr_tasks import is_on_object, order_lines, select_prices


def sighting_of(text: str, box: BoxTuple) -> TextSighting:
    source = SceneText(
        id=text,
        parent="sign",
        text=text,
        centre_m=(0, 0, 0),
        right=(1, 0, 0),
        up=(0, 0, 1),
        width_m=1,
        height_m=1,
        cap_height_m=0.1,
    )
    return TextSighting(source, box, 20.0, 0.0, 1.0)


ROAD, AHEAD, ASIDE = (
    sighting_of("ROAD", (0.4, 0.40, 0.6, 0.44)), sighting_of("AHEAD", (0.42, 0.46, 0.6, 0.50)),
    sighting_of("LEFT", (0.7, 0.41, 0.8, 0.45)),
)  # fmt: skip


def test_lines_are_ordered_from_top_to_bottom() -> None:
    assert order_lines((AHEAD, ROAD)) == (ROAD, AHEAD)


def test_separate_texts_are_not_joined() -> None:
    assert order_lines((ROAD, ASIDE)) is None
    assert order_lines((ROAD, sighting_of("FOOT", (0.4, 0.9, 0.6, 0.94)))) is None
    assert order_lines(()) is None


def test_a_repeated_text_counts_once() -> None:
    repeated = sighting_of("ROAD", (0.1, 0.2, 0.2, 0.24))
    assert order_lines((ROAD, repeated)) == (repeated,)


def test_only_the_price_of_a_price_card_is_read() -> None:
    price = sighting_of("5.00", (0.4, 0.46, 0.6, 0.5))
    assert select_prices((sighting_of("ROSES", (0.4, 0.4, 0.6, 0.44)), price)) == (price,)


def test_a_plate_next_to_an_object_is_not_a_text_on_it() -> None:
    box = (0.4, 0.45, 0.6, 0.9)
    assert is_on_object(box, AHEAD)
    assert not is_on_object(box, ROAD)
    assert not is_on_object(None, AHEAD)
