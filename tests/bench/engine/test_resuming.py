"""Resuming a killed evaluation neither loses nor repeats runs, and failing servers lose none."""

from __future__ import annotations

import asyncio
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest

from scope_ptz.bench.engine.annotations import check_labels
from scope_ptz.bench.engine.judgement_journal import Journal, journal_file
from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.engine.runs import evaluation_lock
from scope_ptz.bench.engine.sample_files import open_sample
from scope_ptz.bench.judging.human_labels import add_label, labels_file, read_labels
from scope_ptz.bench.judging.rubrics import prompt_version
from scope_ptz.bench.scoring.trials import Judgement, Label
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.cli.bench.label import sample_trials
from scope_ptz.errors import InputError
from tests.bench.engine.yard_tasks import turning_tasks
from tests.cli.conftest import Scope
from tests.support.misbehaving import Behaviour, Exchange, Misbehaving, Request, Say, body, good, malformed, reset, stalls, status

TIMEOUT_S = 240.0


def turning_model(request: Request) -> Say:
    """Reply as a model that turns as instructed and reports it."""
    if request.data["messages"][-1]["role"] == "tool":
        return Say("I have turned.")
    angle = float(instruction_of(request).split()[2])
    return Say("", tool_calls=(("adjust_ptz", {"pan_deg": angle}),))


def instruction_of(request: Request) -> str:
    return next(str(m["content"]) for m in request.data["messages"] if m["role"] == "user")


def slow(behaviour: Behaviour, seconds: float) -> Behaviour:
    async def behave(exchange: Exchange) -> None:
        if exchange.request.chat:
            await asyncio.sleep(seconds)
        await behaviour(exchange)

    return behave


def in_turn(script: list[Behaviour], then: Behaviour) -> Behaviour:
    """Apply the script to chat requests only; other requests get valid replies."""
    remaining = iter(script)

    async def behave(exchange: Exchange) -> None:
        await (next(remaining, then) if exchange.request.chat else good())(exchange)

    return behave


def first_steps(server: Misbehaving) -> Counter[str]:
    """Return how often each task was started."""
    return Counter(instruction_of(r) for r in server.requests if r.chat and r.data["messages"][-1]["role"] == "user")


def wait_for(started: int, server: Misbehaving, process: subprocess.Popen[bytes]) -> None:
    """Wait until ``started`` tasks have started."""
    deadline = time.monotonic() + TIMEOUT_S
    while len(first_steps(server)) < started:
        assert process.poll() is None, "the evaluation ended before it was killed"
        assert time.monotonic() < deadline, "the evaluation did not start enough tasks in time"
        time.sleep(0.05)


