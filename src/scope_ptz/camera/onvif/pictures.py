"""Pictures from an ONVIF camera: snapshots over HTTP, or frames from its RTSP stream if it has no snapshots."""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING, Any, Literal

import anyio
from anyio import to_thread

from scope_ptz.camera.network.device_pictures import DevicePictures
from scope_ptz.camera.network.errors import CameraReplyError, PictureError
from scope_ptz.camera.network.pictures import decode_jpeg
from scope_ptz.camera.network.rtsp import RtspStream
from scope_ptz.camera.network.scaled_streams import ScaledStream, SnapshotStream, scale_picture
from scope_ptz.camera.network.streams import LiveStream
from scope_ptz.camera.onvif.faults import OnvifFaultError
from scope_ptz.camera.onvif.transport import pinned_path

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.camera.network.credentials import Credentials
    from scope_ptz.camera.network.http import DeviceHttp
    from scope_ptz.camera.onvif.client import OnvifClient
    from scope_ptz.camera.onvif.device import OnvifDevice

OnvifStream = Literal["rtsp", "snapshot"]
"""The transport of live frames: video, or a sequence of snapshots."""

_SETUP = {"Stream": "RTP-Unicast", "Transport": {"Protocol": "RTSP"}}


class OnvifPictures(DevicePictures):
    """Pictures from one profile.

    Args:
        http: The HTTP connection to the device.
        credentials: The credentials for the RTSP stream.
        snapshot_path: Path and query for snapshots; empty if the device has none.
        stream_url: URL of the RTSP stream without credentials; empty if the device has none.
        native_size: Width and height in pixels of a snapshot, or of the stream if there are no snapshots.
        stream_size: Width and height of the stream in pixels.
        width: Width of a frame in pixels; pictures are scaled to it.
        height: Height of a frame in pixels.
        stream: The transport of live frames.
        latency_s: Seconds from the exposure of a streamed frame to its arrival.
    """

    def __init__(
        self,
        http: DeviceHttp,
        credentials: Credentials,
        *,
        snapshot_path: str,
        stream_url: str,
        native_size: tuple[int, int],
        stream_size: tuple[int, int],
        width: int,
        height: int,
        stream: OnvifStream = "rtsp",
        latency_s: float = 0.1,
    ) -> None:
        super().__init__(width, height, small_size=(width, height), latency_s=latency_s)
        self._http, self._credentials = http, credentials
        self.snapshot_path, self.stream_url = snapshot_path, stream_url
        self._native_size, self._stream_size, self._stream_kind = native_size, stream_size, stream
        self._video: LiveStream | None = None

    async def take_snapshot(self, width: int, height: int) -> tuple[bytes, NDArray[np.uint8]]:
        if not self.snapshot_path:
            return await self._take_from_video()
        body = (await self._http.get(self.snapshot_path)).body
        image = await to_thread.run_sync(lambda: decode_jpeg(body, width=self._native_size[0], height=self._native_size[1]))
        return body, scale_picture(image, width, height)

    def open_stream(self, rate_hz: float) -> LiveStream:  # noqa: ARG002 - the device chooses the rate
        if self._stream_kind == "snapshot" or not self.stream_url:
            return SnapshotStream(lambda: self.take_snapshot(self.width, self.height))
        return ScaledStream(self._open_video(), self.width, self.height)

    async def close(self) -> None:
        """Close the stream that is used in place of snapshots."""
        if self._video is not None:
            await self._video.close()
            self._video = None

    async def _take_from_video(self) -> tuple[bytes, NDArray[np.uint8]]:
        """Return the first frame from the stream that was exposed after this call began."""
        if self._video is None:
            self._video = self._open_video()
        requested_s = monotonic()
        while True:
            try:
                picture = await self._video.next()
            except BaseException:
                with anyio.CancelScope(shield=True):
                    await self.close()
                raise
            if picture.arrived_s - self._latency_s >= requested_s:
                return picture.data, scale_picture(picture.image, self.width, self.height)

    def _open_video(self) -> LiveStream:
        width, height = self._stream_size
        return RtspStream(self.stream_url, self._credentials, width=width, height=height, tls=self._http.tls_context)


async def open_pictures(
    client: OnvifClient,
    credentials: Credentials,
    device: OnvifDevice,
    *,
    width: int | None,
    height: int | None,
    stream: OnvifStream,
    rtsp_port: int | None,
    latency_s: float,
) -> OnvifPictures:
    """Read a device's picture URLs and return its pictures. URLs with another host are rewritten to the configured host.

    Args:
        client: The connection.
        credentials: The credentials for the RTSP stream.
        device: The device's properties and capabilities.
        width: Width of a frame in pixels; None for that of the device's pictures.
        height: Height of a frame in pixels; None for that of the device's pictures.
        stream: The transport of live frames.
        rtsp_port: Port of the RTSP server; None for the port that the device reports.
        latency_s: Seconds from the exposure of a streamed frame to its arrival.

    Raises:
        CameraError: The device provides no pictures, or their aspect ratio differs from the requested one.
    """
    token, stream_size = device.picture_profile, (device.width, device.height)
    uri = await _uri(client, "GetSnapshotUri", ProfileToken=token)
    snapshot_path = pinned_path(client.http, uri) if uri else ""
    stream_uri = await _uri(client, "GetStreamUri", StreamSetup=_SETUP, ProfileToken=token)
    stream_url = _with_port(client.address.pin_rtsp(stream_uri), rtsp_port) if stream_uri else ""
    if not snapshot_path and not stream_url:
        raise CameraReplyError(
            f"The camera at {client.address} reports neither a snapshot URL nor a stream URL. Check its video settings."
        )
    native_size = stream_size
    if snapshot_path:
        native_size = await _snapshot_size(client, snapshot_path)
    width, height = _frame_size(native_size, width, height)
    return OnvifPictures(
        client.http, credentials, snapshot_path=snapshot_path, stream_url=stream_url, native_size=native_size,
        stream_size=stream_size, width=width, height=height, stream=stream, latency_s=latency_s,
    )  # fmt: skip


async def _uri(client: OnvifClient, operation: str, **arguments: Any) -> str:
    """Return a URL that the device reports; empty if it reports none."""
    try:
        reply = await client.call("media", operation, **arguments)
    except (OnvifFaultError, CameraReplyError):
        return ""
    return str(getattr(reply, "Uri", None) or "")


async def _snapshot_size(client: OnvifClient, path: str) -> tuple[int, int]:
    for retries_left in (1, 0):
        try:
            image = decode_jpeg((await client.http.get(path)).body)
        except PictureError:
            if not retries_left:
                raise
        else:
            return int(image.shape[1]), int(image.shape[0])
    raise AssertionError("the last attempt returns or raises")


def _frame_size(native_size: tuple[int, int], width: int | None, height: int | None) -> tuple[int, int]:
    if width is None and height is None:
        return native_size
    width = width or round((height or 0) * native_size[0] / native_size[1])
    height = height or round(width * native_size[1] / native_size[0])
    if abs(width * native_size[1] - height * native_size[0]) > max(native_size):
        raise PictureError(
            f"The camera's picture size is {native_size[0]}x{native_size[1]}, which does not have the aspect ratio of "
            f"{width}x{height}. Remove ?height=... from the camera's options.",
            "size",
        )
    return width, height


def _with_port(url: str, port: int | None) -> str:
    from urllib.parse import urlsplit, urlunsplit

    parts = urlsplit(url)
    return url if port is None else urlunsplit(parts._replace(netloc=f"{parts.netloc.rpartition(':')[0]}:{port}"))
