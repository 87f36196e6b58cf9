"""Motion JPEG: an endless multipart reply with one part per frame."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import anyio
from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from scope_ptz.virtual_camera.device import Exposure
from scope_ptz.virtual_camera.frame_selector import FrameSelector
from scope_ptz.virtual_camera.http.connection import abort_connection
from scope_ptz.virtual_camera.http.jpeg import PictureFormat, SharedJpegs, with_comment
from scope_ptz.virtual_camera.live_source import LiveSource

BOUNDARY = "myboundary"
SEND_TIMEOUT_S = 20.0
"""Timeout in seconds for sending a frame. Clients that stop reading are disconnected."""


@dataclass(frozen=True, slots=True)
class StreamOptions:
    """The options for a stream. ``fps``, ``frames`` and ``duration_s`` are 0 for no limit.

    Attributes:
        picture: Size and compression.
        fps: Maximum number of frames per second.
        frames: Number of frames after which the stream ends.
        duration_s: Seconds after which the stream ends.
        truth: A function that returns the ground truth for a frame as headers for its part and a comment for its JPEG; None to send
            no ground truth.
    """

    picture: PictureFormat
    fps: float = 0.0
    frames: int = 0
    duration_s: float = 0.0
    truth: Callable[[Exposure], tuple[Mapping[str, str], str]] | None = None


class MotionJpeg(Response):
    """A stream of JPEGs.

    It ends when its client disconnects or stops reading, when its limits are reached, or when the server shuts down.
    """

    def __init__(self, source: LiveSource, jpegs: SharedJpegs, options: StreamOptions, closing: anyio.Event) -> None:
        super().__init__(media_type=f"multipart/x-mixed-replace; boundary={BOUNDARY}", headers={"Cache-Control": "no-cache"})
        del self.headers["content-length"]
        self._source, self._jpegs, self._options, self._closing = source, jpegs, options, closing

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        await send({"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers})
        if scope["method"] == "HEAD":
            await send({"type": "http.response.body", "body": b""})
            return
        complete = False
        async with anyio.create_task_group() as group:

            async def cancel_after(wait: Callable[[], object]) -> None:
                await wait()  # type: ignore[misc]
                group.cancel_scope.cancel()

            group.start_soon(cancel_after, self._closing.wait)
            group.start_soon(cancel_after, lambda: _wait_for_disconnect(receive))
            complete = await self._send_parts(send)
            group.cancel_scope.cancel()
        if complete:
            await send({"type": "http.response.body", "body": f"--{BOUNDARY}--\r\n".encode()})
        else:
            await abort_connection(scope, receive)

    async def _send_parts(self, send: Send) -> bool:
        """Send frames until a limit is reached. Return False if the client stopped reading."""
        options, sent_count, selector = self._options, 0, FrameSelector(self._source.rate_hz, self._options.fps)
        started_s = anyio.current_time()
        async with self._source.subscribe() as exposures:
            async for exposure in exposures:
                if not selector.accepts(exposure.taken_s):
                    continue
                part = await self._part(exposure)
                with anyio.move_on_after(SEND_TIMEOUT_S) as timeout_scope:
                    await send({"type": "http.response.body", "body": part, "more_body": True})
                if timeout_scope.cancelled_caught:
                    return False
                sent_count += 1
                if sent_count == options.frames or (options.duration_s and anyio.current_time() - started_s >= options.duration_s):
                    return True
        return True

    async def _part(self, exposure: Exposure) -> bytes:
        jpeg = await self._jpegs.jpeg(exposure, self._options.picture)
        extra: Mapping[str, str] = {}
        if self._options.truth is not None:
            extra, comment = self._options.truth(exposure)
            jpeg = with_comment(jpeg, comment)
        head = {"Content-Type": "image/jpeg", "Content-Length": str(len(jpeg)), **extra}
        lines = "".join(f"{name}: {value}\r\n" for name, value in head.items())
        return f"--{BOUNDARY}\r\n{lines}\r\n".encode() + jpeg + b"\r\n"


async def _wait_for_disconnect(receive: Receive) -> None:
    while (await receive())["type"] != "http.disconnect":
        pass
