"""Clauses, descriptions, conditions and what is said beside a command."""

from __future__ import annotations

import pytest

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.conditions import condition_of
from scope_ptz.planner.grammar.parsing.instruction_parser import parse
from scope_ptz.planner.grammar.parsing.parts.clause import Source
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of, things_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, search
from scope_ptz.planner.grammar.parsing.segments.segmentation import clauses_of
from scope_ptz.planner.plan import plan

PRESETS = ("gate", "yard", "loading-dock")


def clauses(text: str) -> list[tuple[str, str, str]]:
    return [(c.link, c.marker, " ".join(x.word for x in c.lexemes)) for c in clauses_of(lexemes_of(text, PRESETS))]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("pan left 10 tilt up 5", [("", "", "pan left 10"), ("and", "", "tilt up 5")]),
        ("count the cars and vans, then go home", [("", "", "count the cars and vans"), ("then", "", "go home")]),
        ("if you see a van, pan left", [("", "IF", "you see a van"), (",", "", "pan left")]),
        ("take a picture if there is a van", [("", "", "take a picture"), ("", "IF", "there is a van")]),
        ("tell me if there is a van", [("", "", "tell me if there is a van")]),
        ("zoom in, but only a little", [("", "", "zoom in , but only a_little")]),
        ("look left, about ten degrees", [("", "", "look left , about ten degrees")]),
        ("go to the gate, the yard and home", [("", "", "go to the gate"), (",", "", "the yard"), ("and", "", "home")]),
    ],
)
def test_clauses_end_where_another_verb_begins(text: str, expected: list[tuple[str, str, str]]) -> None:
    assert clauses(text) == expected


def test_a_pattern_matches_classes_words_and_groups() -> None:
    lexemes = lexemes_of("could you count the red cars please")
    match = full_match("MODAL SELF COUNT DET (?P<thing>_+?) FILLER", lexemes)
    assert match is not None
    assert [x.word for x in match["thing"]] == ["red", "cars"]
    assert not full_match("COUNT _+", lexemes)
    assert search("COUNT DET", lexemes)


@pytest.mark.parametrize(
    ("text", "description"),
    [
        ("the red van by the gate", "red van by the gate"),
        ("people who are not wearing helmets", "people not wearing helmets"),
        ("the second car from the left", "second car from the left"),
        ("all of the cars in the picture", "cars"),
        ("a flange", "flange"),
    ],
)
def test_descriptions(text: str, description: str) -> None:
    thing = thing_of(Source(text), lexemes_of(text))
    assert thing is not None
    assert thing.text == description


@pytest.mark.parametrize(
    "text",
    [
        "the van and take a picture",
        "the van left 20 degrees",
        "the van then go home",
        "zoom",
        "read the sign",
        "the van is open",
        "of",
        "the dog until it stops",
    ],
)
def test_commands_and_statements_are_no_descriptions(text: str) -> None:
    assert thing_of(Source(text), lexemes_of(text)) is None


def test_lists_of_things() -> None:
    def read(text: str) -> list[str]:
        return [thing.text for thing in things_of(Source(text), lexemes_of(text)) or ()]

    assert read("cars, vans and lorries") == ["cars", "vans", "lorries"]
    assert read("people with hats and bags") == ["people with hats and bags"]
    assert read("red and white barriers") == ["red and white barriers"]


@pytest.mark.parametrize(
    ("text", "condition"),
    [
        ("there are more than three cars", ast.Seen(ast.Thing("cars"), ast.Quantity(">", 3))),
        ("you can see at least two vans", ast.Seen(ast.Thing("vans"), ast.Quantity(">=", 2))),
        ("no cars are visible", ast.Seen(ast.Thing("cars"), ast.Quantity("==", 0))),
        ("nobody is there", ast.Seen(ast.Thing("people"), ast.Quantity("==", 0))),
        ("the gate is open", ast.Statement(ast.Thing("gate", definite=True), "open")),
        ("the gate isn't open", ast.Statement(ast.Thing("gate", definite=True), "open", expected=False)),
        ("you can read the sign", ast.Readable(ast.Thing("sign", definite=True))),
        ("there are more cars than vans", ast.Outnumbers(ast.Thing("cars"), ast.Thing("vans"))),
    ],
)
def test_conditions(text: str, condition: ast.Condition) -> None:
    assert condition_of(Source(text), lexemes_of(text)) == condition


