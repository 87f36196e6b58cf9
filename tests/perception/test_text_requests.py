"""Which questions are answered by reading text, and from which objects."""

from __future__ import annotations

import pytest

from scope_ptz.perception.models.text_requests import is_reading_request, reading_target, requested_texts, similarity, text_matches


@pytest.mark.parametrize(
    ("question", "target"),
    [
        ("what does the gantry sign say?", "gantry sign"),
        ("Read the speed limit sign.", "speed limit sign"),
        ("read it", None),
        ("read the text", None),
        ("Read the text on the white van, please", "white van"),
        ("what is written on the side of the lorry?", "side of the lorry"),
        ("What text is on the board?", "board"),
        ("which words are on the container?", "container"),
        ("what is the licence plate of the van?", None),
        ("what is the number plate number of the red car?", "red car"),
        ("transcribe all text in view", None),
        ("what's the name on the shop?", "shop"),
        ("What number is painted on the crane?", "crane"),
        ("zoom in and read the sign", "sign"),
        ("what does the notice read?", "notice"),
    ],
)
def test_reading_questions_and_their_targets(question: str, target: str | None) -> None:
    assert is_reading_request(question)
    assert reading_target(question) == target


@pytest.mark.parametrize(
    "question",
    [
        "what colour is the door?",
        "how many signs are there?",
        "is there a sign that says EXIT?",
        "is the man reading a newspaper?",
        "what is the worker doing?",
        "are there any number plates in view?",
        "which lane is closed?",
        "count the letters on the wall",
        "is the road wet?",
        "how many words are on the sign?",
    ],
)
def test_questions_that_are_not_only_about_reading(question: str) -> None:
    assert not is_reading_request(question)


@pytest.mark.parametrize(
    ("description", "wanted"),
    [
        ('the text "EXIT 14"', ("EXIT 14",)),
        ("the sign that says road works", ("road works",)),
        ("sign reading 'KEEP OUT'", ("KEEP OUT",)),
        ("text", ()),
        ("all visible text", ()),
        ("letters", ()),
        ("traffic cone", None),
        ("SUV", None),
        ("sign", None),
        ("worker's hat", None),
        ("speed limit sign", None),
    ],
)
def test_texts_that_a_description_quotes(description: str, wanted: tuple[str, ...] | None) -> None:
    assert requested_texts(description) == wanted


@pytest.mark.parametrize(
    ("wanted", "line", "fits"),
    [
        ("EXIT 14", "Exit14", True),
        ("Airport", "Alrport", True),
        ("ROAD WORKS", "ROAD WORKS AHEAD", True),
        ("EXIT", "ENTRY", False),
        ("", "x", False),
        ("x", "", False),
        ("出口", "出口 14", True),
    ],
)
def test_texts_match_despite_ocr_mistakes(wanted: str, line: str, fits: bool) -> None:
    assert text_matches(wanted, line) is fits


def test_similarity_is_between_zero_and_one() -> None:
    assert similarity("EXIT 14", "exit-14") == 1.0
    assert similarity("", "") == 0.0
