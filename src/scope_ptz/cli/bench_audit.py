"""``scope bench audit``: pictures and questions for readers who know nothing else, and how far they agree with the tasks."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from scope_ptz.cli.bench_inputs import TasksOption, worlds_of
from scope_ptz.cli.endings import complain, ending, put, put_json
from scope_ptz.errors import InputError, OutputError

if TYPE_CHECKING:
    from scope_ptz.bench.program_runner import ProgramRunner
    from scope_ptz.bench.scoring.episode import Observation
    from scope_ptz.bench.tasks.task import Task
    from scope_ptz.simulator.pack import Scene

audit_app = typer.Typer(
    help="Readers who see only pictures answer tasks: draw the questions, score the answers.", no_args_is_help=True
)

_README = """# Questions about pictures

`questions.jsonl` holds a question a line: its number `q`, what was asked of somebody who steers a camera, and the `pictures` that
the camera then showed, in that order, each with its `caption`. Answer from the pictures alone, as you would tell a colleague.

Write `answers.jsonl`, a line a question: {"q": "q001", "answer": "There are two.", "reader": "your name"}
Answer every question; "I cannot tell" is an answer.
"""


@audit_app.command("make")
def make(
    out: Annotated[Path, typer.Option("--out", help="A new folder for pictures and questions.")],
    tasks: TasksOption = "core",
    number: Annotated[int, typer.Option("--n", min=1, help="How many tasks.")] = 100,
    seed: Annotated[int, typer.Option(help="Which of them.")] = 1,
) -> None:
    """QuestionDraw tasks by category, scene and difficulty; write the frames that their answers rest on and the questions."""
    with ending():
        import anyio

        from scope_ptz.bench.program_runner import ProgramRunner
        from scope_ptz.bench.tasks.files import digest_of
        from scope_ptz.bench.tasks.splits import load_split
        from scope_ptz.cli.bench_show import EYES
        from scope_ptz.factory.validation_perception import KnownViews, equip_with_truth
        from scope_ptz.taskgen.picture_audit import DRAW, QUESTIONS, QuestionDraw, draw_questions

        rows = load_split(tasks)
        chosen = draw_questions(rows, number, seed)
        if not chosen:
            raise InputError("None of these tasks wants an answer: there is nothing to ask.")
        worlds = worlds_of([task for _, task in chosen])
        equip = equip_with_truth(worlds, KnownViews())
        stages = {name: ProgramRunner(world, equip, EYES) for name, world in worlds.items()}
        try:
            out.mkdir(parents=True)
        except FileExistsError as error:
            raise OutputError(f"{out} is there already. Name a new folder with --out.") from error
        except OSError as error:
            raise OutputError(f"{out} cannot be made: {error.strerror}.") from error
        questions = [anyio.run(_question, q, task, stages[task.world], out) for q, task in chosen]
        (out / QUESTIONS).write_text("".join(json.dumps(row, ensure_ascii=False) + "\n" for row in questions), "utf-8")
        draw = QuestionDraw(number=number, seed=seed, tasks=digest_of(rows))
        (out / DRAW).write_text(draw.model_dump_json() + "\n", "utf-8")
        (out / "README.md").write_text(_README, "utf-8")
        put(f"{len(questions)} questions and {sum(len(row['pictures']) for row in questions)} pictures in {out}")


@audit_app.command("score")
def score(
    folder: Annotated[Path, typer.Argument(help="Folder of 'audit make' with answers.jsonl in it.")],
    tasks: TasksOption = "core",
    out: Annotated[Path | None, typer.Option("--out", help="Where the result goes, for the dataset card (audit.json).")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="The result as JSON.")] = False,
) -> None:
    """Read the answers with the benchmark's own reader. What looking into a disagreement showed goes into findings.jsonl."""
    with ending(as_json=as_json):
        from scope_ptz.bench.tasks.splits import load_split
        from scope_ptz.taskgen.picture_audit import score_answers as hold

        audit = hold(folder, load_split(tasks))
        if out is not None:
            out.write_text(json.dumps(audit.as_dict(), indent=1, ensure_ascii=False) + "\n", "utf-8")
        if as_json:
            put_json(audit.as_dict())
            return
        right, of = audit.share()
        put(f"{right} of {of} answers agree")
        for row in audit.rows:
            if row.outcome != "agrees":
                put(f"{row.q} {row.task} {row.outcome}: {row.instruction!r}")
                put(f"     {row.reader or 'nobody'} said {row.answer!r}, expected is {row.expected!r}. {row.finding}")


async def _question(q: str, task: Task, stage: ProgramRunner, out: Path) -> dict[str, Any]:
    """The row of a question; its pictures are written."""
    import cv2

    from scope_ptz.simulator.views import picture

    episode = await stage.run(task, task.reference, "")
    looks = list({(look.viewpoint, look.projection): look for call in episode.calls for look in call.observations[:1]}.values())
    shown = []
    for number, look in enumerate(looks, 1):
        name = f"{q}-{number}.jpg"
        image = picture(stage.scene, str(look.viewpoint), look.projection, look.time_s)
        if not cv2.imwrite(str(out / name), cv2.cvtColor(image, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, 95]):
            raise OutputError(f"{out / name} cannot be written.")
        shown.append({"file": name, "caption": _caption(look, stage.scene)})
    if not shown:
        complain(f"{task.id} looks at nothing")
    return {"q": q, "asked": task.instruction, "pictures": shown}


def _caption(look: Observation, scene: Scene) -> str:
    """Where a picture was taken, as whoever steers the camera would know it."""
    from scope_ptz.geometry import AXIS_M5075_G, Perspective

    view = look.projection
    if not isinstance(view, Perspective):
        return "everything around the camera, from pan -180 to 180 degrees"
    zoom = AXIS_M5075_G.zoom_for_hfov(view.hfov_deg)
    at = [
        p.name
        for p in scene.file.presets
        if p.viewpoint == look.viewpoint
        and abs(p.pan_deg - view.pan_deg) < 0.01
        and abs(p.tilt_deg - view.tilt_deg) < 0.01
        and abs(p.zoom - zoom) < 0.01
    ]
    place = f"preset {at[0]}" if at else f"camera at the {look.viewpoint}"
    return f"{place}: pan {view.pan_deg:.4g}, tilt {view.tilt_deg:.4g} degrees, zoom {zoom:.3g}x"
