"""RTSP streams, read with PyAV in a thread."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from contextlib import suppress
from time import monotonic
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from anyio import to_thread

from scope_ptz.camera.network.errors import CameraSignInError, CameraUnreachableError, ForeignAddressError, PictureError
from scope_ptz.camera.network.rtsp_relay import RtspRelay
from scope_ptz.camera.network.streams import GIVE_UP_S, STALLED_S, LivePicture, LiveStream
from scope_ptz.errors import CameraError, ConfigError

if TYPE_CHECKING:
    import ssl

    from scope_ptz.camera.network.credentials import Credentials


def import_av() -> Any:
    """Import PyAV.

    Raises:
        ConfigError: PyAV is not installed.
    """
    try:
        import av
    except ImportError:
        raise ConfigError("RTSP requires PyAV. Install scope-ptz[camera], or use ?stream=mjpeg.") from None
    return av


class RtspStream(LiveStream):
    """An H.264 or H.265 stream over RTSP. Every frame is decoded, but only the newest one is kept.

    Args:
        url: The stream's URL, without credentials.
        credentials: The credentials; None if the stream requires none.
        width: Expected width in pixels.
        height: Expected height in pixels.
        stalled_s: Seconds without a picture after which the stream is reopened.
        give_up_s: Seconds without a picture after which the stream counts as lost.
        tls: The TLS context for an ``rtsps`` server; by default, one that trusts the system's certificate authorities.

    Raises:
        ConfigError: PyAV is not installed.
    """

    def __init__(
        self,
        url: str,
        credentials: Credentials | None,
        *,
        width: int,
        height: int,
        stalled_s: float = STALLED_S,
        give_up_s: float = GIVE_UP_S,
        tls: ssl.SSLContext | None = None,
    ) -> None:
        self._av = import_av()
        self._url, self._credentials, self._tls = url, credentials, tls
        self._server = urlsplit(url).netloc
        self._size = (width, height)
        self._stalled_s, self._give_up_s = stalled_s, give_up_s
        self._newest: LivePicture | None = None
        self._failure: CameraError | None = None
        self._closing = threading.Event()
        self._loop, self._changed = asyncio.get_running_loop(), asyncio.Event()
        self._thread = threading.Thread(target=self._read, name=f"rtsp {self._server}", daemon=True)
        self._thread.start()

    def __repr__(self) -> str:
        return f"RtspStream({self._server})"

    async def next(self) -> LivePicture:
        while self._newest is None:
            if self._failure is not None:
                raise self._failure
            self._changed.clear()
            await self._changed.wait()
        picture, self._newest = self._newest, None
        if (size := picture.image.shape[1::-1]) != self._size:
            expected = "{}x{}".format(*self._size)
            raise PictureError(
                f"The stream's picture size is {size[0]}x{size[1]} instead of {expected}. Change it in the camera's settings.",
                "size",
            )
        return picture

    async def close(self) -> None:
        self._closing.set()
        await to_thread.run_sync(self._thread.join, self._stalled_s + 2.0)

    def _read(self) -> None:
        """Read until the stream is closed or lost. This runs in the thread."""
        last_s, pause_s = monotonic(), 0.1
        while not self._closing.is_set():
            before_s = last_s
            relay = RtspRelay(self._url, self._credentials, timeout_s=self._stalled_s, tls=self._tls)
            with suppress(self._av.FFmpegError, OSError, ValueError), relay as url:
                for picture in self._pictures(url):
                    last_s = picture.arrived_s
                    self._publish(picture, None)
            is_permanent = isinstance(relay.failure, CameraSignInError | ForeignAddressError)
            if is_permanent or monotonic() - last_s > self._give_up_s:
                message = f"The RTSP stream at {self._server} cannot be read. Check the account and the port, or use ?stream=mjpeg."
                self._publish(None, relay.failure or CameraUnreachableError(message))
                return
            pause_s = 0.1 if last_s > before_s else min(2 * pause_s, 2.0)
            self._closing.wait(pause_s)

    def _pictures(self, url: str) -> Iterator[LivePicture]:
        # Without ``fpsprobesize``, FFmpeg takes a second longer to determine the frame rate, which is not needed.
        options = {"rtsp_transport": "tcp", "fflags": "nobuffer", "flags": "low_delay", "fpsprobesize": "0"}
        with self._av.open(url, options=options, timeout=self._stalled_s) as container:
            for frame in container.decode(video=0):
                if self._closing.is_set():
                    return
                image = frame.to_ndarray(format="rgb24")
                yield LivePicture(image, image[::16, ::16].tobytes(), monotonic())

    def _publish(self, picture: LivePicture | None, failure: CameraError | None) -> None:
        if picture is not None:
            self._newest = picture
        self._failure = failure
        with suppress(RuntimeError):  # the event loop is closed, so no consumer is waiting
            self._loop.call_soon_threadsafe(self._changed.set)
