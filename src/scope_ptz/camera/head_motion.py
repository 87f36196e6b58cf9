"""Compute the pose of a motorised head at any time: at rest, while moving to a pose, or while driven at a velocity."""

from __future__ import annotations

from dataclasses import dataclass, replace

from scope_ptz.camera.capabilities import Velocity
from scope_ptz.camera.motion import Head
from scope_ptz.geometry import Limits, Pose, wrap_pan_deg

_MAX_OCTAVES = 30.0  # maximum zoom change of a drive, far beyond any lens; prevents overflow if the zoom is driven for minutes


@dataclass(frozen=True, slots=True)
class _Move:
    """A move from one pose to another."""

    head: Head
    start: Pose
    end: Pose


@dataclass(frozen=True, slots=True)
class _Drive:
    """A drive that starts at a pose and velocity, accelerates to a target velocity, and starts braking after ``hold_s`` seconds."""

    start: Pose
    speed: Velocity
    target: Velocity
    hold_s: float


class HeadMotion:
    """The current command of a motorised head, and the resulting pose.

    All times are in seconds on the same clock, which the caller reads. Each command replaces the previous one.

    Args:
        head: The motors.
        limits: The limits of motion. A driven axis stops at its limit.
        pose: The initial pose of the head.
    """

    def __init__(self, head: Head, limits: Limits, pose: Pose) -> None:
        self._head, self._limits = head, limits
        # A single attribute, so that a thread that reads the pose never sees a partly updated command.
        self._current: tuple[_Move | _Drive, float] = _Move(head, pose, pose), 0.0
        self.commands = 0
        """Number of commands so far. A caller can compare it to detect that its command has been replaced."""

    def move(self, pose: Pose, now_s: float, *, speed_fraction: float = 1.0, zoom_fraction: float | None = None) -> None:
        """Start moving from the current pose to a target pose, which must be within the limits.

        Args:
            pose: The target pose.
            now_s: The current time.
            speed_fraction: Fraction of the top speeds at which the axes move.
            zoom_fraction: Fraction of the top zoom speed; None to use ``speed_fraction``.
        """
        head = self._head if speed_fraction == 1.0 else self._head.at_speed(speed_fraction)
        if zoom_fraction is not None:
            head = replace(head, zoom=self._head.at_speed(zoom_fraction).zoom)
        self._replace(_Move(head, self.pose(now_s), pose), now_s)

    def drive(self, velocity: Velocity, now_s: float, timeout_s: float) -> None:
        """Accelerate to a velocity, and brake after the timeout."""
        self._replace(_Drive(self.pose(now_s), self.velocity(now_s), velocity, timeout_s), now_s)

    def brake(self, now_s: float) -> None:
        """Decelerate to a standstill."""
        self.drive(Velocity(), now_s, 0.0)

    def stop_axes(self, now_s: float, *, pan_tilt: bool, zoom: bool) -> None:
        """Stop pan and tilt if ``pan_tilt`` is true, and zoom if ``zoom`` is true.

        The other axes keep their velocity and timeout, or their target.
        """
        command, since_s = self._current
        if isinstance(command, _Drive):
            target, remaining_s = command.target, since_s + command.hold_s - now_s
            if remaining_s > 0:
                pan_dps, tilt_dps = (0.0, 0.0) if pan_tilt else (target.pan_dps, target.tilt_dps)
                self.drive(Velocity(pan_dps, tilt_dps, 0.0 if zoom else target.zoom_rate), now_s, remaining_s)
        elif self.is_moving(now_s):
            current, end = self.pose(now_s), command.end
            aim = current if pan_tilt else end
            self._replace(_Move(command.head, current, Pose(aim.pan_deg, aim.tilt_deg, current.zoom if zoom else end.zoom)), now_s)

    def jump_to(self, pose: Pose, now_s: float) -> None:
        """Jump to a pose immediately."""
        self._replace(_Move(self._head, pose, pose), now_s)

    def pose(self, now_s: float) -> Pose:
        """Return the pose at a time, which must not be before the last command."""
        command, since_s = self._current
        time_s = now_s - since_s
        if isinstance(command, _Move):
            return command.head.at(command.start, command.end, time_s)
        pan, tilt, octaves = (distance for distance, _ in self._drive_progress(command, time_s))
        zoom = command.start.zoom * 2.0 ** min(max(octaves, -_MAX_OCTAVES), _MAX_OCTAVES)
        reached, _ = self._limits.clamp(Pose(command.start.pan_deg + pan, command.start.tilt_deg + tilt, zoom))
        return Pose(wrap_pan_deg(reached.pan_deg), reached.tilt_deg, reached.zoom) if self._limits.pan_endless else reached

    def velocity(self, now_s: float) -> Velocity:
        """Return the velocity of a driven head. It is zero during a move to a pose, so the next command starts from rest."""
        command, since_s = self._current
        if isinstance(command, _Move):
            return Velocity()
        pose = self.pose(now_s)
        pan, tilt, zoom = (speed for _, speed in self._drive_progress(command, now_s - since_s))
        limits = self._limits
        return Velocity(
            0.0
            if not limits.pan_endless and _pushes_against_limit(pan, pose.pan_deg, limits.min_pan_deg, limits.max_pan_deg)
            else pan,
            0.0 if _pushes_against_limit(tilt, pose.tilt_deg, limits.min_tilt_deg, limits.max_tilt_deg) else tilt,
            0.0 if _pushes_against_limit(zoom, pose.zoom, limits.min_zoom, limits.max_zoom) else zoom,
        )

    @property
    def end(self) -> Pose | None:
        """The target of the current move; None for a driven head."""
        command, _ = self._current
        return command.end if isinstance(command, _Move) else None

    def commanded_velocity(self, now_s: float) -> Velocity:
        """Return the commanded velocity of a driven head. It is zero after the timeout and during a move to a pose."""
        command, since_s = self._current
        return command.target if isinstance(command, _Drive) and now_s - since_s < command.hold_s else Velocity()

    def end_time_s(self) -> float:
        """Return the time at which the current command ends, including the settling time of a move to a pose."""
        command, since_s = self._current
        if isinstance(command, _Move):
            return since_s + command.head.duration_s(command.start, command.end)
        head, at_end = self._head, self._drive_progress(command, command.hold_s)
        motors = (head.pan, head.tilt, head.zoom)
        braking_s = max(motor.braking_s(speed) for motor, (_, speed) in zip(motors, at_end, strict=True))
        return since_s + command.hold_s + braking_s

    def is_moving(self, now_s: float) -> bool:
        """Return whether a command is still in progress."""
        return now_s < self.end_time_s()

    def _drive_progress(self, command: _Drive, time_s: float) -> tuple[tuple[float, float], ...]:
        """Return the distance travelled and the current speed on each axis, ``time_s`` seconds into a drive. Zoom is in octaves."""
        head, speed, target = self._head, command.speed, command.target
        return (
            head.pan.after_command(speed.pan_dps, target.pan_dps, command.hold_s, time_s),
            head.tilt.after_command(speed.tilt_dps, target.tilt_dps, command.hold_s, time_s),
            head.zoom.after_command(speed.zoom_rate, target.zoom_rate, command.hold_s, time_s),
        )

    def _replace(self, command: _Move | _Drive, now_s: float) -> None:
        self._current = command, now_s
        self.commands += 1


def _pushes_against_limit(speed: float, value: float, low: float, high: float) -> bool:
    """Return whether a motor is pushing against a limit."""
    return (speed > 0 and value >= high) or (speed < 0 and value <= low)
