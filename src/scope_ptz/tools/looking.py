"""count_objects and query_answer, on the current view or the full scene."""

from __future__ import annotations

from scope_ptz.camera.base import Frame
from scope_ptz.tools.arguments import CountObjects, QueryAnswer, View
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.results import AnswerResult, CountResult, PoseData
from scope_ptz.tools.sweep import sweep


async def look(context: ToolContext, view: View) -> Frame:
    """The frame that a question is about."""
    return await (sweep(context.camera) if view == "full" else context.camera.frame())


async def count_objects(context: ToolContext, arguments: CountObjects) -> CountResult:
    frame = await look(context, arguments.view)
    found = await context.perception.detect(frame, arguments.description)
    count = len(found.boxes)
    where = "in the full scene" if arguments.view == "full" else "in the current view"
    return CountResult(
        message=f"{count} of '{arguments.description}' {where} (seen by {found.source}).",
        pose=PoseData.of(frame.pose),
        source=found.source,
        view=arguments.view,
        frames=(context.images.save_look(frame),),
        description=arguments.description,
        count=count,
        boxes=found.boxes,
    )


async def query_answer(context: ToolContext, arguments: QueryAnswer) -> AnswerResult:
    frame = await look(context, arguments.view)
    answer = await context.perception.query(frame, arguments.question)
    return AnswerResult(
        message=f"{answer.text} (seen by {answer.source})",
        pose=PoseData.of(frame.pose),
        source=answer.source,
        view=arguments.view,
        frames=(context.images.save_look(frame),),
        question=arguments.question,
        answer=answer.text,
        known=answer.known,
    )
