"""The camera object that SCOPE moves. The user's cameras remain unchanged."""

from __future__ import annotations

import time
from typing import Any

import bpy

from ..protocol.view import View
from . import cameras

NAME = "SCOPE camera"
GLIDE_S = 0.35
"""Duration in seconds of the camera's animated move on the screen. Pictures do not wait for it."""


class ViewCamera:
    """The camera that SCOPE moves in a scene. It is the active camera while SCOPE is connected.

    Args:
        scene: The scene.
    """

    def __init__(self, scene: Any) -> None:
        self._scene_name = scene.name
        self._start_view: View | None = None
        self._end_view: View | None = None
        self._glide_start_s = 0.0
        before = cameras.previous_camera(scene)
        self._previous = before.name if before is not None else ""
        if before is not None:
            self.settle(cameras.view_through(scene, before, ""))
        else:
            self.object()

    @property
    def view(self) -> View | None:
        """The current view, or the final view of a glide; None before the first view is set."""
        return self._end_view

    def object(self) -> Any:
        """Return the camera object. It is created again if the user has deleted it."""
        scene = bpy.data.scenes.get(self._scene_name) or bpy.context.scene
        found = next((o for o in scene.objects if o.type == "CAMERA" and cameras.VIEW_CAMERA in o), None)
        if found is None:
            found = bpy.data.objects.new(NAME, bpy.data.cameras.new(NAME))
            found[cameras.VIEW_CAMERA] = self._previous
            scene.collection.objects.link(found)
        if scene.camera != found:
            scene.camera = found
        return found

    def look(self, view: View, *, glide: bool) -> None:
        """Go to a view. With ``glide``, the object moves there on the screen over the next ticks."""
        moving = glide and self._end_view is not None
        self._start_view = self._displayed_view() if moving else view
        self._end_view, self._glide_start_s = view, time.monotonic()
        if not moving:
            self._aim(view)

    def settle(self, view: View) -> Any:
        """Go to a view immediately, and return the camera object."""
        if self._end_view != view or self._start_view != view:
            self._start_view = self._end_view = view
        return self._aim(view)

    @property
    def gliding(self) -> bool:
        """Whether the camera is still moving to the view."""
        return self._end_view is not None and self._start_view != self._end_view

    def tick(self) -> None:
        """Continue a glide."""
        if self.gliding:
            shown = self._displayed_view()
            self._aim(shown)
            if shown == self._end_view:
                self._start_view = self._end_view

    def remove(self) -> None:
        """Remove the camera object, and reactivate the previous camera."""
        for scene in bpy.data.scenes:
            restore(scene)

    def _displayed_view(self) -> View:
        assert self._start_view is not None
        assert self._end_view is not None
        fraction = min(1.0, (time.monotonic() - self._glide_start_s) / GLIDE_S)
        return self._start_view.interpolate(self._end_view, fraction * fraction * (3.0 - 2.0 * fraction))

    def _aim(self, view: View) -> Any:
        camera = self.object()
        cameras.aim(camera, view)
        data = camera.data
        data.dof.use_dof = False
        data.clip_start, data.clip_end = 0.05, 5000.0
        return camera


def restore(scene: Any) -> None:
    """Remove SCOPE's camera from a scene, if present, and reactivate the previous camera."""
    for camera in [o for o in scene.objects if o.type == "CAMERA" and cameras.VIEW_CAMERA in o]:
        previous = scene.objects.get(str(camera[cameras.VIEW_CAMERA]))
        if scene.camera == camera:
            scene.camera = previous
        data = camera.data
        bpy.data.objects.remove(camera)
        if data.users == 0:
            bpy.data.cameras.remove(data)
