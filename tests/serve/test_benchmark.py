"""Evaluations through the API. A script replaces ``scope bench``; tests of the full tier run the real program."""

from __future__ import annotations

import json
import os
import signal
import sys
import textwrap
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx2
import pytest

from scope_ptz.bench.reports.progress_state import LOCK_FILE, STATE_FILE, TRIALS_FILE, ProgressState, Score
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.bench.tasks.splits import load_split
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.serve.security.access import Access
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.site.benchmark.evaluation_folder import EvaluationFolder
from scope_ptz.serve.site.benchmark.evaluations import EvaluationRequest, Evaluations
from scope_ptz.serve.site.errors import EvaluationRunningError
from scope_ptz.serve.site.site import SiteOptions
from tests.serve.conftest import SPEC
from tests.serve.serving import CAMERA, Served, serving

SCRIPT = """
import fcntl, json, os, pathlib, signal, sys, time
arguments = sys.argv[1:]
option = lambda name: pathlib.Path(arguments[arguments.index(name) + 1])
if arguments[:2] == ["bench", "report"]:
    out = option("--out")
    for folder in ("tasks", "frames", "tables"):
        (out / folder).mkdir(parents=True, exist_ok=True)
    (out / "tasks" / "one.html").write_text("<p>one</p>")
    (out / "index.html").write_text("<h1>report</h1><a href='tasks/one.html'>one</a>")
    sys.exit()
progress = option("--progress")
progress.mkdir(parents=True, exist_ok=True)
lock = (progress / "progress.lock").open("w")
fcntl.flock(lock, fcntl.LOCK_EX)
(option("--out")).mkdir(exist_ok=True)
(option("--out") / "log.eval").write_text("no log")
state = {"pid": os.getpid(), "runs": 2, "done": 1, "correct": 0, "incorrect": 1}
(progress / "arguments.json").write_text(json.dumps(arguments))
(progress / "trials.jsonl").write_bytes(pathlib.Path(os.environ["FAKE_TRIALS"]).read_bytes() + b'{"half a li')
(progress / "progress.json").write_text(json.dumps(state))
mode = pathlib.Path(os.environ["FAKE_MODE"]).read_text()
if mode == "stubborn":
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
if mode == "error":
    (progress / "progress.json").unlink()
    sys.exit("scope: The model is not configured.")
while pathlib.Path(os.environ["FAKE_MODE"]).read_text() != "end":
    time.sleep(0.02)
(progress / "progress.json").write_text(json.dumps({**state, "done": 2, "correct": 1, "finished": True, "log": "log.eval"}))
"""


def until(condition: Callable[[], Any], seconds: float = 30.0) -> Any:
    """Wait until a condition returns a true value, and return the value."""
    deadline = time.monotonic() + seconds
    while not (value := condition()):
        assert time.monotonic() < deadline, "the condition did not become true"
        time.sleep(0.02)
    return value


@pytest.fixture(scope="module")
def trial() -> Trial:
    """A failed run of a published task."""
    task = load_split("lite")[0]
    return Trial(
        task=facts_of(task, "somewhere"),
        sample=f"{task.id}#1",
        headline="incorrect",
        reason="the answer is wrong",
        error_mode=ErrorMode.VLM_QUERY,
        outcome="answered",
        answer="There are 3.",
    )


