"""Show the picture of a run in an image editor."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy

IMAGE = "SCOPE frame"


def show(path: Path) -> None:
    """Load a picture, and show it in image editors that do not show another image."""
    image = bpy.data.images.get(IMAGE)
    if image is None:
        image = bpy.data.images.load(str(path))
        image.name = IMAGE
    else:
        image.filepath = str(path)
        image.reload()
    for area in _editors():
        if area.spaces.active.image in (None, image):
            area.spaces.active.image = image
            area.tag_redraw()


def open_editor(context: Any) -> None:
    """Show the picture in an image editor. If no editor is open, split the current viewport."""
    image = bpy.data.images.get(IMAGE)
    editors = list(_editors())
    if not editors:
        with context.temp_override(area=context.area):
            bpy.ops.screen.area_split(direction="VERTICAL", factor=0.4)
        new = context.screen.areas[-1]
        new.type = "IMAGE_EDITOR"
        editors = [new]
    editors[0].spaces.active.image = image
    region = next(region for region in editors[0].regions if region.type == "WINDOW")
    with context.temp_override(area=editors[0], region=region):
        bpy.ops.image.view_all(fit_view=True)


def _editors() -> list[Any]:
    windows = bpy.context.window_manager.windows
    return [area for window in windows for area in window.screen.areas if area.type == "IMAGE_EDITOR"]
