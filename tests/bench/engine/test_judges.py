"""Judges in the engine: during a run, afterwards, repeatedly, and interrupted; and sweeps over pairs."""

from __future__ import annotations

import io
import json
from collections import Counter
from pathlib import Path

import pytest
from rich.console import Console

from scope_ptz.bench.engine.judgement_journal import Journal
from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.scoring.trials import ModelCard
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.cli.bench.run import sweep_tables
from tests.bench.engine.yard_tasks import TASKS
from tests.cli.conftest import Scope
from tests.support.misbehaving import Exchange, Misbehaving, Say, good, status

INCORRECT = {"reason": "It counted wrongly.", "verdict": "incorrect", "error_mode": "vlm_counting"}
CORRECT = {"reason": "All as asked.", "verdict": "correct", "error_mode": None}


def verdict(request: object) -> Say:
    text = json.dumps(request.data["messages"])  # type: ignore[attr-defined]
    return Say(json.dumps(INCORRECT if "how many blocks" in text else CORRECT))


def test_a_log_is_judged_twice_and_keeps_everything(scope: Scope, log_copy: Path) -> None:
    before = read_evaluation(log_copy)
    with Misbehaving(then=good(verdict)) as server:
        options = ("--judge-url", server.url, "--judge-model", "the-judge")
        first = scope("bench", "rescore", str(log_copy), *options)
        assert first.code == 0, first.err
        assert "4 judgements by the-judge" in first.out
        second = scope("bench", "rescore", str(log_copy), *options)
        assert second.code == 0, second.err
    prompt = next(r.data["messages"][-1]["content"] for r in server.requests if r.chat)
    assert 'Presets of the camera: "yard" (viewpoint "mast")' in prompt
    assert 'Camera afterwards: at viewpoint "mast", pan' in prompt
    after = read_evaluation(log_copy)
    assert [t.headline for t in after.trials] == [t.headline for t in before.trials]
    assert [(j.judge, j.repeat, j.verdict) for j in after.trials[0].judgements] == [
        ("the-judge", 0, "correct"), ("the-judge", 1, "correct"),
    ]  # fmt: skip
    judgement = after.trials[1].judgements[0]
    assert (judgement.verdict, judgement.error_mode, judgement.reason) == ("incorrect", "vlm_counting", "It counted wrongly.")
    assert not Journal.of_log(log_copy).path.exists()  # type: ignore[union-attr]


def test_judgements_before_an_interruption_are_not_repeated(scope: Scope, log_copy: Path) -> None:
    with Misbehaving(then=good(verdict)) as server:
        options = ("--judge-url", server.url, "--judge-model", "the-judge")
        assert scope("bench", "rescore", str(log_copy), *options).code == 0
        trial = read_evaluation(log_copy).trials[0]
        # As left by a killed rescoring: the journal contains the next judgement of one run.
        Journal.of_log(log_copy).add(trial.sample, trial.judgements[0].model_copy(update={"repeat": 1}))
        earlier_requests = len([r for r in server.requests if r.chat])
        assert scope("bench", "rescore", str(log_copy), *options).code == 0
        assert len([r for r in server.requests if r.chat]) - earlier_requests == 3
    assert [len(t.judgements) for t in read_evaluation(log_copy).trials] == [2, 2, 2, 2]


def test_judge_failures_are_counted_separately(scope: Scope, log_copy: Path) -> None:
    with Misbehaving(then=good(Say("I think it went well."))) as server:
        assert scope("bench", "rescore", str(log_copy), "--judge-url", server.url, "--judge-model", "j").code == 0
    assert {j.verdict for t in read_evaluation(log_copy).trials for j in t.judgements} == {"unparseable"}


