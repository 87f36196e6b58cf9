"""Remarks before and after a command, parts that are taken back, and presets that a question names."""

from __future__ import annotations

import pytest

from scope_ptz.planner.grammar.parsing.rewording.rewordings import required_text
from scope_ptz.planner.plan import plan
from tests.planner.wordings.test_wordings_of_speech import PRESETS, shown

DROPPED = [
    ("up a bit, all I'm getting is mud", "adjust_ptz(tilt_deg=5)"),
    ("count the cars, I'm sure we're two short today", "count_objects(description=cars, view=current)"),
    ("go to the crossing, Dave reckons it's getting too busy", "go_to_preset(name=crossing)"),
    ("raise the view by seven degrees, as Mrs Okafor says her window was left open", "adjust_ptz(tilt_deg=7)"),
    ("take a photo before the boss walks in", "take_image()"),
    ("tilt down by twelve, so that the bench comes into the picture as well", "adjust_ptz(tilt_deg=-12)"),
    ("One of the guests has complained, so I would like a closer look at the tile.", "zoom_to_object(description=tile)"),
    ("He went left an hour ago, count the cars.", "count_objects(description=cars, view=current)"),
    (
        "Ahead of Thursday's audit, please count the fire extinguishers.",
        "count_objects(description=fire extinguishers, view=current)",
    ),
    ("Please rotate the camera ten degrees to the right. Many thanks, Helen", "adjust_ptz(pan_deg=10)"),
    (
        "Has somebody left a bag behind? They were still faffing about with the scaffolding.",
        "query_answer(question=Has somebody left a bag behind?, view=current)",
    ),
    ("pan left 20, over", "adjust_ptz(pan_deg=-20)"),
]
"""Remarks that change nothing."""

TAKEN_BACK = [
    ("tilt up 10 and pan left 20 and take a photo, cancel the photo", "adjust_ptz(tilt_deg=10, pan_deg=-20)"),
    ("go home and take a photo, actually no, leave the photo", "go_home()"),
    ("Zoom in 2x, tilt up 5. Cancel the tilt.", "adjust_ptz(zoom_factor=2)"),
    ("Pan left 20 and then tilt down 5, no, scratch the tilt.", "adjust_ptz(pan_deg=-20)"),
    ("take a picture, no forget the picture, just tilt up 10", "adjust_ptz(tilt_deg=10)"),
    ("Zoom in on the van and follow it. Actually, do not follow it.", "zoom_to_object(description=van)"),
    ("Follow that car, actually no leave it, just count the vans", "count_objects(description=vans, view=current)"),
]
"""Parts that are taken back."""

PLAIN = [
    ("pan left 20 plus 15 degrees", "adjust_ptz(pan_deg=-35)"),
    ("pan right 7 1/2 degrees", "adjust_ptz(pan_deg=7.5)"),
    ("person count at the gate", "go_to_preset(name=gate); count_objects(description=people, view=current)"),
]
"""Wordings that are replaced with plainer ones."""

NAMED = [
    (
        "has the bus bay got any room left?",
        "go_to_preset(name=bus-bay); query_answer(question=has the bus bay got any room left?, view=current)",
    ),
    ("bus bay clear?", "go_to_preset(name=bus-bay); query_answer(question=is the bus bay clear?, view=current)"),
    (
        "Go to the crossing if the bus bay is full",
        "go_to_preset(name=bus-bay); query_answer(question=is the bus bay full?, view=current); go_to_preset(name=crossing)",
    ),
    (
        "go to the bus bay and zoom in 2x. Is the bus bay full?",
        "go_to_preset(name=bus-bay); adjust_ptz(zoom_factor=2); query_answer(question=Is the bus bay full?, view=current)",
    ),
    ("without moving the camera, is the bus bay full?", "query_answer(question=is the bus bay full?, view=current)"),
    ("what is parked next to the bus bay?", "query_answer(question=what is parked next to the bus bay?, view=current)"),
    ("number of vans, bus-bay", "go_to_preset(name=bus-bay); count_objects(description=vans, view=current)"),
    ("bus byy", "go_to_preset(name=bus-bay)"),
    (
        "more than five vans at the gate? Then go to the crossing",
        "go_to_preset(name=gate); count_objects(description=vans, view=current); go_to_preset(name=crossing)",
    ),
]
"""Presets in questions, counts and conditions."""

KEPT = [
    "pan left 20, I think that is wrong",
    "zoom in, we are not allowed",
    "go to the gate, the manager has forbidden it",
    "go home, my boss has cancelled",
    "pan left 20, it is 30",
    "pan left 20. I said 30.",
    "pan right 10, Dave says twenty",
    "pan right 10, he said ten left",
    "pan right 10, I have had second thoughts",
    "take a picture, the boss has called it off",
    "go to the gate, I was told never to go there",
    "follow it. No, don't follow it",
]
"""Remarks that may change what is meant, so that the planner asks."""


@pytest.mark.parametrize(("text", "calls"), [*DROPPED, *TAKEN_BACK, *PLAIN, *NAMED])
def test_what_is_left_is_carried_out(text: str, calls: str) -> None:
    assert shown(plan(text, PRESETS).calls) == calls


@pytest.mark.parametrize("text", KEPT)
def test_remarks_that_may_change_the_command_are_asked_about(text: str) -> None:
    made = plan(text, PRESETS)
    assert not made.understood, shown(made.calls)
    assert made.clarification


@pytest.mark.parametrize(
    "text",
    [
        "Dip the lens a touch for me will you. How many cars are parked?",
        "Is there a man by the van, could you zoom in on him",
        "Ease it left a bit to begin with, could you count the vans for me",
    ],
)
def test_a_command_or_question_in_front_is_no_remark(text: str) -> None:
    made = plan(text, PRESETS)
    assert not made.understood or len(made.calls) > 1, shown(made.calls)


@pytest.mark.parametrize(
    ("pattern", "required"),
    [
        (r"\bal the way\b", "al the way"),
        (r"^(?:hang|hold) on(?: a sec)?,? ok", " on"),
        (r"colou?r of", "colo"),
        (r"a{2}bc", "bc"),
        (r"one|two", ""),
        (r"[abc]+ (x|y)", " "),
        (r"\(up\)", "up"),
    ],
)
def test_text_that_every_match_of_a_pattern_contains(pattern: str, required: str) -> None:
    assert required_text(pattern) == required
