"""The answer parser against hand-written right and wrong answers of every type, and properties that hold for any answer."""

from __future__ import annotations

import json
import random
from collections import Counter
from itertools import permutations, product
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter

from scope_ptz.bench.answers import Declined, ParsedValue, Unreadable, agrees, parse_answer
from scope_ptz.bench.tasks.expected import (
    ActionOnly,
    AnyExpected,
    Choice,
    Expected,
    NameSet,
    NoneThere,
    Number,
    Ordering,
    Text,
    YesNo,
)
from scope_ptz.taskgen.facts.answer_phrasing import correct_answers, wrong_answer

DATA = Path(__file__).parent / "data"
ADAPTER: TypeAdapter[AnyExpected] = TypeAdapter(Expected)
EXPECTATIONS = {
    name: ADAPTER.validate_python(content)
    for name, content in yaml.safe_load((DATA / "expectations.yaml").read_text("utf-8")).items()
}
ANSWERS = [json.loads(line) for line in (DATA / "answers.jsonl").read_text("utf-8").splitlines()]
HELD_OUT = [
    json.loads(line)
    for name in ("answers_held_out.jsonl", "answers_models.jsonl")
    for line in (DATA / name).read_text("utf-8").splitlines()
]
ANSWERED = {name: expected for name, expected in EXPECTATIONS.items() if not isinstance(expected, ActionOnly)}


def verdict(expected: AnyExpected, answer: str) -> str:
    if isinstance(expected, ActionOnly):
        return "right"
    reading = parse_answer(expected, answer)
    if isinstance(reading, Declined):
        return "declined"
    return {True: "right", False: "wrong", None: "unscored"}[agrees(expected, reading)]


@pytest.mark.parametrize("case", ANSWERS, ids=[f"{c['expected']}-{i}" for i, c in enumerate(ANSWERS)])
def test_answers_are_parsed_as_people_understand_them(case: dict[str, str]) -> None:
    expected = EXPECTATIONS[case["expected"]]
    assert verdict(expected, case["answer"]) == case["verdict"], (case["answer"], parse_answer(expected, case["answer"]))


@pytest.mark.parametrize("note", [" (Source: the simulator's ground truth.)", " (seen by moondream3)", "\n"])
def test_a_source_note_changes_nothing(note: str) -> None:
    changed = [c["answer"] for c in ANSWERS if verdict(EXPECTATIONS[c["expected"]], c["answer"] + note) != c["verdict"]]
    assert changed == []


def test_text_in_capitals_is_an_answer_of_any_length() -> None:
    board = Text(accepted=("ALDERMERE POST / TRAM FARES / TO RISE / IN MAY",), ocr=True)
    assert verdict(board, board.accepted[0]) == "right"
    assert verdict(board, board.accepted[0].replace("MAY", "JUNE")) == "wrong"
    assert verdict(board, "it is a board of a newspaper with several lines about trams") == "unscored"


def test_text_with_a_verb_is_parsed_as_a_whole() -> None:
    board = Text(accepted=("DAILY COURIER MARKET IS 300 YEARS OLD",), ocr=True)
    for answer in ("DAILY COURIER MARKET IS 300 YEARS OLD", "The board says DAILY COURIER MARKET IS 300 YEARS OLD."):
        assert agrees(board, parse_answer(board, answer)) is True
    assert agrees(board, parse_answer(board, "The board says DAILY COURIER MARKET IS 500 YEARS OLD.")) is False


def test_there_are_many_answers_of_every_type() -> None:
    assert len(ANSWERS) >= 300
    kinds = Counter(EXPECTATIONS[c["expected"]].kind for c in ANSWERS)
    assert set(kinds) == {e.kind for e in EXPECTATIONS.values()}
    assert len(kinds) == 10
    for kind in set(kinds) - {"action_only"}:
        verdicts = {c["verdict"] for c in ANSWERS if EXPECTATIONS[c["expected"]].kind == kind}
        assert {"right", "wrong"} <= verdicts, kind


def test_held_out_answers() -> None:
    """Answers that are not parsed exactly are unscored: no wrong answer passes, and no right one fails."""
    verdicts = [(c["verdict"], verdict(EXPECTATIONS[c["expected"]], c["answer"]), c["answer"]) for c in HELD_OUT]
    assert [row for row in verdicts if row[1] == "right" != row[0]] == []
    assert [row for row in verdicts if row[0] == "right" != row[1]] == []
    assert sum(one == two for one, two, _ in verdicts) / len(verdicts) > 0.98


