"""Trials that only a judge could score are reported under the judge, not under the checks or the rules."""

from __future__ import annotations

import pytest

from scope_ptz.bench.reports.assemble import build_report
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Evaluation, Judgement, Trial
from scope_ptz.registry import load_registry
from tests.bench.reports.sample_evaluations import card, facts, trial
from tests.bench.reports.test_report import row


def judged_trial(number: int, task: object, *, by_checks: bool) -> Trial:
    is_correct = number % 2 == 0
    mode = None if is_correct else ErrorMode.VLM_COUNTING
    judgement = Judgement(judge="judge-a", prompt="standard-1", verdict="correct" if is_correct else "incorrect", error_mode=mode)
    headline = "incorrect" if by_checks else ("correct" if is_correct else "incorrect")
    return trial(
        task,  # type: ignore[arg-type]
        headline,
        scored_by="checks" if by_checks else "judge",
        error_mode=ErrorMode.REASONING if by_checks else mode,
        judgements=(judgement,),
    )


def judged_evaluation(*, by_checks: bool) -> Evaluation:
    trials = tuple(judged_trial(number, task, by_checks=by_checks) for number, task in enumerate(facts(2)))
    return Evaluation(card=card("qwen3-4b", "moondream3"), trials=trials, wanted=len(trials))


def test_verdicts_of_a_judge_are_not_reported_as_checks() -> None:
    report = build_report([judged_evaluation(by_checks=False)], load_registry())
    cells = row(report, "judge", "qwen3-4b + moondream3")
    assert cells["macro_checks"] is None and cells["macro_judge"] == pytest.approx(0.5)
    cells = row(report, "oracle", "qwen3-4b + moondream3")
    assert cells["macro_checks"] is None and cells["oracle_rules"] is None and cells["perception_rules"] is None
    assert cells["oracle_judge"] == pytest.approx(1.0)
    assert not any(found.key == "error_modes" for found in report.tables)
    assert row(report, "error_modes_judge", "qwen3-4b + moondream3")["vlm_counting"] == 8


def test_verdicts_of_checks_and_judge_are_shown_next_to_each_other() -> None:
    report = build_report([judged_evaluation(by_checks=True)], load_registry())
    cells = row(report, "judge", "qwen3-4b + moondream3")
    assert cells["macro_checks"] == 0.0 and cells["macro_judge"] == pytest.approx(0.5)
    assert row(report, "error_modes", "qwen3-4b + moondream3")["reasoning"] == 16
