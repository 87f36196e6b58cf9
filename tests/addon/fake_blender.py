"""A deliberate fake of the Blender side: the add-on's own connection, with a scene that is computed instead of rendered."""

from __future__ import annotations

import threading
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import anyio
import cv2
import numpy as np
from anyio import to_thread

from scope_addon.protocol.address import parse_address
from scope_addon.protocol.errors import AddOnError
from scope_addon.protocol.link import CameraLink, Picture, Reply, Request
from scope_addon.protocol.view import parse_size, parse_view
from scope_ptz.camera.base import Camera
from scope_ptz.geometry import Perspective
from scope_ptz.serve.security.access import Access
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.server import serve
from scope_ptz.serve.site.site import Site, SiteOptions

CAMERA = "blender-window"


def place(name: str, bearing_deg: float = 0.0, hfov_deg: float = 60.0, **others: Any) -> dict[str, Any]:
    """Return the description of a camera of a scene."""
    where = {"position_m": [1.0, 2.0, 3.0], "bearing_deg": bearing_deg, "tilt_deg": -5.0, "hfov_deg": hfov_deg}
    return {"name": name, "title": name.title(), "viewpoint": None, **where, **others}


class FakeBlender:
    """A Blender whose pictures show, as the colour of each pixel, the direction in which it lies.

    Args:
        url: The address of the server.
        token: A token, if the server needs one.
        client: The name of the client.
    """

    def __init__(self, url: str, token: str = "", client: str = "blender-test") -> None:
        self.cameras = [place("gate"), place("roof", bearing_deg=70.0, hfov_deg=30.0)]
        self.requests: list[Request] = []
        self.version = 1
        self.broken = ""
        """The error message of every picture; empty if pictures do not fail."""
        self.link = CameraLink(parse_address(url, token), CAMERA, client, self.describe())
        self._stopping = threading.Event()
        self._main = threading.Thread(target=self._work, daemon=True)

    def start(self) -> FakeBlender:
        """Connect, and begin to carry out requests."""
        self.link.start()
        self._main.start()
        return self

    def stop(self) -> None:
        """Disconnect."""
        self._stopping.set()
        self._main.join(30)
        self.link.stop()
        self.link.join(30)

    def describe(self) -> dict[str, Any]:
        """Describe the scene."""
        head = {"name": "fake", "title": "fake.blend", "blender_version": "0", "active": "gate", "width": 160, "height": 90}
        return {**head, "cameras": list(self.cameras)}

    def _work(self) -> None:
        while not self._stopping.is_set():
            if self.link.requests.empty():
                time.sleep(0.001)
                continue
            request = self.link.requests.get()
            self.requests.append(request)
            self.link.reply(request, self._carry_out(request))

    def _carry_out(self, request: Request) -> Reply:
        arguments = request.arguments
        if request.operation == "frame":
            return self._picture(arguments)
        if request.operation == "save_preset":
            view = parse_view(arguments)
            self._remove(arguments["name"])
            where = place(arguments["name"], view.bearing_deg, view.hfov_deg, saved=True, viewpoint=view.viewpoint)
            self.cameras.append({**where, "tilt_deg": view.tilt_deg, "title": arguments["description"]})
        elif request.operation == "remove_preset":
            self._remove(arguments["name"])
        else:
            return {}
        return self.describe()

    def _remove(self, name: str) -> None:
        self.cameras = [camera for camera in self.cameras if camera["name"] != name]

    def _picture(self, arguments: dict[str, Any]) -> Reply:
        if self.broken:
            return AddOnError(self.broken)
        if arguments["version"] == str(self.version):
            return {"unchanged": str(self.version)}
        view, (width, height) = parse_view(arguments), parse_size(arguments)
        perspective = Perspective(view.bearing_deg, view.tilt_deg, view.hfov_deg, width, height)
        x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
        colours = np.round(127.5 + 127.5 * perspective.directions(np.stack([x, y], axis=-1))).astype(np.uint8)
        return Picture(lambda: cv2.imencode(".png", colours[..., ::-1])[1].tobytes(), str(self.version))


@asynccontextmanager
async def window_camera(connect: Callable[[str], object], runs: Path) -> AsyncIterator[tuple[Camera, Site]]:
    """Serve the camera of a Blender in the running event loop. ``connect`` lets a Blender connect to an address."""
    site = Site({CAMERA: f"{CAMERA}:"}, SiteOptions(runs))
    async with serve(site, Access("127.0.0.1", limits=RateLimits(None)), port=0) as port:
        await to_thread.run_sync(connect, f"http://127.0.0.1:{port}")
        with anyio.fail_after(60):
            while site.station(CAMERA).add_on.current is None:  # noqa: ASYNC110 - a thread connects
                await anyio.sleep(0.005)
        yield await site.station(CAMERA).camera(), site
