"""Live video: a WebSocket with acknowledgements, Motion JPEG, and single frames."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from contextlib import suppress
from typing import Annotated, Any, Literal

import cv2
from anyio import to_thread
from fastapi import APIRouter, Query, Response, WebSocket, WebSocketDisconnect
from fastapi.responses import StreamingResponse

from scope_ptz.camera.base import Frame
from scope_ptz.errors import CameraError, ScopeError
from scope_ptz.serve.http.dependencies import SiteDep, StationDep, Viewer, client_of, site_of, station_of
from scope_ptz.serve.http.errors import responses
from scope_ptz.serve.site.live_picture import LiveFrame, encode_jpeg
from scope_ptz.serve.site.scene_time import scene_time
from scope_ptz.serve.site.station import Station

BOUNDARY = "scopeframe"
ACK_TIMEOUT_S = 30.0
"""Seconds without an acknowledgement after which a WebSocket client is disconnected."""

router = APIRouter(prefix="/cameras/{camera}", tags=["live"])
Width = Annotated[int, Query(ge=160, le=3840, description="Maximum width in pixels")]


@router.get(
    "/frame",
    response_class=Response,
    responses={200: {"content": {"image/jpeg": {}, "image/png": {}}, "description": "The picture"}, **responses(404, 409, 503)},
)
async def frame(
    station: StationDep,
    client: Viewer,  # noqa: ARG001 - checks the token
    image_format: Annotated[Literal["jpeg", "png"], Query(alias="format")] = "jpeg",
    width: Width = 3840,
) -> Response:
    """Take a picture. The header `Scope-Frame` contains the picture's pose, field of view and time."""
    picture = await (await station.camera()).frame()
    data = await to_thread.run_sync(_png, picture) if image_format == "png" else await to_thread.run_sync(_jpeg, picture, width)
    return Response(data, media_type=f"image/{image_format}", headers={"Scope-Frame": json.dumps(frame_facts(picture))})


@router.get(
    "/live.mjpeg",
    response_class=StreamingResponse,
    responses={200: {"content": {"multipart/x-mixed-replace": {}}, "description": "A stream of JPEGs"}, **responses(404, 409, 503)},
)
async def motion_jpeg(
    site: SiteDep,
    station: StationDep,
    client: Viewer,  # noqa: ARG001 - checks the token
    width: Width = 1280,
    frames: Annotated[int | None, Query(ge=1, le=100_000, description="Number of frames after which the stream ends")] = None,
) -> StreamingResponse:
    """Stream the live video as Motion JPEG, for video players and pages without scripts."""
    await station.get_open_camera()

    async def parts() -> AsyncIterator[bytes]:
        sent = 0
        async with station.live.watch() as pictures:
            async for picture in _until_closing(site.closing, pictures):
                if picture is None:
                    continue
                jpeg = await picture.jpeg(width)
                head = f"--{BOUNDARY}\r\nContent-Type: image/jpeg\r\nContent-Length: {len(jpeg)}\r\n\r\n"
                yield head.encode() + jpeg + b"\r\n"
                sent += 1
                if sent == frames:
                    break
        yield f"--{BOUNDARY}--\r\n".encode()

    # Without this header, a proxy may compress the stream and delay frames.
    headers = {"Content-Encoding": "identity", "Cache-Control": "no-store"}
    return StreamingResponse(parts(), media_type=f"multipart/x-mixed-replace; boundary={BOUNDARY}", headers=headers)


@router.websocket("/live")
async def live(socket: WebSocket, camera: str, width: int = 1280) -> None:
    """Stream the live video to a page. ``docs/http-api.md`` describes the messages."""
    client = client_of(socket)
    try:
        station = station_of(socket, camera)
        await station.get_open_camera()
    except ScopeError as error:
        await socket.close(1008, str(error)[:120])
        return
    await socket.accept()
    watcher = _Watcher(socket, station, min(max(width, 160), 3840))
    with suppress(WebSocketDisconnect, RuntimeError, TimeoutError), station.control.live_connection(client):
        await watcher.run(site_of(socket).closing)
    with suppress(RuntimeError, WebSocketDisconnect):  # the client has already disconnected
        await socket.close(1001)


