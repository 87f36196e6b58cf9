"""A sweep of two tiny planners with a tiny vision model on the first lite split, killed, resumed, and judged by a tiny judge."""

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
from tests.bench.engine.yard_tasks import counting_task, turning_task
from tests.cli.conftest import CommandResult
from tests.full.serving import transformers_serve
from tests.full.test_served_models import ServedModel, lesson_of
from tests.support.misbehaving import Misbehaving, Request, Responder, Say, good

MODELS_YAML = """
models:
  tiny-novice: {{repo: {novice.model}, url: '{novice.url}', roles: [planner], size_b: 0.001, active_b: 0.001, precision: fp32,
    context: 16384, licence: none}}
  tiny-adept: {{repo: {adept.model}, url: '{adept.url}', roles: [planner], size_b: 0.001, active_b: 0.001, precision: fp32,
    context: 16384, licence: none}}
  tiny-vision: {{repo: {vision.model}, url: '{vision.url}', roles: [perception], backend: openai_vision, coordinates: qwen3-vl,
    size_b: 0.001,
    active_b: 0.001, precision: fp32, context: 2048, licence: none}}
"""
NOVICE, ADEPT = "tiny-novice + tiny-vision", "tiny-adept + tiny-vision"
COMMANDS = ("single_call", "multi_step_command")
DONE_REPLY, COUNT_REPLY, REFUSAL_REPLY = "It is done.", "There are 3 balls.", "I cannot do that."
RUNS_BEFORE_THE_KILL = 4
TIMEOUT_S = 400.0

TURNING, COUNTING = turning_task(1, 20.0), counting_task(1, "ball", 3)
LITE = load_split("lite1")  # the tiny models are trained for these tasks
TASKS = (TURNING, COUNTING, *LITE)
SHORT_COMMANDS = tuple(
    t for t in LITE if t.category in COMMANDS and len(t.reference) < 3 and t.reference[0].tool != "zoom_to_object"
)
"""Commands with at most two calls and without a search, so they need no perception."""


def planner_teacher(learned: Sequence[Task]) -> Responder:
    """Return the replies that a tiny planner is trained to give.

    It runs the programs of the learned tasks, claims to have done every other command, and refuses all other tasks.
    """
    known, commands = {t.instruction: t for t in learned}, {t.instruction for t in TASKS if t.category in COMMANDS}

    def reply(request: Request) -> Say:
        instruction, call_count = instruction_of(request), sum(m["role"] == "tool" for m in request.data["messages"])
        if instruction not in known:
            return Say(DONE_REPLY if instruction in commands else REFUSAL_REPLY)
        program = known[instruction].reference
        if call_count < len(program):
            return Say("", tool_calls=((program[call_count].tool, program[call_count].arguments),))
        return Say(DONE_REPLY if instruction in commands else COUNT_REPLY)

    return reply


def instruction_of(request: Request) -> str:
    return next(str(m["content"]) for m in request.data["messages"] if m["role"] == "user")


@dataclass(frozen=True)
class Program:
    """The program, run in separate processes with its logs, models and data in one folder."""

    folder: Path
    scenes: Path

    @property
    def logs(self) -> Path:
        return self.folder / "logs"

    def start(self, *arguments: str) -> subprocess.Popen[str]:
        settings = {
            "SCOPE_SCENES_DIR": self.scenes,
            "SCOPE_RUNS_DIR": self.folder / "runs",
            "SCOPE_MODELS": self.folder / "models.yaml",
        }
        environment = os.environ | {name: str(path) for name, path in settings.items()}
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

    def runs_not_in_log(self) -> dict[tuple[str, int], str]:
        """Return the unique ids of runs that are finished but not yet in a log, by task and epoch."""
        finished_runs = dict[tuple[str, int], str]()
        for store in (self.folder / "data").rglob("*.db"):
            connection = sqlite3.connect(f"file:{store}?mode=ro", uri=True)
            try:
                rows = connection.execute("SELECT id, epoch, data FROM samples").fetchall()
            except sqlite3.OperationalError:
                continue  # the table has not been created yet
            finally:
                connection.close()
            samples = ((str(name), int(epoch), json.loads(data)) for name, epoch, data in rows)
            finished_runs |= {(name, epoch): row["uuid"] for name, epoch, row in samples if row.get("completed_at")}
        return finished_runs


@pytest.fixture(scope="module")
def planners(tmp_path_factory: pytest.TempPathFactory, scenes: Path) -> Iterator[dict[str, ServedModel]]:
    """Serve two planners, one trained on more tasks, with requests recorded from a scripted model on the tasks of the sweep."""
    from tests.full.tiny_models import BRIEF_TEMPLATE, tiny_planner

    folder = tmp_path_factory.mktemp("planners")
    learned = {"novice": (TURNING, COUNTING), "adept": (TURNING, COUNTING, *SHORT_COMMANDS)}
    (folder / "models.yaml").write_text("models: {}")
    dump_tasks(TASKS, folder / "tasks.jsonl")
    with Misbehaving(then=good(planner_teacher(learned["adept"]))) as scripted_model:
        result = Program(folder, scenes).run(
            "bench", "run", "--tasks", str(folder / "tasks.jsonl"), "--no-pictures", "--out", str(folder / "rehearsal"),
            "--planner-url", scripted_model.url, "--planner-model", "scripted",
        )  # fmt: skip
        assert result.code == 0, result.err
        requests = [request for request in scripted_model.requests if request.chat]
    with ExitStack() as servers:
        endpoints = {}
        for name, tasks in learned.items():
            instructions, teacher = {task.instruction for task in tasks}, planner_teacher(tasks)
            known = [r for r in requests if instruction_of(r) in instructions or r.data["messages"][-1]["role"] == "user"]
            lessons = [lesson_of(request, teacher(request)) for request in known]
            checkpoint = tiny_planner(folder / name, lessons, template=BRIEF_TEMPLATE)
            url = servers.enter_context(transformers_serve(checkpoint, folder / f"{name}.log"))
            endpoints[name] = ServedModel(url, str(checkpoint))
        yield endpoints


