"""The virtual device: motors, presets, faults, and stale commands."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from scope_ptz.camera.capabilities import Velocity
from scope_ptz.errors import CameraError, InputError, UnknownNameError
from scope_ptz.geometry import Pose
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera import device as device_module
from scope_ptz.virtual_camera.device import MAX_PRESETS, VirtualDevice
from scope_ptz.virtual_camera.faults import Faults


@dataclass
class HandClock:
    """A replacement for ``time.monotonic`` that tests advance, so that no test waits."""

    now: float = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def time(monkeypatch: pytest.MonkeyPatch) -> HandClock:
    clock = HandClock()
    monkeypatch.setattr(device_module, "monotonic", clock)
    return clock


@pytest.fixture
def device(analytic_scene: Scene, time: HandClock) -> VirtualDevice:
    return VirtualDevice(analytic_scene, width=160, height=90)


def test_a_move_takes_the_time_of_the_motors(device: VirtualDevice, time: HandClock) -> None:
    start = device.pose()
    device.move(Pose(start.pan_deg + 50, start.tilt_deg, start.zoom))
    assert device.is_moving()
    time.now += 0.4
    assert start.pan_deg < device.pose().pan_deg < start.pan_deg + 50
    time.now += 5.0
    assert device.pose().pan_deg == start.pan_deg + 50
    assert not device.is_moving()


def test_motors_can_run_faster_than_real_time(analytic_scene: Scene, time: HandClock) -> None:
    device = VirtualDevice(analytic_scene, time_scale=100.0)
    device.move(Pose(120.0, 0.0, 5.0))
    time.now += 0.05
    assert device.pose() == Pose(120.0, 0.0, 5.0)


def test_values_beyond_a_limit_are_clamped(device: VirtualDevice, time: HandClock) -> None:
    device.move(Pose(400.0, 90.0, 99.0))
    time.now += 20
    assert device.pose() == Pose(179.0, 30.0, 5.0)


def test_a_drive_ends_at_its_timeout_or_with_a_stop(device: VirtualDevice, time: HandClock) -> None:
    assert device.drive(Velocity(pan_dps=20.0), timeout_s=1.0)
    time.now += 10
    ended = device.pose()
    assert 19 < ended.pan_deg - device.home.pan_deg < 21
    device.drive(Velocity(pan_dps=-20.0))
    time.now += 4
    device.stop()
    time.now += 1
    stopped = device.pose()
    time.now += 10
    assert device.pose() == stopped
    assert not device.is_moving()


def test_a_continuous_move_sent_before_the_last_stop_is_dropped(device: VirtualDevice, time: HandClock) -> None:
    device.drive(Velocity(pan_dps=20.0), sent_s=1000.0)
    device.stop(sent_s=1001.0)
    time.now += 1
    assert not device.drive(Velocity(pan_dps=20.0), sent_s=1000.5)
    assert not device.is_moving()
    assert device.drive(Velocity(pan_dps=20.0), sent_s=1001.5)
    assert device.is_moving()


def test_presets_keep_their_numbers(device: VirtualDevice) -> None:
    before = device.presets()
    assert before
    assert {preset.name for preset in before} <= {p.name for p in device.scene.file.presets if p.viewpoint == device.viewpoint}
    saved = device.save_preset("yard gate")
    assert device.preset(saved.number) == device.find_preset("yard gate") == saved
    assert device.save_preset("yard gate").number == saved.number
    device.remove_preset(before[0].number)
    assert device.save_preset("new").number == before[0].number
    with pytest.raises(UnknownNameError):
        device.find_preset(before[0].name)
    with pytest.raises(UnknownNameError):
        device.remove_preset(200)


def test_wrong_and_too_many_presets_are_refused(device: VirtualDevice) -> None:
    with pytest.raises(InputError, match="preset name"):
        device.save_preset("")
    with pytest.raises(CameraError, match="from 1 to 256, not 257"):
        device.save_preset("out of range", number=MAX_PRESETS + 1)
    for number in range(1, MAX_PRESETS + 1):
        device.save_preset(f"spot {number}", number=number)
    with pytest.raises(CameraError, match="All 256 presets"):
        device.save_preset("one more")


def test_a_stuck_axis_does_not_move_and_the_others_do(device: VirtualDevice, time: HandClock) -> None:
    device.faults = Faults(stuck=frozenset({"tilt"}))
    start = device.pose()
    device.move(Pose(30.0, 20.0, 2.0))
    time.now += 10
    assert device.pose() == Pose(30.0, start.tilt_deg, 2.0)
    device.drive(Velocity(pan_dps=10.0, tilt_dps=10.0), timeout_s=1.0)
    time.now += 10
    assert device.pose().tilt_deg == start.tilt_deg


def test_drift_turns_the_picture_and_not_the_encoders(device: VirtualDevice, time: HandClock) -> None:
    straight, pose = device.expose(), device.pose()
    device.faults = Faults(drift_dps=2.0)
    time.now += 3.0
    drifted = device.expose()
    assert device.pose() == drifted.pose == pose
    assert np.any(drifted.image != straight.image)
    device.faults = Faults()
    device.move(Pose(pose.pan_deg + 6.0, pose.tilt_deg, pose.zoom))
    time.now += 10
    assert np.array_equal(device.expose().image, drifted.image)


def test_faults_of_the_picture(device: VirtualDevice, time: HandClock) -> None:
    good = device.expose()
    device.faults = Faults(picture="black")
    assert not device.expose().image.any()
    device.faults = Faults(picture="size")
    assert device.expose().image.shape == (45, 80, 3)
    device.faults = Faults(picture="frozen")
    frozen = device.expose()
    device.move(Pose(100.0, 0.0, 1.0))
    time.now += 10
    assert device.expose() is frozen
    device.faults = Faults()
    assert np.any(device.expose().image != good.image)


def test_the_move_status_can_be_wrong_or_missing(device: VirtualDevice) -> None:
    device.move(Pose(100.0, 0.0, 1.0))
    assert device.reported_moving() is True
    device.faults = Faults(move_status="lying")
    assert device.reported_moving() is False
    assert device.is_moving()
    device.faults = Faults(move_status="missing")
    assert device.reported_moving() is None


def test_a_reboot_returns_to_the_home_pose(device: VirtualDevice, time: HandClock) -> None:
    device.move(Pose(100.0, 0.0, 1.0))
    time.now += 10
    device.reboot()
    assert device.pose() == device.home


def test_a_viewpoint_can_be_read_in_advance(device: VirtualDevice) -> None:
    reading = device.prefetch()
    assert reading.wait(30)
    assert device.expose().image.shape == (90, 160, 3)
