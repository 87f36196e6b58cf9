"""Calibration of simulated cameras in a real scene: right ones, inverted ones, and one with a wrong zoom table."""

from __future__ import annotations

from dataclasses import replace

import pytest

from scope_ptz.camera.base import Arrival, CameraInfo
from scope_ptz.camera.measurement.calibration import calibrate
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.factory.scenes import open_scene
from scope_ptz.geometry import Optics, Pose
from scope_ptz.simulator.pack import Scene

pytestmark = [pytest.mark.anyio, pytest.mark.full]

WRONG_TABLE = Optics(((1.0, 71.0), (5.0, 20.0)))


@pytest.fixture(scope="module")
def scene() -> Scene:
    return open_scene("highway-works")


class WronglyBuiltCamera(SimulatedCamera):
    """A camera whose motors turn by other angles than it states, or whose zoom table is wrong."""

    def __init__(self, scene: Scene, *, pan: float = 1.0, tilt: float = 1.0, optics: Optics | None = None) -> None:
        super().__init__(scene, width=960, height=540)
        self._pan, self._tilt, self._optics = pan, tilt, optics
        self._stated = super().info

    @property
    def info(self) -> CameraInfo:
        own = super().info
        optics = getattr(self, "_optics", None)
        return own if optics is None else replace(own, optics=optics)

    async def move(self, pose: Pose) -> Arrival:
        stated, clamped = self.info.limits.clamp(pose)
        self.stated = stated
        await super().move(replace(stated, pan_deg=self._pan * stated.pan_deg, tilt_deg=self._tilt * stated.tilt_deg))
        return Arrival(stated, clamped)

    async def pose(self) -> Pose:
        there = await super().pose()
        return replace(there, pan_deg=there.pan_deg / self._pan, tilt_deg=there.tilt_deg / self._tilt)


async def test_right_camera_is_confirmed(scene: Scene) -> None:
    camera = SimulatedCamera(scene, width=960, height=540)
    before = await camera.pose()
    found = await calibrate(camera)
    assert found.contradictions == ()
    assert found.pan.scale == pytest.approx(1.0, abs=0.005)
    assert found.tilt.scale == pytest.approx(1.0, abs=0.005)
    assert abs(found.tilt_offset_deg) < 0.5
    for each in found.fields:
        assert each.measured_deg == pytest.approx(camera.info.optics.hfov_deg(each.zoom), rel=0.01)
    assert [each.zoom for each in found.fields] == sorted(each.zoom for each in found.fields)
    assert await camera.pose() == before


@pytest.mark.parametrize(("pan", "tilt", "axis"), [(-1.0, 1.0, "pan"), (1.0, -1.0, "tilt")])
async def test_inverted_axis_is_proven(scene: Scene, pan: float, tilt: float, axis: str) -> None:
    found = await calibrate(WronglyBuiltCamera(scene, pan=pan, tilt=tilt), zooms=2)
    assert (found.pan.inverted, found.tilt.inverted) == (pan < 0, tilt < 0)
    assert any(f"{axis.capitalize()} is inverted" in text for text in found.contradictions)
    assert found.pan.scale == pytest.approx(pan, abs=0.01)
    assert found.tilt.scale == pytest.approx(tilt, abs=0.01)


async def test_wrong_scale_is_measured(scene: Scene) -> None:
    found = await calibrate(WronglyBuiltCamera(scene, pan=0.7), zooms=2)
    assert found.pan.scale == pytest.approx(0.7, abs=0.01)
    assert any("0.7" in text for text in found.contradictions)


async def test_wrong_zoom_table_is_found_and_replaced(scene: Scene) -> None:
    camera = WronglyBuiltCamera(scene, optics=WRONG_TABLE)
    found = await calibrate(camera)
    true = SimulatedCamera(scene).info.optics
    assert any("zoom table is wrong" in text for text in found.contradictions)
    for each in found.fields:
        assert each.measured_deg == pytest.approx(true.hfov_deg(each.zoom), rel=0.015)
        assert each.stated_deg == pytest.approx(WRONG_TABLE.hfov_deg(each.zoom))
    assumed = await calibrate(camera, zooms=2, assumed=("field of view",))
    assert assumed.contradictions == ()
