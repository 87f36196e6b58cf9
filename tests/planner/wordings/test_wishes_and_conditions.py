"""Wishes for pictures and close views, questions in unusual forms, and conditions with nothing to do otherwise."""

from __future__ import annotations

import pytest

from scope_ptz.planner.grammar.consistency.check import objection
from scope_ptz.planner.grammar.instruction_tree import Count, Move, Snap, Thing
from scope_ptz.planner.plan import PlannedCall, plan

PRESETS = ("gate", "ferry-ramp", "players-bench")

PICTURES = [
    ("Tilt down 5, count the vans, then we'd really like a snapshot", "adjust_ptz tilt_deg=-5; count_objects vans; take_image"),
    ("Pan left 20, then I would also love a close-up of the kiosk", "adjust_ptz pan_deg=-20; zoom_to_object kiosk"),
    ("I'd also like a count of the buoys", "count_objects buoys"),
    ("Take a baseline still of the current view", "take_image"),
    ("Go home and save a comparison image", "go_home; take_image"),
    ("Make also two photos of the gate", "go_to_preset gate; take_image; take_image"),
    ("Follow please the cyclist", "track_object cyclist"),
    (
        "Grab a photo here, then go to the ferry ramp and grab another one, head office needs both of them",
        "take_image; go_to_preset ferry-ramp; take_image",
    ),
]
QUESTIONS = [
    ("Confirm players bench is free of bottles", "go_to_preset players-bench; query_answer Is players bench free of bottles?"),
    ("Confirm the ferry ramp is clear", "go_to_preset ferry-ramp; query_answer Is the ferry ramp clear?"),
    ("Verify lamps are off", "query_answer Are lamps off?"),
    ("Whole area sweep: are there any dogs?", "query_answer are there any dogs in the whole scene? (full)"),
    ("Yes or no: is there a tug at the ferry ramp?", "go_to_preset ferry-ramp; query_answer is there a tug?"),
    ("notices on the wall say what", "query_answer what do the notices on the wall say?"),
    ("the display over the door shows what?", "query_answer what does the display over the door show?"),
    ("track 7 clear?", "query_answer is track 7 clear?"),
    ("berth 12 free or not?", "query_answer is berth 12 free?"),
    ("how many coaches are on stand 3?", "count_objects coaches on stand 3"),
    ("Does the crate look as though it is leaking?", "query_answer Does the crate look like it is leaking?"),
    ("check weather the hatch is shut", "query_answer Is the hatch shut?"),
    ("is the skipper on board, he already had a fine last month", "query_answer is the skipper on board"),
    (
        "is it slippery over at the ferry ramp? I don't want anybody to fall",
        "go_to_preset ferry-ramp; query_answer is it slippery?",
    ),
    (
        "I heard a bang just now are there any people on the jetty",
        "query_answer are there any people on the jetty?",
    ),
    (
        "I think the girls left the pump running at the ferry ramp again is the pump still running over there",
        "go_to_preset ferry-ramp; query_answer is the pump still running over there?",
    ),
    ("What memory positions does this camera have?", "get_presets"),
    ("Which spots does this thing remember?", "get_presets"),
]
CLOSE_VIEWS = [
    ("Get me the penalty spot, close up.", "zoom_to_object penalty spot"),
    ("I should like the barge with the red hull to be nicely framed", "zoom_to_object barge with the red hull"),
    ("We need the gauge in shot for the logbook", "zoom_to_object gauge"),
    ("Tilt up a lot, I want the mast in the picture.", "adjust_ptz tilt_deg=20"),
    ("find the grey cat she got out again", "zoom_to_object grey cat"),
    ("find the box he left by the door", "zoom_to_object box he left by the door"),
    ("find me a lifebuoy somewhere", "zoom_to_object lifebuoy"),
    ("zoom in on the no mooring sign", "zoom_to_object no mooring sign"),
    ("count the no entry signs", "count_objects no entry signs"),
    ("Search the pressure washer and go close to it", "zoom_to_object pressure washer"),
    ("zoom in on the tyre, reckon it's flat", "zoom_to_object tyre"),
]
CONDITIONS = [
    ("If the hatch lies open, take a picture", "query_answer is the hatch open?; take_image"),
    ("If there are more than 4 prams, go home; 4 is our limit.", "count_objects prams; go_home"),
    (
        "If the gate is empty, take a still, otherwise just leave everything the way it is.",
        "go_to_preset gate; query_answer is the gate empty?; take_image",
    ),
    (
        "What I'd like, if it's not too much trouble, is the gate first, then count the bikes",
        "go_to_preset gate; count_objects bikes",
    ),
    (
        "Do your rounds. At every preset, take a photo.",
        "go_to_preset gate; take_image; go_to_preset ferry-ramp; take_image; go_to_preset players-bench; take_image",
    ),
]


def shown(calls: tuple[PlannedCall, ...]) -> str:
    """Return the calls in one line, with the view only if it is the whole scene and the duration left out."""
    return "; ".join(_shown(call) for call in calls)


def _shown(call: PlannedCall) -> str:
    moves = [
        f"{name}={value:g}" for name, value in call.arguments.items() if isinstance(value, int | float) and name != "duration_s"
    ]
    texts = [str(value) for value in call.arguments.values() if isinstance(value, str) and value not in {"current", "full"}]
    return " ".join([call.name, *moves, *texts, *(["(full)"] if call.arguments.get("view") == "full" else [])])


@pytest.mark.parametrize(("text", "calls"), [*PICTURES, *QUESTIONS, *CLOSE_VIEWS, *CONDITIONS])
def test_what_is_asked_for_is_planned(text: str, calls: str) -> None:
    assert shown(plan(text, PRESETS).calls) == calls


@pytest.mark.parametrize(
    "text",
    [
        "If there are more than 4 prams, go home; 5 is our limit.",
        "Pan left 20, he already did that.",
        "Search the yard and come close to it.",
    ],
)
def test_what_remains_unclear_is_asked_about(text: str) -> None:
    assert not plan(text, PRESETS).calls


@pytest.mark.parametrize("wish", ["I'd also like a photo", "we need a quick snapshot", "I would love one more photograph"])
def test_a_plan_without_the_picture_that_is_wished_for_is_rejected(wish: str) -> None:
    count = Count((Thing("vans"),))
    assert objection(f"count the vans, then {wish}", (count,)) is not None
    assert objection(f"count the vans, then {wish}", (count, Snap())) is None


def test_a_comparison_with_a_photo_is_no_wish() -> None:
    assert objection("count the vans, it looks like a photo", (Count((Thing("vans"),)),)) is None


def test_left_after_a_subject_and_before_an_object_is_no_direction() -> None:
    count = Count((Thing("vans"),))
    assert objection("the boys left the lights on, count the vans", (count,)) is None
    assert objection("turn the thing left the same way, count the vans", (count, Move(()))) is not None
