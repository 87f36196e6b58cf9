"""Parts of an instruction that are taken back are not carried out."""

from __future__ import annotations

import pytest

from scope_ptz.planner.plan import PlannedCall, plan

PRESETS = ("gate", "dock", "yard", "boat-ramp")


def described(call: PlannedCall) -> str:
    return f"{call.name}({', '.join(f'{name}={value}' for name, value in call.arguments.items())})"


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("Pan left 20 and tilt up 10. Actually, leave the tilt alone.", "adjust_ptz(pan_deg=-20)"),
        ("Tilt up 10 and pan right 30. No, leave the pan as it is.", "adjust_ptz(tilt_deg=10)"),
        ("Pan left 20 and zoom in 2x. On second thoughts, don't zoom.", "adjust_ptz(pan_deg=-20)"),
        ("up 10 and left 30, no, forget the pan", "adjust_ptz(tilt_deg=10)"),
        ("Zoom in on the ducks, no wait, forget the ducks, just go to the boat ramp.", "go_to_preset(name=boat-ramp)"),
        ("follow the cleaner, no wait, don't follow him, just take a picture", "take_image()"),
        ("Count the vans and the trucks. No, forget the trucks.", "count_objects(description=vans, view=current)"),
        (
            "Show me the gate, then the yard - no, leave out the yard - and count the people.",
            "go_to_preset(name=gate); count_objects(description=people, view=current)",
        ),
        (
            "Go to the gate, then the dock, then the yard. Actually, skip the dock.",
            "go_to_preset(name=gate); go_to_preset(name=yard)",
        ),
        ("Take a picture of the dock. Scratch that, just show me the dock.", "go_to_preset(name=dock)"),
        ("Tilt up 15, then zoom in 2x. Correction: drop the zoom, tilt only.", "adjust_ptz(tilt_deg=15)"),
        ("Go to the yard and take three pictures, no, cancel the pictures, just go there.", "go_to_preset(name=yard)"),
        ("pan left 20 and take a photo, actually forget the photo, the union doesn't like that", "adjust_ptz(pan_deg=-20)"),
        ("Pan left 20. No one may touch the zoom.", "adjust_ptz(pan_deg=-20)"),
        ("Go to the yard. Don't zoom in, leave it wide.", "go_to_preset(name=yard)"),
        ("tilt up 10, sorry, I mean down 10, always confuse those", "adjust_ptz(tilt_deg=-10)"),
    ],
)
def test_a_part_that_is_taken_back_is_left_out(instruction: str, expected: str) -> None:
    assert "; ".join(described(call) for call in plan(instruction, PRESETS).calls) == expected


@pytest.mark.parametrize(
    "instruction",
    [
        "Zoom in on the van and read the sign. Actually, forget the van.",
        "Zoom in on the van, then zoom in on the dog. Actually, don't zoom.",
        "Take a picture of the gate. Actually, forget the picture.",
        "Follow the van and take a picture of it. No, don't follow it.",
        "If you see a van, follow it. Actually, don't follow the van.",
        "Pan left 20 and tilt up 10. Leave the tilt alone.",
        "Pan left 20 and tilt up 10. Actually, forget the tilt, just go home.",
        "pan left 20 and tilt up 10. no, forget the tilt and the pan",
        "pan left 20 and tilt up 10. no, forget the tilt or the pan",
        "pan left 20, twice, no forget the pan, tilt up 5",
        "turn left 20, look up 10 and again, no, don't tilt",
        "pan left 20, tilt up 5, undo, forget the tilt",
        "Pan left 20, then zoom in 3x. Correction: cancel the zoom, tilt only.",
        "Go to the gate and pan left 10 and take two pictures, no, cancel the pictures, only go there.",
    ],
)
def test_unclear_words_that_take_something_back_are_asked_about(instruction: str) -> None:
    assert not plan(instruction, PRESETS).understood


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("Pan left 20, leave the tilt alone", "adjust_ptz(pan_deg=-20)"),
        ("take a picture of the gate, no, the dock", "go_to_preset(name=dock); take_image()"),
    ],
)
def test_words_that_take_nothing_back_leave_all_parts(instruction: str, expected: str) -> None:
    assert "; ".join(described(call) for call in plan(instruction, PRESETS).calls) == expected
