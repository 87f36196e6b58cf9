"""The gate fails on significant losses, passes on chance differences, and rejects incomparable evaluations."""

from __future__ import annotations

from pathlib import Path

import pytest

from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.engine.regression.gate import compare_evaluations
from scope_ptz.bench.engine.regression.text import comparison_lines, judge_change_note
from scope_ptz.bench.scoring.trials import Evaluation, Judgement, Trial
from scope_ptz.errors import InputError
from tests.cli.conftest import Scope


def evaluation(template: Evaluation, correct: dict[str, int], total: int = 10) -> Evaluation:
    """Return an evaluation with ``total`` trials in each category. ``correct`` maps categories to numbers of correct trials."""
    trials: list[Trial] = []
    for category, number in correct.items():
        for index in range(total):
            task = template.trials[0].task.model_copy(update={"id": f"scope1-x-{category}-{index:03d}", "category": category})
            headline = "correct" if index < number else "incorrect"
            trials.append(template.trials[0].model_copy(update={"task": task, "sample": f"{task.id}#1", "headline": headline}))
    return Evaluation(card=template.card, trials=tuple(trials), wanted=len(trials))


def test_a_significant_loss_fails(shared_log: Path) -> None:
    template = read_evaluation(shared_log)
    before = evaluation(template, {"counting": 10, "ocr": 10})
    comparison = compare_evaluations(evaluation(template, {"counting": 2, "ocr": 10}), before)
    assert not comparison.passed
    assert [c.group for c in comparison.regressions] == ["all", "counting"]
    # 8 losses and no gain: 2 / 2^8, twice that in the category because of two tests.
    assert comparison.overall.p == pytest.approx(2 / 256)
    assert comparison.categories[0].p == pytest.approx(4 / 256)
    assert comparison.overall.worse[0] == "scope1-x-counting-002"


def test_chance_and_gains_pass(shared_log: Path) -> None:
    template = read_evaluation(shared_log)
    before = evaluation(template, {"counting": 5, "ocr": 5})
    assert compare_evaluations(evaluation(template, {"counting": 4, "ocr": 6}), before).passed
    assert compare_evaluations(evaluation(template, {"counting": 10, "ocr": 10}), before).passed
    assert compare_evaluations(before, before).passed


def test_incomparable_evaluations_are_rejected(shared_log: Path) -> None:
    template = read_evaluation(shared_log)
    other = template.model_copy(update={"card": template.card.model_copy(update={"dataset_digest": "0" * 16})})
    with pytest.raises(InputError, match="different tasks"):
        compare_evaluations(other, template)
    with pytest.raises(InputError, match="Finish the evaluation first"):
        compare_evaluations(template.model_copy(update={"wanted": 99}), template)
    broken = tuple(t.model_copy(update={"headline": "infrastructure"}) for t in template.trials)
    with pytest.raises(InputError, match="no task is scored in both"):
        compare_evaluations(template.model_copy(update={"trials": broken}), template)


def with_judge(template: Evaluation, judge: str) -> Evaluation:
    judgement = Judgement(judge=judge, prompt="p", verdict="correct")
    trials = (
        t.model_copy(update={"scored_by": "judge", "headline": "correct", "judgements": (judgement,)}) for t in template.trials
    )
    return template.model_copy(update={"trials": tuple(trials)})


def test_broken_tasks_and_changed_judges_are_reported(shared_log: Path) -> None:
    template = read_evaluation(shared_log)
    first, *rest = template.trials
    broken = first.model_copy(update={"headline": "infrastructure"})
    now = template.model_copy(update={"trials": (broken, *rest)})
    assert any(
        line.startswith("1 task is left out, because in one of the logs infrastructure")
        for line in comparison_lines(compare_evaluations(now, template), now)
    )
    assert judge_change_note(template, template) == judge_change_note(with_judge(template, "a"), with_judge(template, "a")) == ""
    assert judge_change_note(with_judge(template, "a"), template) == ""
    note = judge_change_note(with_judge(template, "b"), with_judge(template, "a"))
    assert note.startswith("note: the deciding judge is a (p) in the baseline and b (p) in the log")


def test_the_gate_command(scope: Scope, log_copy: Path) -> None:
    result = scope("bench", "gate", str(log_copy), "--baseline", str(log_copy), "--json")
    assert result.code == 0
    assert '"passed": true' in result.out
    missing = scope("bench", "gate", str(log_copy), "--baseline", str(log_copy.with_name("none.eval")))
    assert missing.code == 2
    assert "does not exist" in missing.err