@pytest.fixture
def mode(tmp_path: Path, trial: Trial, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """A function that sets the behaviour of the script: wait (the default), end, error, or stubborn (ignore SIGTERM)."""
    (tmp_path / "script.py").write_text(textwrap.dedent(SCRIPT))
    (tmp_path / "trials").write_text(trial.model_dump_json() + "\n")
    (tmp_path / "mode").write_text("wait")
    monkeypatch.setenv("FAKE_MODE", str(tmp_path / "mode"))
    monkeypatch.setenv("FAKE_TRIALS", str(tmp_path / "trials"))

    def choose(name: str) -> None:
        (tmp_path / "new").write_text(name)
        (tmp_path / "new").replace(tmp_path / "mode")

    return choose


@pytest.fixture
def evaluations(tmp_path: Path, mode: Callable[[str], None]) -> Iterator[Evaluations]:
    opened = Evaluations(tmp_path / "runs", (sys.executable, str(tmp_path / "script.py")))
    yield opened
    if (name := opened.running()) is not None:
        mode("end")
        until(lambda: opened.status(name).state != "running")


def wait_for_progress(evaluations: Evaluations, name: str) -> None:
    """Wait until an evaluation has written its progress."""
    until(lambda: evaluations.status(name).progress is not None)


def test_arguments_are_those_of_the_command(evaluations: Evaluations, mode: Callable[[str], None]) -> None:
    name = evaluations.start(EvaluationRequest("qwen3-4b+moondream3", "core", 7, ("counting", "ocr")), "anna")
    wait_for_progress(evaluations, name)
    mode("end")
    status = until(lambda: evaluations.status(name) if evaluations.status(name).state == "finished" else None)
    arguments = json.loads((evaluations.folder(name).progress / "arguments.json").read_text())
    assert arguments[:4] == ["bench", "run", "--split", "core"]
    assert arguments[8:] == ["--pair", "qwen3-4b+moondream3", "--limit", "7", "--category", "counting", "--category", "ocr"]
    assert not status.can_resume and status.record.actor == "anna"
    with pytest.raises(Exception, match="complete"):
        evaluations.resume(name)


def test_only_one_runs_at_a_time_even_with_another_server(evaluations: Evaluations, tmp_path: Path) -> None:
    name = evaluations.start(EvaluationRequest("grammar+ground-truth", "lite"), "")
    wait_for_progress(evaluations, name)
    other = Evaluations(tmp_path / "runs")
    for each in (evaluations, other):
        with pytest.raises(EvaluationRunningError, match="cancel it"):
            each.start(EvaluationRequest("grammar+ground-truth", "lite"), "")
        with pytest.raises(EvaluationRunningError):
            each.remove(name)
    other.cancel(name)  # it finds the process through the files
    until(lambda: evaluations.status(name).state == "cancelled")
    assert other.status(name).can_resume


def test_a_killed_evaluation_is_reported_and_resumed(evaluations: Evaluations, mode: Callable[[str], None]) -> None:
    name = evaluations.start(EvaluationRequest("grammar+ground-truth", "lite"), "")
    wait_for_progress(evaluations, name)
    state = evaluations.folder(name).state()
    assert state is not None
    os.kill(state.pid, signal.SIGKILL)
    until(lambda: evaluations.status(name).state == "interrupted")
    assert [each.sample for each in evaluations.folder(name).trials()]
    mode("end")
    evaluations.resume(name)
    status = until(lambda: evaluations.status(name) if evaluations.status(name).state == "finished" else None)
    assert status.record.resumed == 1 and status.progress.done == 2


def test_an_evaluation_that_does_not_stop_is_killed(
    evaluations: Evaluations, mode: Callable[[str], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scope_ptz.serve.site.benchmark.evaluations.KILL_AFTER_S", 0.1)
    mode("stubborn")
    name = evaluations.start(EvaluationRequest("grammar+ground-truth", "lite"), "")
    wait_for_progress(evaluations, name)
    time.sleep(0.1)
    evaluations.cancel(name)
    until(lambda: evaluations.status(name).state == "cancelled")


def test_an_error_is_shown_with_its_message(evaluations: Evaluations, mode: Callable[[str], None]) -> None:
    mode("error")
    name = evaluations.start(EvaluationRequest("grammar+ground-truth", "lite"), "")
    until(lambda: evaluations.status(name).state == "failed")
    status = evaluations.status(name)
    assert status.message == "The model is not configured." and status.can_resume


@pytest.fixture
def api(
    scenes: None, tmp_path: Path, mode: Callable[[str], None], monkeypatch: pytest.MonkeyPatch
) -> Iterator[tuple[httpx2.Client, Served]]:
    options = SiteOptions(tmp_path / "runs")
    with serving(options, Access("127.0.0.1", limits=RateLimits(None)), {CAMERA: SPEC}) as server:
        monkeypatch.setattr(server.site.evaluations, "_program", (sys.executable, str(tmp_path / "script.py")))
        with server.client() as client:
            yield client, server
            mode("end")
            until(lambda: server.site.evaluations.running() is None)


def test_an_evaluation_from_start_to_report(api: tuple[httpx2.Client, Served], mode: Callable[[str], None], trial: Trial) -> None:
    client, _ = api
    choices = client.get("/benchmark").json()
    assert {"lite", "core"} <= {each["name"] for each in choices["splits"]} and choices["missing"] == ""
    assert client.get("/benchmark/evaluations").json() == []
    started = client.post("/benchmark/evaluations", json={"split": "lite", "limit": 2})
    assert started.status_code == 202, started.text
    address = f"/benchmark/evaluations/{started.json()['id']}"
    until(lambda: client.get(address).json()["progress"])
    state = client.get(address).json()
    assert (state["state"], state["progress"]["done"], state["limit"]) == ("running", 1, 2)
    assert "pid" not in state["progress"]
    second = client.post("/benchmark/evaluations", json={})
    assert (second.status_code, second.json()["error"]["code"]) == (409, "evaluation_in_progress")
    assert client.delete(address).status_code == 409

    rows = client.get(f"{address}/trials", params={"verdict": "failed"}).json()
    assert [(each["expected"], each["answer"], each["error_mode"]) for each in rows["trials"]] == [
        (trial.task.expected, "There are 3.", "vlm_query")
    ]
    assert client.get(f"{address}/trials", params={"verdict": "correct"}).json()["count"] == 0
    details = client.get(f"{address}/trials/{trial.sample.replace('#', '%23')}").json()
    assert details["trial"]["sample"] == trial.sample and "not in the log yet" in details["missing"]

    mode("end")
    until(lambda: client.get(address).json()["state"] == "finished")
    assert client.get(f"{address}/report/index.html").status_code == 404
    assert client.post(f"{address}/report").json()["report"] in ("making", "ready")
    until(lambda: client.get(address).json()["report"] == "ready")
    page = client.get(f"{address}/report/index.html")
    assert page.headers["content-security-policy"].startswith("default-src 'none'; style-src 'unsafe-inline'; img-src 'self'")
    assert client.get(f"{address}/report/tasks/one.html").text == "<p>one</p>"
    assert client.delete(address).status_code == 204
    assert client.get("/benchmark/evaluations").json() == []


@pytest.mark.parametrize(
    "path",
    ["report/tasks/..%2f..%2fevaluation.json", "report/tasks/evaluation.json", "report/frames/..", "report/logs/log.eval"],
)
def test_no_file_outside_of_the_report_is_served(api: tuple[httpx2.Client, Served], mode: Callable[[str], None], path: str) -> None:
    client, _ = api
    mode("end")
    name = client.post("/benchmark/evaluations", json={}).json()["id"]
    address = f"/benchmark/evaluations/{name}"
    until(lambda: client.get(address).json()["state"] == "finished")
    client.post(f"{address}/report")
    until(lambda: client.get(address).json()["report"] == "ready")
    assert client.get(f"{address}/{path}").status_code in (404, 405, 422)


@pytest.mark.parametrize(
    ("body", "status"),
    [
        ({"pair": "axis://host"}, 404),
        ({"split": "/etc/passwd"}, 422),
        ({"split": "reaction", "categories": ["ocr"]}, 409),
        ({"categories": ["--out=/tmp"]}, 422),
        ({"limit": 0}, 422),
        ({"agent": "os:system"}, 422),
    ],
)
def test_only_names_are_accepted(api: tuple[httpx2.Client, Served], body: dict[str, object], status: int) -> None:
    client, server = api
    assert client.post("/benchmark/evaluations", json=body).status_code == status
    assert server.site.evaluations.ids() == []


@pytest.mark.parametrize("name", ["..", "%2e%2e", "nothing", "..%2fruns"])
def test_unknown_evaluations(api: tuple[httpx2.Client, Served], name: str) -> None:
    client, _ = api
    assert client.get(f"/benchmark/evaluations/{name}/trials").status_code == 404


def test_viewers_cannot_start_or_cancel(guarded: Served, tokens: dict[str, str]) -> None:
    with guarded.client(tokens["vera"]) as client:
        assert client.get("/benchmark/evaluations").status_code == 200
        assert client.post("/benchmark/evaluations", json={}).status_code == 403
        assert client.post("/benchmark/evaluations/x/cancel").status_code == 403


def test_incomplete_files_are_ignored(tmp_path: Path) -> None:
    folder = EvaluationFolder(tmp_path)
    folder.progress.mkdir()
    assert folder.state() is None and folder.trials() == [] and not folder.is_locked()
    (folder.progress / STATE_FILE).write_text('{"pid": 1, "ru')
    (folder.progress / TRIALS_FILE).write_text("{}\nnot json\n")
    (folder.progress / LOCK_FILE).touch()
    assert folder.state() is None and folder.trials() == [] and not folder.is_locked()
    state = ProgressState(pid=1, runs=3, micro=Score(value=0.5, low=None, high=None))
    (folder.progress / STATE_FILE).write_text(state.model_dump_json())
    assert folder.state() == state
