"""The commands about the benchmark."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.endings import FAILED, complain, ending, put, put_json

if TYPE_CHECKING:
    from scope_ptz.bench.tasks import Task
    from scope_ptz.world.pack import Scene

bench_app = typer.Typer(help="The benchmark: its tasks and how they are checked.", no_args_is_help=True)
TasksFile = Annotated[Path | None, typer.Option("--tasks", help="Task file (JSONL or YAML); by default the published tasks.")]
SceneNames = Annotated[list[str] | None, typer.Option("--scene", help="A scene to make tasks of; by default every one there is.")]


@bench_app.callback()
def bench() -> None:
    """The benchmark: its tasks and how they are checked."""


@bench_app.command("schema")
def schema() -> None:
    """Print the JSON schema of a task."""
    with ending():
        from scope_ptz.bench.tasks import schema as task_schema

        put_json(task_schema(), indent=2)


@bench_app.command("build")
def build(
    out: Annotated[Path, typer.Option("--out", help="Where the tasks go (JSONL).")],
    scene: SceneNames = None,
    seed: Annotated[int, typer.Option(help="Another seed makes another dataset of the same scenes.")] = 1,
    share: Annotated[float, typer.Option(min=0.02, max=1.0, help="Share of the published numbers to make.")] = 1.0,
) -> None:
    """Make tasks from the ground truth of scenes. Exit code 1 when the scenes do not yield the numbers wanted."""
    with ending():
        from scope_ptz.bench.authoring.assembly import QUOTAS
        from scope_ptz.bench.authoring.assembly import build as make
        from scope_ptz.bench.task_files import dump_tasks

        quotas = None if share == 1.0 else {name: max(2, round(number * share)) for name, number in QUOTAS.items()}
        made = make(list(_scenes(scene).values()), seed, quotas, complain)
        out.parent.mkdir(parents=True, exist_ok=True)
        dump_tasks(made.tasks, out)
        put(f"{len(made.tasks)} tasks in {out}")
        if made.short:
            complain("too few: " + ", ".join(f"{number} of {name} are missing" for name, number in made.short.items()))
            sys.exit(FAILED)


@bench_app.command("validate")
def validate(
    tasks: TasksFile = None,
    as_json: Annotated[bool, typer.Option("--json", help="The whole report as JSON.")] = False,
    seed: Annotated[int, typer.Option(help="For the wrong answers that are tried.")] = 1,
) -> None:
    """Prove the tasks: right programs and answers pass, cheats do not. Exit code 1 on any failure."""
    with ending(as_json=as_json):
        import anyio

        from scope_ptz.bench.validate import validate as prove
        from scope_ptz.cli.bench_eyes import KnownViews, equip_with_truth
        from scope_ptz.cli.bench_report import report_lines

        rows = _tasks(tasks)
        scenes = _scenes(sorted({task.scene for task in rows}))
        views = KnownViews()
        report = anyio.run(lambda: prove(rows, scenes, equip_with_truth(scenes, views), seed=seed, look=views.look))
        if as_json:
            put_json(report.as_dict())
        else:
            for line in report_lines(report):
                put(line)
        if not report.sound:
            sys.exit(FAILED)


@bench_app.command("browse")
def browse(
    task: Annotated[str, typer.Argument(help="Id of a task, or its end (counting-017).")],
    tasks: TasksFile = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for the frames of its evidence, with boxes.")] = None,
) -> None:
    """Show a task: what is asked and expected, the run of its reference program, and the frames that it rests on."""
    with ending():
        from scope_ptz.cli.bench_browse import frames, reference_run, summary
        from scope_ptz.errors import InputError

        found = [row for row in _tasks(tasks) if row.id == task or row.id.endswith(f"-{task}")]
        if len(found) != 1:
            raise InputError(f"There is {'no task' if not found else 'more than one task'} '{task}'. Give a whole id.")
        (chosen,) = found
        scene = _scenes([chosen.scene])[chosen.scene]
        for line in (*summary(chosen), *reference_run(chosen, scene)):
            put(line)
        if out is not None:
            for path in frames(chosen, scene, out):
                put(f"frame      {path}")


def _tasks(path: Path | None) -> tuple[Task, ...]:
    """The tasks of a file; without one those that come with the package."""
    from importlib.resources import files

    from scope_ptz.bench.task_files import load_tasks
    from scope_ptz.errors import InputError

    published = Path(str(files("scope_ptz"))) / "data" / "bench" / "tasks.jsonl"
    if path is None and not published.is_file():
        raise InputError("No tasks come with this installation. Make some with 'scope bench build' and give --tasks.")
    return load_tasks(path or published)


def _scenes(names: list[str] | None) -> dict[str, Scene]:
    from scope_ptz.cli.session import open_scene, scene_search
    from scope_ptz.settings import load_settings
    from scope_ptz.world.pack import list_scenes

    return {name: open_scene(name) for name in names or list_scenes(scene_search(load_settings()))}
