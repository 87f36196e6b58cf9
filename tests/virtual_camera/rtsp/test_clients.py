"""Independent clients: FFmpeg through PyAV and through OpenCV's VideoCapture, over TCP, UDP and HTTP."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from functools import partial
from itertools import pairwise
from time import time

import anyio
import av
import cv2
import numpy as np
import pytest
from anyio import to_thread
from numpy.typing import NDArray

from scope_ptz.geometry import Pose
from scope_ptz.virtual_camera.device import Exposure, VirtualDevice
from scope_ptz.virtual_camera.faults import Faults
from scope_ptz.virtual_camera.truth import unix_s
from tests.support.rtsp_client import Depacketizer, RtpPacket, RtspClient, SenderReport
from tests.virtual_camera.conftest import ACCOUNTS
from tests.virtual_camera.rtsp.pictures import difference
from tests.virtual_camera.rtsp.serving import Served, serving, until

pytestmark = pytest.mark.anyio

ROOT = ACCOUNTS[0]
ACCOUNT = "root:pass%20word"
POSES = [Pose(0.0, 0.0, 1.0), Pose(60.0, -10.0, 2.0), Pose(-120.0, 5.0, 1.0)]


def pyav_frames(url: str, transport: str) -> Iterator[tuple[float, NDArray[np.uint8]]]:
    """Yield the time and the picture of every frame that PyAV decodes."""
    # The analysis at the start would otherwise read for seconds.
    options = {"rtsp_transport": transport, "fflags": "nobuffer", "fpsprobesize": "0", "analyzeduration": "200000"}
    with av.open(url, options=options, timeout=20) as container:
        for frame in container.decode(video=0):
            assert frame.time is not None
            yield frame.time, np.asarray(frame.to_ndarray(format="rgb24"), np.uint8)


def opencv_frames(url: str, transport: str) -> Iterator[tuple[float, NDArray[np.uint8]]]:
    """Yield the same by OpenCV, which reads the transport from the environment."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("OPENCV_FFMPEG_CAPTURE_OPTIONS", f"rtsp_transport;{transport}|fflags;nobuffer|analyzeduration;200000")
        capture = cv2.VideoCapture(url, cv2.CAP_FFMPEG)
    try:
        assert capture.isOpened()
        while True:
            done, image = capture.read()
            assert done
            yield capture.get(cv2.CAP_PROP_POS_MSEC) / 1000, np.asarray(image[..., ::-1], np.uint8)
    finally:
        capture.release()


CLIENTS = {"pyav": pyav_frames, "opencv": opencv_frames}


def settled(device: VirtualDevice, pose: Pose) -> NDArray[np.uint8]:
    """Move, and return the picture that follows."""
    device.move(pose)
    while device.is_moving():
        pass
    return device.expose().image


@pytest.mark.parametrize("transport", ["tcp", "udp", "http"])
@pytest.mark.parametrize("name", CLIENTS)
async def test_frames_show_the_picture_of_the_pose(open_device: VirtualDevice, name: str, transport: str) -> None:
    expected = [settled(open_device, pose) for pose in POSES]
    open_device.move(POSES[0])

    def watch(url: str) -> list[float]:
        """Follow the camera from pose to pose, and return the times of all frames."""
        frames, times = CLIENTS[name](url, transport), []
        for k, pose in enumerate(POSES):
            open_device.move(pose)
            for time_s, image in frames:
                times.append(time_s)
                found = [difference(image, each) for each in expected]
                if found[k] < 6 and found[k] == min(found):
                    break
                assert len(times) < 2000, found
        frames.close()  # type: ignore[attr-defined]
        return times

    async with serving(open_device) as served:
        times = await to_thread.run_sync(watch, served.url())
        assert all(sooner < later for sooner, later in pairwise(times))
        await served.until_left()


async def test_four_clients_at_once_share_one_encoder(served_device: VirtualDevice) -> None:
    seen: list[int] = []

    def watch(served: Served, name: str, transport: str, together: list[str]) -> None:
        together.append(name)
        for k, (_, image) in enumerate(CLIENTS[name](served.url(ACCOUNT), transport)):
            assert image.shape == (180, 320, 3)
            seen.append(served.server.encoders)
            if k >= 20 and served.server.statistics.sessions == 4:
                return

    async with serving(served_device) as served:
        async with anyio.create_task_group() as group:
            together: list[str] = []
            for name in CLIENTS:
                for transport in ("tcp", "udp"):
                    group.start_soon(to_thread.run_sync, partial(watch, served, name, transport, together))
        assert max(seen) == 1
        await served.until_left()


