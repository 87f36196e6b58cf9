"""Helpers for ``count_objects`` and ``query_answer``: the frame for a view, and sentences about an observation's notes."""

from __future__ import annotations

from scope_ptz.camera.base import Frame
from scope_ptz.perception.base import Answer, Detections
from scope_ptz.tools.arguments import View
from scope_ptz.tools.context import ToolContext


async def view_frame(context: ToolContext, view: View) -> Frame:
    """Return the current frame or, for the full view, a panorama from a sweep."""
    if view == "full":
        from scope_ptz.tools.sweep import sweep  # imported here, because only sweeps require OpenCV

        return await sweep(context.camera)
    return await context.camera.frame()


def note_sentences(observation: Detections | Answer) -> str:
    """Return sentences, each preceded by a space, about corrections to an observation and disagreement with a second backend."""
    sentences = list(observation.notes)
    agreement = observation.agreement
    if agreement is not None and not agreement.agrees:
        sentences.append(f"{agreement.other} sees it differently: {agreement.said}")
    return "".join(" " + sentence.rstrip(".") + "." for sentence in sentences)