@pytest.mark.parametrize("name", ANSWERED)
def test_generated_right_and_wrong_answers(name: str) -> None:
    expected = EXPECTATIONS[name]
    wordings = correct_answers(expected)
    assert len(set(wordings)) >= 5
    assert [w for w in wordings if verdict(expected, w) != "right"] == []
    wrong = [wrong_answer(expected, random.Random(seed)) for seed in range(20)]
    assert [w for w in wrong if w is None or verdict(expected, w) != "wrong"] == []


@settings(deadline=None)
@given(
    st.integers(0, 130), st.integers(0, 3), st.sampled_from(["cone", "person", "bus", "lorry", "traffic cone", ""]), st.integers()
)
def test_any_number_in_any_of_its_wordings(value: int, tolerance: int, unit: str, seed: int) -> None:
    expected = Number(value=value, tolerance=tolerance, unit=(unit,) if unit else ())
    assert {verdict(expected, answer) for answer in correct_answers(expected)} == {"right"}
    wrong = wrong_answer(expected, random.Random(seed))
    assert wrong is not None
    assert verdict(expected, wrong) == "wrong"


@settings(deadline=None)
@given(st.permutations(["cone", "van", "sign", "bus"]), st.integers())
def test_any_order(order: list[str], seed: int) -> None:
    expected = Ordering(value=tuple(order), options=dict.fromkeys(sorted(order), ()))
    assert {verdict(expected, answer) for answer in correct_answers(expected)} == {"right"}
    wrong = wrong_answer(expected, random.Random(seed))
    assert wrong is not None
    assert verdict(expected, wrong) == "wrong"


@settings(deadline=None)
@given(st.sets(st.sampled_from(["car", "van", "bus", "lorry", "crane"])), st.integers())
def test_any_set(names: set[str], seed: int) -> None:
    expected = NameSet(value=tuple(sorted(names)), options=dict.fromkeys(("car", "van", "bus", "lorry", "crane"), ()))
    assert {verdict(expected, answer) for answer in correct_answers(expected)} == {"right"}
    wrong = wrong_answer(expected, random.Random(seed))
    assert wrong is not None
    assert verdict(expected, wrong) == "wrong"


@settings(deadline=None)
@given(st.from_regex(r"[A-Z]{2}[0-9]{2} [A-Z]{3}", fullmatch=True), st.integers())
def test_any_number_plate(plate: str, seed: int) -> None:
    expected = Text(accepted=(plate,), ocr=True)
    assert {verdict(expected, answer) for answer in correct_answers(expected)} == {"right"}
    wrong = wrong_answer(expected, random.Random(seed))
    assert wrong is not None
    assert verdict(expected, wrong) == "wrong"


@given(st.text(max_size=200))
@settings(max_examples=120, deadline=None)
def test_no_text_breaks_the_parser(text: str) -> None:
    for expected in ANSWERED.values():
        assert isinstance(parse_answer(expected, text), ParsedValue | Declined | Unreadable)


WORDS = [
    "no",
    "yes",
    "5",
    "cones",
    "not",
    "or",
    "and",
    "red",
    "gate",
    "highway",
    "than",
    "more",
    "the",
    ",",
    ".",
    "a",
    "van",
    "none",
    "left",
]


@given(st.lists(st.sampled_from(WORDS), max_size=12).map(" ".join))
@settings(max_examples=300, deadline=None)
def test_the_parsed_value_does_not_depend_on_the_expected_value(text: str) -> None:
    for value in (1, 5):
        assert parse_answer(Number(value=value, unit=("cone",)), text) == parse_answer(Number(value=9, unit=("cone",)), text)
    assert parse_answer(YesNo(value=True, affirms=("van",)), text) == parse_answer(YesNo(value=False, affirms=("van",)), text)
    options: dict[str, tuple[str, ...]] = {"red": (), "blue": (), "left": ()}
    assert parse_answer(Choice(value="red", options=options), text) == parse_answer(Choice(value="left", options=options), text)


@pytest.mark.parametrize("joint", [" ", ", ", " or ", "; ", ". ", " and ", "\n", " / "])
def test_naming_all_options_is_not_an_answer(joint: str) -> None:
    """An answer that names every option never passes, in any order."""
    options: dict[str, tuple[str, ...]] = {"red": (), "blue": (), "white": ()}
    for words in permutations(options):
        assert verdict(Choice(value="red", options=options), joint.join(words)) != "right"
    for numbers in permutations(["4", "5", "6"]):
        assert verdict(EXPECTATIONS["cones"], joint.join(numbers)) != "right"
    for pair in (("yes", "no"), ("no", "yes")):
        assert verdict(EXPECTATIONS["van"], joint.join(pair)) != "right"
        assert verdict(EXPECTATIONS["lorry"], joint.join(pair)) != "right"
    for texts in permutations(['"ROAD CLOSED"', '"ROAD OPEN"', '"STOP"']):
        assert verdict(EXPECTATIONS["road-closed"], joint.join(texts)) != "right"
    for names in permutations(["excavator", "roller", "van"]):
        assert verdict(EXPECTATIONS["machines"], joint.join(names)) != "right"
    assert verdict(EXPECTATIONS["bikes"], joint.join(["none", "one bicycle"])) != "right"
    assert verdict(EXPECTATIONS["more"], joint.join(["the gate has more", "the highway has more"])) != "right"


