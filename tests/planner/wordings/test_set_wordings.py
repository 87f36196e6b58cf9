"""Wordings of surveys, states without a verb, absolute angles, further pictures, and what is asked at a preset."""

from __future__ import annotations

import pytest

from scope_ptz.planner.plan import plan
from tests.planner.wordings.planned_calls import planned_calls

PRESETS = ("gate", "dock", "crest-road", "main-entrance", "spillway", "hall-a")


def calls(instruction: str) -> str:
    return planned_calls(instruction, PRESETS, with_names=True)


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        (
            "Take a picture here and then another one at the crest road.",
            "take_image(); go_to_preset(name=crest-road); take_image()",
        ),
        (
            "Take a photo of the gate and another one of the dock before we open",
            "go_to_preset(name=gate); take_image(); go_to_preset(name=dock); take_image()",
        ),
        ("I want the left engine filling the frame", "zoom_to_object(description=left engine)"),
        ("I'd like to see the board better, could you zoom in on it?", "zoom_to_object(description=board)"),
    ],
)
def test_further_pictures_and_close_views(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("skip full or not?", "query_answer(question=skip full?, view=current)"),
        ("floor by the drain, wet or dry?", "query_answer(question=Is the floor by the drain wet or dry?, view=current)"),
        ("the side doors, open or shut?", "query_answer(question=Are the side doors open or shut?, view=current)"),
        ("Stop bar lights, are they red or green?", "query_answer(question=are the stop bar lights red or green?, view=current)"),
        (
            "lights on the crest road, red or green?",
            "go_to_preset(name=crest-road); query_answer(question=are the lights red or green?, view=current)",
        ),
        (
            "Is any water flowing down the spillway yet?",
            "go_to_preset(name=spillway); query_answer(question=Is any water flowing down the spillway yet?, view=current)",
        ),
    ],
)
def test_states_that_are_asked_about(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    ("instruction", "things"),
    [
        ("People in hi-vis, all around, how many?", "People in hi-vis"),
        ("White vans, all the way round, total please.", "White vans"),
        ("how many yellow buoys, look right the way round", "yellow buoys"),
        ("Look at everything around you, the full circle, and tell me how many vans there are", "vans"),
        ("do a full look round and tell me how many guards you see", "guards"),
    ],
)
def test_counts_in_the_whole_scene(instruction: str, things: str) -> None:
    assert calls(instruction) == f"count_objects(description={things}, view=full)"


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        (
            "how many smokers are standing outside the main entrance",
            "go_to_preset(name=main-entrance); count_objects(description=smokers, view=current)",
        ),
        (
            "how many cars are parked outside the main entrance",
            "go_to_preset(name=main-entrance); count_objects(description=parked cars, view=current)",
        ),
        ("how many children have turned up so far?", "count_objects(description=children, view=current)"),
        ("how many people can you find", "count_objects(description=people, view=current)"),
        (
            "Cyclists on crest road. Number only.",
            "go_to_preset(name=crest-road); count_objects(description=Cyclists, view=current)",
        ),
        (
            "Count the tents, then turn around and count the tents on that side as well.",
            "count_objects(description=tents, view=current); adjust_ptz(pan_deg=180); "
            "count_objects(description=tents, view=current)",
        ),
        ("Count the cars. No photos though.", "count_objects(description=cars, view=current)"),
        ("Count the vans. Please don't move the camera while you do it.", "count_objects(description=vans, view=current)"),
    ],
)
def test_counts(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("set absolute pan to minus 25 and absolute tilt to minus 10", "adjust_ptz(pan_deg=-25, tilt_deg=-10)"),
        ("rotate to an absolute pan of 110 degrees and an absolute tilt of 20", "adjust_ptz(pan_deg=110, tilt_deg=20)"),
        ("put the gate back up", "go_to_preset(name=gate)"),
        ("I'd like to look at the crest road for a minute", "go_to_preset(name=crest-road)"),
        ("what presets have been programmed on this unit so far?", "get_presets()"),
        ("read me out the presets", "get_presets()"),
        ("Follow the dog, half a minute will do.", "track_object(description=dog, duration_s=30)"),
        (
            "Follow the cyclist on the crest road for half a minute.",
            "go_to_preset(name=crest-road); track_object(description=cyclist, duration_s=30)",
        ),
    ],
)
def test_moves(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    "instruction",
    [
        "rotate the picture clockwise so the crooked pole is upright",
        "turn the image anticlockwise 10",
        "do the other one like before but more",
        "it was better the other way, how Margaret had it",
        "Ops are asking about birds again. How many on the crest road?",
    ],
)
def test_wordings_that_are_asked_about(instruction: str) -> None:
    assert not plan(instruction, PRESETS).understood
