"""Carry out the server's requests on the main thread, in short steps."""

from __future__ import annotations

import time
from collections import deque
from contextlib import suppress
from typing import Any

import bpy

from ..protocol.errors import AddOnError
from ..protocol.link import CameraLink, Picture, Reply, Request
from ..protocol.view import parse_size, parse_view
from . import cameras, changes, pictures
from .view_camera import ViewCamera

MAX_PAUSE_S = 0.5
"""Maximum pause in seconds after a picture. A pause of half the time that the picture took keeps Blender's window responsive."""

DESCRIBE_INTERVAL_S = 1.0
"""Interval in seconds between checks for changes that the user has made to the cameras of the scene."""


class Executor:
    """Carries out the requests of one connection.

    Args:
        link: The connection to the server.
        description: The description of the scene that the link sent.
    """

    def __init__(self, link: CameraLink, description: dict[str, Any]) -> None:
        self._link, self._description = link, description
        self._picture_requests: deque[Request] = deque()
        self._pause_until_s = self._next_description_s = 0.0
        self.last_picture_s = 0.0
        """Time in seconds that the last picture took."""
        self.picture_count = 0
        """Number of pictures so far."""
        with changes.own_change():
            self.camera = ViewCamera(bpy.context.scene)

    def tick(self) -> bool:
        """Carry out the requests that have arrived, with at most one picture. Return whether the sidebar must be redrawn."""
        redraw = False
        while not self._link.requests.empty():
            request = self._link.requests.get()
            if request.operation == "frame":
                self._picture_requests.append(request)
            else:
                self._link.reply(request, self._reply_to(request))
                redraw = True
        if self._picture_requests and time.monotonic() >= self._pause_until_s:
            request = self._picture_requests.popleft()
            self._link.reply(request, self._reply_to(request))
        if self.camera.gliding:
            with changes.own_change():
                self.camera.tick()
            redraw = True
        self._describe_if_due()
        return redraw

    def close(self) -> None:
        """Restore the scene's own camera."""
        with changes.own_change():
            self.camera.remove()

    def restore_camera(self) -> None:
        """Put SCOPE's camera back into the scene, after it was removed to save the file."""
        with changes.own_change():
            if self.camera.view is not None:
                self.camera.settle(self.camera.view)
            else:
                self.camera.object()

    def describe_now(self) -> None:
        """Send the description of the scene if it has changed."""
        description = cameras.describe(bpy.context.scene)
        if description != self._description:
            self._description = description
            self._link.update(description)

    def _reply_to(self, request: Request) -> Reply:
        """Carry out a request. Any failure becomes its reply, because an exception would end the timer."""
        try:
            return self._carry_out(request)
        except AddOnError as error:
            return error
        except Exception as error:
            return AddOnError(f"Blender failed: {type(error).__name__}: {error}")

    def _carry_out(self, request: Request) -> Reply:
        scene, arguments = bpy.context.scene, request.arguments
        if request.operation == "look":
            with changes.own_change():
                self.camera.look(parse_view(arguments), glide=not bpy.app.background)
            return {}
        if request.operation == "frame":
            return self._picture(scene, arguments)
        if request.operation == "save_preset":
            cameras.save_preset(scene, arguments)
        elif request.operation == "remove_preset":
            cameras.remove_preset(scene, str(arguments.get("name", "")))
        else:
            raise AddOnError("The server sent a request that this add-on does not understand. Update the add-on.")
        self._description = cameras.describe(scene)
        return self._description

    def _picture(self, scene: Any, arguments: dict[str, Any]) -> Reply:
        view, size, source = parse_view(arguments), parse_size(arguments), scene.scope.source
        version = f"{changes.version()}-{pictures.appearance(source)}"[:60]
        if arguments.get("version") == version:
            return {"unchanged": version}
        began_s = time.monotonic()
        with changes.own_change():
            camera = self.camera.settle(view)
            bpy.context.view_layer.update()
            encode = pictures.take(scene, camera, size, source)
        self.last_picture_s = time.monotonic() - began_s
        self._pause_until_s = time.monotonic() + min(MAX_PAUSE_S, self.last_picture_s / 2)
        self.picture_count += 1
        return Picture(encode, version)

    def _describe_if_due(self) -> None:
        now_s = time.monotonic()
        if now_s >= self._next_description_s:
            self._next_description_s = now_s + DESCRIBE_INTERVAL_S
            with suppress(AddOnError):  # the user has deleted the last camera; the server keeps the last description
                self.describe_now()
