"""Trials that only a judge could score are reported under the judge, not under the checks or the rules."""

from __future__ import annotations

import pytest

from scope_ptz.bench.reports.assemble import build_report
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Evaluation, Judgement, Trial
from scope_ptz.registry import load_registry
from tests.bench.reports.making import card, facts, trial
from tests.bench.reports.test_report import row


def judged(number: int, task: object, *, by_checks: bool) -> Trial:
    right = number % 2 == 0
    mode = None if right else ErrorMode.VLM_COUNTING
    said = Judgement(judge="judge-a", prompt="standard-1", verdict="correct" if right else "incorrect", error_mode=mode)
    own = "incorrect" if by_checks else ("correct" if right else "incorrect")
    return trial(
        task,  # type: ignore[arg-type]
        own,
        scored_by="checks" if by_checks else "judge",
        error_mode=ErrorMode.REASONING if by_checks else mode,
        judgements=(said,),
    )


def made(*, by_checks: bool) -> Evaluation:
    trials = tuple(judged(number, task, by_checks=by_checks) for number, task in enumerate(facts(2)))
    return Evaluation(card=card("qwen3-4b", "moondream3"), trials=trials, wanted=len(trials))


def test_verdicts_of_a_judge_are_not_reported_as_checks() -> None:
    report = build_report([made(by_checks=False)], load_registry())
    told = row(report, "judge", "qwen3-4b + moondream3")
    assert told["macro_checks"] is None and told["macro_judge"] == pytest.approx(0.5)
    told = row(report, "oracle", "qwen3-4b + moondream3")
    assert told["macro_checks"] is None and told["oracle_rules"] is None and told["perception_rules"] is None
    assert told["oracle_judge"] == pytest.approx(1.0)
    assert not any(found.key == "error_modes" for found in report.tables)
    assert row(report, "error_modes_judge", "qwen3-4b + moondream3")["vlm_counting"] == 8


def test_verdicts_of_checks_and_judge_are_shown_next_to_each_other() -> None:
    report = build_report([made(by_checks=True)], load_registry())
    told = row(report, "judge", "qwen3-4b + moondream3")
    assert told["macro_checks"] == 0.0 and told["macro_judge"] == pytest.approx(0.5)
    assert row(report, "error_modes", "qwen3-4b + moondream3")["reasoning"] == 16
