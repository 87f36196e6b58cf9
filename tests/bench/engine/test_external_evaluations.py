"""Evaluations of external agents: failures are scored, labels are kept, and runs with different labels are not mixed."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import scope_ptz
from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.tasks.files import load_tasks
from scope_ptz.errors import ConfigError
from tests.bench.agents.sandboxes import needs_sandbox
from tests.cli.conftest import Scope

FAILING = """
import os, time

class Agent:
    async def run(self, session):
        if "balls" in session.instruction:
            os.abort()
        if "blocks" in session.instruction:
            await session.call("count_objects", {"description": "gibberish without any meaning"})
            time.sleep(60)
        if "20" in session.instruction:
            await session.call("adjust_ptz", {"pan_deg": 20.0})
            raise ZeroDivisionError("after the work")
        await session.call("adjust_ptz", {"pan_deg": 30.0})
        return "Done."
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the agent's folder, which is also the working folder."""
    (tmp_path / "agent").mkdir()
    monkeypatch.chdir(tmp_path / "agent")
    return tmp_path / "agent"


@pytest.mark.full
def test_failures_of_the_agent_are_scored(scope: Scope, tasks_file: Path, folder: Path) -> None:
    (folder / "failing_agent.py").write_text(FAILING)
    options = ("--agent", "failing_agent:Agent", "--agent-step-s", "5", "--no-pictures", "--out", "logs", "--json")
    result = scope("bench", "run", "--tasks", str(tasks_file), *options)
    assert result.code == 0, result.err
    trials = {trial.task.id.split("yard-")[1]: trial for trial in read_evaluation(Path(result.json["log"])).trials}
    assert {name: trial.headline for name, trial in trials.items()} == {
        "counting-001": "incorrect", "counting-002": "incorrect", "single-call-001": "incorrect", "single-call-002": "correct",
    }  # fmt: skip
    assert {trials[name].outcome for name in trials if trials[name].headline == "incorrect"} == {"planner_error"}
    assert all(trials[name].error_mode for name in trials if trials[name].headline == "incorrect")
    assert trials["counting-001"].reason.startswith("the agent failed (agent-exited): ")
    assert "SIGABRT" in trials["counting-001"].answer
    assert trials["counting-002"].reason.startswith("the agent failed (agent-timeout): ")
    assert "ZeroDivisionError: after the work" in trials["single-call-001"].reason
    (summary,) = [line for line in result.json["failure_summary"] if "agent failed" in line]
    assert "3 of 4 runs" in summary and "agent-timeout 1" in summary
    assert result.json["micro"] == 0.25


QUICK = """
class Agent:
    async def run(self, session):
        return "x"
"""


@pytest.mark.full
def test_labels_and_limits_are_part_of_the_identity(scope: Scope, tasks_file: Path, folder: Path) -> None:
    (folder / "quick_agent.py").write_text(QUICK)

    def run_with(*options: str) -> str:
        common = ("--tasks", str(tasks_file), "--agent", "quick_agent:Agent", "--limit", "1", "--no-pictures", "--out", "../logs")
        result = scope("bench", "run", *common, *options)
        assert result.code == 0, result.err
        return result.out + result.err

    assert "agent   isolated: " in run_with() and "agent      isolated: " in run_with()
    assert "already complete" in run_with()
    assert "already complete" not in run_with("--agent-in-process")
    assert "already complete" in run_with("--agent-in-process")
    assert "already complete" not in run_with("--agent-memory-mb", "1000")
    assert "already complete" not in run_with("--agent-python", sys.executable)
    labels = sorted(read_evaluation(log).card.isolation or "" for log in (folder.parent / "logs").glob("*.eval"))
    assert labels == ["in-process", "isolated", "isolated", "isolated"]
    result = scope("bench", "report", *map(str, (folder.parent / "logs").glob("*.eval")), "--out", "../report")
    assert result.code == 0, result.err
    page = (folder.parent / "report" / "report.md").read_text("utf-8").replace("\\", "")
    assert "quick_agent:Agent (in-process)" in page and "quick_agent:Agent (isolated)" in page


CURIOUS = """
import os

class Agent:
    async def run(self, session):
        found = [name for _, _, files in os.walk(".") for name in files]
        try:
            found.append(open("tasks.jsonl").read())
        except OSError:
            pass
        return repr(found)
"""


@needs_sandbox
@pytest.mark.full
def test_a_sandboxed_agent_does_not_see_logs_and_tasks_in_its_folder(scope: Scope, tasks_file: Path, folder: Path) -> None:
    (folder / "curious_agent.py").write_text(CURIOUS)
    (folder / "tasks.jsonl").write_bytes(tasks_file.read_bytes())
    options = ("--agent", "curious_agent:Agent", "--sandbox", "--no-pictures", "--out", "logs", "--json")
    result = scope("bench", "run", "--tasks", "tasks.jsonl", *options)
    assert result.code == 0, result.err
    evaluation = read_evaluation(Path(result.json["log"]))
    assert evaluation.card.isolation == "sandboxed"
    assert not any("expected" in trial.answer or ".eval" in trial.answer for trial in evaluation.trials)
    assert all(trial.outcome == "answered" for trial in evaluation.trials)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--sandbox"], "require an agent"),
        (["--agent-memory-mb", "100"], "require an agent"),
        (["--agent", "a:B", "--agent-command", "sh x"], "cannot be combined"),
        (["--agent-command", "sh x", "--agent-in-process"], "--agent MODULE:CLASS"),
        (["--agent-command", " "], "empty"),
        (["--agent-command", "no-such-program"], "does not exist"),
        (["--agent", "json:JSONDecoder", "--agent-env", "NOT_SET"], "NOT_SET"),
        (["--agent", "json:JSONDecoder", "--agent-in-process"], "is not an agent"),
    ],
)
def test_wrong_options(options: list[str], message: str, scope: Scope, tasks_file: Path, folder: Path) -> None:
    result = scope("bench", "run", "--tasks", str(tasks_file), "--out", "logs", *options)
    assert result.code == 2 and message in result.err, result.err
    assert not list(folder.glob("logs/*.eval"))


def test_the_python_interface(tasks_file: Path, scenes: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(scenes))
    (folder / "quick_agent.py").write_text(QUICK)
    tasks = load_tasks(tasks_file)[:1]
    results = scope_ptz.evaluate(tasks=tasks, agent="quick_agent:Agent", agent_memory_mb=500, pictures=False, out="logs")
    assert read_evaluation(results.log).card.isolation == "isolated"
    assert [trial.answer for trial in results.trials] == ["x"]
    with pytest.raises(ConfigError, match="cannot be combined"):
        scope_ptz.evaluate(tasks=tasks, agent="quick_agent:Agent", agent_command="sh", out="logs")
