"""Answers that adapt to the form of a question: the forms, the agents, and the limit on the tasks that they may pass."""

from __future__ import annotations

import pytest

from scope_ptz.bench.tasks.expected import ActionOnly
from scope_ptz.bench.tasks.splits import load_split
from scope_ptz.taskgen.validation.adaptive import NONE, adaptive_attempts, common_answers_by_form, question_form
from scope_ptz.taskgen.validation.dataset_checks import MAX_ADAPTIVE_SHARE, check_adaptive
from scope_ptz.taskgen.validation.validation_report import ValidationReport

CORE = load_split("core")


@pytest.mark.parametrize(
    ("instruction", "form"),
    [
        ("Is there a litter bin in the tram-stop view?", "exists"),
        ("Check the tram-stop preset for ticket machines. If you see any, say so.", "exists"),
        ("Zoom in 2x. How many open awnings are there?", "count"),
        ("Tell me the count of toolboxes.", "count"),
        ("If there is a shovel, what colour is it?", "colour"),
        ("Which of these can be seen: a bench or a van?", "list"),
        ("From nearest to farthest, how are the bus and the clock placed?", "order"),
        ("What can you read on the drivers sign after zooming in on it?", "read"),
        ("Turn 20 degrees to the left.", "other"),
    ],
)
def test_the_form_of_a_question(instruction: str, form: str) -> None:
    assert question_form(instruction) == form


def test_the_two_tasks_of_a_pair_have_the_same_form() -> None:
    """An agent that only sees the wording cannot tell them apart."""
    by_id = {task.id: task for task in CORE}
    pairs = [(task, by_id[task.pair]) for task in CORE if task.pair is not None]
    same = sum(question_form(one.instruction) == question_form(other.instruction) for one, other in pairs)
    assert same >= 0.9 * len(pairs)


def test_agents_answer_by_form() -> None:
    common = common_answers_by_form(CORE)
    assert common["exists"] == "Yes." and common["count"].isdigit()
    for task in CORE[::9]:
        attempts = {attempt.name: attempt.text for attempt in adaptive_attempts(task, common)}
        assert bool(attempts) == (not isinstance(task.expected, ActionOnly)), task.id
        if attempts and question_form(task.instruction) in ("count", "exists", "colour", "place"):
            assert attempts["adaptive: absence"] == NONE


def report_with(passed: set[str]) -> ValidationReport:
    report = ValidationReport(tasks=len(CORE), adaptive={"adaptive: x": passed})
    report.by_stratum["core"] = len(CORE)
    return report


def test_more_than_the_limit_is_a_fault_that_names_the_tasks() -> None:
    tasks = [task.model_copy(update={"dataset": "scope9"}) for task in CORE]
    unpaired = [task.id for task in tasks if task.pair is None]
    limit = int(MAX_ADAPTIVE_SHARE * len(tasks))
    allowed, above = report_with(set(unpaired[:limit])), report_with(set(unpaired[: limit + 1]))
    check_adaptive(allowed, tasks)
    check_adaptive(above, tasks)
    assert allowed.faults == [] and allowed.adaptive_pairs == {"adaptive: x": limit}
    assert [fault.task for fault in above.faults] == ["all"] and unpaired[0] in above.faults[0].reason


def test_one_task_of_a_pair_does_not_count_and_both_are_a_fault() -> None:
    one = next(task for task in CORE if task.pair is not None)
    half, both = report_with({one.id}), report_with({one.id, str(one.pair)})
    check_adaptive(half, CORE)
    check_adaptive(both, CORE)
    assert half.faults == [] and half.adaptive_pairs["adaptive: x"] == 0
    assert {fault.task for fault in both.faults} == {one.id, one.pair}