@pytest.mark.full
def test_an_evaluation_killed_twice_loses_and_repeats_nothing(
    scope: Scope, scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tasks, logs, concurrency = turning_tasks(9), tmp_path / "logs", 2
    dump_tasks(tasks, tmp_path / "tasks.jsonl")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))  # for files that the engine keeps outside the logs
    with Misbehaving(then=slow(good(turning_model), 0.4)) as server:
        command = [
            "bench", "run", "--tasks", str(tmp_path / "tasks.jsonl"), "--no-pictures", "--out", str(logs),
            "--concurrency", str(concurrency), "--planner-url", server.url, "--planner-model", "m",
        ]  # fmt: skip
        for started in (4, 7):
            process = subprocess.Popen(
                [sys.executable, "-m", "scope_ptz.cli", *command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT
            )
            wait_for(started, server, process)
            process.send_signal(signal.SIGKILL)
            process.communicate()
        last = scope(*command)
        starts = first_steps(server)
    assert last.code == 0, last.err
    assert "Resuming" in last.out
    (log,) = logs.glob("*.eval")
    evaluation = read_evaluation(log)
    assert [trial.task.id for trial in evaluation.trials] == [task.id for task in tasks]
    assert {trial.headline for trial in evaluation.trials} == {"correct"}
    for trial in evaluation.trials:
        assert open_sample(log, trial.sample).trace.ended is not None
    # Only runs in progress when the program was killed were started again.
    assert set(starts) == {task.instruction for task in tasks}
    assert sum(starts.values()) - len(tasks) <= 2 * concurrency


def test_the_same_evaluation_cannot_run_twice_concurrently(tmp_path: Path) -> None:
    with evaluation_lock(tmp_path, "one"):
        with pytest.raises(InputError, match="already running"), evaluation_lock(tmp_path, "one"):
            pass
        with evaluation_lock(tmp_path, "another"):
            pass
    with evaluation_lock(tmp_path, "one"):
        pass


def run(scope: Scope, server: Misbehaving, tasks: Path, logs: Path, *extra: str) -> int:
    return scope(
        "bench", "run", "--tasks", str(tasks), "--no-pictures", "--out", str(logs), "--concurrency", "1", "--planner-url",
        server.url, "--planner-model", "m", "--timeout", "3", *extra,
    ).code  # fmt: skip


@pytest.mark.full
def test_a_misbehaving_server_loses_no_run(scope: Scope, tmp_path: Path) -> None:
    tasks = turning_tasks(11)  # one of them breaks, which is too few to fail the whole log
    dump_tasks(tasks, tmp_path / "tasks.jsonl")
    rate_limited = status(429, headers={"Retry-After": "0"})
    garbage = body('{"choices": [{"message": {"tool_calls": [1]}}]}')
    valid = good(turning_model)
    script = [status(401), rate_limited, rate_limited, valid, valid, malformed(), valid, reset(), valid, garbage]
    with Misbehaving(then=in_turn(script, valid)) as server:
        code = run(scope, server, tmp_path / "tasks.jsonl", tmp_path / "logs", "--price", "1,2")
        assert code == 1
        (log,) = (tmp_path / "logs").glob("*.eval")
        first = read_evaluation(log)
        # The log contains every requested run. Runs that the server broke are counted separately and excluded from accuracy.
        assert len(first.trials) == 11
        broken = [trial for trial in first.trials if trial.headline == "infrastructure"]
        assert len(broken) == 1
        assert "unauthorised" in broken[0].reason
        priced = next(trial for trial in first.trials if trial.headline == "correct")
        assert priced.cost_usd == pytest.approx((priced.input_tokens + 2 * priced.output_tokens) / 1e6)
        events = Counter[str]()
        for trial in first.trials:
            events.update(trial.server_events)
        assert events["rate-limited"] == 2
        assert events["unauthorised"] == 1
        assert events["malformed"] >= 1
        # Running the same command again repeats only the broken run.
        before = len([r for r in server.requests if r.chat])
        assert run(scope, server, tmp_path / "tasks.jsonl", tmp_path / "logs") == 0
        assert len([r for r in server.requests if r.chat]) - before == 2
    (log,) = (tmp_path / "logs").glob("*.eval")
    assert {trial.headline for trial in read_evaluation(log).trials} == {"correct"}


def test_a_dead_server_stops_the_evaluation(scope: Scope, tmp_path: Path) -> None:
    dump_tasks(turning_tasks(30), tmp_path / "tasks.jsonl")
    with Misbehaving(then=in_turn([], status(401))) as server:
        result = scope(
            "bench", "run", "--tasks", str(tmp_path / "tasks.jsonl"), "--no-pictures", "--out", str(tmp_path / "logs"),
            "--concurrency", "1", "--planner-url", server.url, "--planner-model", "m",
        )  # fmt: skip
        assert len([r for r in server.requests if r.chat]) < 20
    assert result.code == 1
    assert "12 consecutive runs with infrastructure failures" in result.err
    assert f"The model server at {server.url} rejected the API key. Set the key for this server" in result.err
    (log,) = (tmp_path / "logs").glob("*.eval")
    assert {trial.headline for trial in read_evaluation(log).trials} == {"infrastructure"}


def test_a_stalling_server_is_an_outcome(scope: Scope, tmp_path: Path) -> None:
    dump_tasks(turning_tasks(1), tmp_path / "tasks.jsonl")
    with Misbehaving(then=in_turn([], stalls())) as server:
        code = run(scope, server, tmp_path / "tasks.jsonl", tmp_path / "logs", "--timeout", "0.5")
    assert code == 1
    (log,) = (tmp_path / "logs").glob("*.eval")
    (trial,) = read_evaluation(log).trials
    assert trial.headline == "infrastructure"
    assert trial.tool_calls == {}


@pytest.mark.full
def test_labels_are_kept_with_reused_runs(scope: Scope, tmp_path: Path) -> None:
    tasks, logs = turning_tasks(11), tmp_path / "logs"
    dump_tasks(tasks, tmp_path / "tasks.jsonl")
    valid = good(turning_model)
    with Misbehaving(then=in_turn([valid, valid, status(401)], valid)) as server:
        assert run(scope, server, tmp_path / "tasks.jsonl", logs) == 1
        (old,) = logs.glob("*.eval")
        first = read_evaluation(old)
        broken = next(trial for trial in first.trials if trial.headline == "infrastructure")
        reused = next(trial for trial in first.trials if trial.headline == "correct")
        # A run that infrastructure broke is repeated, so it is not offered for labelling, and its label is dropped.
        assert (
            broken.sample not in {trial.sample for trial in sample_trials(first, None, 1)}
            and len(sample_trials(first, None, 1)) == 10
        )
        for sample, verdict in ((reused.sample, "correct"), (reused.sample, "unclear"), (broken.sample, "incorrect")):
            mode = "scope" if verdict == "incorrect" else None
            add_label(labels_file(old), Label.model_validate({"by": "ann", "verdict": verdict, "error_mode": mode}), sample)
        judgement = Judgement(judge="j", prompt=prompt_version(), verdict="correct")
        Journal.of_log(old).add(reused.sample, judgement)  # as left by a killed rescoring
        assert run(scope, server, tmp_path / "tasks.jsonl", logs) == 0
    (new,) = logs.glob("*.eval")
    assert new != old
    assert [(row.sample, row.verdict) for row in read_labels(labels_file(new))] == [(reused.sample, "unclear")]
    assert Journal.of_log(new).find(reused.sample, "j", 0) == judgement
    # The labels of the old log are unchanged.
    superseded = logs / "superseded" / old.name
    assert superseded.is_file() and len(read_labels(labels_file(superseded))) == 2
    assert sorted(path.name for path in logs.glob("*.jsonl")) == sorted([labels_file(new).name, journal_file(new).name])
    comparison = scope("bench", "label", str(new), "--compare")
    assert comparison.code == 0 and "1 unclear" in comparison.out
    # A damaged line is reported before anything runs.
    labels_file(new).write_text("nonsense\n", "utf-8")
    with pytest.raises(InputError, match="line 1 is not a valid label"):
        check_labels([new])
