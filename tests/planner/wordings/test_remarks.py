"""What is said beside a command: statements, comments and polite phrases change nothing, and commands among them are not lost."""

from __future__ import annotations

import pytest

from scope_ptz.english.grammar.parts_of_speech import parts_of_speech, verb_form
from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.lexing.spelling import corrected_word
from scope_ptz.planner.grammar.parsing.parts.courtesy import is_polite
from scope_ptz.planner.grammar.parsing.parts.statements import is_comment, is_event, is_statement
from scope_ptz.planner.plan import plan

NOTHING_LEFT = "All right, I do nothing. What shall I do instead?"
PRESETS = ("main-gate", "yard", "helipad")


@pytest.mark.parametrize(
    "text",
    [
        "something just banged behind us",
        "the driver keeps honking",
        "school party's due",
        "we think it may have gone",
        "the wind has got up",
        "there is too much sky",
    ],
)
def test_statements_have_a_subject_and_a_finite_verb(text: str) -> None:
    assert is_statement(lexemes_of(text))


@pytest.mark.parametrize(
    "text",
    ["the white trucks", "the van parked by the gate", "two people near the van", "red cars", "people with hats", "of the lorry"],
)
def test_noun_phrases_are_no_statements(text: str) -> None:
    assert not is_statement(lexemes_of(text))


@pytest.mark.parametrize(("text", "is_one"), [("lost my bearings", True), ("far too close", True), ("a red lorry", False)])
def test_comments_have_no_subject(text: str, is_one: bool) -> None:
    assert is_comment(lexemes_of(text)) is is_one


@pytest.mark.parametrize(("text", "is_one"), [("I decide", True), ("the ferry leaves", True), ("you go home", False)])
def test_events_are_not_commands(text: str, is_one: bool) -> None:
    assert is_event(lexemes_of(text)) is is_one


@pytest.mark.parametrize(
    ("text", "is_one"),
    [
        ("do forgive me", True),
        ("my apologies for the bother", True),
        ("thank you ever so much", True),
        ("zoom out please", False),
        ("please", False),
    ],
)
def test_polite_phrases_contain_no_command(text: str, is_one: bool) -> None:
    assert is_polite(lexemes_of(text)) is is_one


@pytest.mark.parametrize(
    ("instruction", "calls"),
    [
        ("ease it down slightly there's too much sky", [{"tilt_deg": -5}]),
        ("turn round, something just banged behind us", [{"pan_deg": 180}]),
        ("I should be most grateful if you could pan right by 15 degrees", [{"pan_deg": 15}]),
        ("Okay, so what I need is a quarter turn to the right", [{"pan_deg": 90}]),
        ("Backlash test: pan right 25, then pan left 25", [{"pan_deg": 25}, {"pan_deg": -25}]),
        ("pan left 10 before the light goes", [{"pan_deg": -10}]),
        ("camera one from control, come six degrees to your left, over", [{"pan_deg": -6}]),
    ],
)
def test_remarks_beside_a_move_change_nothing(instruction: str, calls: list[dict[str, float]]) -> None:
    planned = plan(instruction, PRESETS)
    assert [call.arguments for call in planned.calls] == calls, planned.clarification


@pytest.mark.parametrize(
    "instruction",
    [
        "pan left 10, somebody told me right 20",
        "turn right 20, the left one is broken",
        "florp the lens right by 20",
        "avoid it 15 left",
        "zoom in, double it",
    ],
)
def test_remarks_that_may_matter_are_asked_about(instruction: str) -> None:
    assert not plan(instruction, PRESETS).calls


@pytest.mark.parametrize(
    "statement",
    [
        "I changed my mind",
        "the boss says no",
        "that was a joke",
        "it isn't needed",
        "that is not allowed",
        "we don't want that any more",
        "the camera is not supposed to move",
        "it has already been done",
        "no wait that's a mistake",
    ],
)
def test_statements_that_take_a_command_back_are_not_ignored(statement: str) -> None:
    planned = plan(f"pan left 10, {statement}", PRESETS)
    assert (planned.calls, planned.clarification) == ((), "Shall I do that, or not?")


@pytest.mark.parametrize(
    ("words", "question"),
    [
        ("don't", NOTHING_LEFT),
        ("actually don't", NOTHING_LEFT),
        ("no, don't do that", NOTHING_LEFT),
        ("oh wait, stay where you are", NOTHING_LEFT),
        ("don't bother", NOTHING_LEFT),
        ("no need", "Shall I do that, or not?"),
        ("no hang on", "Shall I do that, or not?"),
        ("hold on", "Shall I do that, or not?"),
        ("not yet", "Shall I do that, or not?"),
    ],
)
def test_words_that_take_a_command_back_are_not_ignored(words: str, question: str) -> None:
    planned = plan(f"go home, {words}", PRESETS)
    assert (planned.calls, planned.clarification) == ((), question)


def test_it_is_asked_which_of_several_commands_are_taken_back() -> None:
    planned = plan("pan left 20 and zoom in, no, don't", PRESETS)
    assert (planned.calls, planned.clarification) == ((), "Shall I do that, or not?")


@pytest.mark.parametrize(
    "negation",
    ["don't", "don't you dare", "could you not", "please do not", "you mustn't", "never", "I don't want you to", "let's not"],
)
def test_forbidden_moves_are_not_made(negation: str) -> None:
    assert plan(f"{negation} pan left", PRESETS).calls == ()


def test_a_preset_after_on_is_a_place_unless_things_have_its_name() -> None:
    names = [call.name for call in plan("how many people are on the helipad?", PRESETS).calls]
    assert names == ["go_to_preset", "count_objects"]
    assert [call.name for call in plan("how many signs are on the gantry", ("gantry",)).calls] == ["count_objects"]


@pytest.mark.parametrize(
    ("slip", "word"), [("becuase", "because"), ("coudl", "could"), ("imgae", "image"), ("gte", "get"), ("kingfisher", "kingfisher")]
)
def test_slips_of_the_keys_are_corrected_in_the_whole_vocabulary(slip: str, word: str) -> None:
    assert corrected_word(slip) == word


def test_parts_of_speech_of_words() -> None:
    assert parts_of_speech("gulls") == {"NOUN", "VERB"}
    assert [verb_form(word) for word in ("keep", "keeps", "kept", "keeping", "wheelchair")] == [
        "base", "third person", "past", "participle", None,
    ]  # fmt: skip
    assert not parts_of_speech("florp")


@pytest.mark.parametrize(
    ("text", "is_one"),
    [
        ("the shouting came from behind us", True),
        ("the light from the right side disturbs", True),
        ("half the crowd is cut off", True),
        ("the lady from the council wishes to see the block", True),
        ("the left lane", False),
        ("the cars parked by the gate", False),
    ],
)
def test_subjects_have_parts_sides_and_gerunds(text: str, is_one: bool) -> None:
    assert is_statement(lexemes_of(text)) is is_one


@pytest.mark.parametrize(
    ("instruction", "names"),
    [
        ("right, that's lunch. Go home.", ["go_home"]),
        ("go to the yard and I want to see the van", ["go_to_preset", "zoom_to_object"]),
        ("tilt up a lot, I want to see the roof", ["adjust_ptz"]),
        ("bit of glare so tilt down", ["adjust_ptz"]),
    ],
)
def test_a_wish_is_a_command_unless_it_is_the_reason_for_a_move(instruction: str, names: list[str]) -> None:
    assert [call.name for call in plan(instruction, PRESETS).calls] == names
