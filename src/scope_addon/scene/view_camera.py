"""The camera object that SCOPE moves. The cameras of the user stay where they are."""

from __future__ import annotations

import time
from typing import Any

import bpy

from ..protocol.view import View
from . import cameras

NAME = "SCOPE camera"
GLIDE_S = 0.35
"""Duration in seconds of the camera's animated move to a new pose on the screen. Pictures never wait for it."""


class ViewCamera:
    """The camera that SCOPE moves in a scene. It is the active camera while SCOPE is connected.

    Args:
        scene: The scene.
    """

    def __init__(self, scene: Any) -> None:
        self._scene_name = scene.name
        self._from: View | None = None
        self._to: View | None = None
        self._since_s = 0.0
        before = cameras.previous_camera(scene)
        self._previous = before.name if before is not None else ""
        if before is not None:
            self.settle(cameras.view_through(scene, before, ""))
        else:
            self.object()

    @property
    def view(self) -> View | None:
        """The view that the camera has, or reaches at the end of a glide; None before the first view is set."""
        return self._to

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
        moving = glide and self._to is not None
        self._from = self._displayed_view() if moving else view
        self._to, self._since_s = view, time.monotonic()
        if not moving:
            self._aim(view)

    def settle(self, view: View) -> Any:
        """Go to a view at once, and return the object."""
        if self._to != view or self._from != view:
            self._from = self._to = view
        return self._aim(view)

    @property
    def gliding(self) -> bool:
        """Whether the object is still on its way to the view."""
        return self._to is not None and self._from != self._to

    def tick(self) -> None:
        """Continue a glide."""
        if self.gliding:
            shown = self._displayed_view()
            self._aim(shown)
            if shown == self._to:
                self._from = self._to

    def remove(self) -> None:
        """Remove the object, and make the camera active that was active before."""
        for scene in bpy.data.scenes:
            restore(scene)

    def _displayed_view(self) -> View:
        assert self._from is not None
        assert self._to is not None
        fraction = min(1.0, (time.monotonic() - self._since_s) / GLIDE_S)
        return self._from.interpolate(self._to, fraction * fraction * (3.0 - 2.0 * fraction))

    def _aim(self, view: View) -> Any:
        camera = self.object()
        cameras.aim(camera, view)
        data = camera.data
        data.dof.use_dof = False
        data.clip_start, data.clip_end = 0.05, 5000.0
        return camera


def restore(scene: Any) -> None:
    """Remove SCOPE's camera from a scene, if it is there, and make the earlier camera active."""
    for camera in [o for o in scene.objects if o.type == "CAMERA" and cameras.VIEW_CAMERA in o]:
        previous = scene.objects.get(str(camera[cameras.VIEW_CAMERA]))
        if scene.camera == camera:
            scene.camera = previous
        data = camera.data
        bpy.data.objects.remove(camera)
        if data.users == 0:
            bpy.data.cameras.remove(data)
