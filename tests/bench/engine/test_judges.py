"""Judges in the engine: during a run, afterwards, repeatedly, and interrupted; and sweeps over pairs."""

from __future__ import annotations

import io
import json
from collections import Counter
from pathlib import Path

from rich.console import Console

from scope_ptz.bench.engine.judgement_journal import Journal
from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.scoring.trials import ModelCard
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.cli.bench.sweep import sweep_tables
from tests.bench.engine.making import TASKS
from tests.cli.conftest import Scope
from tests.support.misbehaving import Exchange, Misbehaving, Say, good, status

CONDEMNED = {"reason": "It counted wrongly.", "verdict": "incorrect", "error_mode": "vlm_counting"}
PASSED = {"reason": "All as asked.", "verdict": "correct", "error_mode": None}


def verdict(request: object) -> Say:
    text = json.dumps(request.data["messages"])  # type: ignore[attr-defined]
    return Say(json.dumps(CONDEMNED if "how many blocks" in text else PASSED))


def test_a_log_is_judged_twice_and_keeps_everything(scope: Scope, evaluated: Path) -> None:
    before = read_evaluation(evaluated)
    with Misbehaving(then=good(verdict)) as server:
        options = ("--judge-url", server.url, "--judge-model", "the-judge")
        first = scope("bench", "rescore", str(evaluated), *options)
        assert first.code == 0, first.err
        assert "4 judgements by the-judge" in first.out
        second = scope("bench", "rescore", str(evaluated), *options)
        assert second.code == 0, second.err
    told = next(r.data["messages"][-1]["content"] for r in server.requests if r.chat)
    assert 'Presets of the camera: "yard" (viewpoint "mast")' in told
    assert 'Camera afterwards: at viewpoint "mast", pan' in told
    after = read_evaluation(evaluated)
    assert [t.headline for t in after.trials] == [t.headline for t in before.trials]
    assert [(j.judge, j.repeat, j.verdict) for j in after.trials[0].judgements] == [
        ("the-judge", 0, "correct"), ("the-judge", 1, "correct"),
    ]  # fmt: skip
    condemned = after.trials[1].judgements[0]
    assert (condemned.verdict, condemned.error_mode, condemned.reason) == ("incorrect", "vlm_counting", "It counted wrongly.")
    assert not Journal.of_log(evaluated).path.exists()  # type: ignore[union-attr]


def test_judgements_before_an_interruption_are_not_repeated(scope: Scope, evaluated: Path) -> None:
    with Misbehaving(then=good(verdict)) as server:
        options = ("--judge-url", server.url, "--judge-model", "the-judge")
        assert scope("bench", "rescore", str(evaluated), *options).code == 0
        trial = read_evaluation(evaluated).trials[0]
        # As a rescoring that was killed leaves it: the next judgement of one run stands in the journal.
        Journal.of_log(evaluated).add(trial.sample, trial.judgements[0].model_copy(update={"repeat": 1}))
        asked = len([r for r in server.requests if r.chat])
        assert scope("bench", "rescore", str(evaluated), *options).code == 0
        assert len([r for r in server.requests if r.chat]) - asked == 3
    assert [len(t.judgements) for t in read_evaluation(evaluated).trials] == [2, 2, 2, 2]


def test_judge_failures_are_counted_separately(scope: Scope, evaluated: Path) -> None:
    with Misbehaving(then=good(Say("I think it went well."))) as server:
        assert scope("bench", "rescore", str(evaluated), "--judge-url", server.url, "--judge-model", "j").code == 0
    assert {j.verdict for t in read_evaluation(evaluated).trials for j in t.judgements} == {"unparseable"}