class _Watcher:
    """A client of the live video, which gets the newest frame after it has acknowledged the previous one."""

    def __init__(self, socket: WebSocket, station: Station, width: int) -> None:
        self._socket, self._station, self._width = socket, station, width
        self._acknowledged = asyncio.Event()
        self._acknowledged.set()
        self._sent_state: dict[str, Any] | None = None

    async def run(self, closing: asyncio.Event) -> None:
        """Send frames until the client disconnects or the server shuts down."""
        work = [asyncio.create_task(coroutine) for coroutine in (self._send(), self._receive(), closing.wait())]
        try:
            done, _ = await asyncio.wait(work, return_when=asyncio.FIRST_COMPLETED)
            for task in done:
                task.result()
        finally:
            for task in work:
                task.cancel()
            await asyncio.gather(*work, return_exceptions=True)

    async def _send(self) -> None:
        async with self._station.live.watch() as pictures:
            async for picture in pictures:
                await self._send_state()
                if picture is None:
                    continue
                # Only the newest of the frames that arrive before the acknowledgement is sent.
                if not self._acknowledged.is_set():
                    await asyncio.wait_for(self._acknowledged.wait(), ACK_TIMEOUT_S)
                    if picture is not self._station.live.newest:
                        continue
                self._acknowledged.clear()
                await self._socket.send_bytes(await self._message(picture))

    async def _receive(self) -> None:
        while True:
            message = await self._socket.receive()
            if message["type"] == "websocket.disconnect":
                return
            text = message.get("text") or ""
            if text.startswith("width ") and text[6:].isdecimal():
                self._width = min(max(int(text[6:12]), 160), 3840)
            self._acknowledged.set()

    async def _send_state(self) -> None:
        """Send the camera's state, such as its run and the client in control, if the state has changed since it was last sent."""
        station = self._station
        holder = station.control.holder
        state = {
            "run": station.current_run.id if station.current_run else None,
            "holder": holder.name if holder else None,
            "control": station.control.changes,
            "presets": station.preset_changes,
            "can_undo": station.can_undo,
            "problem": station.live.problem,
            "scene_time": _scene_time_state(station),
        }
        if state != self._sent_state:
            self._sent_state = state
            await self._socket.send_text(json.dumps({"state": state}))

    async def _message(self, picture: LiveFrame) -> bytes:
        facts = {**frame_facts(picture.frame), "number": picture.number, "taken": picture.taken}
        header = json.dumps(facts).encode()
        return len(header).to_bytes(4, "big") + header + await picture.jpeg(self._width)


def frame_facts(frame: Frame) -> dict[str, Any]:
    """Return a frame's pose, field of view, time, size and viewpoint."""
    pose, origin = frame.pose, frame.origin
    return {
        "pose": {"pan_deg": float(pose.pan_deg), "tilt_deg": float(pose.tilt_deg), "zoom": float(pose.zoom)},
        "hfov_deg": float(frame.hfov_deg),
        "time_s": float(frame.time_s),
        "width": frame.width,
        "height": frame.height,
        "viewpoint": origin.viewpoint if origin is not None else None,
    }


def _scene_time_state(station: Station) -> dict[str, Any] | None:
    """Return whether scene time is playing, and its speed; None for a camera that shows the real world.

    The scene time itself is part of each frame.
    """
    time = scene_time(station.open_camera.camera) if station.open_camera is not None else None
    return None if time is None else {"playing": time.playing, "speed": time.speed}


async def _until_closing(closing: asyncio.Event, pictures: AsyncIterator[LiveFrame | None]) -> AsyncIterator[LiveFrame | None]:
    async for picture in pictures:
        if closing.is_set():
            return
        yield picture


def _jpeg(frame: Frame, width: int) -> bytes:
    return encode_jpeg(frame.image, min(width, frame.width), 92)


def _png(frame: Frame) -> bytes:
    encoded, data = cv2.imencode(".png", cv2.cvtColor(frame.image, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_PNG_COMPRESSION, 1])
    if not encoded:
        raise CameraError("The picture cannot be encoded.")
    return bytes(data)
