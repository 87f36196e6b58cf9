"""The whole machinery against real serving code: a sweep of two pairs that is killed, goes on, is judged twice and reported."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.expected import ActionOnly
from scope_ptz.bench.splits import load_split
from scope_ptz.bench.task_files import dump_tasks
from scope_ptz.bench.tasks import Behaviour, FinalPose, ProgramCall, Task
from scope_ptz.planner.chat.conformance import TURN
from tests.bench.engine.making import SCENE, task
from tests.cli.conftest import Scope
from tests.full.test_served_models import Served, eyes_server, planner_server

__all__ = ["eyes_server", "planner_server"]

pytestmark = [
    pytest.mark.full,
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::FutureWarning"),
    pytest.mark.filterwarnings("ignore::UserWarning"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]

MINE = """
models:
  tiny-planner: {{repo: {planner.model}, url: '{planner.url}', roles: [planner], size_b: 0.001, active_b: 0.001, precision: fp32,
    context: 16384, licence: none}}
  tiny-eyes: {{repo: {eyes.model}, url: '{eyes.url}', roles: [eyes], backend: openai_vision, coordinates: qwen3-vl, size_b: 0.001,
    active_b: 0.001, precision: fp32, context: 2048, licence: none}}
"""
PAIRS = "tiny-planner+tiny-eyes,tiny-planner+ground-truth"
PATIENCE_S = 400.0


def turning() -> Task:
    """What the tiny planner has learned to do, word for word."""
    behaviour = Behaviour(final=FinalPose(viewpoint="mast", pan_deg=20.0, tilt_deg=-8.0, zoom=1.0))
    call = ProgramCall(tool="adjust_ptz", arguments={"pan_deg": 20})
    return task(1, "single_call", TURN, ActionOnly(), call, behaviour=behaviour, needs=("move",))


def test_a_sweep_on_checkpoints_is_killed_goes_on_is_judged_and_reported(
    scope: Scope, planner_server: Served, eyes_server: Served, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mine, tasks, logs = tmp_path / "models.yaml", tmp_path / "tasks.jsonl", tmp_path / "logs"
    mine.write_text(MINE.format(planner=planner_server, eyes=eyes_server))
    dump_tasks((turning(), *load_split("lite")), tasks)
    monkeypatch.setenv("SCOPE_MODELS", str(mine))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    sweep = ("bench", "sweep", "--pairs", PAIRS, "--tasks", str(tasks), "--out", str(logs), "--concurrency", "1")
    process = subprocess.Popen([sys.executable, "-m", "scope_ptz.cli", *sweep], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    deadline = time.monotonic() + PATIENCE_S
    while not any(logs.glob("*.eval")):
        assert process.poll() is None, process.communicate()[0].decode()
        assert time.monotonic() < deadline, "no log in time"
        time.sleep(0.1)
    process.send_signal(signal.SIGKILL)
    process.communicate()

    done = scope(*sweep)
    assert done.code == 0, done.err
    found = {read_evaluation(path).card.pair: path for path in logs.glob("*.eval")}
    assert set(found) == {"tiny-planner + tiny-eyes", "tiny-planner + ground-truth"}
    for path in found.values():
        evaluation = read_evaluation(path)
        assert evaluation.finished
        assert len(evaluation.trials) == 1 + len(load_split("lite"))
        headlines = {trial.task.instruction: trial.headline for trial in evaluation.trials}
        assert headlines[TURN] == "correct"
        assert "infrastructure" not in headlines.values()
        assert evaluation.card.planner.reported
        assert all(trial.input_tokens > 0 for trial in evaluation.trials)

    judge = ("--judge-url", planner_server.url, "--judge-model", planner_server.model, "--judge-option", "max_tokens=64")
    for _ in range(2):
        judged = scope("bench", "rescore", *map(str, found.values()), *judge)
        assert judged.code == 0, judged.err
    for path in found.values():
        # A model of a few hundred thousand parameters gives no verdicts; what it says is counted apart, and changes nothing.
        rows = [trial.judgements for trial in read_evaluation(path).trials]
        assert {judgement.verdict for row in rows for judgement in row} <= {"unparseable", "failed"}
        assert all(row for row in rows)

    report = scope("bench", "report", *map(str, found.values()), "--out", str(tmp_path / "report"))
    assert report.code == 0, report.err
    assert "tiny-planner" in (tmp_path / "report" / "index.html").read_text("utf-8")
    assert (
        scope("bench", "gate", str(found["tiny-planner + tiny-eyes"]), "--baseline", str(found["tiny-planner + ground-truth"])).code
        == 0
    )
    assert SCENE in evaluation.trials[0].task.scene
