"""An unavailable judge or one with invalid replies is never a success, and repeating the command adds missing verdicts."""

from __future__ import annotations

import json
from pathlib import Path

from scope_ptz.bench.engine.judgement_journal import Journal
from scope_ptz.bench.engine.logs import read_evaluation, uuids_in
from scope_ptz.bench.judging.judgement_tally import JudgementTally, judged_by
from scope_ptz.bench.judging.rubrics import prompt_version
from scope_ptz.bench.scoring.trials import Judgement
from tests.bench.engine.test_judges import verdict
from tests.cli.conftest import Scope
from tests.support.misbehaving import Behaviour, Exchange, Misbehaving, Say, body, good, status

AWAY = "http://127.0.0.1:1/v1"


def run(scope: Scope, tasks: Path, out: Path, *judge: str) -> tuple[int, str, str]:
    done = scope("bench", "run", "--tasks", str(tasks), "--no-pictures", "--out", str(out), *judge)
    return done.code, done.out, done.err


def test_rescoring_with_an_unavailable_judge_fails_and_can_be_repeated(scope: Scope, evaluated: Path) -> None:
    down = scope("bench", "rescore", str(evaluated), "--judge-url", AWAY, "--judge-model", "j")
    assert down.code == 1
    assert "4 judgements by j: 0 with a verdict, 0 unparseable, 4 failed" in down.out
    assert "4 of 4 judgements failed because the judge's server gave no usable reply" in down.err
    assert "127.0.0.1:1" in down.err and "Start it, or check the address." in down.err
    assert "running the same command again retries them" in down.err
    with Misbehaving(then=good(verdict)) as server:
        up = scope("bench", "rescore", str(evaluated), "--judge-url", server.url, "--judge-model", "j")
    assert up.code == 0, up.err
    assert "4 judgements by j: 4 with a verdict, 0 unparseable, 0 failed" in up.out
    assert [[j.verdict for j in t.judgements] for t in read_evaluation(evaluated).trials] == [
        ["correct"], ["incorrect"], ["correct"], ["correct"],
    ]  # fmt: skip


def test_invalid_replies_are_counted_but_are_not_server_failures(scope: Scope, evaluated: Path) -> None:
    with Misbehaving(then=good(Say("I think it went well."))) as server:
        done = scope("bench", "rescore", str(evaluated), "--judge-url", server.url, "--judge-model", "j")
    assert done.code == 0, done.err
    assert "4 judgements by j: 0 with a verdict, 4 unparseable, 0 failed" in done.out


def test_a_run_whose_judge_is_unavailable_is_not_complete(scope: Scope, tasks_file: Path, tmp_path: Path) -> None:
    code, out, err = run(scope, tasks_file, tmp_path, "--judge-url", AWAY, "--judge-model", "j")
    assert code == 1
    assert "judge      j: 0 with a verdict, 0 unparseable, 4 failed" in out
    assert "Start it, or check the address." in err and "scope bench rescore" in err
    (log,) = tmp_path.glob("*.eval")
    runs = uuids_in(log)

    async def half(exchange: Exchange) -> None:
        behaviour = status(401) if "how many" in str(exchange.request.data) else good(verdict)
        await behaviour(exchange)

    with Misbehaving(then=half) as server:
        code, out, err = run(scope, tasks_file, tmp_path, "--judge-url", server.url, "--judge-model", "j")
        assert code == 1
    assert "4 of 4 judgements by j are missing" in err
    assert "2 of 4 judgements failed" in err
    with Misbehaving(then=good(verdict)) as server:
        code, out, err = run(scope, tasks_file, tmp_path, "--judge-url", server.url, "--judge-model", "j")
        assert code == 0, err
        assert len([r for r in server.requests if r.chat]) == 2
    assert "this evaluation is already complete" in err
    assert "judge      j: 4 with a verdict, 0 unparseable, 0 failed" in out
    # The agent was not run again, and a judge that has said everything is not asked, wherever it is.
    assert list(tmp_path.glob("*.eval")) == [log] and uuids_in(log) == runs
    for judge in (("--judge-url", AWAY, "--judge-model", "j"), ("--judge-url", AWAY)):
        code, out, err = run(scope, tasks_file, tmp_path, *judge)
        assert (code, "4 with a verdict" in out, "missing" in err) == (0, True, False)
    assert f"The judge's server at {AWAY} did not report the name of its model" in err
    assert "j has already judged every run" in err


