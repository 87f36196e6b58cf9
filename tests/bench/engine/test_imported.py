"""Imported tasks run through the same engine; a judge decides where no check applies."""

from __future__ import annotations

import json
from pathlib import Path

from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.engine.regression.gate import gate
from scope_ptz.bench.engine.run_totals import accuracy
from scope_ptz.bench.judging.deciding_judge import decided_by_one_judge, other_judges_note, reported_judge
from scope_ptz.bench.judging.judgement_tally import needs_judgement
from scope_ptz.bench.reports.report_judge import judge_name, verdicts
from scope_ptz.bench.reports.report_runs import ReportRun
from scope_ptz.bench.scoring.trials import Evaluation, Judgement, Trial
from scope_ptz.bench.tasks.imported import ImportedTask
from scope_ptz.bench.tasks.task import RequiredCall
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.cli.bench.progress import unscored_lines
from tests.bench.engine.making import SCENE
from tests.bench.reports.making import card, facts
from tests.bench.reports.making import trial as report_trial
from tests.cli.conftest import Scope
from tests.support.misbehaving import Misbehaving, Say, good


def test_imported_tasks_run_and_are_judged(scope: Scope, tmp_path: Path) -> None:
    facts = TaskFacts(
        id="q-1", dataset="theirs", stratum="imported", scene=SCENE, viewpoint="mast", preset="yard",
        instruction="pan right 20 degrees",
        category="single_call", scope="current", difficulty="easy", expected="The camera has turned.",
    )  # fmt: skip
    task = ImportedTask(facts=facts, line=2, raw={}, calls=(RequiredCall(tool="adjust_ptz"),))
    (tmp_path / "theirs.jsonl").write_text(task.model_dump_json() + "\n")
    run = ("bench", "run", "--tasks", str(tmp_path / "theirs.jsonl"), "--no-pictures", "--out", str(tmp_path / "logs"), "--json")
    done = scope(*run)
    assert done.code == 0, done.err
    # Nothing was scored yet, and that is no share of nothing.
    assert (done.json["not_judged"], done.json["macro"], done.json["micro"], done.json["by_category"]) == (
        1, None, None, {"single_call": None},
    )  # fmt: skip
    plain = scope(*run[:-1]).out
    assert "unscored   1 not judged yet: scope bench rescore" in plain
    assert "%" not in plain.partition("unscored   ")[0]
    log = Path(done.json["log"])
    (trial,) = read_evaluation(log).trials
    assert (trial.headline, trial.scored_by) == ("unscored", "judge")
    assert [(check.name, check.passed) for check in trial.checks] == [("calls", True)]
    said = {"reason": "It turned.", "verdict": "correct", "error_mode": None}
    with Misbehaving(then=good(Say(json.dumps(said)))) as server:
        assert scope("bench", "rescore", str(log), "--judge-url", server.url, "--judge-model", "j").code == 0
    (trial,) = read_evaluation(log).trials
    assert (trial.headline, trial.scored_by, trial.reason) == ("correct", "judge", "It turned.")
    again = scope(*run).json
    assert (again["not_judged"], again["macro"]) == (0, 1.0)
    # Another judge decides nothing, unless it is asked to: neither one that says otherwise nor one whose server is away.
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
    assert scope("bench", "rescore", str(log), "--checks").code == 0, "what is rescored goes on saying who decides"
    assert read_evaluation(log).trials[0].headline == "incorrect"
    assert scope("bench", "rescore", str(log), "--decides", "j").code == 0
    assert scope("bench", "rescore", str(log), "--judge-url", "http://127.0.0.1:1/v1", "--judge-model", "k").code == 1
    (trial,) = read_evaluation(log).trials
    assert (trial.headline, [j.verdict for j in trial.judgements]) == (
        "correct", ["correct", "incorrect", "failed"],
    )  # fmt: skip


