"""The operators behind the buttons."""
# No `from __future__ import annotations` here: Blender reads the annotations of these classes as properties.

import bpy

from ..protocol.errors import AddOnError
from ..scene import cameras
from . import picture_view
from .preferences import preferences
from .session import session, tag_redraw, wake


class _Operator(bpy.types.Operator):
    """Base class of the operators. It shows errors in the sidebar and in Blender's status bar."""

    bl_options = {"INTERNAL"}  # noqa: RUF012 - Blender requires a set

    def execute(self, context):
        session.problem = ""
        try:
            self.work(context)
        except AddOnError as error:
            session.problem = str(error)
            self.report({"ERROR"}, str(error))
            tag_redraw()
            return {"CANCELLED"}
        wake()
        tag_redraw()
        return {"FINISHED"}


class SCOPE_OT_connect(_Operator):
    """Connect the open scene to a server. If the preferences request it, start the server first"""

    bl_idname, bl_label = "scope.connect", "Connect"

    def work(self, context):
        settings = preferences(context)
        if settings.server_mode == "START":
            session.start_server(settings.program, settings.pairs.split())
        else:
            session.connect(settings.address, settings.token, settings.camera)


class SCOPE_OT_disconnect(_Operator):
    """Disconnect, restore the scene's camera, and stop the server if the add-on started it"""

    bl_idname, bl_label = "scope.disconnect", "Disconnect"

    def work(self, _context):
        session.disconnect()


class SCOPE_OT_ask(_Operator):
    """Run the instruction or answer the question"""

    bl_idname, bl_label = "scope.ask", "Ask"

    @classmethod
    def poll(cls, context):
        return session.state == "connected" and session.run is None and bool(context.window_manager.scope.question.strip())

    def work(self, context):
        settings = context.window_manager.scope
        session.ask(settings.question.strip(), settings.pair)


class SCOPE_OT_cancel(_Operator):
    """Stop the instruction in progress"""

    bl_idname, bl_label = "scope.cancel", "Cancel"

    @classmethod
    def poll(cls, _context):
        return session.run is not None

    def work(self, _context):
        session.cancel()


class SCOPE_OT_look(_Operator):
    """Look through SCOPE's camera in this viewport"""

    bl_idname, bl_label = "scope.look", "Look Through Camera"

    def work(self, context):
        context.space_data.region_3d.view_perspective = "CAMERA"
        bpy.ops.view3d.view_center_camera()


class SCOPE_OT_preset_add(_Operator):
    """Save this viewport's view as a preset, which is stored as a camera in the scene"""

    bl_idname, bl_label = "scope.preset_add", "Save View"

    @classmethod
    def poll(cls, context):
        return session.state == "connected" and bool(context.window_manager.scope.preset.strip())

    def work(self, context):
        settings = context.window_manager.scope
        name, region = settings.preset.strip(), context.space_data.region_3d
        if region.view_perspective == "CAMERA":
            session.save_preset(name)
        else:
            if name in session.presets and cameras.find_preset(context.scene, name) is None:
                raise AddOnError(f"'{name}' is a camera of the scene. Choose another name.")
            cameras.add_preset(context.scene, name, cameras.viewport_view(region))
            session.scene_changed()
        settings.preset = ""


class SCOPE_OT_preset_go(_Operator):
    """Go to this preset"""

    bl_idname, bl_label = "scope.preset_go", "Go to Preset"
    name: bpy.props.StringProperty()

    def work(self, _context):
        session.go_to_preset(self.name)


class SCOPE_OT_preset_remove(_Operator):
    """Remove this preset from the scene"""

    bl_idname, bl_label = "scope.preset_remove", "Remove Preset"
    name: bpy.props.StringProperty()

    def work(self, _context):
        session.remove_preset(self.name)


class SCOPE_OT_home(_Operator):
    """Go to the view of the scene's own camera"""

    bl_idname, bl_label = "scope.home", "Home"

    @classmethod
    def poll(cls, _context):
        return session.state == "connected"

    def work(self, _context):
        session.go_home()


class SCOPE_OT_picture(_Operator):
    """Show the last picture of the run, with detections marked, in an image editor"""

    bl_idname, bl_label = "scope.picture", "Show Picture"

    @classmethod
    def poll(cls, _context):
        return picture_view.IMAGE in bpy.data.images

    def work(self, context):
        picture_view.open_editor(context)


CLASSES = (
    SCOPE_OT_connect, SCOPE_OT_disconnect, SCOPE_OT_ask, SCOPE_OT_cancel, SCOPE_OT_look, SCOPE_OT_preset_add, SCOPE_OT_preset_go,
    SCOPE_OT_preset_remove, SCOPE_OT_home, SCOPE_OT_picture,
)  # fmt: skip
