"""The banner above the 3D viewport, and the SCOPE tab of its sidebar."""

from __future__ import annotations

import textwrap
from typing import Any

import bpy

from ..scene import cameras
from .session import session

STATES = {
    "off": ("Not connected", "UNLINKED"),
    "starting": ("Starting the server", "SORTTIME"),
    "connecting": ("Connecting", "SORTTIME"),
    "connected": ("Connected", "LINKED"),
}
PIXELS_PER_CHARACTER = 6.3  # average for Blender's interface font at scale 1


def draw_banner(header: Any, context: Any) -> None:
    """Draw the question field in the header of the 3D viewport's tool settings."""
    if session.state != "connected":
        return
    layout, settings = header.layout, context.window_manager.scope
    layout.separator_spacer()
    row = layout.row(align=True)
    row.label(text="", icon="OUTLINER_OB_CAMERA")
    field = row.row(align=True)
    field.ui_units_x = 18
    field.prop(settings, "question", text="")
    if session.run is None:
        row.operator("scope.ask", text="Ask")
    else:
        row.operator("scope.cancel", text="Cancel", icon="CANCEL")


class _Panel:
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "SCOPE"


class SCOPE_PT_connection(_Panel, bpy.types.Panel):
    bl_label, bl_idname = "SCOPE", "SCOPE_PT_connection"

    def draw(self, context: Any) -> None:
        layout, state = self.layout, session.state
        text, icon = STATES[state]
        url = session.server_url.partition("//")[2]
        layout.label(text=text, icon=icon)
        if url:
            layout.label(text=url, icon="URL")
        if state == "off":
            layout.operator("scope.connect")
        else:
            layout.operator("scope.disconnect")
        if session.problem:
            _draw_lines(layout.box(), context, session.problem, icon="ERROR")


class SCOPE_PT_ask(_Panel, bpy.types.Panel):
    bl_label, bl_idname = "Ask", "SCOPE_PT_ask"

    @classmethod
    def poll(cls, _context: Any) -> bool:
        return session.state == "connected"

    def draw(self, context: Any) -> None:
        layout, settings = self.layout, context.window_manager.scope
        layout.prop(settings, "pair", text="", icon="MODIFIER")
        layout.prop(settings, "question", text="", icon="QUESTION")
        row = layout.row(align=True)
        row.operator("scope.ask", icon="PLAY")
        row.operator("scope.cancel", icon="CANCEL")
        if session.activity:
            layout.label(text=session.activity, icon="SORTTIME")
        if session.end is not None:
            box = layout.box()
            box.label(text=session.end.outcome, icon="CHECKMARK" if session.end.outcome == "Answered" else "INFO")
            _draw_lines(box, context, session.end.text)


class SCOPE_PT_steps(_Panel, bpy.types.Panel):
    bl_label, bl_idname = "Steps", "SCOPE_PT_steps"

    @classmethod
    def poll(cls, _context: Any) -> bool:
        return session.state == "connected"

    def draw(self, context: Any) -> None:
        layout = self.layout
        if not session.steps:
            _draw_lines(layout, context, "The steps of an instruction appear here.")
        for number, step in enumerate(session.steps, 1):
            column = layout.box().column(align=True)
            row = column.row()
            row.label(text=f"Step {number}", icon="ERROR" if step.failed else "CHECKMARK")
            time = row.row()
            time.alignment = "RIGHT"
            time.label(text=f"{step.duration_s:.2f} s")
            _draw_lines(column, context, step.call)
            column.separator()
            _draw_lines(column, context, step.text)
        if session.end is not None:
            column = layout.column(align=True)
            for timing in session.end.timings:
                split = column.split(factor=0.6)
                split.label(text=timing.part)
                split.label(text=f"{timing.duration_s:.2f} s")
        layout.operator("scope.picture", icon="IMAGE_DATA")


class SCOPE_PT_presets(_Panel, bpy.types.Panel):
    bl_label, bl_idname = "Presets", "SCOPE_PT_presets"

    @classmethod
    def poll(cls, _context: Any) -> bool:
        return session.state == "connected"

    def draw(self, context: Any) -> None:
        layout = self.layout
        row = layout.row(align=True)
        row.prop(context.window_manager.scope, "preset", text="")
        row.operator("scope.preset_add", icon="ADD")
        column = layout.column(align=True)
        for name in session.presets:
            row = column.row(align=True)
            row.operator("scope.preset_go", text=name, icon="VIEW_CAMERA").name = name
            if cameras.find_preset(context.scene, name) is not None:
                row.operator("scope.preset_remove", text="", icon="X").name = name
        layout.operator("scope.home", icon="HOME")


class SCOPE_PT_pictures(_Panel, bpy.types.Panel):
    bl_label, bl_idname = "Pictures", "SCOPE_PT_pictures"

    def draw(self, context: Any) -> None:
        layout, settings = self.layout, context.scene.scope
        layout.use_property_split = True
        layout.prop(settings, "source")
        column = layout.column(align=True)
        column.prop(settings, "width")
        column.prop(settings, "height")
        if session.state == "connected":
            layout.operator("scope.look", icon="OUTLINER_OB_CAMERA")
        if session.executor is not None and session.executor.picture_count:
            layout.label(text=f"Pictures: {session.executor.picture_count} (the last took {session.executor.last_picture_s:.2f} s)")


def _draw_lines(layout: Any, context: Any, text: str, icon: str = "NONE") -> None:
    """Draw text, wrapped to the width of the panel."""
    scale = context.preferences.system.ui_scale
    width = max(20, int((context.region.width - 60 * scale) / (PIXELS_PER_CHARACTER * scale)))
    column = layout.column(align=True)
    for number, line in enumerate(textwrap.wrap(text, width) or [""]):
        column.label(text=line, icon=icon if number == 0 else ("BLANK1" if icon != "NONE" else "NONE"))


CLASSES = (SCOPE_PT_connection, SCOPE_PT_ask, SCOPE_PT_steps, SCOPE_PT_presets, SCOPE_PT_pictures)
