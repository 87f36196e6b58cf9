"""What somebody reports beside a command, and why the user wants it, neither counts anything nor changes the command."""

from __future__ import annotations

import pytest

from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.parts.statements import is_past_event, is_statement
from scope_ptz.planner.plan import plan
from tests.planner.conversations.talk import last_calls
from tests.planner.wordings.test_wordings_of_speech import PRESETS, shown


@pytest.mark.parametrize(
    ("text", "calls"),
    [
        ("someone coughed, go to the gate", "go_to_preset(name=gate)"),
        ("somebody just rang, zoom in", "adjust_ptz(zoom_factor=2)"),
        ("somebody came in, pan left 20", "adjust_ptz(pan_deg=-20)"),
        ("a neighbour complained, go to the crossing", "go_to_preset(name=crossing)"),
        ("two visitors fainted, tilt down 10", "adjust_ptz(tilt_deg=-10)"),
        ("count the vans, my wife asked", "count_objects(description=vans, view=current)"),
        ("count the vans, our warden queried", "count_objects(description=vans, view=current)"),
    ],
)
def test_a_past_form_after_a_subject_reports_something(text: str, calls: str) -> None:
    assert shown(plan(text, PRESETS).calls) == calls


def test_people_who_are_described_are_still_looked_for() -> None:
    assert shown(plan("anyone limping, zoom in", PRESETS).calls).startswith("count_objects(description=people limping")
    assert shown(plan("if somebody fell, zoom in", PRESETS).calls).startswith("count_objects(description=people fell")


@pytest.mark.parametrize(("text", "expected"), [("someone rang", True), ("someone trapped", False), ("someone is there", False)])
def test_past_events(text: str, expected: bool) -> None:
    assert is_past_event(lexemes_of(text)) == expected


def test_participles_after_a_noun_make_no_statement() -> None:
    assert not is_statement(lexemes_of("a lorry parked"))


@pytest.mark.parametrize(
    ("text", "calls"),
    [
        ("zoom in, I love this one", "adjust_ptz(zoom_factor=2)"),
        ("Zoom in. I really like that one.", "adjust_ptz(zoom_factor=2)"),
        ("zoom in on the heron, I like this one", "zoom_to_object(description=heron)"),
        ("zoom right in, that one is lovely", "adjust_ptz(zoom_limit=in)"),
        ("tilt down, the gate is hidden", "adjust_ptz(tilt_deg=-10)"),
        ("tilt up 5, the bus bay is cut off", "adjust_ptz(tilt_deg=5)"),
        ("zoom out, that was too much", "adjust_ptz(zoom_factor=0.5)"),
    ],
)
def test_a_reason_changes_nothing(text: str, calls: str) -> None:
    assert shown(plan(text, PRESETS).calls) == calls


@pytest.mark.parametrize("reason", ["back, I like that one better", "go back, that was nicer", "go back, that was too far"])
def test_reasons_for_going_back(reason: str) -> None:
    calls, _ = last_calls("pan left 20", "tilt up 10", reason)
    assert calls == [("adjust_ptz", {"tilt_deg": -10})]


@pytest.mark.parametrize(
    "text",
    [
        "pan left 20, that was too much",
        "zoom in, that was too much",
        "zoom out 3x, that was too much",
        "go to the gate, I like the other one",
        "go to the gate, nobody is allowed there",
        "pan left 20, the gate is better",
    ],
)
def test_what_may_change_a_command_is_asked_about(text: str) -> None:
    asked = plan(text, PRESETS)
    assert not asked.understood
    assert asked.clarification
