"""The faults of a camera, as RTSP clients see them."""

from __future__ import annotations

import anyio
import av
import numpy as np
import pytest
from anyio import to_thread
from numpy.typing import NDArray

from scope_ptz.geometry import Pose
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.faults import Faults
from tests.support.rtsp_client import Depacketizer, RtpPacket, RtspClient
from tests.virtual_camera.rtsp.pictures import difference
from tests.virtual_camera.rtsp.serving import serving
from tests.virtual_camera.rtsp.test_clients import pyav_frames
from tests.virtual_camera.rtsp.test_encoder import decoded

pytestmark = pytest.mark.anyio


async def pictures(client: RtspClient, count: int) -> list[list[bytes]]:
    """Return the NAL units of pictures."""
    depacketizer = Depacketizer()
    found: list[list[bytes]] = []
    while len(found) < count:
        nals = depacketizer.add(RtpPacket.parse(await client.packet(0)))
        if nals is not None:
            found.append(nals)
    return found


async def test_a_camera_that_goes_down_breaks_everything_off_and_comes_back(open_device: VirtualDevice) -> None:
    async with serving(open_device) as served:
        async with RtspClient(served.port) as client:
            await client.play()
            open_device.faults = Faults(down=True)
            with pytest.raises((EOFError, OSError)):
                while True:
                    await client.packet(0)
        await served.until_left()
        with pytest.raises((EOFError, OSError)):
            async with RtspClient(served.port) as client:
                await client.request("OPTIONS")
        open_device.faults = Faults()
        async with RtspClient(served.port) as client:
            await client.play()
            await client.packet(0)


async def test_a_fraction_of_requests_is_dropped(open_device: VirtualDevice) -> None:
    open_device.faults = Faults(drop=0.5)
    outcomes = []
    async with serving(open_device) as served:
        for _ in range(20):
            async with RtspClient(served.port) as client:
                try:
                    outcomes.append((await client.request("OPTIONS")).status)
                except (EOFError, OSError):
                    outcomes.append(0)
    assert 4 < outcomes.count(0) < 16
    assert set(outcomes) == {0, 200}


async def test_replies_are_late(open_device: VirtualDevice) -> None:
    open_device.faults = Faults(stall_s=0.3)
    async with serving(open_device) as served, RtspClient(served.port) as client:
        before_s = anyio.current_time()
        assert (await client.request("OPTIONS")).status == 200
        assert anyio.current_time() - before_s >= 0.3
        open_device.faults = Faults(stall_s=600)
        await client.send(b"OPTIONS * RTSP/1.0\r\nCSeq: 2\r\n\r\n")
        await anyio.sleep(0.1)
    # The server ends although a reply is waiting.


async def test_every_account_is_refused(served_device: VirtualDevice) -> None:
    served_device.faults = Faults(unauthorized=True)
    async with serving(served_device) as served, RtspClient(served.port, user="root", password="pass word") as client:
        assert (await client.request("DESCRIBE")).status == 401
        served_device.faults = Faults()
        assert (await client.request("DESCRIBE")).status == 200


async def test_replies_are_garbage(open_device: VirtualDevice) -> None:
    open_device.faults = Faults(garbage=True)
    async with serving(open_device) as served, RtspClient(served.port) as client:
        with pytest.raises((ValueError, AssertionError, KeyError)):
            await client.request("OPTIONS")


@pytest.mark.parametrize("fault", [Faults(garbage=True), Faults(picture="truncated")])
async def test_damaged_pictures_do_not_decode_and_whole_ones_follow(open_device: VirtualDevice, fault: Faults) -> None:
    expected = open_device.expose().image

    def good(keyframe: list[bytes]) -> bool:
        try:
            found = decoded([keyframe])
        except av.FFmpegError:
            return False
        return len(found) == 1 and difference(found[0], expected) < 6

    async with serving(open_device) as served, RtspClient(served.port) as client:
        await client.play()
        assert good((await pictures(client, 1))[0])
        for current, is_good in ((fault, False), (Faults(), True)):
            open_device.faults = current
            with anyio.fail_after(30):
                while True:
                    (nals,) = await pictures(client, 1)
                    if nals[0][0] & 0x1F == 7 and good(nals) == is_good:
                        break


async def test_a_frozen_picture_goes_on_with_fresh_time_stamps(open_device: VirtualDevice) -> None:
    def watch(url: str) -> tuple[list[float], list[NDArray[np.uint8]]]:
        frames = [next_frame for next_frame, _ in zip(pyav_frames(url, "tcp"), range(30), strict=False)]
        return [time_s for time_s, _ in frames], [image for _, image in frames]

    open_device.faults = Faults(picture="frozen")
    expected = open_device.expose().image
    open_device.move(Pose(90.0, 0.0, 1.0))
    async with serving(open_device) as served:
        times, images = await to_thread.run_sync(watch, served.url())
    assert times == sorted(set(times))
    assert times[-1] - times[0] > 0.3
    assert max(difference(image, expected) for image in images) < 6


async def test_a_picture_of_another_size_reaches_the_client(open_device: VirtualDevice) -> None:
    async with serving(open_device) as served, RtspClient(served.port) as client:
        await client.play()
        (first,) = await pictures(client, 1)
        open_device.faults = Faults(picture="size")
        while (other := (await pictures(client, 1))[0])[0][0] & 0x1F != 7 or other[0] == first[0]:
            pass
        assert [image.shape for image in decoded([first])] == [(180, 320, 3)]
        assert [image.shape for image in decoded([other])] == [(90, 160, 3)]
