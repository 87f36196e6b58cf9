"""Counts and comparisons of counts: who sees or placed the things, where to count, how the count is ordered, and its occasion."""

from __future__ import annotations

import pytest

from scope_ptz.planner.plan import plan
from tests.planner.wordings.planned_calls import count, planned_calls

PRESETS = ("lane-2", "dock-4", "main-gate", "fuel-yard")


def calls(instruction: str) -> str:
    return planned_calls(instruction, PRESETS)


@pytest.mark.parametrize(
    ("instruction", "things"),
    [
        ("How many bollards can the software detect in this view?", "bollards"),
        ("How many boats does the camera see?", "boats"),
        ("Give me the number of skips that you can identify.", "skips"),
        ("How many carts with flat tyres can you make out?", "carts with flat tyres"),
        ("count the flags that can be identified", "flags"),
        ("How many barriers have they put out along the road?", "barriers along the road"),
        ("How many chairs have they laid out, can you count them up for me?", "chairs"),
        ("How many boxes has the fitter put on the bench?", "boxes on the bench"),
        ("How many bikes do we have chained to the fence?", "bikes chained to the fence"),
        ("How many visitors have we got standing outside the shop?", "visitors standing outside the shop"),
        ("How many trailers do we have standing here?", "trailers"),
        ("How many cars do they have parked outside?", "cars parked outside"),
        ("How many bicycles do stand in the frame?", "bicycles"),
        ("how many bikes stand by the wall", "bikes by the wall"),
        ("how many bollards are located next to the wall", "bollards next to the wall"),
    ],
)
def test_who_sees_and_who_placed_the_things_is_no_part_of_them(instruction: str, things: str) -> None:
    assert calls(instruction) == count(things)


@pytest.mark.parametrize(
    ("instruction", "things"),
    [
        ("how many vans are sitting at the main gate just now?", "vans"),
        ("how many dogs are sitting at the main gate?", "dogs sitting"),
        ("how many vans are waiting at the main gate?", "vans waiting"),
    ],
)
def test_a_posture_is_left_out_only_if_it_adds_nothing(instruction: str, things: str) -> None:
    assert calls(instruction) == f"go_to_preset(main-gate); {count(things)}"


@pytest.mark.parametrize(
    "question",
    ["How many gates did they leave behind?", "How many words can you make out?", "How many cars does the driver see?"],
)
def test_what_somebody_did_or_can_read_is_asked(question: str) -> None:
    assert calls(question) == f"query_answer({question}, current)"


@pytest.mark.parametrize(
    ("instruction", "things", "view"),
    [
        ("How many masts are within the present field of view?", "masts", "current"),
        ("Count the open hatches, current view only.", "open hatches", "current"),
        ("how many cranes, present view only", "cranes", "current"),
        ("I need a tally of green crates for the whole scene.", "green crates", "full"),
        ("Count for me all the parked vans, the whole place around please.", "parked vans", "full"),
        ("count vans, whole scene only", "vans", "full"),
        ("Return the number of pallets in the entire 360-degree scene.", "pallets", "full"),
        ("Look all around the arena please and tell me how many ice cream vans have turned up today.", "ice cream vans", "full"),
        ("How many taxis are on the road, check all around, not just what is on the screen.", "taxis on the road", "full"),
    ],
)
def test_the_view_is_no_part_of_the_things(instruction: str, things: str, view: str) -> None:
    assert calls(instruction) == count(things, view)


@pytest.mark.parametrize(
    ("instruction", "things", "view"),
    [
        ("Run a count of lamp posts over the full scene.", "lamp posts", "full"),
        ("Return the number of persons carrying a bag.", "persons carrying a bag", "current"),
        ("Perform a tally of pallets.", "pallets", "current"),
        ("For the stock sheet I need the number of sacks on the trolley.", "sacks on the trolley", "current"),
        ("For my spreadsheet, we need the total number of crates.", "crates", "current"),
        ("I've a driver asking me how many carts there are by the doors, could you tell me?", "carts by the doors", "current"),
        ("count the excevators", "excavators", "current"),
    ],
)
def test_counts_that_are_ordered_in_other_words(instruction: str, things: str, view: str) -> None:
    assert calls(instruction) == count(things, view)


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("count trucks lane 2", f"go_to_preset(lane-2); {count('trucks')}"),
        (
            "how many vans main gate and dock 4",
            f"go_to_preset(main-gate); {count('vans')}; go_to_preset(dock-4); {count('vans')}",
        ),
        ("count lane 2 signs", count("lane 2 signs")),
        ("count trucks near lane 2", count("trucks near lane 2")),
        ("how many vans at the main gate, the radio won't stop beeping", f"go_to_preset(main-gate); {count('vans')}"),
        ("I need a head count of guards at the main gate before the shift change", f"go_to_preset(main-gate); {count('guards')}"),
        (
            "For the main gate and dock 4 give me the no. of bicycles in each case.",
            f"go_to_preset(main-gate); {count('bicycles')}; go_to_preset(dock-4); {count('bicycles')}",
        ),
    ],
)
def test_counts_at_presets(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    "instruction",
    [
        "Compare the van count at the main gate with the one at dock 4.",
        "Compare the number of vans at the main gate with the number at dock 4.",
        "Compare the van totals between the main gate and dock 4.",
        "are there more vans at the main gate or at dock 4, my manager wants to know which way to send people",
    ],
)
def test_counts_at_two_presets_are_compared(instruction: str) -> None:
    assert calls(instruction) == f"go_to_preset(main-gate); {count('vans')}; go_to_preset(dock-4); {count('vans')}"


@pytest.mark.parametrize(
    "instruction",
    [
        "Could you go round all the presets one after another and tell me how many bins there are at each one, it's for the rota.",
        "Visit each preset in list order and count the bins there.",
        "Go to each preset in the order listed and count the bins.",
    ],
)
def test_counts_on_a_tour(instruction: str) -> None:
    assert calls(instruction) == "; ".join(f"go_to_preset({preset}); {count('bins')}" for preset in PRESETS)


@pytest.mark.parametrize("instruction", ["count trucks, not lane 2", "don't run a count of flags", "look all around the van"])
def test_what_is_denied_or_unclear_is_asked_about(instruction: str) -> None:
    assert plan(instruction, PRESETS).clarification
