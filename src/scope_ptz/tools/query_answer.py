"""The tool ``query_answer``: answer a question about the current view or the full scene."""

from __future__ import annotations

from pydantic import Field

from scope_ptz.tools.arguments import Arguments, Phrase, View
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.observing import note_sentences, view_frame
from scope_ptz.tools.results import PerceptionResult, PoseData
from scope_ptz.tools.tool import Tool


class QueryAnswer(Arguments):
    """Answer a question about what the camera sees: existence, colour, text, position, state."""

    question: Phrase = Field(description="The question, in plain words.")
    view: View = Field("current", description="'current' = this view only, 'full' = sweep everything around the camera.")


class AnswerResult(PerceptionResult):
    """The result of ``query_answer``.

    Attributes:
        question: The question.
        answer: The answer.
        known: False when perception reports that it cannot tell.
    """

    question: str
    answer: str
    known: bool


async def query_answer(context: ToolContext, arguments: QueryAnswer) -> AnswerResult:
    """Ask perception a question."""
    frame = await view_frame(context, arguments.view)
    answer = await context.perception.query(frame, arguments.question)
    return AnswerResult(
        message=f"{answer.text} (seen by {answer.source}){note_sentences(answer)}",
        pose=PoseData.of(frame.pose),
        source=answer.source,
        view=arguments.view,
        frames=(await context.images.save_frame(frame),),
        question=arguments.question,
        answer=answer.text,
        known=answer.known,
    )


QUERY_ANSWER = Tool(
    "query_answer",
    QueryAnswer,
    query_answer,
    "Answer a question about the view",
    perceives=True,
    only_reads=lambda arguments: arguments.view == "current",
)
