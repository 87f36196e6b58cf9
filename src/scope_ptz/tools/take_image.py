"""The tool ``take_image``: save a picture of the current view."""

from __future__ import annotations

from scope_ptz.tools.arguments import Arguments
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.results import PoseData, Result
from scope_ptz.tools.tool import Tool


class TakeImage(Arguments):
    """Save a picture of the current view."""


class ImageResult(Result):
    """The result of ``take_image``, with the file name of the picture in the run folder."""

    file: str


async def take_image(context: ToolContext, arguments: TakeImage) -> ImageResult:  # noqa: ARG001 - tools share one signature
    """Save a picture losslessly."""
    frame = await context.camera.frame()
    name = await context.images.save_picture(frame)
    return ImageResult(message=f"Saved the picture as {name}.", pose=PoseData.of(frame.pose), file=name)


TAKE_IMAGE = Tool("take_image", TakeImage, take_image, "Save a picture")