@pytest.mark.parametrize("name", CLIENTS)
async def test_a_wrong_password_opens_nothing(served_device: VirtualDevice, name: str, capfd: pytest.CaptureFixture[str]) -> None:
    async with serving(served_device) as served:
        with pytest.raises((AssertionError, av.FFmpegError)):
            await to_thread.run_sync(next, CLIENTS[name](served.url("root:wrong"), "tcp"))
        assert served.server.statistics.sessions == 0


async def test_size_and_rate_are_chosen_in_the_address(open_device: VirtualDevice) -> None:
    def watch(url: str) -> list[tuple[float, tuple[int, ...]]]:
        frames = pyav_frames(url, "tcp")
        return [(time_s, image.shape) for (time_s, image), _ in zip(frames, range(8), strict=False)]

    async with serving(open_device, rate_hz=50) as served:
        found = await to_thread.run_sync(watch, served.url(options="resolution=160x90&fps=10"))
        assert {shape for _, shape in found} == {(90, 160, 3)}
        # A busy machine delays or omits frames. It never adds any, so eight frames cannot follow faster than the rate on average.
        assert found[-1][0] - found[0][0] > 7 * 0.075


@pytest.mark.parametrize("skew_s", [0.0, 3600.0])
async def test_reports_map_every_frame_to_the_time_of_its_exposure(open_device: VirtualDevice, skew_s: float) -> None:
    exposed: list[Exposure] = []
    open_device.observers.append(exposed.append)
    open_device.faults = Faults(clock_skew_s=skew_s)
    started_s = time()
    async with serving(open_device, latency_s=0.1) as served, RtspClient(served.port) as client:
        await client.play()
        report = SenderReport.parse(await client.packet(1))
        depacketizer = Depacketizer()
        times: list[float] = []
        while len(times) < 10:
            packet = RtpPacket.parse(await client.packet(0))
            if depacketizer.add(packet) is not None:
                times.append(report.taken_s(packet.timestamp) - skew_s)
    assert times == sorted(set(times))
    for taken_s in times:
        assert started_s < taken_s < time()
        # Clocks are set while a test runs, by NTP: a millisecond is enough to tell frames from each other.
        assert min(abs(unix_s(each) - taken_s) for each in exposed) < 1e-3


async def test_keyframes_come_every_second_and_for_every_new_client(open_device: VirtualDevice) -> None:
    async with serving(open_device, rate_hz=20) as served, RtspClient(served.port) as first, RtspClient(served.port) as second:
        await first.play()
        depacketizer = Depacketizer()
        stamps: list[int] = []  # of keyframes
        joined = False
        while len(stamps) < 4:
            packet = RtpPacket.parse(await first.packet(0))
            picture = depacketizer.add(packet)
            if picture is None:
                continue
            kinds = [nal[0] & 0x1F for nal in picture]
            assert kinds in ([7, 8, 5], [1])
            if kinds != [1]:
                stamps.append(packet.timestamp)
            elif len(stamps) == 2 and not joined:
                await second.play()
                joined = True
                assert RtpPacket.parse(await second.packet(0)).payload[0] & 0x1F == 7
        gaps = [(later - sooner) % 2**32 / 90_000 for sooner, later in pairwise(stamps)]
        assert gaps[0] >= 0.97
        assert gaps[1] < gaps[0]


async def test_pictures_wait_for_the_configured_latency(open_device: VirtualDevice) -> None:
    async with serving(open_device, latency_s=0.7) as served, RtspClient(served.port) as client:
        await client.play()
        report = SenderReport.parse(await client.packet(1))
        for _ in range(30):
            packet = RtpPacket.parse(await client.packet(0))
            assert time() - report.taken_s(packet.timestamp) >= 0.699
        assert served.server.statistics.oldest_s <= 0.5


async def test_streams_of_different_formats_have_a_limit(open_device: VirtualDevice) -> None:
    async with serving(open_device) as served:
        clients = [RtspClient(served.port, path=f"/axis-media/media.amp?fps={k + 1}") for k in range(9)]
        async with anyio.create_task_group() as group:
            for client in clients:
                group.start_soon(client.__aenter__)
        for client in clients[:8]:
            await client.play()
        set_up = await clients[8].request("SETUP", Transport="RTP/AVP/TCP;unicast")
        assert (await clients[8].request("PLAY", Session=set_up.session)).status == 453
        for client in clients:
            await client.__aexit__(None, None, None)
        await served.until_left()


async def test_a_stream_comes_back_after_everybody_has_left(open_device: VirtualDevice) -> None:
    async with serving(open_device) as served:
        for _ in range(3):
            async with RtspClient(served.port) as client:
                await client.play()
                await client.packet(0)
                assert served.server.encoders == 1
            await until(lambda: served.server.encoders == 0)
    assert not [task for task in asyncio.all_tasks() if "Stream" in repr(task.get_coro())]
