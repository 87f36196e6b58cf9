"""Texts on one thing are read together, line by line, and what cannot be read is mentioned."""

from __future__ import annotations

from dataclasses import replace

import pytest

from scope_ptz.english.grammar.questions.question_parser import parse_question
from scope_ptz.perception.ground_truth.answers import answer
from scope_ptz.perception.ground_truth.answers.text_blocks import blocks_of
from scope_ptz.perception.ground_truth.view import View, read_view
from scope_ptz.simulator.models import SceneText
from scope_ptz.simulator.truth import TextSighting
from tests.perception import yard

CAP_M = 0.1


def text(words: str, x_m: float, z_m: float, *, parent: str = "sign-01", cap_px: float = 20.0, facing: float = 1.0) -> TextSighting:
    """Return a text in the plane y = 0 that faces the camera, or with ``facing`` -1 the other way."""
    placed = SceneText(
        id=f"{words}-{x_m}-{z_m}-{facing}", text=words, parent=parent, centre_m=(x_m, 0.0, z_m), right=(facing, 0.0, 0.0),
        up=(0.0, 0.0, 1.0), width_m=0.06 * len(words), height_m=0.15, cap_height_m=CAP_M,
    )  # fmt: skip
    return TextSighting(placed, (0.4, 0.5 - z_m / 10, 0.5, 0.55 - z_m / 10), cap_px, 10.0, 1.0)


BOARD = [
    text("DEPARTURES", 0.3, 3.2), text("Platform", 2.6, 3.2),
    text("09:44", 0.0, 2.9), text("Harrowfield", 0.7, 2.9), text("1", 2.6, 2.9),
    text("09:52", 0.0, 2.6), text("Port Ellis", 0.7, 2.61), text("3", 2.6, 2.6),
    text("09:58", 0.0, 2.3), text("Brampton", 0.7, 2.28), text("2", 2.6, 2.3),
]  # fmt: skip
ROWS = ["DEPARTURES Platform", "09:44 Harrowfield 1", "09:52 Port Ellis 3", "09:58 Brampton 2"]
PRICES = ["PLUMS", "1.80 A KILO", "LEEKS 0.95"]


@pytest.mark.parametrize(
    ("texts", "lines"),
    [
        ([text("PARKING", 0.0, 1.0), text("STAFF", 0.0, 1.2)], [["STAFF PARKING"]]),
        (BOARD, [ROWS]),
        (BOARD[::-1], [ROWS]),
        ([text("PLUMS", 0.0, 1.0), text("1.80 A KILO", 0.0, 0.8), text("LEEKS 0.95", 0.0, 0.6)], [PRICES]),
        ([text("SOUP", 0.0, 1.0), text("SOUP", 0.0, 1.0, facing=-1.0)], [["SOUP"]]),
        ([text("7", 0.0, 3.0), text("HARROW VALE BUSES", 0.0, 1.0)], [["7"], ["HARROW VALE BUSES"]]),
        ([text("Brampton 14", 0.0, 3.0), text("50", 2.0, 3.0)], [["Brampton 14"], ["50"]]),
    ],
)  # fmt: skip
def test_texts_next_to_each_other_are_one_block(texts: list[TextSighting], lines: list[list[str]]) -> None:
    assert [block.lines for block in blocks_of(texts)] == lines


@pytest.mark.parametrize(
    ("goods", "price"), [("plums", "1.80"), ("leeks", "0.95"), ("sausages", "6.20")]
)  # fmt: skip
def test_a_price_may_be_in_the_row_below_its_goods(goods: str, price: str) -> None:
    board = [
        text("PLUMS", 0.0, 1.0), text("1.80 A KILO", 0.0, 0.8), text("LEEKS 0.95", 0.0, 0.6),
        text("SAUSAGES", 0.0, 0.4), text("6.20", 0.0, 0.2),
    ]  # fmt: skip
    reply = answer(view_with(*board), parse_question(f"how much are the {goods}?"))
    assert reply.text == f"The price of the {goods} is {price}."


def test_a_price_above_its_goods_is_not_that_of_the_goods_above_it() -> None:
    board = [text("1.20", 0.0, 1.0), text("PLUMS", 0.0, 0.8), text("6.20", 0.0, 0.6), text("LEEKS", 0.0, 0.4)]
    reply = answer(view_with(*board), parse_question("how much are the plums?"))
    assert not reply.known


