"""Simulation-only perception: the ground truth that a virtual camera serves, read through both drivers."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace

import pytest

from scope_ptz.builtin_names import SERVED_TRUTH
from scope_ptz.camera.axis.camera import AxisCamera
from scope_ptz.camera.base import Camera
from scope_ptz.camera.network.address import DeviceAddress
from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.network.http import DeviceHttp
from scope_ptz.camera.network.settling import SettlingCriteria
from scope_ptz.camera.onvif.camera import OnvifCamera
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.errors import InputError, PerceptionError
from scope_ptz.geometry import Pose
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.perception.ground_truth.served import ServedTruth, ServedTruthPerception
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.pack import Scene
from scope_ptz.tools.sweep import sweep
from scope_ptz.virtual_camera.accounts import Account, Role
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.server import ServedCamera, serve
from scope_ptz.virtual_camera.onvif.app import OnvifApp

pytestmark = pytest.mark.anyio

OPERATOR = Credentials("operator", "on-loopback")
QUICK = SettlingCriteria(poll_s=0.005, start_s=0.15, picture_interval_s=0.0)
WIDTH, HEIGHT = 320, 180
POSE = Pose(2.2, -8.7, 1.1)


@asynccontextmanager
async def served(scene: Scene, *, truth: bool = True) -> AsyncIterator[ServedCamera]:
    device = VirtualDevice(
        scene, accounts=[Account(OPERATOR.user, OPERATOR.password, Role.OPERATOR)], clock=SceneClock(3.0),
        width=WIDTH, height=HEIGHT, time_scale=200,
    )  # fmt: skip
    async with serve([device], truth=truth, onvif=lambda each: OnvifApp(each, rtsp_port=554)) as (camera,):
        yield camera


def http(camera: ServedCamera) -> DeviceHttp:
    return DeviceHttp(DeviceAddress("127.0.0.1", camera.port), OPERATOR)


@asynccontextmanager
async def driver(camera: ServedCamera, name: str = "axis") -> AsyncIterator[Camera]:
    if name == "axis":
        opened: Camera = await AxisCamera.open(http(camera), OPERATOR, width=WIDTH, height=HEIGHT, settling=QUICK)
    else:
        opened = await OnvifCamera.open(http(camera), OPERATOR, stream="snapshot", settling=QUICK)
    try:
        yield opened
    finally:
        await opened.close()


@asynccontextmanager
async def perception(camera: ServedCamera, opened: Camera, scene: Scene) -> AsyncIterator[ServedTruthPerception]:
    backend = ServedTruthPerception(ServedTruth(http(camera), opened.clock), {scene.name: scene}.__getitem__)
    try:
        yield backend
    finally:
        await backend.close()


@pytest.mark.parametrize("name", ["axis", pytest.param("onvif", marks=pytest.mark.full)])
async def test_answers_equal_those_of_ground_truth_in_process(analytic_scene: Scene, name: str) -> None:
    own = SimulatedCamera(analytic_scene, clock=SceneClock(3.0), width=WIDTH, height=HEIGHT)
    with own.clock.hold():
        await own.move(POSE)
        frame, panorama = await own.frame(), await sweep(own)
    expected = GroundTruthPerception({analytic_scene.name: analytic_scene}.__getitem__)
    async with (
        served(analytic_scene) as camera,
        driver(camera, name) as opened,
        perception(camera, opened, analytic_scene) as backend,
    ):
        await opened.move(POSE)
        taken, whole = await opened.frame(), await sweep(opened)
        assert taken.origin is None
        assert whole.origin is None
        for one, two in ((frame, taken), (panorama, whole)):
            boxes, found = await expected.detect(one, "ball"), await backend.detect(two, "ball")
            assert found.source == SERVED_TRUTH
            assert len(found.boxes) == len(boxes.boxes) > 0
            for box, other in zip(boxes.boxes, found.boxes, strict=True):
                assert other.centre == pytest.approx(box.centre, abs=0.002)
            assert (await backend.query(two, "how many balls?")).text == (await expected.query(one, "how many balls?")).text
            assert (await backend.caption(two)).text == (await expected.caption(one)).text
            assert len((await backend.point(two, "ball")).points) == len(boxes.boxes)


async def test_the_truth_is_that_of_the_picture_and_not_of_the_pose_of_the_driver(analytic_scene: Scene) -> None:
    async with served(analytic_scene) as camera, driver(camera) as opened, perception(camera, opened, analytic_scene) as backend:
        await opened.move(POSE)
        frame = await opened.frame()
        believed = replace(frame, hfov_deg=50.0, projection=replace(frame.projection, hfov_deg=50.0))  # type: ignore[type-var]
        assert await backend.query(believed, "how many balls?") is not None
        one, two = await backend.detect(frame, "ball"), await backend.detect(believed, "ball")
        assert [box.centre for box in one.boxes] == [box.centre for box in two.boxes]


async def test_a_frame_that_was_not_served_has_no_truth(analytic_scene: Scene) -> None:
    async with served(analytic_scene) as camera, driver(camera) as opened, perception(camera, opened, analytic_scene) as backend:
        frame = await opened.frame()
        with pytest.raises(PerceptionError, match="has not stored a frame of that time"):
            await backend.detect(replace(frame, time_s=frame.time_s - 60), "ball")
        elsewhere = Pose(frame.pose.pan_deg + 20, frame.pose.tilt_deg, frame.pose.zoom)
        with pytest.raises(PerceptionError, match="not the pose that the driver reports"):
            await backend.detect(replace(frame, pose=elsewhere), "ball")


async def test_a_camera_without_truth_is_refused(analytic_scene: Scene) -> None:
    async with (
        served(analytic_scene, truth=False) as camera,
        driver(camera) as opened,
        perception(camera, opened, analytic_scene) as backend,
    ):
        with pytest.raises(PerceptionError, match="scope camera serve --truth"):
            await backend.caption(await opened.frame())


@pytest.mark.parametrize("host", ["10.0.0.7", "camera.example", "127.0.0.1.example.org", "[2001:db8::1]"])
async def test_only_cameras_on_this_machine_are_asked(host: str) -> None:
    far = DeviceHttp(DeviceAddress(host, 80), OPERATOR)
    try:
        with pytest.raises(InputError, match="virtual cameras on this machine"):
            ServedTruth(far, SceneClock())
    finally:
        await far.close()


@pytest.mark.parametrize(
    ("host", "own"), [("127.0.0.1", True), ("127.8.8.8", True), ("[::1]", True), ("localhost", True), ("192.0.2.7", False)]
)
def test_loopback_addresses(host: str, own: bool) -> None:
    assert DeviceAddress(host, 80).is_loopback is own
