"""Text at the bottom of the 3D viewport that shows the current step of a run or its answer."""

from __future__ import annotations

import textwrap
from typing import Any

import blf
import bpy

from .session import session

_TEXT, _ACCENT, _BACKGROUND = (1.0, 1.0, 1.0, 1.0), (0.298, 0.765, 0.969, 1.0), (0.05, 0.07, 0.1, 0.82)
_handles: list[object] = []


def add() -> None:
    """Start drawing."""
    if not bpy.app.background:
        _handles.append(bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL"))


def remove() -> None:
    """Stop drawing."""
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")


def text() -> tuple[str, str]:
    """Return the heading and the body; both are empty if nothing is shown."""
    if session.run is not None:
        last = session.steps[-1].text if session.steps else session.activity
        return session.run.instruction, last
    if session.end is not None and session.state == "connected":
        return session.end.outcome, session.end.text
    return "", ""


def _draw() -> None:
    heading, body = text()
    region = bpy.context.region
    if not heading or region is None or not bpy.context.space_data.overlay.show_overlays:
        return
    scale = bpy.context.preferences.system.ui_scale
    size, margin = 15 * scale, 14 * scale
    _set_size(size)
    start, end = _free_range(region)
    columns = max(20, int((0.8 * (end - start) - 2 * margin) / (size * 0.55)))
    lines = [heading[:columns], *textwrap.wrap(body, columns)[:4]]
    width = max(blf.dimensions(0, line)[0] for line in lines)
    height = len(lines) * size * 1.45
    left, bottom = (start + end - width) / 2, 24 * scale
    _rectangle(left - margin, bottom - margin, width + 2 * margin, height + 1.6 * margin)
    for number, line in enumerate(lines):
        blf.color(0, *(_ACCENT if number == 0 else _TEXT))
        blf.position(0, left, bottom + height - (number + 1) * size * 1.45 + size * 0.4, 0)
        blf.draw(0, line)


def _free_range(region: Any) -> tuple[float, float]:
    """Return the part of the viewport, in pixels from its left edge, that the toolbar and the sidebar do not cover."""
    start, end = 0.0, float(region.width)
    for other in bpy.context.area.regions:
        if other.type == "TOOLS" and other.x <= region.x:
            start = max(start, float(other.width))
        elif other.type == "UI" and other.width > 1 and other.x > region.x:
            end = min(end, float(other.x - region.x))
    return start, end


def _set_size(size: float) -> None:
    if bpy.app.version < (4, 0, 0):
        blf.size(0, int(size), 72)
    else:
        blf.size(0, size)


def _rectangle(left: float, bottom: float, width: float, height: float) -> None:
    import gpu
    from gpu_extras.batch import batch_for_shader

    shader = gpu.shader.from_builtin("2D_UNIFORM_COLOR" if bpy.app.version < (4, 0, 0) else "UNIFORM_COLOR")
    right, top = left + width, bottom + height
    batch = batch_for_shader(shader, "TRI_FAN", {"pos": ((left, bottom), (right, bottom), (right, top), (left, top))})
    gpu.state.blend_set("ALPHA")
    shader.bind()
    shader.uniform_float("color", _BACKGROUND)
    batch.draw(shader)
    gpu.state.blend_set("NONE")
