"""The preferences of the add-on."""
# No `from __future__ import annotations` here: Blender reads the annotations of these classes as properties.

import bpy

PACKAGE = __package__.rpartition(".")[0]
"""The name of the add-on's package. In an extension, it begins with ``bl_ext``."""


_secrets = {"token": ""}  # in memory only, because Blender stores preferences in plain text


def _token(_self: object) -> str:
    return _secrets["token"]


def _set_token(_self: object, value: str) -> None:
    _secrets["token"] = value


class ScopePreferences(bpy.types.AddonPreferences):
    """Settings for the connection to a server."""

    bl_idname = PACKAGE

    server_mode: bpy.props.EnumProperty(
        name="Server",
        items=(
            ("START", "Start a server", "Start the scope program on this machine, and stop it when Blender exits"),
            ("ADDRESS", "Use a running server", "Connect to a server that was started with `scope serve --camera blender-window`"),
        ),
        default="START",
    )
    program: bpy.props.StringProperty(
        name="Program", description="The scope program, by name or path", default="scope", subtype="FILE_PATH"
    )
    pairs: bpy.props.StringProperty(
        name="Pairs",
        description="Pairs of planner and perception that the server offers, separated by spaces, with the default first; "
        "empty for the built-in planner without perception. `scope models pairs` lists them",
    )
    address: bpy.props.StringProperty(name="Address", description="Address of the server", default="http://127.0.0.1:8000")
    token: bpy.props.StringProperty(
        name="Token",
        description="Token with the operator role, if the server requires one. It is not stored",
        subtype="PASSWORD",
        get=_token,
        set=_set_token,
    )
    camera: bpy.props.StringProperty(name="Camera", description="Name of the camera on the server", default="blender-window")

    def draw(self, _context):  # type: ignore[no-untyped-def]
        """Draw the preferences."""
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "server_mode")
        if self.server_mode == "START":
            layout.prop(self, "program")
            layout.prop(self, "pairs")
        else:
            layout.prop(self, "address")
            layout.prop(self, "token")
            layout.prop(self, "camera")


def preferences(context):  # type: ignore[no-untyped-def]
    """Return the preferences of the add-on."""
    return context.preferences.addons[PACKAGE].preferences
