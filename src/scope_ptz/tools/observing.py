"""Helpers for ``count_objects`` and ``query_answer``: the frame of a view, and sentences about the notes of an observation."""

from __future__ import annotations

from scope_ptz.camera.base import Frame
from scope_ptz.perception.base import Answer, Detections
from scope_ptz.tools.arguments import View
from scope_ptz.tools.context import ToolContext


async def view_frame(context: ToolContext, view: View) -> Frame:
    """Return the current frame or, for the full view, the panorama of a sweep."""
    if view == "full":
        from scope_ptz.tools.sweep import sweep  # only a sweep needs OpenCV

        return await sweep(context.camera)
    return await context.camera.frame()


def note_sentences(observation: Detections | Answer) -> str:
    """Return sentences about corrections to an observation and about a second backend that disagrees, each preceded by a space."""
    sentences = list(observation.notes)
    agreement = observation.agreement
    if agreement is not None and not agreement.agrees:
        sentences.append(f"{agreement.other} sees it differently: {agreement.said}")
    return "".join(" " + sentence.rstrip(".") + "." for sentence in sentences)
