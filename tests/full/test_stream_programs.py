"""The streams of a virtual camera in installed programs: ffprobe, ffmpeg, and a browser's ``<img>``."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import cv2
import numpy as np
import pytest
from anyio import to_thread
from numpy.typing import NDArray

from scope_ptz.factory.cameras.virtual import VirtualCameraOptions, serve_virtual_cameras
from scope_ptz.geometry import Pose
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.accounts import Account
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import ServedCamera

pytestmark = [pytest.mark.anyio, pytest.mark.full]

SECRET = "pass word"
STREAMS = {"rtsp over tcp": ["-rtsp_transport", "tcp"], "rtsp over udp": ["-rtsp_transport", "udp"], "mjpeg": []}


def program(name: str) -> str:
    """Return the path of a program, or fail with the name of its package."""
    path = shutil.which(name)
    package = {"ffprobe": "ffmpeg"}.get(name, name)
    assert path, f"{name} is missing. Install Debian's package: apt-get install --no-install-recommends {package}"
    return path


async def run(*command: str) -> bytes:
    """Run a program and return its output."""
    result = await to_thread.run_sync(lambda: subprocess.run(command, capture_output=True, timeout=120, check=False))
    assert result.returncode == 0, result.stderr.decode(errors="replace")[-2000:]
    return result.stdout


@asynccontextmanager
async def camera_of(scene: Scene, *, accounts: bool = True) -> AsyncIterator[ServedCamera]:
    device = VirtualDevice(
        scene, accounts=[Account("root", SECRET)] if accounts else [], clock=SceneClock(scene.file.start_s), width=640, height=360,
        time_scale=1000.0,
    )  # fmt: skip
    device.move(Pose(40.0, -5.0, 1.0))
    async with serve_virtual_cameras([device], VirtualCameraOptions(scenes=(scene.name,), discovery=False)) as (camera,):
        yield camera


def address(camera: ServedCamera, stream: str) -> str:
    url = f"{camera.url}/axis-cgi/mjpg/video.cgi" if stream == "mjpeg" else str(camera.rtsp_url)
    return url.replace("://", "://root:pass%20word@")


def differences(image: NDArray[np.uint8], camera: ServedCamera) -> tuple[float, float]:
    """Return the mean differences from the picture at the camera's pose, and from that in the opposite direction."""
    device = camera.device
    height, width = image.shape[:2]
    right = device.expose(width, height).image
    device.move(Pose(-140.0, -5.0, 1.0))
    while device.is_moving():
        pass
    wrong = device.expose(width, height).image
    return float(np.abs(image - right.astype(float)).mean()), float(np.abs(image - wrong.astype(float)).mean())


@pytest.mark.parametrize("stream", STREAMS)
async def test_ffprobe_finds_the_stream(analytic_scene: Scene, stream: str) -> None:
    async with camera_of(analytic_scene) as camera:
        output = await run(
            program("ffprobe"), "-v", "error", *STREAMS[stream], "-show_streams", "-of", "json", address(camera, stream)
        )
    (found,) = json.loads(output)["streams"]
    assert (found["codec_type"], found["width"], found["height"]) == ("video", 640, 360)
    if stream == "mjpeg":
        assert found["codec_name"] == "mjpeg"
    else:
        assert (found["codec_name"], found["profile"], found["has_b_frames"]) == ("h264", "Constrained Baseline", 0)
        assert (found["pix_fmt"], found["avg_frame_rate"], found["color_space"]) == ("yuv420p", "25/1", "smpte170m")


@pytest.mark.parametrize("stream", STREAMS)
async def test_ffmpeg_reads_pictures_without_an_error(analytic_scene: Scene, stream: str, tmp_path: Path) -> None:
    async with camera_of(analytic_scene) as camera:
        await run(
            program("ffmpeg"), "-v", "fatal", "-xerror", *STREAMS[stream], "-i", address(camera, stream), "-frames:v", "50",
            "-fps_mode", "passthrough", str(tmp_path / "%d.png"),
        )  # fmt: skip
        image = cv2.imread(str(tmp_path / "50.png"))
        assert image is not None, "fewer than 50 pictures"
        right, wrong = differences(np.asarray(image[..., ::-1], np.uint8), camera)
    assert right < 6
    assert right < wrong / 2


async def test_a_browser_shows_motion_jpeg(analytic_scene: Scene, tmp_path: Path) -> None:
    """The camera's page contains an ``<img>`` of its stream. The camera has no accounts, because browsers send no credentials."""
    async with camera_of(analytic_scene, accounts=False) as camera:
        shot = tmp_path / "page.png"
        await run(
            program("chromium"), "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}",
            "--hide-scrollbars", "--timeout=10000", "--window-size=640,900", f"--screenshot={shot}", f"{camera.url}/",
        )  # fmt: skip
        page = cv2.imread(str(shot))
        assert page is not None
        device = camera.device
        picture = device.expose().image[..., ::-1]
        # The browser scales the picture to the width of its page, with margins.
        small = cv2.resize(page, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
        best = max(
            float(cv2.matchTemplate(small, cv2.resize(picture, (width, width * 9 // 16)), cv2.TM_CCOEFF_NORMED).max())
            for width in range(300, 321, 2)
        )
    assert best > 0.9
