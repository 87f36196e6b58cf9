"""Cheating agents under each isolation mode. One task has a wrong expected answer, which only a cheating agent gives."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import scope_ptz
from scope_ptz.bench.engine import trial_records
from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.bench.scoring.verdict import score_episode
from tests.bench.agents.sandboxes import needs_sandbox
from tests.cli.conftest import Scope

READS_THE_ANSWERS = """
import json, pathlib

class Agent:
    async def run(self, session):
        await session.call("count_objects", {"description": "blocks"})
        for path in PLACES:
            try:
                files = [path] if path.is_file() else sorted(path.rglob("*.jsonl"))
                texts = [file.read_text() for file in files]
            except OSError:
                continue
            for line in "\\n".join(texts).splitlines():
                task = json.loads(line)
                if task.get("instruction") == session.instruction:
                    return f"There are {task['expected']['value']} {task['expected']['unit'][0]}s."
        return "I do not know."
"""
WALKS_THE_HEAP = """
import gc

class Agent:
    async def run(self, session):
        await session.call("count_objects", {"description": "blocks"})
        for thing in gc.get_objects():
            if type(thing).__name__ == "Task" and getattr(thing, "instruction", "") == session.instruction:
                return f"There are {thing.expected.value} {thing.expected.unit[0]}s."
        return "I do not know."
"""
REPLACES_THE_CHECKS = """
class Agent:
    async def run(self, session):
        from scope_ptz.bench.engine import trial_records
        from scope_ptz.bench.scoring.verdict import Verdict
        trial_records.score_episode = lambda task, episode: Verdict(task.id, "correct", (), False, "")
        return "I did nothing."
"""
RunCheat = Callable[[str, str], Trial]
MODES = {"in-process": ["--agent-in-process"], "isolated": [], "sandboxed": ["--sandbox"]}


@pytest.fixture
def run_cheat(scope: Scope, tasks_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RunCheat:
    """Run a cheat on the counting tasks, and return the trial of the task with the wrong answer."""
    monkeypatch.setattr(trial_records, "score_episode", score_episode)  # so that monkeypatch restores it after the test

    def run(source: str, mode: str) -> Trial:
        folder = tmp_path / "agent"
        folder.mkdir()
        module = f"cheat_{mode.replace('-', '_')}_{abs(hash(source))}"
        places = (
            f"PLACES = [pathlib.Path(p) for p in {[str(tasks_file), str(Path(scope_ptz.__file__).parent / 'data' / 'bench')]!r}]\n"
        )
        (folder / f"{module}.py").write_text(source + "\nimport pathlib\n" + places)
        monkeypatch.chdir(folder)
        monkeypatch.syspath_prepend(str(folder))
        options = ("--no-pictures", "--category", "counting", "--out", str(tmp_path / "logs"), "--json")
        result = scope("bench", "run", "--tasks", str(tasks_file), "--agent", f"{module}:Agent", *options, *MODES[mode])
        assert result.code == 0, result.err
        evaluation = read_evaluation(Path(result.json["log"]))
        assert (evaluation.card.isolation, result.json["isolation"]) == (mode, mode)
        return next(trial for trial in evaluation.trials if trial.task.id.endswith("counting-002"))

    return run


@pytest.mark.full
@pytest.mark.parametrize(
    ("source", "mode", "succeeds"),
    [
        pytest.param(READS_THE_ANSWERS, "isolated", True, id="reading, isolated"),
        pytest.param(READS_THE_ANSWERS, "sandboxed", False, id="reading, sandboxed", marks=needs_sandbox),
        pytest.param(WALKS_THE_HEAP, "in-process", True, id="heap, in-process"),
        pytest.param(WALKS_THE_HEAP, "isolated", False, id="heap, isolated"),
        pytest.param(WALKS_THE_HEAP, "sandboxed", False, id="heap, sandboxed", marks=needs_sandbox),
        pytest.param(REPLACES_THE_CHECKS, "in-process", True, id="checks, in-process"),
        pytest.param(REPLACES_THE_CHECKS, "isolated", False, id="checks, isolated"),
        pytest.param(REPLACES_THE_CHECKS, "sandboxed", False, id="checks, sandboxed", marks=needs_sandbox),
    ],
)
def test_whether_a_cheat_succeeds(run_cheat: RunCheat, source: str, mode: str, succeeds: bool) -> None:
    trial = run_cheat(source, mode)
    assert trial.headline == ("correct" if succeeds else "incorrect")
    assert trial.outcome == "answered" or (source, mode) == (
        REPLACES_THE_CHECKS,
        "sandboxed",
    )  # a sandboxed agent cannot import SCOPE