def test_only_failed_judgements_are_repeated(scope: Scope, log_copy: Path) -> None:
    async def refuse_counting(exchange: Exchange) -> None:
        behaviour = status(401) if "how many" in str(exchange.request.data) else good(verdict)
        await behaviour(exchange)

    for then, verdicts, request_count, code in (
        (refuse_counting, {"correct": 2, "failed": 2}, 4, 1),
        (good(verdict), {"correct": 3, "incorrect": 1}, 2, 0),
    ):
        with Misbehaving(then=then) as server:
            result = scope("bench", "rescore", str(log_copy), "--judge-url", server.url, "--judge-model", "j")
            assert result.code == code, result.err
            assert len([r for r in server.requests if r.chat]) == request_count
        trials = read_evaluation(log_copy).trials
        assert Counter(j.verdict for t in trials for j in t.judgements) == verdicts
    assert {j.repeat for t in trials for j in t.judgements} == {0}


@pytest.mark.full
def test_a_sweep_of_pairs_resumes_and_judges(scope: Scope, tmp_path: Path) -> None:
    dump_tasks(TASKS[2:], tmp_path / "tasks.jsonl")
    options = ("--tasks", str(tmp_path / "tasks.jsonl"), "--out", str(tmp_path / "logs"))
    first = scope("bench", "sweep", "--pairs", "grammar+ground-truth,grammar+noisy", *options)
    assert first.code == 0, first.err
    logs = {read_evaluation(path).card.pair: path for path in (tmp_path / "logs").glob("*.eval")}
    assert set(logs) == {"grammar + ground-truth", "grammar + noisy"}
    second = scope("bench", "sweep", "--pairs", "grammar+ground-truth,grammar+noisy", *options, "--json")
    assert second.code == 0
    assert second.err.count("this evaluation is already complete") == 2
    assert {name: row["micro"] for name, row in second.json.items()} == {"grammar+ground-truth": 1.0, "grammar+noisy": 1.0}


def test_a_pair_without_a_server_does_not_stop_the_others(scope: Scope, tmp_path: Path) -> None:
    dump_tasks(TASKS[2:3], tmp_path / "tasks.jsonl")
    result = scope(
        "bench", "sweep", "--pairs", "qwen3-4b+ground-truth,grammar+ground-truth", "--tasks", str(tmp_path / "tasks.jsonl"),
        "--out", str(tmp_path / "logs"),
    )  # fmt: skip
    assert result.code == 1
    assert "requires a model server" in result.err
    assert "Not run" in result.out
    assert len(list((tmp_path / "logs").glob("*.eval"))) == 1


def test_a_sweep_rejects_unknown_pairs(scope: Scope) -> None:
    for options, text in (
        (("--pairs", "nobody+moondream3"), "There is no planner 'nobody'"),
        ((), "Give the pairs to run"),
        (("--pairs", "a+b", "--paper"), "Give the pairs to run"),
    ):
        result = scope("bench", "sweep", *options)
        assert result.code == 2
        assert text in result.err


def test_reference_planners_and_perception_are_not_ranked_in_a_sweep(log_copy: Path) -> None:
    def table_lines(width: int) -> list[str]:
        console = Console(width=width, file=io.StringIO(), record=True)
        for table in sweep_tables(
            {"small+moondream2": small, "grammar+ground-truth": exact, "big+moondream2": "No server."}, console
        ):
            console.print(table)
        return console.export_text().splitlines()

    exact = read_evaluation(log_copy)
    model = ModelCard(name="small", provider="http")
    small = exact.model_copy(update={"card": exact.card.model_copy(update={"planner": model, "perception": model})})
    narrow, wide = table_lines(80), table_lines(200)

    positions = [next(n for n, line in enumerate(narrow) if text in line) for text in ("best first", "small+", "baselines")]
    positions += [
        next(n for n, line in enumerate(narrow) if text in line) for text in ("grammar+ground-truth", "Not run", "No server.")
    ]
    assert positions == sorted(positions)
    assert not any("counting" in line for line in narrow)
    assert sum("counting" in line for line in wide) == 2


def test_the_pairs_of_the_paper_have_a_short_name() -> None:
    from scope_ptz.cli.bench.run import pair_names

    names = pair_names(None, paper=True)
    assert len(names) == 19
    assert "qwen3-next-80b-a3b+qwen2.5-vl-7b" in names
