"""The commands of docs/hosting.md, with a host in a separate process that is killed once."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx2
import pytest

from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.bench.tasks.splits import load_split
from tests.bench.engine.yard_tasks import TASKS

pytestmark = pytest.mark.full
EXAMPLES = Path(__file__).parents[2] / "examples"
HELLO = {"type": "hello", "protocol": 1, "name": "test"}


class Recipe:
    """The folder and the environment in which the commands run."""

    def __init__(self, folder: Path, scenes: Path | None) -> None:
        self.folder = folder
        self.environment = dict(os.environ) | ({"SCOPE_SCENES_DIR": str(scenes)} if scenes is not None else {})

    def scope(self, *arguments: str, code: int = 0) -> str:
        """Run a command, and return its output."""
        command = [sys.executable, "-m", "scope_ptz.cli", *arguments]
        result = subprocess.run(
            command, cwd=self.folder, env=self.environment, capture_output=True, text=True, timeout=600, check=False
        )
        assert result.returncode == code, result.stdout + result.stderr
        return result.stdout + result.stderr

    def example(self, name: str, *arguments: str) -> None:
        """Run an example program."""
        command = [sys.executable, str(EXAMPLES / name), *arguments]
        result = subprocess.run(
            command, cwd=self.folder, env=self.environment, capture_output=True, text=True, timeout=600, check=False
        )
        assert result.returncode == 0, result.stderr

    @contextmanager
    def host(self, *extra: str) -> Iterator[tuple[subprocess.Popen[str], list[dict[str, Any]]]]:
        """Run the host, and yield its process and the lines that it printed until it listened."""
        command = [
            sys.executable, "-m", "scope_ptz.cli", "bench", "host", "--tasks", "private.jsonl", "--key", "host.key",
            "--out", "hosted", "--port", "0", "--json", "--until-done", *extra,
        ]  # fmt: skip
        process = subprocess.Popen(command, cwd=self.folder, env=self.environment, stdout=subprocess.PIPE, text=True)
        assert process.stdout is not None
        lines: list[dict[str, Any]] = []
        try:
            for line in process.stdout:
                lines.append(json.loads(line))
                if "url" in lines[-1]:
                    break
            yield process, lines
        finally:
            process.kill()
            process.wait(60)
            process.stdout.close()


def test_the_recipe(analytic_folder: Path, tmp_path: Path) -> None:
    recipe = Recipe(tmp_path, analytic_folder.parent)
    dump_tasks(TASKS, tmp_path / "private.jsonl")
    printed = recipe.scope("bench", "keygen", "--out", "host.key")
    assert "SHA256:" in printed and "PRIVATE" not in printed
    with recipe.host("--participant", "anna", "--participant", "ben") as (process, lines):
        tokens = {line["participant"]: line["token"] for line in lines if "token" in line}
        assert set(tokens) == {"anna", "ben"} and lines[-1]["runs"] == len(TASKS)
        with httpx2.Client(base_url=lines[-1]["url"], headers={"Authorization": f"Bearer {tokens['anna']}"}, timeout=300) as http:
            assert http.post("/api/v1/messages", json=HELLO).json()["type"] == "task"
        process.send_signal(signal.SIGKILL)
        process.wait(60)
    for name, token in tokens.items():
        (tmp_path / f"{name}.token").write_text(token, "utf-8")
    with recipe.host() as (process, lines):
        url = str(lines[-1]["url"])
        assert len(lines) == 1, "tokens are printed once"
        with httpx2.Client(base_url=url, headers={"Authorization": f"Bearer {tokens['anna']}"}, timeout=300) as http:
            assert http.get("/api/v1/evaluation").json()["begun"] == 1
        recipe.example("hosted_agent.py", url, "anna.token")
        recipe.example("hosted_agent_mcp.py", f"{url}/mcp", "ben.token")
        assert process.wait(300) == 0
    (tmp_path / "submissions").mkdir()
    for name in ("anna", "ben"):
        (folder,) = (tmp_path / "hosted").glob(f"{name}-*")
        (log,) = folder.glob("*.eval")
        assert len(read_evaluation(log).trials) == len(TASKS)
        journal = [json.loads(line) for line in (folder / "journal.jsonl").read_text("utf-8").splitlines()]
        assert len({entry["run"] for entry in journal if "run" in entry}) == len(TASKS)
        assert sum(entry["type"] == "ended" for entry in journal) == len(TASKS)
        validated = recipe.scope(
            "bench", "submission", "validate", str(folder / "submission.jsonl"), "--tasks", "private.jsonl", "--host-key",
            "host.key.pub",
        )  # fmt: skip
        assert "valid, hosted" in validated
        for suffix in (".jsonl", ".jsonl.sig"):
            shutil.copy(folder / f"submission{suffix}", tmp_path / "submissions" / f"{name}{suffix}")
    recipe.scope("bench", "run", "--tasks", "private.jsonl", "--out", "baseline")
    (log,) = (tmp_path / "baseline").glob("*.eval")
    recipe.scope("bench", "submission", "make", str(log), "--tasks", "private.jsonl", "--out", "submissions/baseline.jsonl")
    shutil.copy(tmp_path / "submissions" / "anna.jsonl", tmp_path / "submissions" / "stolen.jsonl")
    board = ("bench", "leaderboard", "submissions", "--tasks", "private.jsonl", "--out", "leaderboard.html")
    listed = recipe.scope(*board, "--host-key", "host.key.pub")
    assert "3 entries" in listed and "stolen.jsonl: not listed" in listed
    page = (tmp_path / "leaderboard.html").read_text("utf-8")
    assert all(word in page for word in ("anna", "ben", "baseline", "hosted", "self-reported"))
    assert "1 entry" in recipe.scope(*board), "without the key, hosted submissions are not accepted"
    with (tmp_path / "submissions" / "ben.jsonl").open("a", encoding="utf-8") as file:
        file.write("\n")
    assert "edited after it was signed" in recipe.scope(*board, "--host-key", "host.key.pub")


def test_closing_counts_unfinished_runs_as_incorrect(analytic_folder: Path, tmp_path: Path) -> None:
    recipe = Recipe(tmp_path, analytic_folder.parent)
    dump_tasks(TASKS, tmp_path / "private.jsonl")
    recipe.scope("bench", "keygen", "--out", "host.key")
    options = ("bench", "host", "--tasks", "private.jsonl", "--key", "host.key", "--out", "hosted")
    assert "no participants" in recipe.scope(*options, "--close", code=2)
    recipe.scope(*options, "--participant", "anna", "--close")
    (log,) = (tmp_path / "hosted").glob("anna-*/*.eval")
    trials = read_evaluation(log).trials
    assert len(trials) == len(TASKS)
    assert {trial.headline for trial in trials} == {"incorrect"}


@pytest.mark.parametrize("extra", [(), ("--seeds", "48151623")], ids=["another seed", "a private variation"])
def test_a_private_seed_gives_other_tasks(tmp_path: Path, extra: tuple[str, ...]) -> None:
    recipe = Recipe(tmp_path, None)
    build = ("bench", "build", "--scene", "highway-works", "--share", "0.05", *extra)
    recipe.scope(*build, "--seed", "918273645", "--out", "one.jsonl")
    recipe.scope(*build, "--seed", "192837465", "--out", "other.jsonl")
    one, other = load_split(tmp_path / "one.jsonl"), load_split(tmp_path / "other.jsonl")
    published = {(task.instruction, task.preset, str(task.expected)) for task in load_split("core") + load_split("unseen")}
    for tasks in (one, other):
        known = [task for task in tasks if (task.instruction, task.preset, str(task.expected)) in published]
        assert len(known) <= len(tasks) / 10
    assert len({task.instruction for task in one} & {task.instruction for task in other}) <= len(one) / 4
    recipe.scope("bench", "validate", "--tasks", "one.jsonl")
