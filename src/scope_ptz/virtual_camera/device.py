"""The virtual device behind all protocols: motors, presets, accounts, faults, and the image at the current pose."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from time import monotonic

import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.capabilities import Velocity, check_preset_name
from scope_ptz.camera.head_motion import HeadMotion
from scope_ptz.camera.motion import AXIS_M5075_G_HEAD, Head
from scope_ptz.camera.scene_presets import camera_home_preset, preset_pose
from scope_ptz.errors import CameraError, InputError, UnknownNameError
from scope_ptz.geometry import Perspective, Pose
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.prefetch import Prefetch
from scope_ptz.simulator.views import picture
from scope_ptz.virtual_camera.accounts import Account, Accounts
from scope_ptz.virtual_camera.faults import Faults
from scope_ptz.virtual_camera.lens import VirtualLens

REBOOT_S = 10.0
"""Default time in seconds for which a rebooting camera is off the network."""

REBOOT_DELAY_S = 0.3
"""Delay in seconds before a rebooting camera goes off the network, so that the reboot request still gets a reply."""

MAX_PRESETS = 256
"""Maximum number of presets, the same as on the AXIS M5075-G."""

_POSE_FIELDS = {"pan": "pan_deg", "tilt": "tilt_deg", "zoom": "zoom"}


@dataclass(frozen=True, slots=True)
class DevicePreset:
    """A stored pose, which clients address by name, by number (VAPIX), or by token (the number as text, ONVIF)."""

    number: int
    name: str
    pose: Pose


@dataclass(frozen=True, slots=True)
class Exposure:
    """A captured image, with its pose and times.

    Attributes:
        image: Read-only array of shape ``(H, W, 3)``, uint8, RGB.
        pose: The pose that the encoders reported at the time of exposure.
        time_s: Scene time of the exposure in seconds.
        taken_s: ``time.monotonic`` time of the exposure in seconds.
    """

    image: NDArray[np.uint8]
    pose: Pose
    time_s: float
    taken_s: float


class VirtualDevice:
    """A pan-tilt-zoom camera at a viewpoint of a scene.

    Commands must come from a single thread. ``expose`` may run in another thread at the same time.

    Args:
        scene: The scene.
        viewpoint: The camera's viewpoint; by default, that of the scene's home preset.
        name: Device name, which clients show to their users; by default, the names of the scene and the viewpoint.
        accounts: The accounts that may use the camera. If there are none, it requires no password.
        clock: The scene clock, which moves the actors. It can be paused independently of the motors.
        head: The motors; by default, those of the AXIS M5075-G.
        width: Width of a full-size picture in pixels.
        height: Height of a full-size picture in pixels.
        time_scale: Speed of the motors, as a multiple of the real speed.

    Attributes:
        faults: The current faults; assign a new ``Faults`` to change them.
        observers: Functions that are called with each new exposure, in the thread that captures it.
        lens: The camera's focus and iris.
    """

    def __init__(
        self,
        scene: Scene,
        *,
        viewpoint: str | None = None,
        name: str = "",
        accounts: Iterable[Account] = (),
        clock: SceneClock | None = None,
        head: Head = AXIS_M5075_G_HEAD,
        width: int = 1280,
        height: int = 720,
        time_scale: float = 1.0,
    ) -> None:
        start = camera_home_preset(scene.file, viewpoint)
        self.scene, self.viewpoint = scene, start.viewpoint
        self.name = name or f"{scene.name} {start.viewpoint}"
        self.accounts = Accounts(accounts)
        self.clock = clock or SceneClock(scene.file.start_s, realtime=True)
        self.limits, self.optics, self.head = scene.file.limits, scene.file.optics, head
        self.width, self.height, self.time_scale = width, height, time_scale
        self.home = preset_pose(start)
        local = [preset for preset in scene.file.presets if preset.viewpoint == self.viewpoint]
        self._presets = {k: DevicePreset(k, preset.name, preset_pose(preset)) for k, preset in enumerate(local, start=1)}
        self._motion = HeadMotion(head, self.limits, self.home)
        self._started_s = monotonic()
        self.lens = VirtualLens(self.now_s)
        self._last_stop_sent_s = -np.inf
        self._faults, self._faults_since_s = Faults(), 0.0
        self._frozen_exposure: Exposure | None = None
        self._reboot_s = (-np.inf, -np.inf)  # ``time.monotonic`` times at which the last reboot started and ended
        self.observers: list[Callable[[Exposure], None]] = []

    @property
    def faults(self) -> Faults:
        return self._faults

    @faults.setter
    def faults(self, faults: Faults) -> None:
        self._faults, self._faults_since_s, self._frozen_exposure = faults, self.now_s(), None

    @property
    def down(self) -> bool:
        """Whether the camera is off the network because of the fault ``down`` or a reboot."""
        start_s, end_s = self._reboot_s
        return self._faults.down or start_s <= monotonic() < end_s

    def now_s(self) -> float:
        """Return the motor time in seconds, which runs ``time_scale`` times as fast as the wall clock."""
        return (monotonic() - self._started_s) * self.time_scale

    def pose(self) -> Pose:
        """Return the pose that the encoders report."""
        return self._motion.pose(self.now_s())

    def is_moving(self) -> bool:
        """Return whether a motor is moving or the image has not settled yet."""
        return self._motion.is_moving(self.now_s())

    def reported_moving(self) -> bool | None:
        """Return the move status that is reported to clients; None if the device does not report one."""
        status = self._faults.move_status
        return None if status == "missing" else (self.is_moving() and status != "lying")

    @property
    def destination(self) -> Pose:
        """The target of the last move; the current pose if the last command was a drive."""
        return self._motion.end or self.pose()

    def move(self, pose: Pose, *, speed_fraction: float = 1.0, zoom_fraction: float | None = None) -> None:
        """Start a move to a pose. Values beyond a limit are clamped, and axes with the fault ``stuck`` do not move.

        Args:
            pose: The target.
            speed_fraction: Speed as a fraction of each axis's top speed.
            zoom_fraction: Zoom speed as a fraction of its top speed; by default, ``speed_fraction``.
        """
        clamped, _ = self.limits.clamp(pose)
        current = self.pose()
        stuck = {_POSE_FIELDS[axis]: getattr(current, _POSE_FIELDS[axis]) for axis in self._faults.stuck}
        self._motion.move(replace(clamped, **stuck), self.now_s(), speed_fraction=speed_fraction, zoom_fraction=zoom_fraction)

    def drive(self, velocity: Velocity, *, timeout_s: float | None = None, sent_s: float | None = None) -> bool:
        """Move continuously. A command that was sent before the last ``stop`` but arrives after it is dropped.

        Args:
            velocity: The velocities, which are capped at the top speed of each axis.
            timeout_s: Seconds of motor time after which the device stops on its own; None for never.
            sent_s: The time at which the client sent the command, in Unix seconds; None if unknown.

        Returns:
            False if the command was dropped.
        """
        if sent_s is not None and sent_s < self._last_stop_sent_s:
            return False
        stuck = self._faults.stuck
        unblocked = Velocity(
            0.0 if "pan" in stuck else velocity.pan_dps,
            0.0 if "tilt" in stuck else velocity.tilt_dps,
            0.0 if "zoom" in stuck else velocity.zoom_rate,
        )
        # Without a timeout, the motors run until the next command or the end of their range. A year stands for "never".
        self._motion.drive(unblocked, self.now_s(), 3.2e7 if timeout_s is None else timeout_s)
        return True

    @property
    def velocity(self) -> Velocity:
        """The current velocity of a drive; zero during a move to a pose."""
        return self._motion.velocity(self.now_s())

    @property
    def commanded_velocity(self) -> Velocity:
        """The velocity requested by the last ``drive``; zero after its timeout and during a move to a pose."""
        return self._motion.commanded_velocity(self.now_s())

    def stop(self, *, pan_tilt: bool = True, zoom: bool = True, sent_s: float | None = None) -> None:
        """Stop pan and tilt, zoom, or both. The other axes keep moving.

        Args:
            pan_tilt: Whether to stop pan and tilt.
            zoom: Whether to stop zoom.
            sent_s: The time at which the client sent the command, in Unix seconds; None if unknown.
        """
        if sent_s is not None:
            self._last_stop_sent_s = max(self._last_stop_sent_s, sent_s)
        now_s = self.now_s()
        if not (pan_tilt and zoom):
            self._motion.stop_axes(now_s, pan_tilt=pan_tilt, zoom=zoom)
            return
        if self._motion.velocity(now_s) == Velocity():
            self._motion.jump_to(self._motion.pose(now_s), now_s)
        else:
            self._motion.brake(now_s)

    def reboot(self, down_s: float = 0.0, *, after_s: float = 0.0) -> None:
        """Simulate a reboot. The camera returns to its home position, keeps its presets, and sets focus and iris to automatic.

        Stop commands from before the reboot no longer cause ``drive`` commands to be dropped.

        Args:
            down_s: Seconds for which the camera is off the network.
            after_s: Seconds until the camera goes off the network, so that the client that requested the reboot still gets a reply.
        """
        start_s = monotonic() + after_s
        self._reboot_s = (start_s, start_s + down_s)
        self._motion.jump_to(self.home, self.now_s())
        self.lens = VirtualLens(self.now_s)
        self._last_stop_sent_s = -np.inf

    def presets(self) -> list[DevicePreset]:
        """Return the presets, sorted by number."""
        return [self._presets[number] for number in sorted(self._presets)]

    def find_preset(self, name: str) -> DevicePreset:
        """Return a preset by name.

        Raises:
            UnknownNameError: There is no such preset.
        """
        preset = next((preset for preset in self._presets.values() if preset.name == name), None)
        if preset is None:
            raise UnknownNameError("preset", name, [preset.name for preset in self._presets.values()])
        return preset

    def preset(self, number: int) -> DevicePreset:
        """Return a preset by number.

        Raises:
            UnknownNameError: There is no such preset.
        """
        if number not in self._presets:
            raise UnknownNameError("preset number", str(number), map(str, self._presets))
        return self._presets[number]

    def save_preset(self, name: str, *, number: int | None = None) -> DevicePreset:
        """Store the current pose as a preset. An existing preset with the same number is replaced.

        Args:
            name: The name.
            number: The number; by default, that of the existing preset with this name, or else the first free number.

        Raises:
            InputError: The name is empty or too long, or contains unprintable characters.
            CameraError: No number is free, or the number is out of range.
        """
        check_preset_name(name)
        if number is None:
            with_name = (preset.number for preset in self._presets.values() if preset.name == name)
            unused = (k for k in range(1, MAX_PRESETS + 1) if k not in self._presets)
            number = next(with_name, None) or next(unused, None)
        if number is None:
            raise CameraError(f"All {MAX_PRESETS} presets are in use. Remove one first.")
        if not 1 <= number <= MAX_PRESETS:
            raise CameraError(f"The number of a preset is from 1 to {MAX_PRESETS}, not {number}.")
        self._presets[number] = DevicePreset(number, name, self.pose())
        return self._presets[number]

    def rename_preset(self, number: int, name: str) -> None:
        """Rename a preset.

        Raises:
            UnknownNameError: There is no such preset.
            InputError: The name is empty, too long or already in use, or contains unprintable characters.
        """
        check_preset_name(name)
        if any(preset.name == name and preset.number != number for preset in self._presets.values()):
            raise InputError(f"A preset named '{name}' already exists.")
        self._presets[number] = replace(self.preset(number), name=name)

    def remove_preset(self, number: int) -> None:
        """Remove a preset.

        Raises:
            UnknownNameError: There is no such preset.
        """
        del self._presets[self.preset(number).number]

    def set_home(self) -> None:
        """Set the home position to the current pose."""
        self.home = self.pose()

    def prefetch(self) -> Prefetch:
        """Start reading the viewpoint's files in the background, so that later exposures do not have to wait for them."""
        return Prefetch(self.scene.viewpoint(self.viewpoint), self.width, self.optics, self.limits)

    def expose(self, width: int | None = None, height: int | None = None) -> Exposure:
        """Capture the image at the current pose. This blocks until the image has been rendered.

        The horizontal field of view depends only on the zoom, not on the image size.

        Args:
            width: Width of the image in pixels; by default, the full size.
            height: Height of the image in pixels; by default, the full size.
        """
        faults = self._faults
        if faults.picture == "frozen" and self._frozen_exposure is not None:
            return self._frozen_exposure
        width, height = width or self.width, height or self.height
        if faults.picture == "size":
            width, height = width // 2, height // 2
        pose, time_s, taken_s = self.pose(), self.clock.now_s(), monotonic()
        if faults.picture == "black":
            image = np.zeros((height, width, 3), np.uint8)
        else:
            drift_deg = faults.drift_dps * (self.now_s() - self._faults_since_s)
            view = Perspective(pose.pan_deg + drift_deg, pose.tilt_deg, self.optics.hfov_deg(pose.zoom), width, height)
            image = self.lens.apply(picture(self.scene, self.viewpoint, view, time_s), pose.zoom)
        image.flags.writeable = False
        exposure = Exposure(image, pose, time_s, taken_s)
        for observe in self.observers:
            observe(exposure)
        if faults.picture == "frozen":
            self._frozen_exposure = exposure
        return exposure
