"""Create gold runs from reference programs, and format their confusion matrix as lines of text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from scope_ptz.bench.program_runner import MakeToolContext, ProgramRunner
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.verdict import score_episode
from scope_ptz.bench.tasks.task import Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.task_places import preset_position
from scope_ptz.taskgen.facts.answer_phrasing import correct_answers
from scope_ptz.taskgen.facts.robust import TASK_CAMERA
from scope_ptz.taskgen.gold.gold_runs import WITHOUT_MODE, confusion_matrix, create_gold_runs
from scope_ptz.taskgen.gold.mutations import FaultContext, GoldRun


async def make_gold_runs(
    tasks: Sequence[Task], worlds: Mapping[str, Scene], make_context: MakeToolContext, seed: int
) -> list[GoldRun]:
    """Run the reference programs of tasks with the real tools, and insert known faults into a selection of the runs.

    Args:
        tasks: Tasks. Only core tasks with a reference program are used.
        worlds: The scenes and variations that the tasks use, by name.
        make_context: Creates the tool context for a camera.
        seed: Seed for the selection of runs and faults.
    """
    runners = {name: ProgramRunner(world, make_context, TASK_CAMERA) for name, world in worlds.items()}
    fault_contexts = {
        name: FaultContext({p.name: preset_position(p) for p in world.file.presets}, TASK_CAMERA) for name, world in worlds.items()
    }
    runs = []
    for task in tasks:
        if task.stratum == "core" and task.reference:
            episode = await runners[task.world].run(task, task.reference, correct_answers(task.expected)[0])
            if score_episode(task, episode).headline == "correct":
                runs.append((task, episode))
    return create_gold_runs(runs, fault_contexts, seed)


COLUMN_NAMES = {
    "lack_of_tool_call": "lack", "tool_routing": "routing", "tool_args": "args", "hallucination": "halluc.",
    "vlm_counting": "counting", "vlm_query": "query",
}  # fmt: skip
"""Short names of error modes, for the columns of the confusion matrix."""


def matrix_lines(gold: Sequence[GoldRun]) -> Iterator[str]:
    """Yield the confusion matrix (rows: inserted faults, columns: assigned error modes), then every run off the diagonal."""
    result = confusion_matrix(gold)
    columns = [*(mode.value for mode in ErrorMode), *WITHOUT_MODE]
    yield f"{'inserted fault':<18}" + "".join(f"{COLUMN_NAMES.get(name, name):>11}" for name in columns)
    for mode in ErrorMode:
        yield f"{mode.value.replace('_', ' '):<18}" + "".join(
            f"{result.cells[mode.value, reported] or '.':>11}" for reported in columns
        )
    accepted = f"{result.accepted} judged correct, a false-accept rate of {result.false_accept_rate:.1%}"
    yield f"{result.correct_modes} of {result.total} error modes are correct; {accepted}"
    for task, fault, fault_mode, reported in result.off_diagonal:
        yield f"  {task}: {fault} ({fault_mode}) was assigned the mode {reported}"
