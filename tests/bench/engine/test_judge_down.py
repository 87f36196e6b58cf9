"""An unavailable judge or invalid replies never count as success, and repeating the command adds missing verdicts."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scope_ptz.bench.engine.judgement_journal import Journal
from scope_ptz.bench.engine.logs import read_evaluation, uuids_in
from scope_ptz.bench.judging.judgement_tally import JudgementTally, judge_of_every_run
from scope_ptz.bench.judging.rubrics import prompt_version
from scope_ptz.bench.scoring.trials import Judgement
from tests.bench.engine.test_judges import verdict
from tests.cli.conftest import Scope
from tests.support.misbehaving import Behaviour, Exchange, Misbehaving, Say, body, good, status

UNREACHABLE_URL = "http://127.0.0.1:1/v1"


def run(scope: Scope, tasks: Path, out: Path, *judge: str) -> tuple[int, str, str]:
    result = scope("bench", "run", "--tasks", str(tasks), "--no-pictures", "--out", str(out), *judge)
    return result.code, result.out, result.err


def test_rescoring_with_an_unavailable_judge_fails_and_can_be_repeated(scope: Scope, log_copy: Path) -> None:
    failure = scope("bench", "rescore", str(log_copy), "--judge-url", UNREACHABLE_URL, "--judge-model", "j")
    assert failure.code == 1
    assert "4 judgements by j: 0 with a verdict, 0 unparseable, 4 failed" in failure.out
    assert "4 of 4 judgements failed because the judge's server gave no usable reply" in failure.err
    assert "127.0.0.1:1" in failure.err and "Start it, or check its URL." in failure.err
    assert "running the same command again retries them" in failure.err
    with Misbehaving(then=good(verdict)) as server:
        success = scope("bench", "rescore", str(log_copy), "--judge-url", server.url, "--judge-model", "j")
    assert success.code == 0, success.err
    assert "4 judgements by j: 4 with a verdict, 0 unparseable, 0 failed" in success.out
    assert [[j.verdict for j in t.judgements] for t in read_evaluation(log_copy).trials] == [
        ["correct"], ["incorrect"], ["correct"], ["correct"],
    ]  # fmt: skip


def test_invalid_replies_are_counted_but_are_not_server_failures(scope: Scope, log_copy: Path) -> None:
    with Misbehaving(then=good(Say("I think it went well."))) as server:
        result = scope("bench", "rescore", str(log_copy), "--judge-url", server.url, "--judge-model", "j")
    assert result.code == 0, result.err
    assert "4 judgements by j: 0 with a verdict, 4 unparseable, 0 failed" in result.out


@pytest.mark.full
def test_a_run_whose_judge_is_unavailable_is_not_complete(scope: Scope, tasks_file: Path, tmp_path: Path) -> None:
    code, out, err = run(scope, tasks_file, tmp_path, "--judge-url", UNREACHABLE_URL, "--judge-model", "j")
    assert code == 1
    assert "judge      j: 0 with a verdict, 0 unparseable, 4 failed" in out
    assert "Start it, or check its URL." in err and "scope bench rescore" in err
    (log,) = tmp_path.glob("*.eval")
    runs = uuids_in(log)

    async def refuse_counting(exchange: Exchange) -> None:
        behaviour = status(401) if "how many" in str(exchange.request.data) else good(verdict)
        await behaviour(exchange)

    with Misbehaving(then=refuse_counting) as server:
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
    # The agent was not run again, and a judge with complete verdicts is not called, even if its server is unreachable.
    assert list(tmp_path.glob("*.eval")) == [log] and uuids_in(log) == runs
    for judge in (("--judge-url", UNREACHABLE_URL, "--judge-model", "j"), ("--judge-url", UNREACHABLE_URL)):
        code, out, err = run(scope, tasks_file, tmp_path, *judge)
        assert (code, "4 with a verdict" in out, "missing" in err) == (0, True, False)
    assert f"The judge's server at {UNREACHABLE_URL} did not report the name of its model" in err
    assert "j has already judged every run" in err


def test_an_unavailable_judge_changes_no_log(scope: Scope, log_copy: Path, tasks_file: Path, tmp_path: Path) -> None:
    before = log_copy.read_bytes()
    failure = scope("bench", "rescore", str(log_copy), "--judge-url", UNREACHABLE_URL)
    assert failure.code == 1 and "nothing was judged" in failure.err and "Start it, or check its URL." in failure.err
    assert log_copy.read_bytes() == before
    code, _, err = run(scope, tasks_file, tmp_path / "new", "--judge-url", UNREACHABLE_URL)
    assert code == 1 and "nothing was judged" in err and not list((tmp_path / "new").glob("*.eval"))


def models_then_verdicts(*names: str) -> Behaviour:
    listing = body(json.dumps({"object": "list", "data": [{"id": name} for name in names]}))

    async def behave(exchange: Exchange) -> None:
        await (good(verdict) if exchange.request.chat else listing)(exchange)

    return behave


@pytest.mark.full
def test_a_second_judge_is_called_although_the_first_is_complete(scope: Scope, tasks_file: Path, tmp_path: Path) -> None:
    for name in ("judge-a", "judge-b"):
        with Misbehaving(then=models_then_verdicts(name)) as server:
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


def test_verdicts_of_another_judge_are_resumed_by_its_own_command(scope: Scope, log_copy: Path) -> None:
    trial = read_evaluation(log_copy).trials[0]
    stored = Judgement(judge="a", prompt=prompt_version(), verdict="correct", reason="Kept.")
    Journal.of_log(log_copy).add(trial.sample, stored)  # as left by a killed rescoring by "a"
    with Misbehaving(then=good(verdict)) as server:
        for judge, request_count in (("b", 4), ("a", 4 + 3)):
            assert scope("bench", "rescore", str(log_copy), "--judge-url", server.url, "--judge-model", judge).code == 0
            assert len([r for r in server.requests if r.chat]) == request_count
    assert stored in read_evaluation(log_copy).trials[0].judgements
    assert not list(log_copy.parent.glob("*.jsonl*"))


def test_summaries_of_judgements(log_copy: Path) -> None:
    def judgement(verdict: str, **values: object) -> Judgement:
        return Judgement.model_validate({"judge": "j", "prompt": prompt_version(), "verdict": verdict, **values})

    tally = JudgementTally.of(
        [judgement("correct"), judgement("failed", reason="No route\nto it."), judgement("failed", reason="x")]
    )
    tally += JudgementTally.of([judgement("unparseable"), judgement("incorrect", error_mode="scope")])
    assert (tally.summary, tally.total, tally.failure) == ("2 with a verdict, 1 unparseable, 2 failed", 5, "No route to it.")
    first, second, *_ = read_evaluation(log_copy).trials
    judged_trials = [t.model_copy(update={"judgements": (judgement("unparseable"),)}) for t in (first, second)]
    half = [judged_trials[0], second.model_copy(update={"judgements": (judgement("failed"),)})]
    assert [judge_of_every_run(judged_trials, name, 1) for name in ("", "j", "k")] == ["j", "j", None]
    assert judge_of_every_run(judged_trials, "", 2) is None
    assert judge_of_every_run(half, "", 1) is None
    broken = half[1].model_copy(update={"headline": "infrastructure"})
    assert judge_of_every_run([judged_trials[0], broken], "", 1) == "j"
