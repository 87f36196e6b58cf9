"""Snapshots and Motion JPEG streams of the virtual camera."""

from __future__ import annotations

import asyncio
import logging

import anyio
import cv2
import numpy as np
import pytest

from scope_ptz.errors import PackError
from scope_ptz.virtual_camera.device import Exposure, VirtualDevice
from scope_ptz.virtual_camera.http import server as server_module
from scope_ptz.virtual_camera.http.jpeg import PictureFormat
from scope_ptz.virtual_camera.http.server import ServedCamera, serve
from tests.virtual_camera.http.serving import IMAGE, VIDEO, Parts, camera_and_client, client, decoded, until

pytestmark = pytest.mark.anyio


async def test_snapshots(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device) as (_, session):
        full = await session.get(IMAGE)
        assert full.headers["content-type"] == "image/jpeg"
        assert int(full.headers["content-length"]) == len(full.content)
        assert decoded(full.content).shape == (180, 320, 3)
        assert not any(name.startswith("x-scope") for name in full.headers)
        expected = served_device.expose().image[..., ::-1].astype(float)
        best = decoded((await session.get(IMAGE, params={"compression": "0"})).content)
        assert np.abs(best - expected).mean() < 2
        small = await session.get(IMAGE, params={"resolution": "160x90", "compression": "90"})
        assert decoded(small.content).shape == (90, 160, 3)
        assert len(small.content) < len(full.content)
        square = decoded((await session.get(IMAGE, params={"resolution": "90x90", "compression": "0"})).content)
        middle = cv2.resize(expected[:, 70:250].astype(np.uint8), (90, 90), interpolation=cv2.INTER_AREA)
        assert np.abs(square - middle.astype(float)).mean() < 3
        for wrong in ("4000x3000", "8x8", "big", "1x", "-1x5"):
            assert (await session.get(IMAGE, params={"resolution": wrong})).status_code == 400
        assert (await session.get(IMAGE, params={"compression": "101"})).status_code == 400
        for path in (IMAGE, VIDEO):
            assert (await session.get(path, params={"camera": "2"})).status_code == 400
        assert (await session.get(IMAGE, params={"camera": "1"})).status_code == 200


async def test_several_browsers_watch_and_one_vanishes(served_device: VirtualDevice) -> None:
    got: dict[str, int] = {}

    async def watch(camera: ServedCamera, name: str, resolution: str) -> None:
        async with client(camera) as session, session.stream("GET", VIDEO, params={"resolution": resolution}) as response:
            frames = await Parts(response).take(6)
            width, height = map(int, resolution.split("x"))
            assert all(decoded(jpeg).shape == (height, width, 3) for _, jpeg in frames)
            got[name] = len(frames)

    async with serve([served_device], rate_hz=50) as (camera,):
        vanishing = client(camera)
        stream = vanishing.stream("GET", VIDEO)
        response = await stream.__aenter__()
        assert len(await Parts(response).take(2)) == 2
        async with anyio.create_task_group() as group:
            for name, resolution in (("a", "320x180"), ("b", "320x180"), ("c", "160x90")):
                group.start_soon(watch, camera, name, resolution)
            await response.aclose()
            await vanishing.aclose()
        assert got == {"a": 6, "b": 6, "c": 6}
        await until(lambda: camera.source.subscribers == 0)


async def test_clients_of_one_size_share_an_encoding(served_device: VirtualDevice) -> None:
    async with serve([served_device]) as (camera,):
        jpegs = camera.application.jpegs
        exposure = served_device.expose()
        encoded = await asyncio.gather(*(jpegs.jpeg(exposure, PictureFormat(160, 90)) for _ in range(5)))
        assert len({id(content) for content in encoded}) == 1
        assert jpegs.encodings == 1
        await jpegs.jpeg(exposure, PictureFormat(320, 180))
        await jpegs.jpeg(served_device.expose(), PictureFormat(160, 90))
        assert jpegs.encodings == 3


async def test_a_stream_ends_after_the_frames_that_were_asked_for(served_device: VirtualDevice) -> None:
    async with camera_and_client(served_device, rate_hz=100) as (_, session):
        reply = await session.get(VIDEO, params={"nbrofframes": "3", "fps": "30"})
        assert reply.content.count(b"--myboundary\r\n") == 3
        assert reply.content.endswith(b"--myboundary--\r\n")


async def test_a_lower_frame_rate_skips_frames(served_device: VirtualDevice) -> None:
    async with (
        camera_and_client(served_device, rate_hz=100, truth=True) as (_, session),
        session.stream("GET", VIDEO, params={"fps": "10"}) as response,
    ):
        frames = await Parts(response).take(4)
    times = [float(headers["x-scope-taken"]) for headers, _ in frames]
    assert times[-1] - times[0] > 0.29


async def test_a_live_picture_that_fails_is_started_again(
    served_device: VirtualDevice, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(server_module, "RETRY_S", 0.01)
    monkeypatch.setattr(logging.getLogger("scope_ptz"), "propagate", True)  # commands that ran before turn it off
    expose, failures = served_device.expose, iter([PackError("The pack is damaged."), OSError("disk")])

    def failing(*size: int) -> Exposure:
        if error := next(failures, None):
            raise error
        return expose(*size)

    monkeypatch.setattr(served_device, "expose", failing)
    async with camera_and_client(served_device) as (_, session):
        reply = await session.get(VIDEO, params={"nbrofframes": "2"})
    assert reply.content.count(b"Content-Type: image/jpeg") == 2
    assert "The pack is damaged." in caplog.text
    assert "disk" in caplog.text
