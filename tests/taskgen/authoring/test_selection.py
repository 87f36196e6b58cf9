"""Selection of drafts: balanced, within limits, pairs together, and reproducible."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import pytest

from scope_ptz.bench.scoring.episode import CameraPosition
from scope_ptz.bench.tasks.expected import AnyExpected, Choice, NoneThere, Number, YesNo
from scope_ptz.geometry import Pose
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.drafts import Question, TaskDraft
from scope_ptz.taskgen.authoring.selection import (
    MAX_AT_ONE_POSITION,
    MAX_SAME_QUESTION,
    MAX_SAME_YES_NO,
    Selection,
    SharedLimits,
    answer_positions,
)
from scope_ptz.taskgen.authoring.task_places import TaskPlace, go, preset_at


@pytest.fixture
def place(analytic_scene: Scene) -> TaskPlace:
    first, second, *_ = analytic_scene.file.presets
    return TaskPlace(analytic_scene, first.name, (go(second.name),), preset_at(second))


def draft(
    place: TaskPlace, name: str, expected: AnyExpected, answer_key: str, kind: str = "count", twin: TaskDraft | None = None
) -> TaskDraft:
    question = Question(((f"how many {name} are there?", f"how many {name} there are"),))
    return TaskDraft("counting", kind, name, place, expected, question, answer_key=answer_key, twin=twin)


def chosen(drafts: list[TaskDraft], quota: int, shared: SharedLimits | None = None) -> list[TaskDraft]:
    return [row.draft for row in Selection("counting", quota, shared or SharedLimits(), 1).fill(drafts)]


def test_answers_are_balanced(place: TaskPlace) -> None:
    ones = [draft(place, f"single {n}", Number(value=1), "1") for n in range(30)]
    others = [draft(place, f"several {n}", Number(value=n), str(n)) for n in range(2, 8)]
    taken = chosen([*ones, *others], 12)
    assert Counter(d.answer_key for d in taken)["1"] <= 7
    assert {d.answer_key for d in taken} >= {str(n) for n in range(2, 8)}


def test_a_question_is_asked_of_few_views_with_the_same_answer(place: TaskPlace) -> None:
    views = [replace(place, at=CameraPosition(place.at.viewpoint, Pose(float(pan), -10.0, 1.0))) for pan in range(0, 90, 15)]
    same = [draft(view, "cars", Number(value=3), "3") for view in views]
    others = [draft(place, f"thing {n}", Number(value=n % 5), str(n % 5)) for n in range(10)]
    assert sum(d.key == "cars" for d in chosen([*same, *others], 10)) <= MAX_SAME_QUESTION


def test_limits_are_widened_when_there_are_no_other_drafts(place: TaskPlace) -> None:
    assert len(chosen([draft(place, f"single {n}", Number(value=1), "1") for n in range(30)], 12)) == 12


def test_yes_and_no_are_equally_frequent(place: TaskPlace) -> None:
    drafts = [
        draft(place, f"{said} {n}", YesNo(value=said), "yes" if said else "no", "is") for said in (True, False) for n in range(9)
    ]
    assert Counter(d.answer_key for d in chosen(drafts, 8)) == {"yes": MAX_SAME_YES_NO, "no": MAX_SAME_YES_NO}


def test_both_tasks_of_a_pair_are_taken_or_neither(place: TaskPlace) -> None:
    there = [draft(place, f"thing {n}", Number(value=n), str(n)) for n in range(1, 6)]
    gone = [draft(place, f"ghost {n}", NoneThere(subject=("ghost",)), "none", "none", there[n]) for n in range(5)]
    shared = SharedLimits(asked={there[0].full_key})
    taken = chosen([*there, *gone], 9, shared)
    assert gone[0] not in taken
    for absence in (d for d in taken if d.twin is not None):
        assert absence.twin in taken


def test_no_draft_is_taken_twice_and_the_selection_is_reproducible(place: TaskPlace) -> None:
    drafts = [draft(place, f"thing {n}", Number(value=n % 5), str(n % 5)) for n in range(20)]
    once = chosen([*drafts, *drafts], 10)
    assert len({d.key for d in once}) == len(once) == 10
    assert chosen([*drafts, *drafts], 10) == once


def test_position_of_the_right_answer_among_those_offered(place: TaskPlace) -> None:
    options = Choice(value="cars", options={"cars": (), "vans": (), "buses": ()})
    offer = TaskDraft("comparative", "more", "x", place, options)
    assert answer_positions(offer, "Are there more cars or more vans?") == ["0"]
    assert answer_positions(offer, "Are there more vans or more cars?") == ["1", "last"]
    assert answer_positions(offer, "What is there most of: vans, cars or buses?") == ["1"]
    assert answer_positions(offer, "What is there most of?") == []


def test_no_offered_position_is_right_too_often(place: TaskPlace) -> None:
    def offer(n: int, value: str) -> TaskDraft:
        expected = Choice(value=value, options={f"cars {n}": (), f"vans {n}": ()})
        return TaskDraft(
            "comparative",
            "more",
            f"{n}",
            place,
            expected,
            Question(((f"are there more cars {n} or more vans {n}?",) * 2,)),
            answer_key=value,
        )

    last = [offer(n, f"vans {n}") for n in range(40)]
    first = [offer(n, f"cars {n}") for n in range(40, 60)]
    rows = Selection("comparative", 10, SharedLimits(), 1).fill([*last, *first])
    assert Counter(at for row in rows for at in answer_positions(row.draft, row.text) if at != "1") == {
        "0": 5,
        "last": MAX_AT_ONE_POSITION["comparative"],
    }


def test_the_order_of_drafts_does_not_matter(place: TaskPlace) -> None:
    drafts = [draft(place, f"thing {n}", Number(value=n % 5), str(n % 5)) for n in range(30)]
    forward = Selection("counting", 10, SharedLimits(), 1).fill(drafts)
    backward = Selection("counting", 10, SharedLimits(), 1).fill(drafts[::-1])
    assert [(row.draft, row.text) for row in forward] == [(row.draft, row.text) for row in backward]


def test_removing_a_draft_keeps_most_of_the_others(place: TaskPlace) -> None:
    drafts = [draft(place, f"thing {n}", Number(value=n), str(n)) for n in range(60)]
    taken = chosen(drafts, 20)
    for gone in taken[:3]:
        again = chosen([d for d in drafts if d is not gone], 20)
        assert sum(d in again for d in taken) == 19
