"""Measure the accuracy of a captured twin: its pose errors, and its structural similarity to the pack of a virtual camera.

    python benchmarks/twin_capture.py [--scene highway-works] [--driver axis|onvif] [--noise 0.1] [--pan=-60:60] [--out FOLDER]

A virtual camera is served on this machine and captured over the network by a driver. Its picture drifts away from the pose that
its encoders report, and noise is added to every reported pose. The capture must correct both from the pictures. The program
prints the errors of the reported and of the adjusted poses, the similarity between views of the twin and of the pack, and the
angle between those views. The targets are a mean SSIM of 0.9 at 1x, after the common rotation of the whole twin has been removed,
because it cannot be determined from pictures, and a pose error of 0.2 degrees, including that rotation. The exit code is 1 if a
target is missed.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scope_ptz.blender.parity import ssim
from scope_ptz.camera.base import Camera, Frame
from scope_ptz.camera.capture.frame_taking import CaptureOptions, capture_settings, take_frames
from scope_ptz.camera.capture.plan import Ranges
from scope_ptz.camera.capture.session import CaptureSession
from scope_ptz.camera.guard.wrapper import CameraWrapper
from scope_ptz.camera.measurement.registration import RegistrationError, focal_px, match, rotation
from scope_ptz.errors import CameraError
from scope_ptz.factory.cameras import open_camera
from scope_ptz.factory.cameras.captures import build_scene
from scope_ptz.factory.cameras.virtual import VirtualCameraOptions, make_accounts, make_devices, serve_virtual_cameras
from scope_ptz.geometry import Perspective, Pose, angle_between_deg, direction, pan_tilt_deg
from scope_ptz.settings import ScopeSettings
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.views import picture
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.faults import Faults

MIN_SSIM, MAX_POSE_ERROR_DEG = 0.9, 0.2
ZOOMS = (1.0, 2.0, 4.0)

Floats = NDArray[np.float64]


class InaccurateCamera(CameraWrapper):
    """A camera with deliberate faults: every reported pose has a random error, and the picture drifts from the first frame on.

    Attributes:
        truths: The true pan and tilt of each frame, keyed by the reported values.
    """

    def __init__(self, camera: Camera, device: VirtualDevice, noise_deg: float, drift_dps: float, seed: int) -> None:
        super().__init__(camera)
        self._device, self._noise_deg, self._random = device, noise_deg, np.random.default_rng(seed)
        self._drift_dps = drift_dps
        self._true = Pose()
        self.truths: dict[tuple[float, float], Pose] = {}
        device.observers.append(self._observe)
        self._since_s = device.now_s()

    def _begin(self) -> None:
        self._device.faults = Faults(drift_dps=self._drift_dps)
        self._since_s = self._device.now_s()

    def _observe(self, exposure: Any) -> None:
        drift_deg = self._device.faults.drift_dps * (self._device.now_s() - self._since_s)
        self._true = exposure.pose.turned(drift_deg)

    async def frame(self) -> Frame:
        if not self.truths:
            self._begin()
        frame = await self.inner.frame()
        pan_deg, tilt_deg = self._random.normal(0.0, self._noise_deg, 2) if self._noise_deg else (0.0, 0.0)
        pose = frame.pose.turned(float(pan_deg), float(tilt_deg))
        if not isinstance(frame.projection, Perspective):
            raise CameraError("A panorama has no pose.")
        self.truths[pose.pan_deg, pose.tilt_deg] = self._true
        return replace(frame, pose=pose, projection=replace(frame.projection, pan_deg=pose.pan_deg, tilt_deg=pose.tilt_deg))


async def capture_twin(arguments: argparse.Namespace, scenes: Path, progress: Any) -> tuple[dict[str, Any], Floats, VirtualDevice]:
    """Serve a camera, capture it, and return the measurements of the capture."""
    options = VirtualCameraOptions(
        scenes=(arguments.scene,), time_scale=arguments.time_scale, freeze_time=not arguments.alive, discovery=False,
        prefetch=False,
    )  # fmt: skip
    accounts = make_accounts(["operator"], ScopeSettings(virtual_camera_password=None))
    (device,) = make_devices(options, accounts)
    os.environ["SCOPE_CAMERA_PASSWORD"] = accounts[0].password
    async with serve_virtual_cameras([device], options) as (served,):
        spec = f"{arguments.driver}://operator@127.0.0.1:{served.port}"
        async with await open_camera(spec, actor="benchmark") as opened:
            drift_dps = arguments.drift / 60 / arguments.time_scale
            camera = InaccurateCamera(opened.camera, device, arguments.noise, drift_dps, arguments.seed)
            ranges = Ranges(_range(arguments.pan), _range(arguments.tilt))
            settings = capture_settings(camera, CaptureOptions(ranges, close_ups=arguments.close_ups))
            session = CaptureSession(scenes / ".twin.capture", settings, "2026-01-01T00:00:00+00:00")
            began_s = time.monotonic()
            await take_frames(camera, session, progress, holder="benchmark")
            taken_s = time.monotonic() - began_s
        began_s, began_cpu_s = time.monotonic(), time.process_time()
        found = await asyncio.to_thread(build_scene, session, scenes / "twin", progress)
        built_s, built_cpu_s = time.monotonic() - began_s, time.process_time() - began_cpu_s
    record = json.loads((scenes / "twin" / "capture.json").read_text())
    true = [camera.truths[each["reported"]["pan_deg"], each["reported"]["tilt_deg"]] for each in record["frames"]]
    rays = np.array([direction(pose.pan_deg, pose.tilt_deg) for pose in true])
    reported, adjusted = (np.array([_ray(each[kind]) for each in record["frames"]]) for kind in ("reported", "adjusted"))
    turn = common_turn(adjusted, rays)
    return {
        "frames": found.frames, "registered": found.registered, "tiles": found.tiles, "matches": record["matches"],
        "residual_px": found.residual_px, "unseen_share": found.unseen_share,
        "reported_error_deg": _summary(angle_between_deg(reported, rays)),
        "adjusted_error_deg": _summary(angle_between_deg(adjusted, rays)),
        "adjusted_error_without_common_turn_deg": _summary(angle_between_deg(adjusted @ turn.T, rays)),
        "taking_s": round(taken_s, 1), "building_s": round(built_s, 1), "building_cpu_s": round(built_cpu_s, 1),
    }, turn, device  # fmt: skip


def common_turn(own: Floats, true: Floats) -> Floats:
    """Return the rotation (3, 3) that best aligns directions (n, 3) with others (Kabsch)."""
    u, _, vt = np.linalg.svd(true.T @ own)
    return np.asarray(u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt)


def compare_views(arguments: argparse.Namespace, device: VirtualDevice, turn: Floats, twin: Scene) -> dict[str, Any]:
    """Return the similarity between views of the twin and of the camera's pack, and the angle between them.

    The similarity is computed at the same pose, and again after removing the common rotation of the whole twin, which cannot be
    determined from pictures.
    """
    random = np.random.default_rng(arguments.seed)
    limits, turned = twin.file.limits, list[float]()
    similar: dict[str, dict[str, list[float]]] = {kind: {} for kind in ("ssim", "ssim_without_common_turn")}
    for zoom in ZOOMS:
        for _ in range(arguments.views):
            pan, tilt = (
                random.uniform(low, high)
                for low, high in ((limits.min_pan_deg, limits.max_pan_deg), (limits.min_tilt_deg, limits.max_tilt_deg))
            )
            there = pan_tilt_deg(turn @ direction(pan, tilt))
            own = picture(twin, "camera", Perspective(pan, tilt, twin.file.optics.hfov_deg(zoom), 1280, 720), 0.0)
            for kind, (true_pan, true_tilt) in zip(similar, ((pan, tilt), map(float, there)), strict=True):
                view = Perspective(true_pan, true_tilt, device.optics.hfov_deg(zoom), 1280, 720)
                true = picture(device.scene, device.viewpoint, view, device.clock.now_s())
                similar[kind].setdefault(f"{zoom:g}x", []).append(ssim(true, own))
                if zoom == 1.0 and kind == "ssim":
                    with suppress(RegistrationError):  # a view of the sky
                        turned.append(rotation(match(true, own), focal_px(view.hfov_deg, 1280)).angle_deg)
    found: dict[str, Any] = {
        kind: {zoom: {"mean": round(statistics.mean(of), 4), "least": round(min(of), 4)} for zoom, of in by_zoom.items()}
        for kind, by_zoom in similar.items()
    }
    return {**found, "views_turned_deg": _summary(turned)}


def _ray(place: dict[str, float]) -> Floats:
    return direction(place["pan_deg"], place["tilt_deg"])


def _summary(values: Sequence[float] | Floats) -> dict[str, float]:
    return {
        "mean": round(float(np.mean(values)), 4),
        "median": round(float(np.median(values)), 4),
        "most": round(float(np.max(values)), 4),
    }


def _range(text: str) -> tuple[float, float] | None:
    low, _, high = text.partition(":")
    return (float(low), float(high)) if high else None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", default="highway-works")
    parser.add_argument("--driver", choices=("axis", "onvif"), default="axis")
    parser.add_argument("--pan", default="-60:60", help="range in degrees, or 'all'")
    parser.add_argument("--tilt", default="-30:15", help="range in degrees, or 'all'")
    parser.add_argument("--close-ups", type=int, default=8)
    parser.add_argument("--noise", type=float, default=0.1, help="standard deviation of the pan and tilt errors in degrees")
    parser.add_argument("--drift", type=float, default=0.5, help="drift of pan in degrees per minute")
    parser.add_argument("--alive", action="store_true", help="let actors move; the comparison uses the final scene time")
    parser.add_argument("--time-scale", type=float, default=20.0, help="speed of the motors, as a multiple of the real speed")
    parser.add_argument("--views", type=int, default=20, help="number of views to compare at each zoom")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="folder in which to keep the twin")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        scenes = arguments.out or Path(temporary)
        scenes.mkdir(parents=True, exist_ok=True)

        def progress(part: str, done: int, total: int) -> None:
            if done == total and not arguments.json:
                print(f"  {part}: {total}", file=sys.stderr, flush=True)

        results, turn, device = asyncio.run(capture_twin(arguments, scenes, progress))
        results |= compare_views(arguments, device, turn, Scene(scenes / "twin"))
    print(json.dumps(results) if arguments.json else "\n".join(f"{name}: {value}" for name, value in results.items()))
    error_deg = max(results["adjusted_error_deg"]["mean"], results["views_turned_deg"]["mean"])
    return int(results["ssim_without_common_turn"]["1x"]["mean"] < MIN_SSIM or error_deg >= MAX_POSE_ERROR_DEG)


if __name__ == "__main__":
    sys.exit(main())
