"""Last words of an instruction that correct, stop, limit or reorder what comes before them."""

from __future__ import annotations

import pytest

from scope_ptz.planner.plan import PlannedCall, plan

PRESETS = ("gate", "dock", "yard", "boat-ramp")


def described(call: PlannedCall) -> str:
    arguments = (f"{name}={value:g}" if isinstance(value, float) else f"{name}={value}" for name, value in call.arguments.items())
    return f"{call.name}({', '.join(arguments)})"


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("show me the dock. the gate, I mean", "go_to_preset(name=gate)"),
        ("Go to the dock. What I meant is the boat ramp.", "go_to_preset(name=boat-ramp)"),
        ("go to the gate. by gate I mean the dock", "go_to_preset(name=dock)"),
        ("go to the gate. for gate read dock", "go_to_preset(name=dock)"),
        ("go to the dock. pardon me, the yard", "go_to_preset(name=yard)"),
        ("go to the dock. I'd prefer the yard", "go_to_preset(name=yard)"),
        ("go to the dock. I said the dock but I meant the gate", "go_to_preset(name=gate)"),
        ("take a picture of the yard. the dock, I mean", "go_to_preset(name=dock); take_image()"),
        ("zoom out. in, I mean", "adjust_ptz(zoom_factor=2)"),
        ("tilt down 12 degrees. up rather", "adjust_ptz(tilt_deg=12)"),
        ("pan right 15; should have been left", "adjust_ptz(pan_deg=-15)"),
        ("tilt up 10. it should be 15", "adjust_ptz(tilt_deg=15)"),
        ("tilt up 5. down, not up", "adjust_ptz(tilt_deg=-5)"),
        ("tilt up 10. panning left would be better", "adjust_ptz(pan_deg=-10)"),
        ("zoom in on the lorry. the number plate, I mean", "zoom_to_object(description=number plate)"),
        ("track the bus. it's the tram I wanted", "track_object(description=tram, duration_s=10)"),
        ("follow the dog. that's not a dog, it's a fox", "track_object(description=fox, duration_s=10)"),
        ("count the cars. the vans, I mean", "count_objects(description=vans, view=current)"),
    ],
)
def test_what_is_meant_replaces_what_was_said(instruction: str, expected: str) -> None:
    assert "; ".join(described(call) for call in plan(instruction, PRESETS).calls) == expected


@pytest.mark.parametrize(
    "instruction",
    [
        "zoom in on the lorry. its driver rather",
        "zoom in on the lorry and go home. the lamp, I mean",
        "tilt up 10. left, I mean",
        "go to the dock. oh, the gate",
    ],
)
def test_corrections_of_an_unclear_part_are_asked_about(instruction: str) -> None:
    assert not plan(instruction, PRESETS).understood


@pytest.mark.parametrize(
    "instruction",
    [
        "tilt down 10. five less",
        "zoom in 4x. three at most",
        "tilt up 10, more",
        "pan right 30. make that double",
        "tilt up 5, half of it",
        "pan right 30 isn't enough",
        "zoom in 2x 5x",
        "zoom in. not that close",
        "tilt down. too low",
        "pan right 10. not right",
        "pan right 10. your right, not mine",
        "tilt up 10 and pan right 5. the second one should be 20",
        "tilt up 10 and pan right 5. the other way round",
        "go to the dock. the last one",
        "go to the dock. take the second one",
        "follow the man, halt",
        "go to the dock, freeze",
        "tilt up 10 degrees. don't touch anything",
        "follow the bus stop",
    ],
)
def test_last_words_that_change_a_command_unclearly_are_asked_about(instruction: str) -> None:
    assert not plan(instruction, PRESETS).understood


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("zoom out. too close", "adjust_ptz(zoom_factor=0.5)"),
        ("come out a bit, too tight", "adjust_ptz(zoom_factor=0.8)"),
        ("tilt up 20, it's the mast I'm after", "adjust_ptz(tilt_deg=20)"),
        ("pan left 10, tilt up 5, stop", "adjust_ptz(pan_deg=-10); adjust_ptz(tilt_deg=5)"),
        ("go to the dock whenever you're ready", "go_to_preset(name=dock)"),
        ("list the presets. go to the first one", "get_presets(); go_to_preset(name=gate)"),
    ],
)
def test_reasons_and_signals_change_nothing(instruction: str, expected: str) -> None:
    assert "; ".join(described(call) for call in plan(instruction, PRESETS).calls) == expected


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("go to the dock. but first the gate", "go_to_preset(name=gate); go_to_preset(name=dock)"),
        ("go to the dock. gate first", "go_to_preset(name=gate); go_to_preset(name=dock)"),
        ("show me the dock. count the boats first", "count_objects(description=boats, view=current); go_to_preset(name=dock)"),
    ],
)
def test_what_comes_first_is_done_first(instruction: str, expected: str) -> None:
    assert "; ".join(described(call) for call in plan(instruction, PRESETS).calls) == expected


@pytest.mark.parametrize("instruction", ["go to the dock. first tilt up 5", "go to the dock and zoom in. the gate first"])
def test_an_unclear_first_step_is_asked_about(instruction: str) -> None:
    assert not plan(instruction, PRESETS).understood


@pytest.mark.parametrize(
    "instruction",
    [
        "track the van once it moves",
        "track the bus as soon as it starts",
        "I overheard follow the bus on the radio",
        "track everything but not the bus",
        "track everything except the bus",
        "track the bus on camera 3",
        "track the bus using the other camera",
        "take a picture whenever the bell rings",
    ],
)
def test_what_this_camera_cannot_do_once_is_asked_about(instruction: str) -> None:
    assert not plan(instruction, PRESETS).understood


@pytest.mark.parametrize(
    "instruction",
    ["pan left 30. Leave it where it is.", "zoom in, actually leave it where it is", "tilt up 4, no, leave it as it is"],
)
def test_a_turn_is_asked_about_if_the_last_words_leave_the_camera_alone(instruction: str) -> None:
    assert "leave it" in str(plan(instruction, PRESETS).clarification).lower()


@pytest.mark.parametrize("instruction", ["take a photo, leave it where it is", "take a photo & leave it there"])
def test_a_picture_is_taken_if_the_camera_stays(instruction: str) -> None:
    assert [call.name for call in plan(instruction, PRESETS).calls] == ["take_image"]
