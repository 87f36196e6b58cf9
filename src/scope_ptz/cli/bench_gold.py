"""``scope bench gold``: runs with known faults, and whether the rules still name them."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench_inputs import TasksOption, worlds_of
from scope_ptz.cli.endings import FAILED, ending, put, put_json

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Task
    from scope_ptz.taskgen.gold.mutations import GoldRun

gold_app = typer.Typer(help="Runs with one known fault each: what the error-mode rules make of them.", no_args_is_help=True)
AsJson = Annotated[bool, typer.Option("--json", help="The result as JSON.")]


@gold_app.command("make")
def make(
    out: Annotated[Path, typer.Option("--out", help="Where the runs go (gzipped JSONL).")],
    tasks: TasksOption = "core",
    seed: Annotated[int, typer.Option(help="Another seed puts other faults into other runs.")] = 1,
    as_json: AsJson = False,
) -> None:
    """Run the reference programs through the real tools and put one known fault into each of some of them."""
    with ending(as_json=as_json):
        import anyio

        from scope_ptz.bench.tasks.splits import load_split
        from scope_ptz.taskgen.gold.gold_runs import confusion_matrix, write_gold

        gold = anyio.run(made_gold, load_split(tasks), seed)
        out.parent.mkdir(parents=True, exist_ok=True)
        write_gold(gold, out)
        if as_json:
            put_json(confusion_matrix(gold).as_dict())
            return
        for line in (*matrix_lines(gold), f"{len(gold)} runs in {out}"):
            put(line)


@gold_app.command("check")
def check(
    gold: Annotated[Path | None, typer.Option("--gold", help="File of gold runs; by default the published one.")] = None,
    tasks: TasksOption = "core",
    as_json: AsJson = False,
) -> None:
    """Apply the rules to the gold runs again. Exit code 1 when fewer faults are named, or more let through, than published."""
    with ending(as_json=as_json):
        from scope_ptz.bench.tasks.splits import load_split, published_folder
        from scope_ptz.taskgen.gold.gold_runs import confusion_matrix, read_gold

        published, runs = read_gold(gold or published_folder() / "gold.jsonl.gz", load_split(tasks))
        result = confusion_matrix(runs)
        worse = result.worse_than(published)
        if as_json:
            put_json({**result.as_dict(), "published": published, "worse": worse})
        else:
            for line in matrix_lines(runs):
                put(line)
            put(f"published: {published['named']} named, {published['accepted']} accepted; {'WORSE' if worse else 'not worse'} now")
        if worse:
            sys.exit(FAILED)


async def made_gold(tasks: Sequence[Task], seed: int) -> list[GoldRun]:
    """Gold runs of tasks: their reference programs through the tools with the ground truth for eyes, then the faults."""
    from scope_ptz.bench.program_runner import ProgramRunner
    from scope_ptz.bench.scoring.verdict import score_episode
    from scope_ptz.factory.validation_perception import KnownViews, equip_with_truth
    from scope_ptz.taskgen.authoring.task_places import preset_at
    from scope_ptz.taskgen.facts.answer_phrasing import right_answers
    from scope_ptz.taskgen.facts.robust import TASK_CAMERA
    from scope_ptz.taskgen.gold.gold_runs import gold_runs
    from scope_ptz.taskgen.gold.mutations import FaultSetting

    worlds = worlds_of(tasks)
    equip = equip_with_truth(worlds, KnownViews())
    stages = {name: ProgramRunner(world, equip, TASK_CAMERA) for name, world in worlds.items()}
    settings = {
        name: FaultSetting({p.name: preset_at(p) for p in world.file.presets}, TASK_CAMERA) for name, world in worlds.items()
    }
    runs = []
    for task in tasks:
        if task.stratum == "core" and task.reference:
            episode = await stages[task.world].run(task, task.reference, right_answers(task.expected)[0])
            if score_episode(task, episode).headline == "correct":
                runs.append((task, episode))
    return gold_runs(runs, settings, seed)


HEADS = {
    "lack_of_tool_call": "lack", "tool_routing": "routing", "tool_args": "args", "hallucination": "halluc.",
    "vlm_counting": "counting", "vlm_query": "query",
}  # fmt: skip
"""Short words for the columns of the matrix."""


def matrix_lines(gold: Sequence[GoldRun]) -> Iterator[str]:
    """The confusion matrix, rows the faults put in, columns what they were taken for; then every run off the diagonal."""
    from scope_ptz.bench.scoring.error_modes import ErrorMode
    from scope_ptz.taskgen.gold.gold_runs import OTHER, confusion_matrix

    result = confusion_matrix(gold)
    columns = [*(mode.value for mode in ErrorMode), *OTHER]
    yield f"{'fault put in':<18}" + "".join(f"{HEADS.get(name, name):>11}" for name in columns)
    for mode in ErrorMode:
        yield f"{mode.value.replace('_', ' '):<18}" + "".join(f"{result.cells[mode.value, told] or '.':>11}" for told in columns)
    accepted = f"{result.accepted} judged correct, a false-accept rate of {result.false_accept_rate:.1%}"
    yield f"{result.named} of {result.total} named as they are; {accepted}"
    for task, fault, mode_in, told in result.off_diagonal:
        yield f"  {task}: {fault} ({mode_in}) was taken for {told}"
