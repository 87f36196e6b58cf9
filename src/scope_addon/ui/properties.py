"""The settings of a scene, and those of the window, which are not saved."""
# No `from __future__ import annotations` here: Blender reads the annotations of these classes as properties.

import bpy

_pair_items: list = []  # Blender requires the strings of dynamic menus to stay in memory


def set_pairs(names: list) -> None:
    """Set the pairs that the menu offers."""
    _pair_items[:] = [(name, name, f"Use {name}") for name in names]


def _pairs(_self: object, _context: object) -> list:
    return _pair_items or [("NONE", "not connected", "Connect to a server to see its pairs")]


class ScopeSceneSettings(bpy.types.PropertyGroup):
    """Settings for the pictures of a scene."""

    source: bpy.props.EnumProperty(
        name="Pictures",
        description="How pictures are taken",
        items=(
            ("VIEWPORT", "Viewport", "Draw like the first 3D viewport, with its shading: fast"),
            ("RENDER", "Render", "Render with the scene's render engine and settings: slower"),
        ),
        default="VIEWPORT",
    )
    width: bpy.props.IntProperty(name="Width", description="Width of a picture in pixels", default=1280, min=160, max=3840)
    height: bpy.props.IntProperty(name="Height", description="Height of a picture in pixels", default=720, min=90, max=2160)


class ScopeWindowSettings(bpy.types.PropertyGroup):
    """The user's inputs in the sidebar."""

    question: bpy.props.StringProperty(
        name="",
        description="Ask about the scene, or tell the camera what to do",
        options={"SKIP_SAVE", "TEXTEDIT_UPDATE"},
        maxlen=2000,
    )
    pair: bpy.props.EnumProperty(name="Pair", description="Planner and perception", items=_pairs, options={"SKIP_SAVE"})
    preset: bpy.props.StringProperty(name="", description="Name of the new preset", maxlen=31, options={"SKIP_SAVE"})
