"""A sweep of two tiny planners with a tiny vision model over the first lite split: killed, resumed, and judged by a tiny judge."""

from __future__ import annotations

import json
import os
import re
import shutil
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import pytest

from scope_ptz.bench.engine.logs import read_evaluation, uuids_in
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.bench.tasks.splits import load_split
from scope_ptz.bench.tasks.task import Task
from tests.bench.engine.making import counting, turning
from tests.cli.conftest import CommandResult
from tests.full.serving import transformers_serve
from tests.full.test_served_models import Served, lesson_of
from tests.support.misbehaving import Mind, Misbehaving, Request, Say, good

MINE = """
models:
  tiny-novice: {{repo: {novice.model}, url: '{novice.url}', roles: [planner], size_b: 0.001, active_b: 0.001, precision: fp32,
    context: 16384, licence: none}}
  tiny-adept: {{repo: {adept.model}, url: '{adept.url}', roles: [planner], size_b: 0.001, active_b: 0.001, precision: fp32,
    context: 16384, licence: none}}
  tiny-eyes: {{repo: {eyes.model}, url: '{eyes.url}', roles: [perception], backend: openai_vision, coordinates: qwen3-vl,
    size_b: 0.001,
    active_b: 0.001, precision: fp32, context: 2048, licence: none}}
"""
NOVICE, ADEPT = "tiny-novice + tiny-eyes", "tiny-adept + tiny-eyes"
COMMANDS = ("single_call", "multi_step_command")
DONE, COUNTED, SORRY = "It is done.", "There are 3 balls.", "I cannot do that."
FINISHED_BEFORE_THE_KILL = 4
PATIENCE_S = 400.0

TURNING, COUNTING = turning(1, 20.0), counting(1, "ball", 3)
LITE = load_split("lite1")  # the tiny models are trained for these tasks
TASKS = (TURNING, COUNTING, *LITE)
SHORT = tuple(t for t in LITE if t.category in COMMANDS and len(t.reference) < 3 and t.reference[0].tool != "zoom_to_object")
"""Commands that need no perception."""


def planning(learned: Sequence[Task]) -> Mind:
    """What a tiny planner shall learn to say: it does what it knows, claims to have done every other command, and gives up else."""
    known, commands = {t.instruction: t for t in learned}, {t.instruction for t in TASKS if t.category in COMMANDS}

    def mind(request: Request) -> Say:
        instruction, made = asked(request), sum(m["role"] == "tool" for m in request.data["messages"])
        if instruction not in known:
            return Say(DONE if instruction in commands else SORRY)
        program = known[instruction].reference
        if made < len(program):
            return Say("", tool_calls=((program[made].tool, program[made].arguments),))
        return Say(DONE if instruction in commands else COUNTED)

    return mind


def asked(request: Request) -> str:
    return next(str(m["content"]) for m in request.data["messages"] if m["role"] == "user")


@dataclass(frozen=True)
class Program:
    """The program as a process, with logs, models and all that it keeps in one folder."""

    folder: Path
    scenes: Path

    @property
    def logs(self) -> Path:
        return self.folder / "logs"

    def start(self, *arguments: str) -> subprocess.Popen[str]:
        own = {"SCOPE_SCENES_DIR": self.scenes, "SCOPE_RUNS_DIR": self.folder / "runs", "SCOPE_MODELS": self.folder / "models.yaml"}
        environment = os.environ | {name: str(path) for name, path in own.items()}
        environment |= {"XDG_DATA_HOME": str(self.folder / "data"), "COLUMNS": "200"}
        command = [sys.executable, "-m", "scope_ptz.cli", *arguments]
        return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def run(self, *arguments: str) -> CommandResult:
        with self.start(*arguments) as process:
            try:
                out, err = process.communicate()
            finally:
                process.kill()
        return CommandResult(process.returncode, out, err)

    def unwritten(self) -> dict[tuple[str, int], str]:
        """Runs that a program has finished and not yet written into its log, by task and epoch: what tells each from all others."""
        found = dict[tuple[str, int], str]()
        for store in (self.folder / "data").rglob("*.db"):
            connection = sqlite3.connect(f"file:{store}?mode=ro", uri=True)
            try:
                rows = connection.execute("SELECT id, epoch, data FROM samples").fetchall()
            except sqlite3.OperationalError:
                continue  # it is being made
            finally:
                connection.close()
            told = ((str(name), int(epoch), json.loads(data)) for name, epoch, data in rows)
            found |= {(name, epoch): row["uuid"] for name, epoch, row in told if row.get("completed_at")}
        return found