def said_by(name: str, verdict: str, prompt: str = "p") -> Judgement:
    mode = "scope" if verdict == "incorrect" else None
    return Judgement.model_validate({"judge": name, "prompt": prompt, "verdict": verdict, "error_mode": mode})


def test_one_judge_decides_on_all_runs_of_a_log(evaluated: Path) -> None:
    first, second, third, fourth = (
        t.model_copy(update={"scored_by": "judge", "headline": "unscored"}) for t in read_evaluation(evaluated).trials
    )
    a, b = said_by("a", "correct"), said_by("b", "incorrect")

    def judged(trial: Trial, *made: Judgement) -> Trial:
        return trial.model_copy(update={"judgements": made})

    # The first judge's server failed on one: another's verdict does not stand in for it, and the run waits for its judge.
    rows = [judged(first, a, b), judged(second, a, b), judged(third, said_by("a", "failed"), b), fourth]
    made = decided_by_one_judge(rows)
    assert [t.headline for t in made] == ["correct", "correct", "unscored", "unscored"]
    assert needs_judgement(made[2]) and needs_judgement(made[3]) and accuracy(made) == 1.0
    assert reported_judge(made) == "a (p)" and "a (p) decides on the 4 runs" in other_judges_note(made)
    named = decided_by_one_judge(rows, "b")
    assert [t.headline for t in named] == ["incorrect", "incorrect", "incorrect", "unscored"]
    assert [t.judgements[0].judge for t in named[:3]] == ["b", "b", "b"]
    assert reported_judge(named) == "b (p)"
    # One model under two prompts is two judges, and a judge that has said nothing yet decides nothing.
    again = [judged(first, a, said_by("a", "incorrect", "q")), judged(second, a)]
    assert [t.headline for t in decided_by_one_judge(again)] == ["correct", "correct"]
    assert [t.headline for t in decided_by_one_judge(again, "a (q)")] == ["incorrect", "unscored"]
    assert [t.headline for t in decided_by_one_judge(again, "nobody")] == ["correct", "correct"]
    broken = judged(first, a).model_copy(update={"headline": "infrastructure"})
    assert decided_by_one_judge([broken])[0].headline == "infrastructure" and other_judges_note([broken]) == ""


def test_a_report_uses_the_deciding_judge_and_not_an_unavailable_one() -> None:
    task = facts(1)[0]

    def run(*made: Judgement, by: str = "judge") -> ReportRun:
        row = report_trial(task, scored_by=by, judgements=made)
        return ReportRun(1, Evaluation(card=card("qwen3-4b", "moondream2"), trials=(row,), wanted=1), "x", None, None)

    a, b, away = said_by("a", "correct"), said_by("b", "incorrect"), said_by("A-phantom", "failed")
    assert judge_name([run(a, b)]) == "a" and judge_name([run(b, a)]) == "b"
    assert judge_name([run(b, a, by="checks")]) == "a"
    assert judge_name([run(away, b, by="checks"), run(away, by="checks")]) == "b"
    assert (judge_name([run(away, by="checks")]), judge_name([run()])) == ("A-phantom", None)
    # What a judge said first where its server had failed before.
    late = a.model_copy(update={"repeat": 1})
    assert verdicts(run(said_by("a", "failed"), late).scored_trials, "a")[0][1] == late


def test_replies_without_a_verdict_are_excluded_from_accuracy_and_gates(scope: Scope, evaluated: Path) -> None:
    evaluation = read_evaluation(evaluated)
    said = Judgement(judge="j", prompt="p", verdict="unparseable")
    mute = evaluation.trials[0].model_copy(update={"scored_by": "judge", "headline": "unscored", "judgements": (said,)})
    trials = (mute, *evaluation.trials[1:])
    assert accuracy(trials) == 2 / 3
    assert unscored_lines(trials) == ["unscored   1 without a verdict: the judge's replies were unparseable"]
    found = gate(evaluation.model_copy(update={"trials": trials}), evaluation)
    assert (found.left_out, found.overall.tasks, found.overall.worse) == ((mute.task.id,), 3, ())
