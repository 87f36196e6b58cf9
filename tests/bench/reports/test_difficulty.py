"""The check of difficulty classes against outcomes, and the classes by item statistics."""

from __future__ import annotations

from typing import Any

import pytest

from scope_ptz.bench.reports.assemble import EvaluationReport, build_report
from scope_ptz.bench.reports.details.difficulty import MIN_PAIRS, compare_classes, item_class, item_shares, verdict_text
from scope_ptz.bench.reports.report_runs import report_runs
from scope_ptz.bench.reports.tables import cell_value
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.registry import load_registry
from tests.bench.reports.sample_evaluations import card, facts, trial
from tests.bench.reports.test_report import table

CLASSES = ("easy", "medium", "hard")
TASKS = tuple(
    t.model_copy(update={"difficulty": CLASSES[n // 3 % 3]}) for n, t in enumerate(facts(36)) if t.category in ("counting", "ocr")
)
"""72 tasks of two categories, with 12 tasks of each class in each."""


def run(planner: str, correct_of_12: dict[str, int], **extra: Any) -> Evaluation:
    """Return an evaluation that is correct on the first tasks of each class."""
    counts_by_class: dict[tuple[str, str], int] = {}
    trials = []
    for task in TASKS:
        number = counts_by_class[task.category, task.difficulty] = counts_by_class.get((task.category, task.difficulty), 0) + 1
        trials.append(trial(task, "correct" if number <= correct_of_12[task.difficulty] else "incorrect"))
    return Evaluation(card=card(planner, "moondream2", **extra), trials=tuple(trials), wanted=len(trials))


def section_text(report: EvaluationReport) -> str:
    return " ".join(next(s for s in report.sections if s.key == "difficulty").text)


def build(number: int, **correct_of_12: int) -> EvaluationReport:
    return build_report([run(f"planner-{n}", correct_of_12) for n in range(number)], load_registry())


def test_a_rule_that_holds() -> None:
    report = build(3, easy=12, medium=6, hard=0)
    assert "No step between classes contradicts the rule. Accuracy falls in 4 of 4 steps, significantly in 4." in section_text(
        report
    )
    assert [values[-1] for values in table(report, "difficulty").rows] == ["yes", "yes"]
    assert f"need at least {MIN_PAIRS} pairs on the same tasks. There are 3." in section_text(report)
    assert "items" not in {t.key for t in report.tables}


def test_a_rule_that_does_not_hold_gives_a_warning() -> None:
    report = build(3, easy=2, medium=11, hard=5)
    assert "Warning: the rule does not hold beyond noise in 2 of 4 steps" in section_text(report)
    assert "Counting: medium is solved more often than easy" in section_text(report)
    assert [values[-1] for values in table(report, "difficulty").rows] == ["no", "no"]


def test_an_inversion_within_noise_gives_no_warning() -> None:
    report = build(3, easy=6, medium=7, hard=3)
    assert "Warning" not in section_text(report) and "in 2 it rises, within noise" in section_text(report)
    assert [values[-1] for values in table(report, "difficulty").rows] == ["within noise", "within noise"]


def test_more_pairs_with_the_same_outcomes_add_no_evidence_on_tasks() -> None:
    few, many = (
        report_runs([run(f"p{n}", {"easy": 6, "medium": 8, "hard": 3}) for n in range(k)], load_registry()) for k in (2, 12)
    )
    assert [s.p_adjusted for s in compare_classes(few)] == pytest.approx([s.p_adjusted for s in compare_classes(many)])


def test_classes_by_item_statistics() -> None:
    report = build_report(
        [run(f"planner-{n}", {"easy": 12, "medium": 12 - n, "hard": 0}) for n in range(MIN_PAIRS)], load_registry()
    )
    rows = {cell_value(values[0]): values for values in table(report, "items").rows}
    assert len(rows) == len(TASKS)
    by_rule = {(values[2], values[3]) for values in rows.values()}
    assert ("easy", "easy") in by_rule and ("hard", "hard") in by_rule and ("easy", "hard") not in by_rule
    assert ("medium", "hard") in by_rule, "only one pair of eight solves the last medium tasks"
    counts = {(values[0], values[1]): values[2:] for values in table(report, "difficulty_items").rows}
    assert counts["Counting", "easy"] == (12, 0, 0) and sum(map(int, map(str, counts["OCR", "medium"]))) == 12
    assert (item_class(2 / 3), item_class(0.5), item_class(1 / 3), item_class(0.2)) == ("easy", "medium", "medium", "hard")


def test_pairs_have_equal_weight_in_item_statistics() -> None:
    task = TASKS[0]
    twice = Evaluation(
        card=card("a", "moondream2", epochs=2),
        trials=tuple(trial(task, "correct", epoch=epoch, sample=f"x/{epoch}") for epoch in (1, 2)),
        wanted=2,
    )
    once = Evaluation(card=card("b", "moondream2"), trials=(trial(task, "incorrect"),), wanted=1)
    assert item_shares(report_runs([twice, once], load_registry())) == {task.id: 0.5}


def test_a_class_with_one_task_shows_nothing() -> None:
    tasks = [t for n, t in enumerate(t for t in TASKS if t.category == "ocr") if t.difficulty == "hard" or n == 0]
    trials = tuple(trial(t, "incorrect" if t.difficulty == "easy" else "correct") for t in tasks)
    runs = report_runs([Evaluation(card=card("p", "e"), trials=trials, wanted=len(trials))], load_registry())
    (step,) = compare_classes(runs)
    assert (step.drop.value, step.p_adjusted, step.is_contradiction) == (-1.0, None, False)


def test_nothing_to_compare() -> None:
    assert verdict_text(()) == "No category has tasks of two classes, so the rule cannot be checked."