@pytest.mark.parametrize(
    ("text", "calls"),
    [
        ("pan left 20, the sun is in the lens", ["adjust_ptz"]),
        ("I can't see the doors, pan left 14", ["adjust_ptz"]),
        ("tilt down to see the path", ["adjust_ptz"]),
        ("there's a man by the van. follow him", ["track_object"]),
        ("if it's not too much trouble, tilt up 5", ["adjust_ptz"]),
        ("see a fox, follow it", ["count_objects", "track_object"]),
        ("any smoke? go home", ["count_objects", "go_home"]),
        ("pan left in case there is someone", ["adjust_ptz"]),
    ],
)
def test_what_is_said_beside_a_command(text: str, calls: list[str]) -> None:
    assert [call.name for call in plan(text, PRESETS).calls] == calls


@pytest.mark.parametrize(
    "text",
    [
        "I panned left 20", "did you pan left?", "camera 2 left", "he said to pan left 20", "pan left 20 and right",
        "tilt it right down", "pan left at 10", "the one on the right", "back up", "go right instead of left 20",
        "we're looking too far left", "pan left or 20", "pan left 10 to 20", "turn the sign to the left", "zoom up",
        "not left", "raise the barrier arm", "go to the van 20 left",
    ],
)  # fmt: skip
def test_what_is_not_clearly_a_command_moves_nothing(text: str) -> None:
    assert not plan(text, PRESETS).calls


def test_one_word_that_no_reading_covers_is_named() -> None:
    assert parse("pan left glorp 20", PRESETS).unread == ("glorp",)
    assert parse("go to the yard and zoom in 2x", PRESETS).unread == ()


@pytest.mark.parametrize(
    "text",
    [
        "pan left 10, ten degrees to the left",
        "go up 5 degrees, a little higher",
        "too far left, come back 5",
        "five degrees left, er, up ten",
        "pan left 10, actually, no, up a bit",
        "set zoom 4x, pan 10",
        "zoom in 2x, no, out",
        "left about 20-25",
    ],
)
def test_what_may_be_one_move_or_two_is_asked_about(text: str) -> None:
    assert len(plan(text, PRESETS).calls) <= 1


@pytest.mark.parametrize(
    ("text", "calls"),
    [
        ("Right, count the cars", ["count_objects"]),
        ("right, 20 degrees", ["adjust_ptz"]),
        ("pan right 10, no zoom", ["adjust_ptz"]),
        ("is this the gate?", ["query_answer"]),
        ("go to the gate, er, the yard", ["go_to_preset"]),
        ("I need to know what the sign says. Pan left 20 to see.", ["adjust_ptz", "query_answer"]),
    ],
)
def test_words_around_a_command(text: str, calls: list[str]) -> None:
    assert [call.name for call in plan(text, PRESETS).calls] == calls


@pytest.mark.parametrize(
    ("text", "step"),
    [
        ("how many cars and vans are there together?", ast.Total),
        ("add up the cars at the gate and those in the yard", ast.Total),
    ],
)
def test_counts_that_are_added_or_subtracted(text: str, step: type[ast.Step]) -> None:
    assert isinstance((parse(text, PRESETS).steps or (None,))[0], step)


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("how many wet floor signs have we got out", [("count_objects", "wet floor signs")]),
        ("how many empty trailers do we have standing here?", [("count_objects", "empty trailers")]),
        ("how many people are there standing here?", [("count_objects", "people standing here")]),
        ("can I have the yard up on the big screen?", [("go_to_preset", "yard")]),
        ("yard nxt pls", [("go_to_preset", "yard")]),
        ("zoom in on the van and please don't follow anyone who walks past it", [("zoom_to_object", "van")]),
        (
            "visit all the presets and tell me at each whether the ground is wet",
            [call for preset in PRESETS for call in (("go_to_preset", preset), ("query_answer", "Is the ground wet?"))],
        ),
        (
            "tell me at each preset how many people there are",
            [call for preset in PRESETS for call in (("go_to_preset", preset), ("count_objects", "people"))],
        ),
        ("do the other lights work?", [("query_answer", "do the other lights work?")]),
    ],
)
def test_everyday_wordings(instruction: str, expected: list[tuple[str, str]]) -> None:
    calls = plan(instruction, PRESETS).calls
    named = [next(a[key] for key in ("description", "question", "name") if key in a) for a in (call.arguments for call in calls)]
    assert list(zip([call.name for call in calls], named, strict=True)) == expected


def test_a_way_back_with_an_amount_is_a_turn() -> None:
    (call,) = plan("come back to the right by eight degrees", PRESETS).calls
    assert call.arguments == {"pan_deg": 8}


@pytest.mark.parametrize("instruction", ["do the other thing with that one like usual", "don't follow anyone"])
def test_what_names_no_deed_is_asked_back(instruction: str) -> None:
    made = plan(instruction, PRESETS)
    assert not made.understood and not made.calls


def test_the_whole_of_a_site_is_the_whole_scene() -> None:
    (call,) = plan("quantity of light poles over the entire terminal, please", PRESETS).calls
    assert call.arguments == {"description": "light poles", "view": "full"}