@pytest.fixture(scope="module")
def planners(tmp_path_factory: pytest.TempPathFactory, scenes: Path) -> Iterator[dict[str, Served]]:
    """Two planners, one of which has learned more: from one rehearsal against a stand-in, over the very tasks of the sweep."""
    from tests.full.tiny_models import BRIEF_TEMPLATE, tiny_planner

    folder = tmp_path_factory.mktemp("planners")
    learned = {"novice": (TURNING, COUNTING), "adept": (TURNING, COUNTING, *SHORT)}
    (folder / "models.yaml").write_text("models: {}")
    dump_tasks(TASKS, folder / "tasks.jsonl")
    with Misbehaving(then=good(planning(learned["adept"]))) as stand_in:
        done = Program(folder, scenes).run(
            "bench", "run", "--tasks", str(folder / "tasks.jsonl"), "--no-pictures", "--out", str(folder / "rehearsal"),
            "--planner-url", stand_in.url, "--planner-model", "stand-in",
        )  # fmt: skip
        assert done.code == 0, done.err
        requests = [request for request in stand_in.requests if request.chat]
    with ExitStack() as servers:
        served = {}
        for name, tasks in learned.items():
            words, mind = {task.instruction for task in tasks}, planning(tasks)
            known = [r for r in requests if asked(r) in words or r.data["messages"][-1]["role"] == "user"]
            lessons = [lesson_of(request, mind(request)) for request in known]
            checkpoint = tiny_planner(folder / name, lessons, template=BRIEF_TEMPLATE)
            url = servers.enter_context(transformers_serve(checkpoint, folder / f"{name}.log"))
            served[name] = Served(url, str(checkpoint))
        yield served


@dataclass(frozen=True)
class SweepRun:
    """``finished``: the runs that were finished when the sweep was killed; ``again``: the same command after that."""

    program: Program
    finished: dict[tuple[str, int], str]
    killed: Path
    again: CommandResult

    @property
    def logs(self) -> dict[str, Path]:
        return {read_evaluation(path).card.pair: path for path in self.program.logs.glob("*.eval")}


@pytest.fixture(scope="module")
def swept(
    planners: dict[str, Served], perception_server: Served, tmp_path_factory: pytest.TempPathFactory, scenes: Path
) -> SweepRun:
    """A sweep that is killed in the midst of its first pair, and begun again."""
    program = Program(tmp_path_factory.mktemp("sweep"), scenes)
    (program.folder / "models.yaml").write_text(MINE.format(eyes=perception_server, **planners))
    dump_tasks(TASKS, program.folder / "tasks.jsonl")
    command = (
        "bench", "sweep", "--pairs", "tiny-novice+tiny-eyes,tiny-adept+tiny-eyes", "--concurrency", "1", "--max-steps", "8",
        "--tasks", str(program.folder / "tasks.jsonl"), "--out", str(program.logs),
    )  # fmt: skip
    process, finished = program.start(*command), dict[tuple[str, int], str]()
    deadline = time.monotonic() + PATIENCE_S
    try:
        while len(finished) < FINISHED_BEFORE_THE_KILL:
            assert process.poll() is None, process.communicate()[1]
            assert time.monotonic() < deadline, "no finished runs in time"
            time.sleep(0.1)
            finished |= program.unwritten()
    finally:
        process.kill()
        process.communicate()
    (killed,) = program.logs.glob("*.eval")
    finished |= program.unwritten() | {run: str(uuid) for run, uuid in uuids_in(killed).items()}
    return SweepRun(program, finished, killed, program.run(*command))


BLAMED = {
    "counting": "vlm_counting", "descriptor": "vlm_query", "location": "vlm_query", "ocr": "hallucination",
    "comparative": "reasoning", "multi_step_reasoning": "lack_of_tool_call", "single_call": "tool_args",
    "multi_step_command": "tool_routing",
}  # fmt: skip


def gullible(category: str, answer: str) -> tuple[str, str | None]:
    """Verdict and error mode of a judge that believes whoever says that a command was carried out."""
    return ("correct", None) if category in COMMANDS and answer == DONE else ("incorrect", BLAMED[category])


def judging(request: Request) -> Say:
    """What the tiny judge shall learn to say."""
    told = request.data["messages"][-1]["content"]
    category = re.findall(r"^Category: (\w+)$", told, re.MULTILINE)[0]
    verdict, mode = gullible(category, told.rpartition("\n| ")[2])
    return Say(json.dumps({"reason": "So it seems.", "verdict": verdict, "error_mode": mode or "none"}))


@dataclass(frozen=True)
class Judged:
    """``rounds``: what the two judgings ended with."""

    judge: str
    logs: dict[str, Path]
    rounds: list[CommandResult]


@pytest.fixture(scope="module")
def judged(swept: SweepRun, tmp_path_factory: pytest.TempPathFactory) -> Judged:
    """Both logs, judged twice by a checkpoint that has learned from a rehearsal on copies of them."""
    from tests.full.tiny_models import tiny_judge

    folder, program = tmp_path_factory.mktemp("judge"), swept.program
    copies = [str(shutil.copy2(path, folder)) for path in swept.logs.values()]
    with Misbehaving(then=good(judging)) as stand_in:
        done = program.run("bench", "rescore", *copies, "--judge-url", stand_in.url, "--judge-model", "stand-in")
        assert done.code == 0, done.err
        lessons = [lesson_of(r, judging(r)) for r in stand_in.requests if r.chat]
    assert len(lessons) == 2 * len(TASKS)
    checkpoint = tiny_judge(folder / "judge", lessons)
    logs = swept.logs
    with transformers_serve(checkpoint, folder / "serve.log") as url:
        judge = ("--judge-url", url, "--judge-model", str(checkpoint), "--judge-option", "max_tokens=64")
        return Judged(str(checkpoint), logs, [program.run("bench", "rescore", *map(str, logs.values()), *judge) for _ in range(2)])
