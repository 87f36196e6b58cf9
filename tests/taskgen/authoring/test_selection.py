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
from scope_ptz.taskgen.authoring.task_places import TaskPlace, preset_call, preset_position


@pytest.fixture
def place(analytic_scene: Scene) -> TaskPlace:
    first, second, *_ = analytic_scene.file.presets
    return TaskPlace(analytic_scene, first.name, (preset_call(second.name),), preset_position(second))


def draft(
    place: TaskPlace, name: str, expected: AnyExpected, answer_key: str, kind: str = "count", twin: TaskDraft | None = None
) -> TaskDraft:
    question = Question(((f"how many {name} are present?", f"how many {name} present are"),))
    return TaskDraft("counting", kind, name, place, expected, question, answer_key=answer_key, twin=twin)


def select(drafts: list[TaskDraft], quota: int, shared: SharedLimits | None = None) -> list[TaskDraft]:
    return [row.draft for row in Selection("counting", quota, shared or SharedLimits(), 1).fill(drafts)]


def test_answers_are_balanced(place: TaskPlace) -> None:
    ones = [draft(place, f"single {n}", Number(value=1), "1") for n in range(30)]
    others = [draft(place, f"several {n}", Number(value=n), str(n)) for n in range(2, 8)]
    selected = select([*ones, *others], 12)
    assert Counter(d.answer_key for d in selected)["1"] <= 7
    assert {d.answer_key for d in selected} >= {str(n) for n in range(2, 8)}


def test_few_views_with_the_same_answer_share_a_question(place: TaskPlace) -> None:
    views = [replace(place, at=CameraPosition(place.at.viewpoint, Pose(float(pan), -10.0, 1.0))) for pan in range(0, 90, 15)]
    same = [draft(view, "cars", Number(value=3), "3") for view in views]
    others = [draft(place, f"thing {n}", Number(value=n % 5), str(n % 5)) for n in range(10)]
    assert sum(d.key == "cars" for d in select([*same, *others], 10)) <= MAX_SAME_QUESTION


def test_limits_are_widened_when_there_are_no_other_drafts(place: TaskPlace) -> None:
    assert len(select([draft(place, f"single {n}", Number(value=1), "1") for n in range(30)], 12)) == 12


def test_yes_and_no_are_equally_frequent(place: TaskPlace) -> None:
    drafts = [
        draft(place, f"{value} {n}", YesNo(value=value), "yes" if value else "no", "is")
        for value in (True, False)
        for n in range(9)
    ]
    assert Counter(d.answer_key for d in select(drafts, 8)) == {"yes": MAX_SAME_YES_NO, "no": MAX_SAME_YES_NO}


def test_both_tasks_of_a_pair_are_taken_or_neither(place: TaskPlace) -> None:
    presences = [draft(place, f"thing {n}", Number(value=n), str(n)) for n in range(1, 6)]
    absences = [draft(place, f"ghost {n}", NoneThere(subject=("ghost",)), "none", "none", presences[n]) for n in range(5)]
    shared = SharedLimits(used_questions={presences[0].full_key})
    selected = select([*presences, *absences], 9, shared)
    assert absences[0] not in selected
    for absence in (d for d in selected if d.twin is not None):
        assert absence.twin in selected


def test_no_draft_is_taken_twice_and_the_selection_is_reproducible(place: TaskPlace) -> None:
    drafts = [draft(place, f"thing {n}", Number(value=n % 5), str(n % 5)) for n in range(20)]
    once = select([*drafts, *drafts], 10)
    assert len({d.key for d in once}) == len(once) == 10
    assert select([*drafts, *drafts], 10) == once


def test_positions_of_the_right_answer(place: TaskPlace) -> None:
    options = Choice(value="cars", options={"cars": (), "vans": (), "buses": ()})
    offer = TaskDraft("comparative", "more", "x", place, options)
    assert answer_positions(offer, "Are present more cars or more vans?") == ["0"]
    assert answer_positions(offer, "Are present more vans or more cars?") == ["1", "last"]
    assert answer_positions(offer, "What is present most of: vans, cars or buses?") == ["1"]
    assert answer_positions(offer, "What is present most of?") == []


def test_no_offered_position_is_right_too_often(place: TaskPlace) -> None:
    def offer(n: int, value: str) -> TaskDraft:
        expected = Choice(value=value, options={f"cars {n}": (), f"vans {n}": ()})
        return TaskDraft(
            "comparative",
            "more",
            f"{n}",
            place,
            expected,
            Question(((f"are present more cars {n} or more vans {n}?",) * 2,)),
            answer_key=value,
        )

    last = [offer(n, f"vans {n}") for n in range(40)]
    first = [offer(n, f"cars {n}") for n in range(40, 60)]
    rows = Selection("comparative", 10, SharedLimits(), 1).fill([*last, *first])
    assert Counter(position for row in rows for position in answer_positions(row.draft, row.text) if position != "1") == {
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
    selected = select(drafts, 20)
    for removed in selected[:3]:
        reselected = select([d for d in drafts if d is not removed], 20)
        assert sum(d in reselected for d in selected) == 19
