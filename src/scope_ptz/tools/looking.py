"""count_objects and query_answer, on the current view or the full scene."""

from __future__ import annotations

from scope_ptz.camera.base import Frame
from scope_ptz.perception.base import Answer, Detections
from scope_ptz.tools.arguments import CountObjects, QueryAnswer, View
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.results import AnswerResult, CountResult, PoseData
from scope_ptz.tools.sweep import sweep


async def look(context: ToolContext, view: View) -> Frame:
    """The frame that a question is about."""
    return await (sweep(context.camera) if view == "full" else context.camera.frame())


def remarks(seen: Detections | Answer) -> str:
    """What a planner should know of a result beside it: what was corrected in it, and a second opinion that differs."""
    said = list(seen.notes)
    if seen.agreement is not None and not seen.agreement.agrees:
        said.append(f"{seen.agreement.other} sees it differently: {seen.agreement.said}")
    return "".join(" " + remark.rstrip(".") + "." for remark in said)


async def count_objects(context: ToolContext, arguments: CountObjects) -> CountResult:
    frame = await look(context, arguments.view)
    found = await context.perception.detect(frame, arguments.description)
    count = len(found.boxes)
    where = "in the full scene" if arguments.view == "full" else "in the current view"
    number = f"{count}" if found.complete else f"At least {count}"
    return CountResult(
        message=f"{number} of '{arguments.description}' {where} (seen by {found.source}).{remarks(found)}",
        pose=PoseData.of(frame.pose),
        source=found.source,
        view=arguments.view,
        frames=(context.images.save_look(frame),),
        description=arguments.description,
        count=count,
        complete=found.complete,
        boxes=found.boxes,
    )


async def query_answer(context: ToolContext, arguments: QueryAnswer) -> AnswerResult:
    frame = await look(context, arguments.view)
    answer = await context.perception.query(frame, arguments.question)
    return AnswerResult(
        message=f"{answer.text} (seen by {answer.source}){remarks(answer)}",
        pose=PoseData.of(frame.pose),
        source=answer.source,
        view=arguments.view,
        frames=(context.images.save_look(frame),),
        question=arguments.question,
        answer=answer.text,
        known=answer.known,
    )
