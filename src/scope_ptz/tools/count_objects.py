"""The tool ``count_objects``: count objects in the current view or the full scene."""

from __future__ import annotations

from pydantic import Field

from scope_ptz.perception.base import Box
from scope_ptz.tools.arguments import Arguments, Phrase, View
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.observing import note_sentences, view_frame
from scope_ptz.tools.results import PerceptionResult, PoseData
from scope_ptz.tools.tool import Tool


class CountObjects(Arguments):
    """Count the objects that fit a description."""

    description: Phrase = Field(description="What to count, for example 'traffic cones' or 'red cars'.")
    view: View = Field("current", description="'current' = this view only, 'full' = sweep everything around the camera.")


class CountResult(PerceptionResult):
    """The result of ``count_objects``.

    Attributes:
        description: The description of the counted objects.
        count: The number of matches.
        complete: Whether the count is exact; otherwise it is a lower bound.
        boxes: The matches.
    """

    description: str
    count: int
    complete: bool = True
    boxes: tuple[Box, ...] = ()


async def count_objects(context: ToolContext, arguments: CountObjects) -> CountResult:
    """Count the objects that perception detects in a view."""
    frame = await view_frame(context, arguments.view)
    detections = await context.perception.detect(frame, arguments.description)
    count = len(detections.boxes)
    where = "in the full scene" if arguments.view == "full" else "in the current view"
    number = f"{count}" if detections.complete else f"At least {count}" if count else "No clear view"
    return CountResult(
        message=f"{number} of '{arguments.description}' {where} (seen by {detections.source}).{note_sentences(detections)}",
        pose=PoseData.of(frame.pose),
        source=detections.source,
        view=arguments.view,
        frames=(await context.images.save_frame(frame),),
        description=arguments.description,
        count=count,
        complete=detections.complete,
        boxes=detections.boxes,
    )


COUNT_OBJECTS = Tool(
    "count_objects",
    CountObjects,
    count_objects,
    "Count objects",
    perceives=True,
    only_reads=lambda arguments: arguments.view == "current",
)
