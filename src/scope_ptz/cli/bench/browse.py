"""``scope bench browse`` and ``audit``: show tasks with their evidence, and check them with annotators who see only pictures."""

from __future__ import annotations

import json
import random
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench.flags import TasksOption, check_category
from scope_ptz.cli.exit import print_error, put, put_json
from scope_ptz.cli.options import JsonOption
from scope_ptz.cli.typer_extensions import command
from scope_ptz.errors import InputError, OutputError

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Task

MAX_AMBIGUOUS_LISTED = 4

audit_app = typer.Typer(help="Check tasks with annotators who see only the pictures.", no_args_is_help=True)

_README = """# Questions about pictures

`questions.jsonl` contains one question per line: its number `q`, what the operator of a camera was `asked`, and the `pictures` that
the camera then showed, in that order, each with its `caption`. Answer from the pictures alone, as you would to a colleague.

Write `answers.jsonl` with one line per question: {"q": "q001", "answer": "There are two.", "reader": "your name"}
Answer every question; "I cannot tell" is an answer.
"""


def browse(
    task: Annotated[str, typer.Argument(help="Id of a task, or the end of one (counting-017).")] = "",
    tasks: Annotated[str, typer.Option("--tasks", help="Split or task file (default: every split).")] = "",
    category: Annotated[str, typer.Option(help="Show only tasks in this category.")] = "",
    scene: Annotated[str, typer.Option("--scene", help="Show only tasks in this scene.")] = "",
    at_random: Annotated[bool, typer.Option("--random", help="Show one of the matching tasks at random.")] = False,
    seed: Annotated[int | None, typer.Option(help="Seed for --random.")] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for pictures of the start view and of the evidence.")] = None,
) -> None:
    """List tasks, or show one: instruction, expected answer, reference run, and the frames that contain its evidence."""
    matches = _matching_tasks(_load_tasks(tasks), check_category(category), scene)
    if task:
        chosen = _task_with_id(matches, task)
    elif at_random:
        chosen = random.Random(seed).choice(matches)
    else:
        for candidate in matches:
            put(f"{candidate.id:<52} {candidate.instruction}")
        return
    from scope_ptz.factory.validation_perception import ground_truth_tools
    from scope_ptz.factory.worlds import open_worlds
    from scope_ptz.taskgen.task_sheet import reference_run, summary, write_frames

    worlds = open_worlds([chosen])
    (world,) = worlds.values()
    for line in summary(chosen, [candidate for candidate in _load_tasks(tasks) if candidate.paraphrase_of == chosen.id]):
        put(line)
    for line in reference_run(chosen, world, ground_truth_tools(worlds)):
        put(line)
    if out is not None:
        for path in write_frames(chosen, world, out):
            put(f"picture    {path}")


def _load_tasks(name: str) -> tuple[Task, ...]:
    from scope_ptz.bench.tasks.splits import load_split

    return load_split(name) if name else (*load_split("all"), *load_split("unseen"))


def _matching_tasks(tasks: tuple[Task, ...], category: str, scene: str) -> list[Task]:
    matches = [task for task in tasks if category in ("", task.category) and scene in ("", task.scene, task.world)]
    if not matches:
        raise InputError("No task matches. Remove --category or --scene, or select other tasks with --tasks.")
    return matches


def _task_with_id(tasks: list[Task], task_id: str) -> Task:
    exact = [task for task in tasks if task.id == task_id]
    matches = exact or [task for task in tasks if task.id.endswith(f"-{task_id}")]
    if not matches:
        raise InputError(f"There is no task '{task_id}'. List them with 'scope bench browse --category counting'.")
    if len(matches) > 1:
        names = ", ".join(task.id for task in matches[:MAX_AMBIGUOUS_LISTED])
        raise InputError(f"Several tasks end with '{task_id}': {names}. Give a full id.")
    return matches[0]


@audit_app.command("make")
@command
def audit_make(
    out: Annotated[Path, typer.Option("--out", help="New folder for pictures and questions.")],
    tasks: TasksOption = "core",
    number: Annotated[int, typer.Option("--n", min=1, help="Number of tasks to sample.")] = 100,
    seed: Annotated[int, typer.Option(help="Seed for the sample.")] = 1,
) -> None:
    """Sample tasks by category, scene and difficulty, and write their questions with the frames that show the answers."""
    import anyio

    from scope_ptz.bench.program_runner import ProgramRunner
    from scope_ptz.bench.tasks.files import digest_of
    from scope_ptz.bench.tasks.splits import load_split
    from scope_ptz.factory.validation_perception import TruthCache, ground_truth_tools
    from scope_ptz.factory.worlds import open_worlds
    from scope_ptz.taskgen.audit_questions import write_question
    from scope_ptz.taskgen.facts.robust import TASK_CAMERA
    from scope_ptz.taskgen.picture_audit import DRAW, QUESTIONS, QuestionDraw, draw_questions

    all_tasks = load_split(tasks)
    sampled = draw_questions(all_tasks, number, seed)
    if not sampled:
        raise InputError("None of these tasks expects an answer, so there is nothing to ask. Select other tasks with --tasks.")
    worlds = open_worlds([task for _, task in sampled])
    make_context = ground_truth_tools(worlds, TruthCache())
    runners = {name: ProgramRunner(world, make_context, TASK_CAMERA) for name, world in worlds.items()}
    try:
        out.mkdir(parents=True)
    except FileExistsError as error:
        raise OutputError(f"{out} already exists. Specify a new folder with --out.") from error
    except OSError as error:
        raise OutputError(f"{out} cannot be created: {error.strerror}.") from error
    questions = [
        anyio.run(write_question, question_number, task, runners[task.world], out, print_error) for question_number, task in sampled
    ]
    (out / QUESTIONS).write_text("".join(json.dumps(question, ensure_ascii=False) + "\n" for question in questions), "utf-8")
    draw = QuestionDraw(number=number, seed=seed, tasks=digest_of(all_tasks))
    (out / DRAW).write_text(draw.model_dump_json() + "\n", "utf-8")
    (out / "README.md").write_text(_README, "utf-8")
    put(f"{len(questions)} questions and {sum(len(question['pictures']) for question in questions)} pictures in {out}")


@audit_app.command("score")
@command
def audit_score(
    folder: Annotated[Path, typer.Argument(help="Folder that 'audit make' wrote, with answers.jsonl in it.")],
    tasks: TasksOption = "core",
    out: Annotated[
        Path | None, typer.Option("--out", help="File to save the result in; the dataset card reads audit.json.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Compare the answers with the tasks, using the benchmark's own answer parser.

    Write explanations of disagreements to findings.jsonl in the folder.
    """
    from scope_ptz.bench.tasks.splits import load_split
    from scope_ptz.taskgen.picture_audit import score_answers

    audit = score_answers(folder, load_split(tasks))
    if out is not None:
        out.write_text(json.dumps(audit.as_dict(), indent=1, ensure_ascii=False) + "\n", "utf-8")
    if as_json:
        put_json(audit.as_dict())
        return
    agreeing, total = audit.agreement_counts()
    put(f"{agreeing} of {total} answers agree")
    for row in audit.rows:
        if row.outcome != "agrees":
            put(f"{row.q} {row.task} {row.outcome}: {row.instruction!r}")
            put(f"     {row.reader or 'nobody'} answered {row.answer!r}, expected {row.expected!r}. {row.finding}")
