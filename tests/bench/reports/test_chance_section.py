"""The section on chance: constant answers on the tasks of a run, and accuracy corrected for them."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from scope_ptz.bench.reports.assemble import build_report
from scope_ptz.bench.reports.details.chance_section import consistent_outcomes
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.bench.statistics.clustered import IntervalEstimate
from scope_ptz.bench.tasks.expected import NoneThere
from scope_ptz.bench.tasks.splits import load_split
from scope_ptz.bench.tasks.task import Task
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.registry import load_registry
from tests.bench.reports.sample_evaluations import card, trial

TASKS = load_split("lite")
BY_ID = {task.id: task for task in TASKS}


def run(is_correct: Callable[[Task], bool], *, epochs: int = 1) -> Evaluation:
    """Return an evaluation of a pair of models on the lite split."""
    trials = tuple(
        trial(facts_of(task, f"place {number % 5}"), "correct" if is_correct(task) else "incorrect", epoch=epoch)
        for number, task in enumerate(TASKS)
        for epoch in range(1, epochs + 1)
    )
    return Evaluation(card=card("qwen3-4b", "moondream2", split="lite", epochs=epochs), trials=trials, wanted=len(trials))


def row(evaluation: Evaluation) -> dict[str, object]:
    report = build_report([evaluation], load_registry(), tasks=BY_ID)
    (table,) = [table for table in report.tables if table.key == "chance_corrected"]
    return dict(zip([column.name for column in table.columns], table.rows[0], strict=True))


def value(cell: object) -> float:
    return cell.value if isinstance(cell, IntervalEstimate) else float(str(cell))


def test_a_perfect_run_stays_perfect() -> None:
    cells = row(run(lambda _: True))
    assert [value(cells[key]) for key in ("macro", "consistent", "corrected")] == pytest.approx([1.0, 1.0, 1.0])


def test_an_agent_that_always_denies_is_not_above_chance() -> None:
    """It is right about every absence, so its accuracy is far above its chance-corrected accuracy."""
    cells = row(run(lambda task: isinstance(task.expected, NoneThere)))
    assert value(cells["macro"]) > 0.1
    assert value(cells["consistent"]) == 0.0
    assert value(cells["corrected"]) < 0.0


def test_both_tasks_of_a_pair_must_be_correct_in_each_repeat() -> None:
    evaluation = run(lambda _: True, epochs=2)
    broken = next(t for t in evaluation.trials if t.task.pair in BY_ID and t.epoch == 2)
    trials = [t.model_copy(update={"headline": "incorrect"}) if t is broken else t for t in evaluation.trials]
    wrong = [t for t, right in zip(trials, consistent_outcomes(trials), strict=True) if not right]
    assert {(t.task.id, t.epoch) for t in wrong} == {(broken.task.id, 2), (broken.task.pair, 2)}


def test_the_summary_and_the_table_state_the_accuracy_of_constant_answers() -> None:
    report = build_report([run(lambda _: True)], load_registry(), tasks=BY_ID)
    assert any("best constant answer scores 0.0% without a tool call" in line for line in report.summary)
    assert any("Chance-corrected macro accuracy" in line for line in report.summary)
    (table,) = [table for table in report.tables if table.key == "constant_answers"]
    shares = {str(cells[3]): cells for cells in table.rows}
    assert set(shares) == {"accepted as an answer", "without a call", "move, look once", "move, look once, by category"}
    assert shares["move, look once"][4] == "None."


def test_a_report_on_unknown_tasks_has_no_chance_section() -> None:
    report = build_report([run(lambda _: True)], load_registry())
    assert "chance" not in [section.key for section in report.sections]
    assert not any("constant" in line for line in report.summary)
