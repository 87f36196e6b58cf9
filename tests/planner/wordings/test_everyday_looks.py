"""Counts, questions, close views and pictures in everyday words, with the remarks that people add to them."""

from __future__ import annotations

import pytest

from scope_ptz.planner.plan import plan
from tests.planner.wordings.planned_calls import ask, count, planned_calls, zoom

PRESETS = ("boat-yard", "north-pontoon", "slip-rank")


def calls(instruction: str) -> str:
    return planned_calls(instruction, PRESETS)


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("count the dinghies please, they need a new licence", count("dinghies")),
        ("tell me how many kayaks there are, I still have tags to hand out", count("kayaks")),
        ("Don't move, just tell me how many kayaks are visible, we still owe them lunch.", count("kayaks")),
        ("how many buoys are currently in the frame", count("buoys")),
        ("count the gulls right now in view", count("gulls")),
        ("how many second officers are there?", count("second officers")),
        ("the number of third class carriages", count("third class carriages")),
        ("how many hatches have they left open", count("open hatches")),
        ("how many sheds did she leave unlocked?", count("unlocked sheds")),
        ("how many boats have got their covers off?", count("boats with their covers off")),
        ("how many men are working and how many are just standing about?", f"{count('men working')}; {count('standing men')}"),
        ("how many rolls of tape do we have left?", count("rolls of tape")),
        ("object count: oars", count("oars")),
        ("preset boat-yard, item count, oars", f"go_to_preset(boat-yard); {count('oars')}"),
        ("buoy count, current view", count("buoys")),
        ("Could you count the crates without moving the camera?", count("crates")),
        ("can you count the masts without zooming in?", count("masts")),
        ("Full view. Count the trailers.", count("trailers", "full")),
        ("the current view. Count the trailers.", count("trailers")),
        ("Current view only: is the lens dirty?", ask("is the lens dirty?")),
        ("how many masts are there, all 360 degrees?", count("masts", "full")),
    ],
)
def test_a_count_is_of_the_things_alone(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("how many trolleys we got by the boat yard", f"go_to_preset(boat-yard); {count('trolleys')}"),
        ("count the skips by the boat yard", f"go_to_preset(boat-yard); {count('skips')}"),
        ("how many anglers on the pontoon", f"go_to_preset(north-pontoon); {count('anglers')}"),
        ("is there a trolley by the boat yard?", ask("is there a trolley by the boat yard?")),
        (
            "is the skip count at the boat yard higher than at the north pontoon?",
            f"go_to_preset(boat-yard); {count('skips')}; go_to_preset(north-pontoon); {count('skips')}",
        ),
        (
            "is the people count lower at the boat yard than at the north pontoon?",
            f"go_to_preset(boat-yard); {count('people')}; go_to_preset(north-pontoon); {count('people')}",
        ),
    ],
)
def test_a_count_by_a_preset_is_made_there(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


WHICH = "Which has {} {}, the boat yard or the north pontoon? Please go to the {} one after that."


@pytest.mark.parametrize(
    ("comparison", "things", "way", "goes"),
    [
        ("more", "people", "busier", True),
        ("fewer", "people", "quieter", True),
        ("fewer", "people", "busier", False),
        ("more", "free berths", "busier", False),
    ],
)
def test_the_busier_of_two_presets_is_the_winner_of_the_comparison(comparison: str, things: str, way: str, goes: bool) -> None:
    planned = calls(WHICH.format(comparison, things, way))
    assert planned.startswith("go_to_preset(boat-yard); count_objects(") == goes
    assert goes or planned.endswith("?")


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("is it snowing up there or nah", ask("is it snowing up there or not")),
        ("check the whole way round, is anybody in the water?", ask("is anybody in the water?", "full")),
        ("is front hatch shut", ask("is front hatch shut")),
        ("are side doors locked", ask("are side doors locked")),
        ("where's the life ring? find it please", zoom("life ring")),
        ("Put eyes on the tug.", zoom("tug")),
        ("Let the weather vane fill the picture.", zoom("weather vane")),
        ("Find the name plate of the winch and bring it up close.", zoom("name plate of the winch")),
        ("show me the mooring post", zoom("mooring post")),
        ("lookat the torn sail", zoom("torn sail")),
        ("zoomin on the winch", zoom("winch")),
        ("tiltup 5", "adjust_ptz(5)"),
        ("It's the bent rail that I'd like to see up close.", zoom("bent rail")),
        ("It's the yellow drum I want you to zoom in on.", zoom("yellow drum")),
        ("It's the notice we'd like to read.", ask("What does the notice say?")),
        ("The hand cart should be followed for a minute and a half.", "track_object(hand cart, 90)"),
        ("the rib must be tracked for 20 seconds", "track_object(rib, 20)"),
        ("The trailers should be counted.", count("trailers")),
    ],
)
def test_a_look_may_be_asked_for_in_many_ways(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    "instruction",
    [
        "the skipper must not be followed",
        "the tug was followed by a rib",
        "the cyclist should be followed by a car",
        "The trailers should be counted, not the boats.",
        "full view",
        "take a picture, full view",
        "snapshot, one only, of the tug",
        "zoom in on the winch, my skipper hates that",
        "zoom in on the winch but no photos, cancel that",
        "zoom in on the tug, it should be the red one",
    ],
)
def test_what_may_mean_something_else_is_asked_about(instruction: str) -> None:
    assert plan(instruction, PRESETS).clarification is not None


@pytest.mark.parametrize(
    "instruction",
    [
        "Record a test image at the current position.",
        "Snapshot, one only, present framing.",
        "take a picture at this position",
    ],
)
def test_a_picture_of_the_current_view_needs_no_thing(instruction: str) -> None:
    assert calls(instruction) == "take_image()"


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("Can you show me the boat yard? I want to know if it's worth launching today.", "go_to_preset(boat-yard)"),
        ("find the green barge, it should be our delivery", zoom("green barge")),
        ("I'm typing this in the rain, go to the boat yard", "go_to_preset(boat-yard)"),
        ("while we're shut can you zoom in on the cracked pane", zoom("cracked pane")),
        (
            "Right, I've got the riggers asking about that noise, so while we're here can you have a look at the bent pulley",
            zoom("bent pulley"),
        ),
    ],
)
def test_remarks_beside_a_look_are_left_out(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected
