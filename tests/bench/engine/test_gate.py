"""The gate: significant losses fail it, chance does not, and evaluations that cannot be compared are refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.engine.regression.gate import gate
from scope_ptz.bench.engine.regression.text import comparison_lines, judge_change_note
from scope_ptz.bench.scoring.trials import Evaluation, Judgement, Trial
from scope_ptz.errors import InputError
from tests.cli.conftest import Scope


def evaluation(like: Evaluation, right: dict[str, int], of: int = 10) -> Evaluation:
    """Return an evaluation with ``of`` trials in each category, of which ``right`` are correct."""
    trials: list[Trial] = []
    for category, number in right.items():
        for at in range(of):
            task = like.trials[0].task.model_copy(update={"id": f"scope1-x-{category}-{at:03d}", "category": category})
            headline = "correct" if at < number else "incorrect"
            trials.append(like.trials[0].model_copy(update={"task": task, "sample": f"{task.id}#1", "headline": headline}))
    return Evaluation(card=like.card, trials=tuple(trials), wanted=len(trials))


def test_a_significant_loss_fails(a_log: Path) -> None:
    like = read_evaluation(a_log)
    before = evaluation(like, {"counting": 10, "ocr": 10})
    lost = gate(evaluation(like, {"counting": 2, "ocr": 10}), before)
    assert not lost.passed
    assert [c.group for c in lost.regressions] == ["all", "counting"]
    # 8 losses and no gain: 2 / 2^8, twice that in the category because of two tests.
    assert lost.overall.p == pytest.approx(2 / 256)
    assert lost.categories[0].p == pytest.approx(4 / 256)
    assert lost.overall.worse[0] == "scope1-x-counting-002"


def test_chance_and_gains_pass(a_log: Path) -> None:
    like = read_evaluation(a_log)
    before = evaluation(like, {"counting": 5, "ocr": 5})
    assert gate(evaluation(like, {"counting": 4, "ocr": 6}), before).passed
    assert gate(evaluation(like, {"counting": 10, "ocr": 10}), before).passed
    assert gate(before, before).passed


def test_what_cannot_be_compared(a_log: Path) -> None:
    like = read_evaluation(a_log)
    other = like.model_copy(update={"card": like.card.model_copy(update={"dataset_digest": "0" * 16})})
    with pytest.raises(InputError, match="different tasks"):
        gate(other, like)
    with pytest.raises(InputError, match="Finish the evaluation first"):
        gate(like.model_copy(update={"wanted": 99}), like)
    broken = tuple(t.model_copy(update={"headline": "infrastructure"}) for t in like.trials)
    with pytest.raises(InputError, match="no task is scored in both"):
        gate(like.model_copy(update={"trials": broken}), like)


def judged_by(like: Evaluation, judge: str) -> Evaluation:
    said = Judgement(judge=judge, prompt="p", verdict="correct")
    trials = (t.model_copy(update={"scored_by": "judge", "headline": "correct", "judgements": (said,)}) for t in like.trials)
    return like.model_copy(update={"trials": tuple(trials)})


def test_broken_tasks_and_changed_judges_are_reported(a_log: Path) -> None:
    like = read_evaluation(a_log)
    first, *rest = like.trials
    broken = first.model_copy(update={"headline": "infrastructure"})
    now = like.model_copy(update={"trials": (broken, *rest)})
    assert any(
        line.startswith("1 task is left out, because in one of the logs infrastructure")
        for line in comparison_lines(gate(now, like), now)
    )
    assert judge_change_note(like, like) == judge_change_note(judged_by(like, "a"), judged_by(like, "a")) == ""
    assert judge_change_note(judged_by(like, "a"), like) == ""
    told = judge_change_note(judged_by(like, "b"), judged_by(like, "a"))
    assert told.startswith("note: the deciding judge is a (p) in the baseline and b (p) in the log")


def test_the_command(scope: Scope, evaluated: Path) -> None:
    done = scope("bench", "gate", str(evaluated), "--baseline", str(evaluated), "--json")
    assert done.code == 0
    assert '"passed": true' in done.out
    missing = scope("bench", "gate", str(evaluated), "--baseline", str(evaluated.with_name("none.eval")))
    assert missing.code == 2
    assert "does not exist" in missing.err
