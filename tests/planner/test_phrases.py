"""Phrasings that were once misunderstood, and instructions that must never cause a move."""

from __future__ import annotations

import pytest

from scope_ptz.planner.plan import PlannedCall, plan

PRESETS = ("gate", "highway", "works-overview")
NEVER_A_MOVE = [
    "fly up",
    "drive forward",
    "move forward",
    "roll 20 degrees",
    "walk left",
    "tilt left",
    "pan left and right 10",
    "zoom in and out",
    "zoom left",
    "pan right 10 metres",
    "move the camera 2 metres to the left",
    "turn on the lights",
    "pan right 20, then make me a sandwich",
    "go to gate and then fly over the fence",
    "zoom in on 3",
    "do not zoom",
    "stop",
    "go to the moon",
    "tell me a joke",
    "zoom in on it",
]
PLANS = [
    ("drop the view by 15 degrees", "adjust_ptz(tilt_deg=-15)"),
    ("lift it up 10", "adjust_ptz(tilt_deg=10)"),
    ("turn 3/4 of the way around", "adjust_ptz(pan_deg=270)"),
    ("tilt to 10 degrees below the horizon", "adjust_ptz(tilt_deg=-10)"),
    ("tilt up to 20 degrees", "adjust_ptz(tilt_deg=20)"),
    ("pan right 30 then another 15", "adjust_ptz(pan_deg=30); adjust_ptz(pan_deg=15)"),
    ("when there are no people left, take a picture", "count_objects(description=people, view=current); take_image()"),
    ("if it's raining, go home", "query_answer(question=is it raining?, view=current); go_home()"),
    (
        "read the sign on the left and then the one on the right",
        "query_answer(question=What does the sign on the left say?, view=current); "
        "query_answer(question=What does the sign on the right say?, view=current)",
    ),
    (
        "count cars at gate and trucks at highway",
        "go_to_preset(name=gate); count_objects(description=cars, view=current); "
        "go_to_preset(name=highway); count_objects(description=trucks, view=current)",
    ),
    (
        "is there a bus? if so, zoom in on it",
        "query_answer(question=is there a bus?, view=current); zoom_to_object(description=bus)",
    ),
    ("zoom in until the truck fills the frame", "zoom_to_object(description=truck)"),
    ("pan until you see a bridge", "count_objects(description=bridge, view=current)"),
    ("go to the hihgway preset", "go_to_preset(name=highway)"),
    ("preset 2", "go_to_preset(name=highway)"),
    ("how many of the cars are red?", "count_objects(description=red cars, view=current)"),
    ("count the red and white barriers", "count_objects(description=red and white barriers, view=current)"),
    ("PAN RIGHT 20!!", "adjust_ptz(pan_deg=20)"),
]


def shown(calls: tuple[PlannedCall, ...]) -> str:
    return "; ".join(f"{c.name}({', '.join(f'{k}={v}' for k, v in c.arguments.items())})" for c in calls)


@pytest.mark.parametrize("text", NEVER_A_MOVE)
def test_never_a_wrong_move(text: str) -> None:
    made = plan(text, PRESETS)
    assert not made.understood, shown(made.calls)
    assert made.clarification


@pytest.mark.parametrize(("text", "calls"), PLANS)
def test_phrases(text: str, calls: str) -> None:
    assert shown(plan(text, PRESETS).calls) == calls
