"""Registration of the add-on's classes, settings and handlers in Blender."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.app.handlers import persistent

from ..scene import changes, view_camera
from . import operators, overlay, panels, preferences, properties
from .session import on_timer, session

_CLASSES = (
    preferences.ScopePreferences,
    properties.ScopeSceneSettings,
    properties.ScopeWindowSettings,
    *operators.CLASSES,
    *panels.CLASSES,
)


def register() -> None:
    """Add the classes, settings and handlers."""
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.scope = bpy.props.PointerProperty(type=properties.ScopeSceneSettings)
    bpy.types.WindowManager.scope = bpy.props.PointerProperty(type=properties.ScopeWindowSettings)
    bpy.types.VIEW3D_HT_tool_header.append(panels.draw_banner)
    bpy.app.handlers.load_post.append(_on_load)
    bpy.app.handlers.save_pre.append(_before_save)
    bpy.app.handlers.save_post.append(_after_save)
    changes.add_handlers()
    overlay.add()


def unregister() -> None:
    """Disconnect, and remove the classes, settings and handlers."""
    session.disconnect()
    if bpy.app.timers.is_registered(on_timer):
        bpy.app.timers.unregister(on_timer)
    overlay.remove()
    changes.remove_handlers()
    for handlers, handler in (
        (bpy.app.handlers.load_post, _on_load),
        (bpy.app.handlers.save_pre, _before_save),
        (bpy.app.handlers.save_post, _after_save),
    ):
        if handler in handlers:
            handlers.remove(handler)
    bpy.types.VIEW3D_HT_tool_header.remove(panels.draw_banner)
    del bpy.types.WindowManager.scope
    del bpy.types.Scene.scope
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)


@persistent
def _on_load(*_: Any) -> None:
    for scene in bpy.data.scenes:  # a crash may have left SCOPE's camera in the file
        view_camera.restore(scene)
    changes.record_change()
    session.file_opened()


@persistent
def _before_save(*_: Any) -> None:
    """Restore the scene's own camera, so that SCOPE's camera is not saved in the file."""
    for scene in bpy.data.scenes:
        view_camera.restore(scene)


@persistent
def _after_save(*_: Any) -> None:
    if session.executor is not None:
        session.executor.restore_camera()
