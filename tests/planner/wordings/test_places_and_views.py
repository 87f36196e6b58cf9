"""Saved positions, groups of presets, and where to look, in everyday words."""

from __future__ import annotations

import pytest

from scope_ptz.planner.plan import PlannedCall, plan

PRESETS = ("berth-one", "berth-two", "north-slip", "south-slip", "ice-house")


def described(call: PlannedCall) -> str:
    return f"{call.name}({', '.join(map(str, call.arguments.values()))})"


def calls(instruction: str) -> str:
    planned = plan(instruction, PRESETS)
    return planned.clarification or "; ".join(map(described, planned.calls))


def count(things: str, view: str = "current") -> str:
    return f"count_objects({things}, {view})"


def at(preset: str, *looks: str) -> str:
    return "; ".join((f"go_to_preset({preset})", *looks))


@pytest.mark.parametrize(
    "instruction",
    [
        "What named viewpoints are there?",
        "Which locations have been stored as presets?",
        "list the predefined positions",
        "remind me which places you've got stored, I never noted them down",
        "tell me what views there are, I lost the list",
    ],
)
def test_the_saved_positions_are_listed(instruction: str) -> None:
    assert calls(instruction) == "get_presets()"


@pytest.mark.parametrize(
    "instruction",
    [
        "go round all the places you've got saved and count the gulls at each one",
        "visit all the spots you have stored and count the gulls",
        "go to every position we've saved and count the gulls there",
    ],
)
def test_a_tour_of_what_is_saved_visits_every_preset(instruction: str) -> None:
    assert calls(instruction) == "; ".join(at(preset, count("gulls")) for preset in PRESETS)


BOTH_BERTHS = "; ".join(at(preset, count("crates")) for preset in ("berth-one", "berth-two"))
BOTH_SLIPS = "; ".join(at(preset, count("crates")) for preset in ("north-slip", "south-slip"))


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("Give me the total number of crates on both berths combined.", BOTH_BERTHS),
        ("count the crates on berths one and two", BOTH_BERTHS),
        ("which berth has more crates, one or two?", BOTH_BERTHS),
        ("Busier berth, one or two? Count crates.", BOTH_BERTHS),
        ("how many crates are there at the two slips?", BOTH_SLIPS),
        ("which slip has fewer crates, north or south?", BOTH_SLIPS),
        (
            "which berth has more crates, 1 or 2? Go to that one and take a picture",
            f"{BOTH_BERTHS}; go_to_preset(berth-one); take_image()",
        ),
        ("A photo of both slips for the log.", "; ".join(at(slip, "take_image()") for slip in ("north-slip", "south-slip"))),
    ],
)
def test_the_presets_of_a_group_are_named(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


def test_for_whom_to_count_is_no_part_of_the_things() -> None:
    assert calls("can you count the barrels for us at the ice house, I've got to know") == at("ice-house", count("barrels"))