KITE = ("kite",)
COLOURS: dict[str, tuple[str, ...]] = {"green": (), "red": ()}
QUARTERS: dict[str, tuple[str, ...]] = {"top left": ("upper left",), "bottom right": ()}
NO_KITE = NoneThere(subject=KITE, claims=(*COLOURS, *QUARTERS, "upper left"))
TWINS: tuple[AnyExpected, ...] = (
    *(Number(value=value, unit=KITE) for value in (1, 2, 3)),
    *(Choice(value=name, options=COLOURS, subject=KITE) for name in COLOURS),
    *(Choice(value=name, options=QUARTERS, subject=KITE) for name in QUARTERS),
    YesNo(value=True, affirms=KITE),
    YesNo(value=True),
)
DENIALS = (
    "There are no kites", "There is no kite", "No", "None", "Nothing", "0", "0 kites", "Kites: 0", "kites are absent", "Not one",
    "There is none", "Kites: none", "neither kites nor vans", "There is no other kite", "no kites at the gate", "none at the gate",
    "There are no red kites", "3 kites are missing", "no kite in the top left", "The answer is no", "not 2 kites",
)  # fmt: skip
CLAIMS = (
    "3", "three", "In total 3", "3 kites", "total: 3", "so 3", "= 3", "3 altogether", "the count is 3", "3 of them",
    "a pair of kites",
    "a kite", "one", "more than 2", "2 + 1", "correction: 3", "perhaps 3", "5 of the 7", "3 at the works", "other than kites 3",
    "not 2", "(3)", "3 others", "Red", "It is green", "so red", "Top left", "it is in the upper left", "the green one",
    "a green kite",
    "its colour is green", "I mean green", "red rather than green", "The kite is green", "yes", "the answer is yes", "not no",
)  # fmt: skip
JOINTS = (
    ". ",
    ", ",
    ": ",
    "; ",
    " - ",
    " but ",
    " and ",
    "? ",
    " or ",
    " (",
    " ",
    "/",
    "\n",
    " so ",
    ", and ",
    " except ",
    " that is ",
)


@pytest.mark.parametrize("step", [11, pytest.param(1, marks=pytest.mark.full)])
@pytest.mark.parametrize("denial", DENIALS)
def test_no_text_is_correct_for_both_an_absence_and_a_presence(denial: str, step: int) -> None:
    """The full tier tests every pair of texts, and the fast tier every 11th, which still includes each claim and joint."""
    texts = [f"{one}{joint}{two}." for claim, joint in product(CLAIMS, JOINTS) for one, two in ((denial, claim), (claim, denial))]
    for text in texts[::step]:
        if verdict(NO_KITE, text) == "right":
            assert [twin for twin in TWINS if verdict(twin, text) == "right"] == [], text


@pytest.mark.full
@settings(deadline=None, max_examples=400)
@given(st.lists(st.tuples(st.sampled_from(DENIALS + CLAIMS), st.sampled_from(JOINTS)), min_size=2, max_size=4))
def test_no_longer_text_is_correct_for_both_an_absence_and_a_presence(pieces: list[tuple[str, str]]) -> None:
    text = "".join(piece + joint for piece, joint in pieces)
    assert not (verdict(NO_KITE, text) == "right" and any(verdict(twin, text) == "right" for twin in TWINS)), text


@pytest.mark.parametrize(
    "text", ["There are no kites (0: 3 and 3)", "There are no kites (0: 3 kites and 3.", "There are no kites. No that is "]
)
def test_odd_combinations_are_unscored(text: str) -> None:
    assert [twin for twin in TWINS if verdict(twin, text) == "right"] == []


def test_denials_and_claims_are_parsed_on_their_own() -> None:
    """Each part can be parsed alone, so the tests above do not pass because of unreadable texts."""
    assert sum(verdict(NO_KITE, denial) == "right" for denial in DENIALS) >= 14
    assert sum(any(verdict(twin, claim) == "right" for twin in TWINS) for claim in CLAIMS) >= 26