def test_an_unavailable_judge_changes_no_log(scope: Scope, evaluated: Path, tasks_file: Path, tmp_path: Path) -> None:
    before = evaluated.read_bytes()
    gone = scope("bench", "rescore", str(evaluated), "--judge-url", AWAY)
    assert gone.code == 1 and "nothing was judged" in gone.err and "Start it, or check the address." in gone.err
    assert evaluated.read_bytes() == before
    code, _, err = run(scope, tasks_file, tmp_path / "new", "--judge-url", AWAY)
    assert code == 1 and "nothing was judged" in err and not list((tmp_path / "new").glob("*.eval"))


def served(*names: str) -> Behaviour:
    listing = body(json.dumps({"object": "list", "data": [{"id": name} for name in names]}))

    async def behave(exchange: Exchange) -> None:
        await (good(verdict) if exchange.request.chat else listing)(exchange)

    return behave


def test_a_second_judge_is_asked_although_the_first_is_complete(scope: Scope, tasks_file: Path, tmp_path: Path) -> None:
    for name in ("judge-a", "judge-b"):
        with Misbehaving(then=served(name)) as server:
            code, out, err = run(scope, tasks_file, tmp_path, "--judge-url", server.url)
            assert code == 0, err
            assert len([r for r in server.requests if r.chat]) == 4
        assert f"judge      {name}: 4 with a verdict" in out
    (log,) = tmp_path.glob("*.eval")
    assert {tuple(j.judge for j in t.judgements) for t in read_evaluation(log).trials} == {("judge-a", "judge-b")}


def test_an_evaluation_that_was_run_without_a_judge_is_judged_by_the_same_command(
    scope: Scope, tasks_file: Path, tmp_path: Path
) -> None:
    assert run(scope, tasks_file, tmp_path)[0] == 0
    with Misbehaving(then=good(verdict)) as server:
        judge = ("--judge-url", server.url, "--judge-model", "j", "--judge-repeats", "2")
        code, out, err = run(scope, tasks_file, tmp_path, *judge)
    assert code == 0, err
    assert "8 of 8 judgements by j are missing" in err
    assert "judge      j: 8 with a verdict" in out
    (log,) = tmp_path.glob("*.eval")
    assert [[j.repeat for j in t.judgements] for t in read_evaluation(log).trials] == [[0, 1]] * 4


def test_verdicts_of_another_judge_are_resumed_by_its_own_command(scope: Scope, evaluated: Path) -> None:
    trial = read_evaluation(evaluated).trials[0]
    said = Judgement(judge="a", prompt=prompt_version(), verdict="correct", reason="Kept.")
    Journal.of_log(evaluated).add(trial.sample, said)  # as a rescoring by "a" that was killed leaves it
    with Misbehaving(then=good(verdict)) as server:
        for judge, asked in (("b", 4), ("a", 4 + 3)):
            assert scope("bench", "rescore", str(evaluated), "--judge-url", server.url, "--judge-model", judge).code == 0
            assert len([r for r in server.requests if r.chat]) == asked
    assert said in read_evaluation(evaluated).trials[0].judgements
    assert not list(evaluated.parent.glob("*.jsonl*"))


def test_summaries_of_judgements(evaluated: Path) -> None:
    def judgement(verdict: str, **values: object) -> Judgement:
        return Judgement.model_validate({"judge": "j", "prompt": prompt_version(), "verdict": verdict, **values})

    told = JudgementTally.of(
        [judgement("correct"), judgement("failed", reason="No route\nto it."), judgement("failed", reason="x")]
    )
    told += JudgementTally.of([judgement("unparseable"), judgement("incorrect", error_mode="scope")])
    assert (told.summary, told.total, told.failure) == ("2 with a verdict, 1 unparseable, 2 failed", 5, "No route to it.")
    first, second, *_ = read_evaluation(evaluated).trials
    whole = [t.model_copy(update={"judgements": (judgement("unparseable"),)}) for t in (first, second)]
    half = [whole[0], second.model_copy(update={"judgements": (judgement("failed"),)})]
    assert [judged_by(whole, name, 1) for name in ("", "j", "k")] == ["j", "j", None]
    assert judged_by(whole, "", 2) is None
    assert judged_by(half, "", 1) is None
    broken = half[1].model_copy(update={"headline": "infrastructure"})
    assert judged_by([whole[0], broken], "", 1) == "j"
