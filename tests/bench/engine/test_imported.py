"""Imported tasks run through the same engine; a judge decides where no check applies."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.engine.regression.gate import compare_evaluations
from scope_ptz.bench.engine.run_totals import accuracy
from scope_ptz.bench.judging.deciding_judge import other_judges_note, reported_judge, with_deciding_verdicts
from scope_ptz.bench.judging.judgement_tally import needs_judgement
from scope_ptz.bench.reports.report_judge import select_judge, trials_judged_by
from scope_ptz.bench.reports.report_runs import ReportRun
from scope_ptz.bench.scoring.trials import Evaluation, Judgement, Trial
from scope_ptz.bench.tasks.imported import ImportedTask
from scope_ptz.bench.tasks.task import RequiredCall
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.factory.evaluation_display import unscored_lines
from tests.bench.engine.yard_tasks import SCENE
from tests.bench.reports.sample_evaluations import card, facts
from tests.bench.reports.sample_evaluations import trial as report_trial
from tests.cli.conftest import Scope
from tests.support.misbehaving import Misbehaving, Say, good


@pytest.mark.full
def test_imported_tasks_run_and_are_judged(scope: Scope, tmp_path: Path) -> None:
    facts = TaskFacts(
        id="q-1", dataset="theirs", stratum="imported", scene=SCENE, viewpoint="mast", preset="yard",
        instruction="pan right 20 degrees",
        category="single_call", scope="current", difficulty="easy", expected="The camera has turned.",
    )  # fmt: skip
    task = ImportedTask(facts=facts, line=2, raw={}, calls=(RequiredCall(tool="adjust_ptz"),))
    (tmp_path / "theirs.jsonl").write_text(task.model_dump_json() + "\n")
    run = ("bench", "run", "--tasks", str(tmp_path / "theirs.jsonl"), "--no-pictures", "--out", str(tmp_path / "logs"), "--json")
    result = scope(*run)
    assert result.code == 0, result.err
    # Nothing has been scored yet, so there is no accuracy.
    assert (result.json["not_judged"], result.json["macro"], result.json["micro"], result.json["by_category"]) == (
        1, None, None, {"single_call": None},
    )  # fmt: skip
    plain = scope(*run[:-1]).out
    assert "unscored   1 not judged yet: scope bench rescore" in plain
    assert "%" not in plain.partition("unscored   ")[0]
    log = Path(result.json["log"])
    (trial,) = read_evaluation(log).trials
    assert (trial.headline, trial.scored_by) == ("unscored", "judge")
    assert [(check.name, check.passed) for check in trial.checks] == [("calls", True)]
    reply = {"reason": "It turned.", "verdict": "correct", "error_mode": None}
    with Misbehaving(then=good(Say(json.dumps(reply)))) as server:
        assert scope("bench", "rescore", str(log), "--judge-url", server.url, "--judge-model", "j").code == 0
    (trial,) = read_evaluation(log).trials
    assert (trial.headline, trial.scored_by, trial.reason) == ("correct", "judge", "It turned.")
    summary = scope(*run).json
    assert (summary["not_judged"], summary["macro"]) == (0, 1.0)
    # A second judge decides nothing unless it is selected, whether it disagrees or its server is unavailable.
    other = {"reason": "It did not.", "verdict": "incorrect", "error_mode": "scope"}
    with Misbehaving(then=good(Say(json.dumps(other)))) as server:
        second = scope("bench", "rescore", str(log), "--judge-url", server.url, "--judge-model", "b")
    assert second.code == 0 and "decides on the run that only a judge can score; the verdicts of b (judge-1:" in second.out
    (trial,) = read_evaluation(log).trials
    assert (trial.headline, trial.reason, [j.judge for j in trial.judgements]) == ("correct", "It turned.", ["j", "b"])
    assert "judged     j (judge-1:" in scope(*run[:-1]).out
    unknown = scope("bench", "rescore", str(log), "--decides", "c")
    assert unknown.code == 2 and "'c' has given no verdict" in unknown.err and "j (judge-1:" in unknown.err
    assert scope("bench", "rescore", str(log), "--decides", "b").code == 0
    (trial,) = read_evaluation(log).trials
    assert (trial.headline, trial.error_mode, [j.judge for j in trial.judgements]) == ("incorrect", "scope", ["b", "j"])
    assert scope(*run).json["macro"] == 0.0
    assert scope("bench", "rescore", str(log), "--checks").code == 0, "rescoring must keep the deciding judge"
    assert read_evaluation(log).trials[0].headline == "incorrect"
    assert scope("bench", "rescore", str(log), "--decides", "j").code == 0
    assert scope("bench", "rescore", str(log), "--judge-url", "http://127.0.0.1:1/v1", "--judge-model", "k").code == 1
    (trial,) = read_evaluation(log).trials
    assert (trial.headline, [j.verdict for j in trial.judgements]) == (
        "correct", ["correct", "incorrect", "failed"],
    )  # fmt: skip


def judgement_by(name: str, verdict: str, prompt: str = "p") -> Judgement:
    mode = "scope" if verdict == "incorrect" else None
    return Judgement.model_validate({"judge": name, "prompt": prompt, "verdict": verdict, "error_mode": mode})


def test_one_judge_decides_on_all_runs_of_a_log(log_copy: Path) -> None:
    first, second, third, fourth = (
        t.model_copy(update={"scored_by": "judge", "headline": "unscored"}) for t in read_evaluation(log_copy).trials
    )
    a, b = judgement_by("a", "correct"), judgement_by("b", "incorrect")

    def judged(trial: Trial, *judgements: Judgement) -> Trial:
        return trial.model_copy(update={"judgements": judgements})

    # The first judge's server failed on one run. Another judge's verdict does not replace it: the run waits for its judge.
    rows = [judged(first, a, b), judged(second, a, b), judged(third, judgement_by("a", "failed"), b), fourth]
    trials = with_deciding_verdicts(rows)
    assert [t.headline for t in trials] == ["correct", "correct", "unscored", "unscored"]
    assert needs_judgement(trials[2]) and needs_judgement(trials[3]) and accuracy(trials) == 1.0
    assert reported_judge(trials) == "a (p)" and "a (p) decides on the 4 runs" in other_judges_note(trials)
    named = with_deciding_verdicts(rows, "b")
    assert [t.headline for t in named] == ["incorrect", "incorrect", "incorrect", "unscored"]
    assert [t.judgements[0].judge for t in named[:3]] == ["b", "b", "b"]
    assert reported_judge(named) == "b (p)"
    # One model with two prompts counts as two judges, and a judge without verdicts decides nothing.
    judged_twice = [judged(first, a, judgement_by("a", "incorrect", "q")), judged(second, a)]
    assert [t.headline for t in with_deciding_verdicts(judged_twice)] == ["correct", "correct"]
    assert [t.headline for t in with_deciding_verdicts(judged_twice, "a (q)")] == ["incorrect", "unscored"]
    assert [t.headline for t in with_deciding_verdicts(judged_twice, "nobody")] == ["correct", "correct"]
    broken = judged(first, a).model_copy(update={"headline": "infrastructure"})
    assert with_deciding_verdicts([broken])[0].headline == "infrastructure" and other_judges_note([broken]) == ""


def test_a_report_uses_the_deciding_judge_and_not_an_unavailable_one() -> None:
    task = facts(1)[0]

    def run(*judgements: Judgement, by: str = "judge") -> ReportRun:
        row = report_trial(task, scored_by=by, judgements=judgements)
        return ReportRun(1, Evaluation(card=card("qwen3-4b", "moondream2"), trials=(row,), wanted=1), "x", None, None)

    a, b, unavailable = judgement_by("a", "correct"), judgement_by("b", "incorrect"), judgement_by("A-phantom", "failed")
    assert select_judge([run(a, b)]) == "a" and select_judge([run(b, a)]) == "b"
    assert select_judge([run(b, a, by="checks")]) == "a"
    assert select_judge([run(unavailable, b, by="checks"), run(unavailable, by="checks")]) == "b"
    assert (select_judge([run(unavailable, by="checks")]), select_judge([run()])) == ("A-phantom", None)
    # The first verdict of a judge whose server failed before.
    late = a.model_copy(update={"repeat": 1})
    assert trials_judged_by(run(judgement_by("a", "failed"), late).scored_trials, "a")[0][1] == late


def test_replies_without_a_verdict_are_excluded_from_accuracy_and_gates(scope: Scope, log_copy: Path) -> None:
    evaluation = read_evaluation(log_copy)
    judgement = Judgement(judge="j", prompt="p", verdict="unparseable")
    unparseable = evaluation.trials[0].model_copy(update={"scored_by": "judge", "headline": "unscored", "judgements": (judgement,)})
    trials = (unparseable, *evaluation.trials[1:])
    assert accuracy(trials) == 2 / 3
    assert unscored_lines(trials) == ["unscored   1 without a verdict: the judge's replies were unparseable"]
    found = compare_evaluations(evaluation.model_copy(update={"trials": trials}), evaluation)
    assert (found.unscored_tasks, found.overall.tasks, found.overall.worse) == ((unparseable.task.id,), 3, ())
