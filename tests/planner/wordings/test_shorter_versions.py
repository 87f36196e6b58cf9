"""Remarks of people who explain themselves or dictate without punctuation, and statements that must never be taken for remarks."""

from __future__ import annotations

import pytest

from scope_ptz.planner.grammar.consistency.withdrawals import withdrawing_statement
from scope_ptz.planner.grammar.parsing.remark_detection.shorter_versions import is_remark, shorter_versions
from scope_ptz.planner.plan import Plan, plan
from tests.planner.wordings.test_wordings_of_speech import PRESETS, shown

LEFT_OUT = [
    ("turn around somebody just honked behind us", "adjust_ptz(pan_deg=180)"),
    ("zoom out a bit its too close", "adjust_ptz(zoom_factor=0.8)"),
    ("go home now were done for the day and im off for me tea", "go_home()"),
    ("show me the gate they should be bringing the first lot in any minute", "go_to_preset(name=gate)"),
    ("hey so my boss says there's a tow truck out there with no permit go ahead and frame the tow truck for me",
     "zoom_to_object(description=tow truck)"),
    ("The crane is turning left again. Zoom in 2x.", "adjust_ptz(zoom_factor=2)"),
    ("Dave said he tilted up 15 before he left. Take a picture.", "take_image()"),
    ("prices are going up 10 percent, can you believe it. anyway, pan left 25", "adjust_ptz(pan_deg=-25)"),
    ("Earlier I panned left 20 and it was too far, so just pan right 5 now.", "adjust_ptz(pan_deg=5)"),
    ("Sorry to trouble you, but the access committee would like to know how many people there are",
     "count_objects(description=people, view=current)"),
    ("Pan all the way left. End stop test.", "adjust_ptz(pan_deg=-360)"),
    ("pan as far left as it will go", "adjust_ptz(pan_deg=-360)"),
    ("pan left 22, then back again by the same amount", "adjust_ptz(pan_deg=-22); adjust_ptz(pan_deg=22)"),
    ("Oh isn't the light beautiful this evening! Please take a photograph.", "take_image()"),
]  # fmt: skip
"""Instructions with remarks that no rule of the grammar reads."""

MEANT = [
    ", but not too far", " but only if the gate is open", " if it is dark", " unless it rains", ". No, the other way.",
    ", no wait, right", " until you see a van", " and then go home", " then back", ", that's wrong", ", don't", ". Don't do that.",
    ", never mind", ", forget it", ", cancel that", ", actually the gate", ", sorry the crossing", ", and the same at the gate",
    ", I want the left one", ", they said it is forbidden", ", it is off limits", ", nobody is allowed to do that",
    ", I changed my mind", ", he wants it further left", ", we need it higher", ", it should be lower", ", the manager said up",
    ", I would rather have a picture", ", I prefer the crossing", " before you go to the gate", " as soon as the van has left",
    " but i only want half of that", ", i need it twice as far", ", somebody said the camera is not to be moved",
    ", nobody wants that", ", you should have asked", ", i take that back", ", it's a joke", ", we must not do this",
    ", it has already been done", ", i am not sure we are allowed to", ", and tell me what you see", ", what colour is it?",
    ", i'd check with me first", ", they told me to wait", ", hold on", ", stop after 10 degrees", ", it needs to be 30",
    ", we agreed on right", " until something moves",
]  # fmt: skip
"""What changes, restricts or takes back the instruction before it."""

COMPARED = [
    "more people where, gate or crossing?",
    "compare gate and crossing for me, at which one stand more people",
    "Where would we find more people, do you think, the gate or the crossing?",
    "is it the gate or the crossing has the most people in it today",
    "which is worse, more people at gate or crossing? count both",
    "I do wonder whether the gate or the crossing has more people standing about this morning, can you find out?",
]
"""Wordings of one comparison of two presets."""


@pytest.mark.parametrize(("text", "calls"), LEFT_OUT)
def test_remarks_are_left_out(text: str, calls: str) -> None:
    assert shown(plan(text, PRESETS).calls) == calls


@pytest.mark.parametrize("meant", MEANT)
@pytest.mark.parametrize("command", ["pan left 20", "go to the bus bay", "tilt up 5 and zoom in"])
def test_what_is_meant_is_never_left_out(command: str, meant: str) -> None:
    alone, both = plan(command, PRESETS), plan(command + meant, PRESETS)
    assert not both.understood or both.calls != alone.calls


@pytest.mark.parametrize("text", COMPARED)
def test_comparisons_of_two_presets(text: str) -> None:
    first, second = (
        f"go_to_preset(name={preset}); count_objects(description=people, view=current)" for preset in ("gate", "crossing")
    )
    assert shown(plan(text, PRESETS).calls) == f"{first}; {second}"


@pytest.mark.parametrize(
    "noun",
    [
        "tilt truck",
        "frying pan",
        "penalty spot",
        "speed camera",
        "centre circle",
        "visitor centre sign",
        "call box",
        "thing on the roof",
    ],
)
@pytest.mark.parametrize(
    ("request_", "name"), [("zoom in on the {}", "zoom_to_object"), ("follow the {} for 20 seconds", "track_object")]
)
def test_words_for_commands_in_compound_nouns(noun: str, request_: str, name: str) -> None:
    made: Plan = plan(request_.format(noun), PRESETS)
    assert [(call.name, call.arguments["description"]) for call in made.calls] == [(name, noun)]


def test_versions_are_yielded_longest_first() -> None:
    text = "Lovely day for it, so zoom in 2x, my eyes are bad"
    versions = list(shorter_versions(text, ()))
    assert versions == sorted(versions, key=len, reverse=True)
    assert versions[-1] == "zoom in 2x"


def test_long_texts_are_not_shortened() -> None:
    assert not list(shorter_versions("it is cold, " * 100 + "pan left", ()))


@pytest.mark.parametrize(
    ("text", "expected"), [("they are late again", True), ("they want the gate", False), ("he said left", False)]
)
def test_a_remark_asks_for_nothing(text: str, expected: bool) -> None:
    assert is_remark(text, ("gate",)) is expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("pan left 20, i take that back", "i take that back"),
        ("zoom in, my mum says it is enough", None),
        ("pan left 20, my mum says 15 is enough", "my mum says 15 is enough"),
        ("pan left 20", None),
    ],
)
def test_statements_that_take_back(text: str, expected: str | None) -> None:
    assert withdrawing_statement(text) == expected
