"""The simulated camera fulfils the contract, moves like a motorised head, and shows the scene."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import anyio
import numpy as np
import pytest

from scope_ptz.camera.base import Arrival, Camera, Frame
from scope_ptz.camera.conformance import CameraConformance
from scope_ptz.camera.simulated import VIEWPOINT_SWITCH_S, SimulatedCamera
from scope_ptz.errors import UnknownNameError
from scope_ptz.geometry import Pose
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.pack import Scene
from tests.support.synthetic_pack import HEIGHT, WAYPOINTS, WIDTH

pytestmark = pytest.mark.anyio


class TestConformance(CameraConformance):
    same_picture_mean_difference = 0.0

    @pytest.fixture(autouse=True)
    def _scene(self, analytic_scene: Scene) -> None:
        self.scene = analytic_scene

    @asynccontextmanager
    async def camera(self) -> AsyncIterator[Camera]:
        camera = SimulatedCamera(self.scene, width=160, height=90)
        yield camera
        await camera.close()


class InvertedPan(SimulatedCamera):
    """A camera with an inverted pan: it moves left instead of right, and reports a move to the right."""

    async def move(self, pose: Pose) -> Arrival:
        arrival = await super().move(Pose(-pose.pan_deg, pose.tilt_deg, pose.zoom))
        return Arrival(Pose(-arrival.pose.pan_deg, arrival.pose.tilt_deg, arrival.pose.zoom), arrival.clamped)


async def test_conformance_finds_an_inverted_pan(analytic_scene: Scene) -> None:
    class Faulty(CameraConformance):
        @asynccontextmanager
        async def camera(self) -> AsyncIterator[Camera]:
            yield InvertedPan(analytic_scene, width=32, height=18)

    findings = await Faulty().findings()
    assert "test_move_arrives_and_stays" in findings
    assert "test_info_is_consistent" not in findings


def _camera(scene: Scene, *, realtime: bool = False, viewpoint: str | None = None) -> SimulatedCamera:
    return SimulatedCamera(scene, viewpoint=viewpoint, clock=SceneClock(realtime=realtime), width=WIDTH, height=HEIGHT)


async def test_starts_at_home(analytic_scene: Scene) -> None:
    camera = _camera(analytic_scene)
    assert await camera.pose() == Pose(0.0, -8.0, 1.0)
    assert camera.viewpoint == "mast"


async def test_presets_can_change_the_viewpoint_and_home_restores_it(analytic_scene: Scene) -> None:
    camera = _camera(analytic_scene)
    before = await camera.frame()
    arrival = await camera.go_to_preset("from-the-roof")
    assert arrival.pose == Pose(10.0, -20.0, 1.5)
    there = await camera.frame()
    assert there.origin is not None
    assert there.origin.viewpoint == "roof"
    assert camera.clock.now_s() == pytest.approx(VIEWPOINT_SWITCH_S)
    await camera.go_home()
    assert camera.viewpoint == "mast"
    with camera.hold_time():
        assert np.abs((await camera.frame()).image.astype(int) - before.image).mean() < 2.0  # the roller has come in meanwhile


async def test_moves_never_change_the_viewpoint(analytic_scene: Scene) -> None:
    camera = _camera(analytic_scene, viewpoint="roof")
    for pan in (-170.0, 0.0, 170.0):
        await camera.move(Pose(pan, -10.0, 1.0))
        assert camera.viewpoint == "roof"


async def test_a_camera_at_another_viewpoint_has_its_home_there(analytic_scene: Scene) -> None:
    camera = _camera(analytic_scene, viewpoint="roof")
    await camera.move(Pose(100.0, 0.0, 2.0))
    assert (await camera.go_home()).pose == Pose(10.0, -20.0, 1.5)
    assert camera.viewpoint == "roof"


async def test_unknown_viewpoint(analytic_scene: Scene) -> None:
    with pytest.raises(UnknownNameError, match=r"viewpoint 'cellar'.*mast, roof"):
        _camera(analytic_scene, viewpoint="cellar")


async def test_a_move_takes_scene_time(analytic_scene: Scene) -> None:
    camera = _camera(analytic_scene)
    await camera.move(Pose(100.0, -8.0, 1.0))
    assert 1.0 < camera.clock.now_s() < 1.6
    at = camera.clock.now_s()
    await camera.move(Pose(100.0, -8.0, 1.0))
    assert camera.clock.now_s() == at


async def test_relative_move_beyond_the_stop_is_not_turned_the_long_way(analytic_scene: Scene) -> None:
    camera = _camera(analytic_scene)
    await camera.move(Pose(170.0, 0.0, 1.0))
    arrival = await camera.move((await camera.pose()).turned(pan_deg=20.0))
    assert arrival.pose.pan_deg == 179.0
    assert arrival.clamped == ("pan",)


async def test_a_frame_taken_during_a_move_shows_an_intermediate_pose(analytic_scene: Scene) -> None:
    camera = _camera(analytic_scene)
    frames: list[Frame] = []

    async def watch() -> None:
        for _ in range(6):
            frames.append(await camera.frame())

    async with anyio.create_task_group() as group:
        group.start_soon(watch)
        await camera.move(Pose(170.0, -8.0, 1.0))
    pans = [f.pose.pan_deg for f in frames]
    assert pans == sorted(pans)
    assert any(0.0 < pan < 170.0 for pan in pans)


async def test_real_time_moves_take_real_time(analytic_scene: Scene) -> None:
    camera = _camera(analytic_scene, realtime=True)
    start = anyio.current_time()
    await camera.move(Pose(20.0, -8.0, 1.0))
    took_s = anyio.current_time() - start
    assert took_s > 0.4
    assert camera.clock.elapsed_s() > took_s - 0.1, "scene time follows real time"


async def test_a_cancelled_move_stops_where_it_is(analytic_scene: Scene) -> None:
    camera = _camera(analytic_scene, realtime=True)
    with anyio.move_on_after(0.3):
        await camera.move(Pose(170.0, -8.0, 1.0))
    stopped = await camera.pose()
    assert 0.0 < stopped.pan_deg < 100.0
    await anyio.sleep(0.1)
    assert await camera.pose() == stopped


async def test_holding_time_stops_the_scene_but_not_the_camera(analytic_scene: Scene) -> None:
    camera = _camera(analytic_scene)
    await camera.clock.sleep(WAYPOINTS[0][0] + 1.0)
    now_s = camera.clock.now_s()
    with camera.hold_time():
        arrival = await camera.move(Pose(90.0, 0.0, 2.0))
        frame = await camera.frame()
    assert arrival.pose == Pose(90.0, 0.0, 2.0)
    assert frame.time_s == camera.clock.now_s() == now_s


async def test_same_pose_and_time_give_the_same_bytes_regardless_of_history(analytic_folder: object, analytic_scene: Scene) -> None:
    fresh = Scene(analytic_scene.folder)
    straight, wandering = _camera(fresh), _camera(analytic_scene)
    for pan, zoom in ((-120.0, 5.0), (18.0, 4.0), (179.0, 1.0)):
        await wandering.move(Pose(pan, -30.0, zoom))
        await wandering.frame()
    for camera in (straight, wandering):
        await camera.move(Pose(-10.0, -3.0, 2.5))
        await camera.clock.sleep(20.0 - camera.clock.now_s())
    assert (await straight.frame()).image.tobytes() == (await wandering.frame()).image.tobytes()


async def test_many_cameras_share_a_scene(analytic_scene: Scene) -> None:
    scene = Scene(analytic_scene.folder)
    cameras = [_camera(scene) for _ in range(4)]
    images: list[bytes] = []

    async def look(camera: SimulatedCamera) -> None:
        await camera.move(Pose(-16.0, 1.0, 4.5))
        images.append((await camera.frame()).image.tobytes())

    async with anyio.create_task_group() as group:
        for camera in cameras:
            group.start_soon(look, camera)
    assert len(set(images)) == 1
