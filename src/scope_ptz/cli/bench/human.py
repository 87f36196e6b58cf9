"""``scope bench human``: record a human baseline with the same tools and checks as for models."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench.flags import SPLITS, check_category
from scope_ptz.cli.exit import put
from scope_ptz.errors import InputError, OutputError, TraceError

if TYPE_CHECKING:
    from scope_ptz.agent.trace import Trace
    from scope_ptz.bench.human_agent import TaskLeftError
    from scope_ptz.bench.scoring.trials import Evaluation
    from scope_ptz.bench.tasks.task import Task
    from scope_ptz.simulator.pack import Scene

MAX_STEPS = 200  # maximum number of steps per run


def human(
    split: Annotated[str, typer.Option("--split", help=f"Split ({SPLITS}) or task file.")] = "lite",
    category: Annotated[str, typer.Option(help="Do only tasks of this category.")] = "",
    out: Annotated[Path, typer.Option("--out", help="Folder for the runs. Give the same folder again to resume.")] = Path("human"),
    by: Annotated[str, typer.Option("--by", help="Name of the person in reports.")] = "a person",
    limit: Annotated[int | None, typer.Option(min=1, help="Stop after N tasks.")] = None,
) -> None:
    """Do tasks yourself, as a human baseline: you type the commands and look at the pictures.

    You can quit and resume at any time.
    """
    from scope_ptz.bench.tasks.splits import load_split

    category = check_category(category)
    tasks = [task for task in load_split(split) if category in ("", task.category)]
    if not tasks:
        raise InputError("No task matches. Leave out --category, or name another --split.")
    _Session(tasks, split if split.isalpha() else Path(split).stem, out, by).run(limit)


class _Session:
    """A session in which a person does tasks. Each finished task has a folder with its trace."""

    def __init__(self, tasks: Sequence[Task], split: str, out: Path, by: str) -> None:
        self.tasks, self.split, self.out, self.by = tasks, split, out, by
        from scope_ptz.factory.worlds import open_worlds

        self.worlds = open_worlds(tasks)

    def run(self, limit: int | None) -> None:
        """Let the person do the tasks that are not finished yet."""
        from scope_ptz.bench.human_agent import HELP

        remaining = [task for task in self.tasks if self._trace(task) is None]
        put(f"{len(remaining)} of {len(self.tasks)} tasks to do. The camera's pictures are written to files. Commands:\n{HELP}")
        for task in remaining[:limit]:
            interruption = self._do_task(task)
            if interruption is None:
                put("Recorded.")
            elif interruption.ends_session:
                break
        self._print_result()

    def _folder(self, task: Task) -> Path:
        return self.out / task.id

    def _trace(self, task: Task) -> Trace | None:
        """Return the trace of a finished task; None if the task is not finished."""
        from scope_ptz.agent.trace import read_trace

        try:
            trace = read_trace(self._folder(task))
        except TraceError:
            return None
        return trace if trace.ended is not None else None

    def _do_task(self, task: Task) -> TaskLeftError | None:
        """Let the person do one task. If the person leaves the task unfinished, its run is deleted.

        Returns:
            How the person left the task; None if the task is finished.
        """
        import anyio

        folder = self._folder(task)
        shutil.rmtree(folder, ignore_errors=True)
        try:
            folder.mkdir(parents=True)
        except OSError as error:
            raise OutputError(f"The folder {folder} cannot be created: {error.strerror}. Choose another with --out.") from error
        put(
            f"\n{task.id}\n\n    {task.instruction}\n\n  presets: {', '.join(p.name for p in self.worlds[task.world].file.presets)}"
        )
        interruption: TaskLeftError | None = None
        try:
            interruption = anyio.run(run_by_person, task, self.worlds[task.world], folder, self.by)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        if interruption is not None:
            shutil.rmtree(folder, ignore_errors=True)
        return interruption

    def _print_result(self) -> None:
        from scope_ptz.bench.human_runs import write_result

        result = self._result()
        if not result.trials:
            put("No runs were recorded.")
            return
        correct = sum(trial.headline == "correct" for trial in result.trials)
        put(f"\n{len(result.trials)} of {result.wanted} tasks done, {correct} correct; {write_result(result, self.out)}")

    def _result(self) -> Evaluation:
        from scope_ptz.bench.human_runs import human_run_card, human_trial
        from scope_ptz.bench.scoring.trials import Evaluation

        finished_runs = [(task, trace) for task in self.tasks if (trace := self._trace(task)) is not None]
        started = min((trace.started.started for _, trace in finished_runs), default=datetime.now(UTC)).isoformat()
        return Evaluation(
            card=human_run_card(self.by, self.split, self.tasks, started, MAX_STEPS),
            trials=tuple(human_trial(task, self.worlds[task.world].file, trace, task.id) for task, trace in finished_runs),
            wanted=len(self.tasks),
            log=str(self.out),
        )


async def run_by_person(task: Task, scene: Scene, folder: Path, by: str) -> TaskLeftError | None:
    """Record a run in which a person is both planner and perception.

    Returns:
        How the person left the task; None if the task is finished.
    """
    from scope_ptz.agent.loop import Agent
    from scope_ptz.agent.records import Budgets, RunLabels
    from scope_ptz.agent.store import RunFolder
    from scope_ptz.agent.trace import TraceWriter
    from scope_ptz.bench.human_agent import HumanPerception, HumanPlanner
    from scope_ptz.bench.human_viewer import Viewer
    from scope_ptz.camera.simulated import SimulatedCamera
    from scope_ptz.settings import inline_pictures
    from scope_ptz.simulator.clock import SceneClock

    clock = SceneClock(task.time_s)
    camera = SimulatedCamera(scene, clock=clock)
    with clock.hold():
        await camera.go_to_preset(task.preset)
    terminal = sys.stdout if sys.stdout.isatty() else None
    viewer = Viewer(folder / "shown", terminal, inline_pictures())
    perception = HumanPerception(by, viewer, input, put)
    planner = HumanPlanner(by, camera, viewer, perception, input, put)
    labels = RunLabels(perception_note="A person looked.")
    agent = Agent(planner, camera, perception, RunFolder(folder), budgets=Budgets(max_steps=MAX_STEPS), labels=labels)
    with TraceWriter(folder / "trace.jsonl") as trace:
        await agent.run(task.instruction, listener=trace)
    return planner.exit_error
