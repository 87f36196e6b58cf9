"""A killed server, or a full disk, loses no step that a client has seen."""

from __future__ import annotations

import json
import os
import random
import signal
import sqlite3
import subprocess
import sys
import threading
from pathlib import Path

import httpx2
import pytest

from scope_ptz.store.run_store import RunStore

KILLS = 8  # number of times that a server is started and killed
INSTRUCTION = "count the balls, then pan right by 20 degrees, then zoom in 2x, then count the balls, then go home"


@pytest.fixture
def scenes(analytic_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(analytic_folder.parent))


def run_and_kill(runs: Path, wait_s: float) -> dict[str, list[str]]:
    """Give instructions to a server, and kill it after ``wait_s`` seconds. Return the records that the client received, by run."""
    command = [sys.executable, "-m", "scope_ptz.cli", "serve", "--port", "0", "--json", "--camera", "analytic-yard"]
    program = subprocess.Popen([*command, "--runs-dir", str(runs)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    received: dict[str, list[str]] = {}
    try:
        assert program.stdout is not None
        url = json.loads(program.stdout.readline())["url"]
        with httpx2.Client(base_url=f"{url}/api/v1", trust_env=False, timeout=60.0) as client:
            client.get("/cameras/analytic-yard")  # opens the camera
            killer = threading.Timer(wait_s, os.kill, (program.pid, signal.SIGKILL))
            killer.start()
            try:
                while True:
                    run = client.post("/runs", json={"camera": "analytic-yard", "instruction": INSTRUCTION}).json()["id"]
                    received[run] = []
                    with client.stream("GET", f"/runs/{run}/events") as events:
                        for line in events.iter_lines():
                            if line.startswith("data: "):
                                received[run].append(line.removeprefix("data: "))
            except httpx2.HTTPError:
                killer.join()
    finally:
        if program.poll() is None:
            program.kill()
        program.communicate()
    return received


@pytest.mark.full
def test_random_kills_lose_no_finished_step(scenes: None, tmp_path: Path) -> None:
    runs, rng, received = tmp_path / "runs", random.Random(7), dict[str, list[str]]()
    for _ in range(KILLS):
        received |= run_and_kill(runs, rng.uniform(0.05, 4.0))
    assert sum(map(len, received.values())) > KILLS, "clients saw steps before the kills"
    with RunStore(runs) as store:
        report = store.index()
        assert not report.damaged
        stored = {run: store.run(run) for run in received}
    unfinished = []
    for run, records in received.items():
        assert set(records) <= set((runs / run / "trace.jsonl").read_text().splitlines()), run
        calls = [record for record in records if json.loads(record)["event"] == "call"]
        assert len(stored[run].steps) >= len(calls), run
        if stored[run].run.ended is None:
            unfinished.append(run)
            assert stored[run].run.outcome == "unfinished"
    assert unfinished, "at least one kill interrupted a run"
    with sqlite3.connect(runs / "store.sqlite") as database:
        assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    database.close()
    command = [sys.executable, "-m", "scope_ptz.cli", "runs", "list", "--outcome", "unfinished", "--runs-dir", str(runs), "--json"]
    listed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert all(run in listed for run in unfinished)


@pytest.mark.full
def test_a_full_disk_causes_a_clear_message_and_loses_no_run(scenes: None, tmp_path: Path) -> None:
    """A limit on the size of files simulates a full disk: writing beyond the limit fails with an error."""
    runs = tmp_path / "runs"
    command = [sys.executable, "-m", "scope_ptz.cli", "serve", "--port", "0", "--json", "--camera", "analytic-yard"]
    limit_file_size = (
        "import os, resource, signal, sys\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))\n"
        "os.execv(sys.argv[1], sys.argv[1:])\n"
    )
    with RunStore(runs) as store:
        store.index()
    environment = {**os.environ, "SCOPE_PICTURES_DIR": str(tmp_path / "cache")}
    command = [sys.executable, "-c", limit_file_size, *command, "--runs-dir", str(runs)]
    program = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
    try:
        assert program.stdout is not None
        url = json.loads(program.stdout.readline())["url"]
        outcomes, replies = dict[str, str](), list[httpx2.Response]()
        with httpx2.Client(base_url=f"{url}/api/v1", trust_env=False, timeout=60.0) as client:
            for _ in range(12):  # enough for the index to exceed the limit
                reply = client.post(
                    "/ask", json={"camera": "analytic-yard", "instruction": "pan right by 20 degrees, then go home"}
                )
                replies.append(reply)
                if reply.status_code == 200:
                    outcomes[reply.json()["id"]] = reply.json()["outcome"]
            assert client.get("/health").status_code == 200
    finally:
        program.send_signal(signal.SIGINT)
        _, errors = program.communicate(timeout=60)
    assert {reply.status_code for reply in replies} <= {200, 507}, replies[-1].text
    assert "Traceback" not in errors
    assert "the space on its disk" in errors or "disk is full" in errors
    assert outcomes
    with RunStore(runs) as store:
        store.index()
        for run, outcome in outcomes.items():
            assert store.run(run).run.outcome == outcome