def test_only_failed_judgements_are_repeated(scope: Scope, evaluated: Path) -> None:
    async def half(exchange: Exchange) -> None:
        behaviour = status(401) if "how many" in str(exchange.request.data) else good(verdict)
        await behaviour(exchange)

    for then, verdicts, asks, code in (
        (half, {"correct": 2, "failed": 2}, 4, 1),
        (good(verdict), {"correct": 3, "incorrect": 1}, 2, 0),
    ):
        with Misbehaving(then=then) as server:
            done = scope("bench", "rescore", str(evaluated), "--judge-url", server.url, "--judge-model", "j")
            assert done.code == code, done.err
            assert len([r for r in server.requests if r.chat]) == asks
        trials = read_evaluation(evaluated).trials
        assert Counter(j.verdict for t in trials for j in t.judgements) == verdicts
    assert {j.repeat for t in trials for j in t.judgements} == {0}


def test_a_sweep_of_pairs_resumes_and_judges(scope: Scope, tmp_path: Path) -> None:
    dump_tasks(TASKS[2:], tmp_path / "tasks.jsonl")
    options = ("--tasks", str(tmp_path / "tasks.jsonl"), "--out", str(tmp_path / "logs"))
    first = scope("bench", "sweep", "--pairs", "grammar+ground-truth,grammar+noisy", *options)
    assert first.code == 0, first.err
    logs = {read_evaluation(path).card.pair: path for path in (tmp_path / "logs").glob("*.eval")}
    assert set(logs) == {"grammar + ground-truth", "grammar + noisy"}
    again = scope("bench", "sweep", "--pairs", "grammar+ground-truth,grammar+noisy", *options, "--json")
    assert again.code == 0
    assert again.err.count("this evaluation is already complete") == 2
    assert {name: row["micro"] for name, row in again.json.items()} == {"grammar+ground-truth": 1.0, "grammar+noisy": 1.0}


def test_a_pair_without_a_server_does_not_stop_the_others(scope: Scope, tmp_path: Path) -> None:
    dump_tasks(TASKS[2:3], tmp_path / "tasks.jsonl")
    done = scope(
        "bench", "sweep", "--pairs", "qwen3-4b+ground-truth,grammar+ground-truth", "--tasks", str(tmp_path / "tasks.jsonl"),
        "--out", str(tmp_path / "logs"),
    )  # fmt: skip
    assert done.code == 1
    assert "runs on a model server" in done.err
    assert "Not run" in done.out
    assert len(list((tmp_path / "logs").glob("*.eval"))) == 1


def test_a_sweep_rejects_unknown_pairs(scope: Scope) -> None:
    for options, words in (
        (("--pairs", "nobody+moondream3"), "There is no planner 'nobody'"),
        ((), "Give the pairs to run"),
        (("--pairs", "a+b", "--paper"), "Give the pairs to run"),
    ):
        done = scope("bench", "sweep", *options)
        assert done.code == 2
        assert words in done.err


def test_reference_planners_and_perception_are_not_ranked_in_a_sweep(evaluated: Path) -> None:
    def drawn(width: int) -> list[str]:
        console = Console(width=width, file=io.StringIO(), record=True)
        for table in sweep_tables(
            {"small+moondream2": small, "grammar+ground-truth": exact, "big+moondream2": "No server."}, width
        ):
            console.print(table)
        return console.export_text().splitlines()

    exact = read_evaluation(evaluated)
    model = ModelCard(name="small", provider="http")
    small = exact.model_copy(update={"card": exact.card.model_copy(update={"planner": model, "perception": model})})
    narrow, wide = drawn(80), drawn(200)

    def first(words: str) -> int:
        return next(number for number, line in enumerate(narrow) if words in line)

    places = [next(n for n, line in enumerate(narrow) if words in line) for words in ("best first", "small+", "baselines")]
    places += [
        next(n for n, line in enumerate(narrow) if words in line) for words in ("grammar+ground-truth", "Not run", "No server.")
    ]
    assert places == sorted(places)
    assert not any("counting" in line for line in narrow)
    assert sum("counting" in line for line in wide) == 2


def test_the_pairs_of_the_paper_have_a_short_name() -> None:
    from scope_ptz.cli.bench.sweep import pair_names

    names = pair_names(None, paper=True)
    assert len(names) == 19
    assert "qwen3-next-80b-a3b+qwen2.5-vl-7b" in names
