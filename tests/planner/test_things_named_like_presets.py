"""Words that name a thing in view and a preset, and comparisons of the current view with a preset."""

from __future__ import annotations

import pytest

from scope_ptz.planner.plan import plan
from tests.planner.stage import Stage

PRESETS = ("yard", "town-hall", "docks", "cars", "containers", "debarker")


def calls(instruction: str) -> list[tuple[str, str]]:
    """Return the calls of a plan, each with its preset, description or question."""
    return [
        (call.name, str(call.arguments.get("name") or call.arguments.get("description") or call.arguments.get("question")))
        for call in plan(instruction, PRESETS).calls
    ]


@pytest.mark.parametrize(
    ("instruction", "counted"),
    [
        ("how many cars?", ["cars"]),
        ("how many containers?", ["containers"]),
        ("how many vans and how many cars?", ["vans", "cars"]),
        ("count docks", ["docks"]),
        ("are there more cars than docks?", ["cars", "docks"]),
    ],
)
def test_what_is_counted_is_a_thing(instruction: str, counted: list[str]) -> None:
    assert calls(instruction) == [("count_objects", thing) for thing in counted]


@pytest.mark.parametrize("question", ["any cars?", "any containers there?", "do you see any cars?", "where is the town hall?"])
def test_what_is_asked_about_is_a_thing(question: str) -> None:
    assert calls(question) == [("query_answer", question)]


@pytest.mark.parametrize(
    ("instruction", "preset"),
    [("show me the cars", "cars"), ("go to the docks", "docks"), ("is the town hall open?", "town-hall")],
)
def test_a_preset_is_gone_to_if_a_thing_of_that_name_is_not_asked_about(instruction: str, preset: str) -> None:
    assert calls(instruction)[0] == ("go_to_preset", preset)


@pytest.mark.parametrize(
    ("first_answer", "expected"),
    [
        ({"answer": "The gate is on the left.", "known": True}, ["query_answer"]),
        ({"answer": "There is no gate in view.", "known": True}, ["query_answer", "go_to_preset", "query_answer"]),
    ],
)
def test_a_thing_that_is_not_in_view_is_sought_at_the_preset_of_its_name(
    first_answer: dict[str, object], expected: list[str]
) -> None:
    stage = Stage([first_answer, {"answer": "The gate is in the middle.", "known": True}])
    reply = stage.run("where is the gate?").text
    assert [name for name, _ in stage.calls] == expected
    assert "There is no gate" not in reply


def test_people_at_a_preset_are_counted_there() -> None:
    assert calls("how many people at the cars?") == [("go_to_preset", "cars"), ("count_objects", "people")]


@pytest.mark.parametrize("question", ["which presets have a dog?", "which preset has a dog?", "what presets have any dogs?"])
def test_presets_with_a_thing_are_looked_at(question: str) -> None:
    assert [name for name, _ in calls(question)] == ["go_to_preset", "count_objects"] * len(PRESETS)


@pytest.mark.parametrize(
    "question",
    [
        "are there more people here than at the docks?",
        "are there more people in this view than at docks?",
        "are there fewer people at the docks than here?",
        "are there more people than at the docks?",
    ],
)
def test_the_current_view_is_counted_before_the_camera_goes_to_the_preset(question: str) -> None:
    assert calls(question) == [("count_objects", "people"), ("go_to_preset", "docks"), ("count_objects", "people")]