@dataclass(frozen=True)
class SweepRun:
    """A sweep that was killed and resumed. ``finished`` contains the ids of the runs that were finished before the kill."""

    program: Program
    finished: dict[tuple[str, int], str]
    killed_log: Path
    resumed: CommandResult

    @property
    def logs(self) -> dict[str, Path]:
        return {read_evaluation(path).card.pair: path for path in self.program.logs.glob("*.eval")}


@pytest.fixture(scope="module")
def sweep_run(
    planners: dict[str, ServedModel], perception_server: ServedModel, tmp_path_factory: pytest.TempPathFactory, scenes: Path
) -> SweepRun:
    """Run a sweep, kill it during its first pair, and resume it."""
    program = Program(tmp_path_factory.mktemp("sweep"), scenes)
    (program.folder / "models.yaml").write_text(MODELS_YAML.format(vision=perception_server, **planners))
    dump_tasks(TASKS, program.folder / "tasks.jsonl")
    command = (
        "bench", "sweep", "--pairs", "tiny-novice+tiny-vision,tiny-adept+tiny-vision", "--concurrency", "1", "--max-steps", "8",
        "--tasks", str(program.folder / "tasks.jsonl"), "--out", str(program.logs),
    )  # fmt: skip
    process, finished = program.start(*command), dict[tuple[str, int], str]()
    deadline = time.monotonic() + TIMEOUT_S
    try:
        while len(finished) < RUNS_BEFORE_THE_KILL:
            assert process.poll() is None, process.communicate()[1]
            assert time.monotonic() < deadline, "no finished runs in time"
            time.sleep(0.1)
            finished |= program.runs_not_in_log()
    finally:
        process.kill()
        process.communicate()
    (killed_log,) = program.logs.glob("*.eval")
    finished |= program.runs_not_in_log() | {run: str(uuid) for run, uuid in uuids_in(killed_log).items()}
    return SweepRun(program, finished, killed_log, program.run(*command))


JUDGE_MODES = {
    "counting": "vlm_counting", "descriptor": "vlm_query", "location": "vlm_query", "ocr": "hallucination",
    "comparative": "reasoning", "multi_step_reasoning": "lack_of_tool_call", "single_call": "tool_args",
    "multi_step_command": "tool_routing",
}  # fmt: skip


def trusting_verdict(category: str, answer: str) -> tuple[str, str | None]:
    """Return the verdict and the error mode of a judge that believes every claim that a command was executed."""
    return ("correct", None) if category in COMMANDS and answer == DONE_REPLY else ("incorrect", JUDGE_MODES[category])


def judge_teacher(request: Request) -> Say:
    """Return the reply that the tiny judge is trained to give."""
    prompt = request.data["messages"][-1]["content"]
    category = re.findall(r"^Category: (\w+)$", prompt, re.MULTILINE)[0]
    verdict, mode = trusting_verdict(category, prompt.rpartition("\n| ")[2])
    return Say(json.dumps({"reason": "So it seems.", "verdict": verdict, "error_mode": mode or "none"}))


@dataclass(frozen=True)
class JudgedLogs:
    """Logs with the verdicts of a judge. ``rounds`` contains the results of the two ``rescore`` commands."""

    judge: str
    logs: dict[str, Path]
    rounds: list[CommandResult]


@pytest.fixture(scope="module")
def judged_logs(sweep_run: SweepRun, tmp_path_factory: pytest.TempPathFactory) -> JudgedLogs:
    """Judge both logs twice with a checkpoint, which is trained on requests recorded from copies of the logs."""
    from tests.full.tiny_models import tiny_judge

    folder, program = tmp_path_factory.mktemp("judge"), sweep_run.program
    copies = [str(shutil.copy2(path, folder)) for path in sweep_run.logs.values()]
    with Misbehaving(then=good(judge_teacher)) as scripted_model:
        result = program.run("bench", "rescore", *copies, "--judge-url", scripted_model.url, "--judge-model", "scripted")
        assert result.code == 0, result.err
        lessons = [lesson_of(r, judge_teacher(r)) for r in scripted_model.requests if r.chat]
    assert len(lessons) == 2 * len(TASKS)
    checkpoint = tiny_judge(folder / "judge", lessons)
    logs = sweep_run.logs
    with transformers_serve(checkpoint, folder / "serve.log") as url:
        judge = ("--judge-url", url, "--judge-model", str(checkpoint), "--judge-option", "max_tokens=64")
        return JudgedLogs(
            str(checkpoint), logs, [program.run("bench", "rescore", *map(str, logs.values()), *judge) for _ in range(2)]
        )
