"""Saved positions, groups of presets, and where to look, in everyday words."""

from __future__ import annotations

import pytest

from tests.planner.wordings.planned_calls import count, planned_calls

PRESETS = ("berth-one", "berth-two", "north-slip", "south-slip", "ice-house")


def calls(instruction: str) -> str:
    return planned_calls(instruction, PRESETS)


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


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("Give me a count of full pallets, whole yard.", count("full pallets", "full")),
        ("how many skips, entire site?", count("skips", "full")),
        ("I need the number of life rings over the entire scene, not just the current view.", count("life rings", "full")),
        ("object counting test. how many oars on the bench?", count("oars on the bench")),
        ("ok counter next, give me a count of buoys across the whole 360", count("buoys", "full")),
        ("right, tracking next, follow the tug for 10 seconds", "track_object(tug, 10)"),
        ("anyone inside the hut? report", "query_answer(anyone inside the hut?, current)"),
        ("blue crates versus red crates in this view, numbers please", f"{count('blue crates')}; {count('red crates')}"),
        ("Men plus women at the ice house: what is the total?", at("ice-house", count("men"), count("women"))),
        ("quick count of the men in the ice house and the women too", at("ice-house", count("men"), count("women"))),
        ("how many chidren can you see", count("children")),
        ("how many peple are there", count("people")),
    ],
)
def test_counts_and_where_they_are_made(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


def test_presets_are_ranked_by_a_count() -> None:
    assert calls("Sort all five presets by number of gulls, fewest first.") == "; ".join(
        at(name, count("gulls")) for name in PRESETS
    )


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("ice house doors. shut or open?", at("ice-house", "query_answer(are the doors shut or open?, current)")),
        (
            "is the shutter down at the ice house do you know?",
            at("ice-house", "query_answer(is the shutter down?, current)"),
        ),
        (
            "is the door to the ice house open?",
            at("ice-house", "query_answer(is the door to the ice house open?, current)"),
        ),
        ("is the hatch open by any chance?", "query_answer(is the hatch open?, current)"),
        (
            "every preset: lamps on or off?",
            "; ".join(at(name, "query_answer(Are the lamps on or off?, current)") for name in PRESETS),
        ),
    ],
)
def test_a_state_is_asked_where_the_thing_is(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


def test_a_condition_without_a_verb_is_checked_at_its_preset() -> None:
    planned = calls("if door at ice house shut, take a photo")
    assert planned == at("ice-house", "query_answer(is the door shut?, current)", "take_image()")


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("a quarter turn to the left please, that should get my tent in", "adjust_ptz(-90)"),
        ("all the way round to the right until it stops", "adjust_ptz(360)"),
        ("incremental move: pan -3 and tilt +2", "adjust_ptz(-3, 2)"),
        ("pull back to a third of what we've got now", f"adjust_ptz({1 / 3:g})"),
        ("Pan right 20 degrees and then go back 5 degrees to the left.", "adjust_ptz(20); adjust_ptz(-5)"),
        ("I forgot my specs so I need to be four times closer, if that's possible", "adjust_ptz(4)"),
        ("stay with the tug as it goes along for, I dunno, thirty seconds", "track_object(tug, 30)"),
        ("I need a detailed view of the dial on the leftmost pump.", "zoom_to_object(dial on the leftmost pump)"),
        ("I'd like to see the ice house if that's all right", "go_to_preset(ice-house)"),
        ("count the gulls, take img", f"{count('gulls')}; take_image()"),
        ("find the red torch, used it last night", "zoom_to_object(red torch)"),
    ],
)
def test_moves_and_views_in_everyday_words(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected
