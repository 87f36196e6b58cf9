"""``scope bench human``: a person does tasks with the same nine tools, and is judged by the same checks."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench_browse import CATEGORIES
from scope_ptz.cli.bench_inputs import worlds_of
from scope_ptz.cli.endings import ending, put
from scope_ptz.errors import InputError, OutputError, TraceError

if TYPE_CHECKING:
    from scope_ptz.agent.trace import Trace
    from scope_ptz.bench.scoring.trials import Evaluation
    from scope_ptz.bench.tasks.task import Task
    from scope_ptz.cli.human_agent import Left
    from scope_ptz.simulator.pack import Scene

MAX_STEPS = 200


def human(
    split: Annotated[
        str, typer.Option("--split", help="Split (core, lite, paraphrase, reaction, unseen, all) or task file.")
    ] = "lite",
    category: Annotated[str, typer.Option(help="Only tasks of this category.")] = "",
    out: Annotated[Path, typer.Option("--out", help="Folder of the runs; name it again to go on.")] = Path("human"),
    by: Annotated[str, typer.Option("--by", help="Name of the person, for reports.")] = "a person",
    limit: Annotated[int | None, typer.Option(min=1, help="Stop after so many tasks.")] = None,
) -> None:
    """Do tasks yourself: you type what the camera does, and you are its eyes. Stop and go on whenever you like."""
    with ending():
        from scope_ptz.bench.tasks.splits import load_split

        if category and category not in CATEGORIES:
            raise InputError(f"There is no category '{category}'. There are: {', '.join(CATEGORIES)}.")
        tasks = [task for task in load_split(split) if category in ("", task.category)]
        if not tasks:
            raise InputError("There is no such task.")
        _Sitting(tasks, split if split.isalpha() else Path(split).stem, out, by).go(limit)


class _Sitting:
    """A person's way through tasks. Each has a folder with its trace; whatever has ended there is done."""

    def __init__(self, tasks: Sequence[Task], split: str, out: Path, by: str) -> None:
        self.tasks, self.split, self.out, self.by = tasks, split, out, by
        self.worlds = worlds_of(tasks)

    def go(self, limit: int | None) -> None:
        from scope_ptz.cli.human_agent import HELP

        open_tasks = [task for task in self.tasks if self._trace(task) is None]
        put(f"{len(open_tasks)} of {len(self.tasks)} tasks to do. You see what the camera shows, as files. Commands:\n{HELP}")
        for task in open_tasks[:limit]:
            left = self._do(task)
            if left is None:
                put("recorded")
            elif left.for_good:
                break
        self._finish()

    def _folder(self, task: Task) -> Path:
        return self.out / task.id

    def _trace(self, task: Task) -> Trace | None:
        """The finished run of a task."""
        from scope_ptz.agent.trace import read_trace

        try:
            trace = read_trace(self._folder(task))
        except TraceError:
            return None
        return trace if trace.ended is not None else None

    def _do(self, task: Task) -> Left | None:
        """One task; what is not finished leaves nothing."""
        import shutil

        import anyio

        folder = self._folder(task)
        shutil.rmtree(folder, ignore_errors=True)
        try:
            folder.mkdir(parents=True)
        except OSError as error:
            raise OutputError(f"The folder {folder} cannot be made: {error.strerror}. Choose another with --out.") from error
        put(
            f"\n{task.id}\n\n    {task.instruction}\n\n  presets: {', '.join(p.name for p in self.worlds[task.world].file.presets)}"
        )
        left: Left | None = None
        try:
            left = anyio.run(run_by_person, task, self.worlds[task.world], folder, self.by)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        if left is not None:
            shutil.rmtree(folder, ignore_errors=True)
        return left

    def _finish(self) -> None:
        from scope_ptz.bench.human_runs import write_result

        result = self._result()
        if not result.trials:
            put("nothing recorded")
            return
        right = sum(trial.headline == "correct" for trial in result.trials)
        put(f"\n{len(result.trials)} of {result.wanted} tasks done, {right} correct; {write_result(result, self.out)}")

    def _result(self) -> Evaluation:
        from scope_ptz.bench.human_runs import human_run_card, human_trial
        from scope_ptz.bench.scoring.trials import Evaluation

        done = [(task, trace) for task in self.tasks if (trace := self._trace(task)) is not None]
        started = min((trace.started.started for _, trace in done), default=datetime.now(UTC)).isoformat()
        return Evaluation(
            card=human_run_card(self.by, self.split, self.tasks, started, MAX_STEPS),
            trials=tuple(human_trial(task, self.worlds[task.world].file, trace, task.id) for task, trace in done),
            wanted=len(self.tasks),
            log=str(self.out),
        )


async def run_by_person(task: Task, scene: Scene, folder: Path, by: str) -> Left | None:
    """A run in which the person decides and looks, recorded in ``folder``; how it was left, if it was."""
    from scope_ptz.agent.loop import Agent
    from scope_ptz.agent.records import Budgets, RunLabels
    from scope_ptz.agent.store import RunFolder
    from scope_ptz.agent.trace import TraceWriter
    from scope_ptz.camera.simulated import SimulatedCamera
    from scope_ptz.cli.human_agent import HumanPerception, HumanPlanner
    from scope_ptz.cli.human_pictures import Viewer
    from scope_ptz.settings import inline_pictures
    from scope_ptz.simulator.clock import SceneClock

    clock = SceneClock(task.time_s)
    camera = SimulatedCamera(scene, clock=clock)
    with clock.hold():
        await camera.go_to_preset(task.preset)
    terminal = sys.stdout if sys.stdout.isatty() else None
    viewer = Viewer(folder / "shown", terminal, inline_pictures())
    eyes = HumanPerception(by, viewer, input, put)
    planner = HumanPlanner(by, camera, viewer, eyes, input, put)
    labels = RunLabels(perception_note="A person looked.")
    agent = Agent(planner, camera, eyes, RunFolder(folder), budgets=Budgets(max_steps=MAX_STEPS), labels=labels)
    with TraceWriter(folder / "trace.jsonl") as trace:
        await agent.run(task.instruction, listener=trace)
    return planner.left