@pytest.mark.parametrize(
    "rows",
    [
        ["PLUMS SOLD OUT", "LEEKS 0.95"],
        ["FRESH PLUMS", "LEEKS 0.95", "BEANS 1.40"],
        ["PLUMS", "LEEKS", "0.95", "BEANS 1.40"],
    ],
)
def test_a_price_of_other_goods_is_not_that_of_the_row_above_them(rows: list[str]) -> None:
    board = [text(row, 0.0, 1.0 - 0.2 * i) for i, row in enumerate(rows)]
    assert not answer(view_with(*board), parse_question("how much are the plums?")).known


def view_with(*texts: TextSighting) -> View:
    return read_view(replace(yard.truth(), texts=texts), yard.SCENE, 5.0)


@pytest.mark.parametrize(
    ("question", "texts", "expected"),
    [
        (
            "what do the signs say?",
            (text("50", 0, 1), text("A1", 0, 1, parent="sign-02", cap_px=5), text("DIG", 0, 1, parent="sign-03", cap_px=4)),
            'I can read 1 of the 3 signs in view: "50". The other 2 are too small to read from here. '
            "A closer view may help with the direction sign and the road works sign.",
        ),
        (
            "what does the sign say?",
            (text("50", 0, 1), text("A1", 0, 1, parent="sign-02", cap_px=5), text("DIG", 0, 1, parent="sign-03", cap_px=4)),
            'The speed limit sign reads "50". The other 2 signs in view are too small to read from here.',
        ),
        (
            "what does the sign say?",
            (text("A1", 0, 1, parent="sign-02", cap_px=5), replace(text("DIG", 0, 1, parent="sign-03"), angle_deg=70.0)),
            "There is text on the sign, but it is too small to read. A closer view may help with the direction sign.",
        ),
        (
            "what signs can you read?",
            (text("A1", 0, 1, parent="sign-02", cap_px=5),),
            "There is text on the signs, but it is too small to read. A closer view may help with the direction sign.",
        ),
        ("which signs can you read?", (text("50", 0, 1), text("A1", 0, 1, parent="sign-02")), 'The signs read "50" and "A1".'),
        (
            "is there a sign that mentions coffee?",
            (text("50", 0, 1), text("A1", 0, 1, parent="sign-02", cap_px=5)),
            'I cannot tell whether any of the 3 signs says "COFFEE": not all of their text can be read from here.',
        ),
        (
            "does the road works sign mention coffee?",
            (text("SLOW", 0, 1, parent="sign-03", cap_px=5),),
            'I cannot tell whether the road works sign says "COFFEE", because it is too small to read.',
        ),
        (
            "do any of the signs mention coffee?",
            (text("COFFEE", 0, 1), text("A1", 0, 1, parent="sign-02", cap_px=5)),
            'Yes, 1 of the 3 signs says "COFFEE": the one on the right.',
        ),
        ("what's the road works sign say?", (text("SLOW", 0, 1, parent="sign-03"),), 'The road works sign reads "SLOW".'),
        (
            "what is the speed limit?",
            (text("50", 0, 1, cap_px=5),),
            "The speed limit is on the speed limit sign, but it is too small to read.",
        ),
        (
            "what do the signs say?",
            (text("50", 0, 1), replace(text("A1", 0, 1, parent="sign-02"), angle_deg=70.0)),
            'I can read 1 of the 2 signs in view: "50". The other one is seen too much from the side to read from here.',
        ),
        ("what do the signs say?", (text("50", 0, 1), text("A1", 0, 1, parent="sign-02")), 'The signs read "50" and "A1".'),
        (
            "what does the road works sign say?",
            (text("SLOW", 0, 1, parent="sign-03"), text("from Monday", 0, 0.8, parent="sign-03", cap_px=5)),
            'The road works sign reads "SLOW". The rest is too small to read.',
        ),
        (
            "what text can you see?",
            (text("STAFF", 0, 1.2), text("PARKING", 0, 1), text("A1", 0, 1, parent="sign-02", cap_px=5)),
            'I can read "STAFF PARKING". The rest is too small to read.',
        ),
        (
            "what does the speed limit sign say?",
            tuple(BOARD),
            "The speed limit sign reads:\n" + "\n".join(f'"{row}"' for row in ROWS) + ".",
        ),
    ],
)
def test_what_is_left_out_is_mentioned(question: str, texts: tuple[TextSighting, ...], expected: str) -> None:
    assert answer(view_with(*texts), parse_question(question)).text == expected
