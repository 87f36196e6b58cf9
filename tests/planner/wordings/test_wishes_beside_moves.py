"""Wishes to see a thing: beside a move they say what it is for, and on their own or after "then" they ask for a close view."""

from __future__ import annotations

import pytest

from scope_ptz.planner.plan import PlannedCall, plan

PRESETS = ("gate", "dock")


def described(call: PlannedCall) -> str:
    return " ".join(
        [call.name, *(f"{value:g}" if isinstance(value, float | int) else str(value) for value in call.arguments.values())]
    )


def calls(instruction: str) -> str:
    return "; ".join(described(call) for call in plan(instruction, PRESETS).calls)


WISHES = [
    "I want the whole bandstand in shot",
    "we need the bandstand in the picture",
    "let me see the bandstand",
    "lemme have a look at the bandstand",
    "I'd like a better view of the bandstand",
    "I wanna look at the bandstand",
    "could I get a better look at the bandstand",
    "let's have a look at the bandstand",
]


@pytest.mark.parametrize("wish", WISHES)
@pytest.mark.parametrize("template", ["{wish}, tilt up 15", "{wish}. Tilt up 15.", "{wish}, so tilt up 15", "tilt up 15, {wish}"])
def test_wish_beside_a_move_is_what_the_move_is_for(wish: str, template: str) -> None:
    assert calls(template.format(wish=wish)) == "adjust_ptz 15"


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("Pull right back a lot, I want the entire queue in shot", "adjust_ptz 0.25"),
        ("I need a clearer view of the allotments before the judge turns up, so swing left 25 and go in to 3x", "adjust_ptz -25 3"),
        ("let me see the cyclist, pan left 20 and follow him", "adjust_ptz -20; track_object cyclist 10"),
        ("I want to see the dumper, zoom in", "zoom_to_object dumper"),
        ("I want to see the dumper, zoom in 3x", "adjust_ptz 3"),
    ],
)
def test_moves_with_their_purpose(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("let me see the dumper. Then pan left 5", "zoom_to_object dumper; adjust_ptz -5"),
        ("pan left 5. Then let me see the dumper", "adjust_ptz -5; zoom_to_object dumper"),
        ("pan left 5 and let me see the dumper", "adjust_ptz -5; zoom_to_object dumper"),
        ("I want to see the dumper but pan left 5 first", "adjust_ptz -5; zoom_to_object dumper"),
        ("pan left 5, zoom in on the dumper", "adjust_ptz -5; zoom_to_object dumper"),
        ("show me the dumper, pan left 5", "zoom_to_object dumper; adjust_ptz -5"),
        ("I want you to find the dumper, pan left 5", "zoom_to_object dumper; adjust_ptz -5"),
        ("pan left 5, I'd like a close-up of the dumper", "adjust_ptz -5; zoom_to_object dumper"),
        ("go to the gate, I want to see the dumper", "go_to_preset gate; zoom_to_object dumper"),
        ("I want to see the dumper", "zoom_to_object dumper"),
        ("I need the dumper in the picture", "zoom_to_object dumper"),
    ],
)
def test_orders_and_later_steps_remain_steps(instruction: str, expected: str) -> None:
    assert calls(instruction) == expected


def test_close_view_that_is_wished_for_before_a_move_is_asked_about() -> None:
    assert not plan("I need a closer look at the kerb, tilt down 10", PRESETS).understood
