"""Parsing of model replies to requests for locations and answers."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.errors import PerceptionError
from scope_ptz.perception.models.reply_parsing import (
    MAX_ANSWER_CHARS,
    MAX_REPLY_CHARS,
    is_unknown_answer,
    parse_answer,
    parse_locations,
    remove_reasoning,
)

ONE = [(1.0, 2.0, 3.0, 4.0)]
TWO = [*ONE, (5.0, 6.0, 7.0, 8.0)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('[{"bbox_2d": [1, 2, 3, 4], "label": "cone"}]', ONE),
        ('```json\n[{"bbox_2d": [1, 2, 3, 4], "label": "cone"}]\n```', ONE),
        ('```json\n[{"bbox_2d": [1, 2, 3, 4]}', ONE),
        ('Here are the cones [1]:\n\n{"objects": [{"bbox_2d": [1, 2, 3, 4]}, {"bbox_2d": [5, 6, 7, 8]}]}\nAnything else?', TWO),
        ('{"bbox_2d": [1, 2, 3, 4]}\n{"bbox_2d": [5, 6, 7, 8]}', TWO),
        ("<think>where [9,9,9,9]?</think>[[1,2,3,4],[5,6,7,8]]", TWO),
        ("[{'bbox_2d': [1, 2, 3, 4], 'label': \"worker's hat\"},]", ONE),
        ('{"cones": [[1,2,3,4],[5,6,7,8]]}', TWO),
        ('[{"bbox_2d": ["1", "2.0", "3", "4"]}]', ONE),
        ('[{"bbox": [[1,2],[3,4]]}]', ONE),
        ('[{"bbox_2d": "[1, 2.0, 3, 4]"}]', ONE),
        ('[{"x_min":1,"y_min":2,"x_max":3,"y_max":4}]', ONE),
        ('[{"box":{"xmin":1,"ymin":2,"xmax":3,"ymax":4},"score":0.5}]', ONE),
        ('[{"x":1,"y":2,"width":2,"height":2}]', ONE),
        ("这里有一个锥桶：[{\"bbox_2d\": [1, 2, 3, 4], \"label\": \"锥桶\"}]", ONE),
        ("<|object_ref_start|>cone<|object_ref_end|><|box_start|>(1,2),(3,4)<|box_end|>", ONE),
        ('[{"point_2d": [1, 2], "label": "a"}]', [(1.0, 2.0)]),
        ('<points x1="1.5" y1="2" x2="3" y2="4" alt="cones">cones</points>', [(1.5, 2.0), (3.0, 4.0)]),
        ('{"points":[{"x":1,"y":2}]}', [(1.0, 2.0)]),
    ],
)  # fmt: skip
def test_locations_are_found_in_any_surrounding_text(text: str, expected: list[tuple[float, ...]]) -> None:
    read = parse_locations(text)
    assert [t.numbers for t in read.locations] == expected


@pytest.mark.parametrize(
    "text",
    [
        '[{"bbox_2d": [1, 2, 3, 4], "label": "cone"}, {"bbox_2d": [5, 6, 7, 800',
        '```json\n[{"bbox_2d": [1, 2, 3, 4], "label": "cone"}, {"bbox_2d": [5, 6, 7, 8',
        '{"objects": [{"bbox_2d": [1, 2, 3, 4], "label": "a \\" b ] }"}, {"bb',
        '[{"x_min":1,"y_min":2,"x_max":3,"y_max":4},{"x_min":5,"y_min":6,"x_max":7,"y_max":80',
        "[[1,2,3,4],[5,6,7,8",
    ],
)
def test_only_complete_locations_of_a_list_count(text: str) -> None:
    read = parse_locations(text)
    assert [t.numbers for t in read.locations] == ONE and not read.complete


@given(st.integers(0, 400))
def test_a_reply_truncated_anywhere_never_gives_other_locations(at: int) -> None:
    allowed = [tuple(float(v + i) for v in (100, 200, 300, 400)) for i in range(7)]
    text = json.dumps([{"bbox_2d": box, "label": f"cone {i}"} for i, box in enumerate(allowed)])
    try:
        read = parse_locations(text[:at])
    except PerceptionError as error:
        assert error.kind == "malformed"
        return
    assert [t.numbers for t in read.locations] == allowed[: len(read.locations)]
    assert read.complete == (at >= len(text))


@pytest.mark.parametrize(
    "text",
    ["[]", "```json\n[]\n```", '{"objects": []}', "None.", "There are no cones in the image.",
     "No cones are visible in the picture.",
     "I see no dogs here.", "Nothing fits the description", "<think>hm</think>[]"],
)  # fmt: skip
def test_nothing_found_counts_when_the_reply_says_so(text: str) -> None:
    assert parse_locations(text).locations == ()


@pytest.mark.parametrize(
    "text",
    ["", "   ", "I'm sorry, I can't help with that.", "画面中没有锥桶。", "{}",
     '{"error": "boom", "objects": []}', "[", '{"objects": [',
     '{"objects": [{"label": "cone"}]}', "The cones are left of the lorry.", "<think>[[1,2,3,4]]", "\x00\x01", "42",
     "None of your business.", "[" * 3000,
     '{"count": 3}', "[some] text", "There are 3 cones", "No, I will not look for people [sic] in the image"],
)  # fmt: skip
def test_unreadable_replies_are_errors(text: str) -> None:
    with pytest.raises(PerceptionError) as caught:
        parse_locations(text)
    assert caught.value.kind == "malformed"
    assert len(str(caught.value)) < 400


def test_nan_and_infinity_are_kept_for_validation() -> None:
    read = parse_locations(
        '[{"bbox_2d": [NaN, 2, Infinity, 4]}, {"bbox_2d": [1, 2, 3, 4]}, {"bbox_2d": [1' + "0" * 500 + ", 2, 3, 4]}]"
    )
    assert len(read.locations) == 3


def test_an_object_without_a_location_is_counted() -> None:
    assert [t.numbers for t in parse_locations('[{"bbox_2d": [1,2,3,4]}, {"label": "cone"}]').locations] == [*ONE, ()]


def test_labels_and_scores_are_kept() -> None:
    (thing,) = parse_locations('[{"bbox_2d": [1,2,3,4], "label": "cone", "confidence": 0.75}]').locations
    assert (thing.label, thing.score) == ("cone", 0.75)


@pytest.mark.parametrize(
    "text",
    [
        "[" + ",".join(f"[{i},{i},{i + 9},{i + 9}]" for i in range(100_000)) + "]",
        "[" * 500_000,
        '{"a":' * 100_000,
        "cones, " * 300_000,
        "[1" * 100_000,
        "'" * 400_000,
    ],
    ids=["list", "brackets", "objects", "prose", "numbers", "quotes"],
)
def test_huge_replies_are_read(text: str) -> None:
    """Quadratic parsing would not finish."""
    try:
        read = parse_locations(text)
    except PerceptionError as error:
        assert error.kind == "malformed"
    else:
        assert not read.complete


@given(st.text(max_size=300))
def test_any_text_gives_locations_or_a_perception_error(text: str) -> None:
    try:
        parse_locations(text)
    except PerceptionError as error:
        assert error.kind == "malformed"


keys = st.sampled_from(["bbox_2d", "point", "x", "y", "objects", "label", "score", "box"])
leaves = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5))
values = st.recursive(leaves, lambda v: st.one_of(st.lists(v, max_size=5), st.dictionaries(keys, v, max_size=4)), max_leaves=20)


@given(values)
def test_any_json_gives_locations_or_a_perception_error(value: object) -> None:
    try:
        parse_locations(json.dumps(value))
    except PerceptionError as error:
        assert error.kind == "malformed"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (" Orange. ", "Orange."),
        ('"EXIT 14"', "EXIT 14"),
        ('"A" and "B"', '"A" and "B"'),
        ("<think>It is red?</think>\nRed.", "Red."),
        ("let me see</think>Red.", "Red."),
        ("La porte est rouge.", "La porte est rouge."),
        ("门是红色的。", "门是红色的。"),
        ("a\x00b\x1b[2J", "ab[2J"),
    ],
)
def test_answers(text: str, expected: str) -> None:
    assert parse_answer(text) == expected


@pytest.mark.parametrize("text", ["", " \n ", "<think>on and on", "<think></think>", '""', "\x00"])
def test_an_empty_answer_is_an_error(text: str) -> None:
    with pytest.raises(PerceptionError) as caught:
        parse_answer(text)
    assert caught.value.kind == "empty"


def test_long_answers_are_truncated() -> None:
    assert len(parse_answer("blah " * MAX_REPLY_CHARS)) <= MAX_ANSWER_CHARS + 2


@pytest.mark.parametrize(
    "text",
    [
        "I cannot tell.",
        "I can't tell from this picture.",
        "Unknown",
        "It is not possible to say.",
        "Not visible.",
        "I'm sorry, but I can't read it.",
        "I’m unable to determine that.",
        "Sorry, I cannot help with that.",
    ],
)
def test_answers_that_state_that_nothing_is_known(text: str) -> None:
    assert is_unknown_answer(text)


@pytest.mark.parametrize(
    "text",
    ["Red.", "No.", "There is no car.", "Three.", "The text reads UNKNOWN ROAD", "I can't see any dogs.", "A cannot tell sign"],
)
def test_answers_that_state_something(text: str) -> None:
    assert not is_unknown_answer(text)


def test_reasoning_is_removed() -> None:
    assert remove_reasoning("<think>a</think>b<thinking>c</thinking>d") == "bd"


@pytest.mark.parametrize("unit", ['[{"bbox_2d":[100,200,300,400]},', '{"objects":[', "[", "{'a':", "[[1,2,3,4],"])
def test_endless_opening_brackets_are_an_error(unit: str) -> None:
    try:
        read = parse_locations(unit * 5000)
    except PerceptionError as error:
        assert error.kind == "malformed"
    else:
        assert not read.complete
