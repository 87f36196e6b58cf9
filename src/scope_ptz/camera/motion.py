"""Motors of a pan-tilt-zoom head, which accelerate, run at constant speed, and brake."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from scope_ptz.camera.capabilities import Velocity
from scope_ptz.geometry import Pose


@dataclass(frozen=True, slots=True)
class Motor:
    """A motor with a top speed in units/s and an acceleration in units/s².

    The units are degrees for pan and tilt, and octaves (doublings of magnification) for zoom.
    """

    speed: float
    acceleration: float

    def duration_s(self, distance: float) -> float:
        """Return the time in seconds to move a distance from rest to rest."""
        d = abs(distance)
        if d < self.speed**2 / self.acceleration:
            return 2 * math.sqrt(d / self.acceleration)
        return d / self.speed + self.speed / self.acceleration

    def distance_after(self, distance: float, time_s: float) -> float:
        """Return the signed distance covered ``time_s`` after the start of a move by ``distance``."""
        d, total = abs(distance), self.duration_s(distance)
        t = min(max(time_s, 0.0), total)
        if t >= total:
            return distance
        ramp = min(self.speed / self.acceleration, total / 2)
        if t <= ramp:
            covered = self.acceleration * t**2 / 2
        elif t >= total - ramp:
            covered = d - self.acceleration * (total - t) ** 2 / 2
        else:
            covered = self.acceleration * ramp**2 / 2 + self.speed * (t - ramp)
        return math.copysign(covered, distance)

    def after_command(self, speed: float, target_speed: float, hold_s: float, time_s: float) -> tuple[float, float]:
        """Return the distance and the speed ``time_s`` after a velocity command.

        Args:
            speed: The speed when the command arrives.
            target_speed: The commanded speed; capped at the motor's top speed.
            hold_s: Seconds for which the command lasts; then the motor brakes.
            time_s: Seconds since the command.
        """
        target = min(max(target_speed, -self.speed), self.speed)
        distance, speed = self._ramp(speed, target, min(time_s, hold_s))
        if time_s > hold_s:
            braking, speed = self._ramp(speed, 0.0, time_s - hold_s)
            distance += braking
        return distance, speed

    def braking_s(self, speed: float) -> float:
        """Return the time in seconds to brake to a standstill."""
        return abs(speed) / self.acceleration

    def _ramp(self, speed: float, target: float, time_s: float) -> tuple[float, float]:
        """Return the distance and the speed ``time_s`` after starting to accelerate to a target speed, which is then held."""
        ramp_s = abs(target - speed) / self.acceleration
        if time_s < ramp_s:
            reached = speed + math.copysign(self.acceleration * time_s, target - speed)
            return (speed + reached) / 2 * time_s, reached
        return (speed + target) / 2 * ramp_s + target * (time_s - ramp_s), target


@dataclass(frozen=True, slots=True)
class Head:
    """The motors of a camera. Zoom is in octaves (doublings of magnification), which match how operators perceive zooming.

    ``settle_s`` is the time in seconds from the end of a move until the picture has settled.
    """

    pan: Motor
    tilt: Motor
    zoom: Motor
    settle_s: float

    def at_speed(self, fraction: float) -> Head:
        """Return a head with its top speeds reduced to a fraction, above 0 and at most 1."""
        pan, tilt, zoom = (replace(motor, speed=motor.speed * fraction) for motor in (self.pan, self.tilt, self.zoom))
        return Head(pan, tilt, zoom, self.settle_s)

    def duration_s(self, start: Pose, end: Pose) -> float:
        """Return the time in seconds until all axes have stopped and the picture has settled; 0 if nothing moves."""
        pan, tilt, octaves = _distances(start, end)
        moving = max(self.pan.duration_s(pan), self.tilt.duration_s(tilt), self.zoom.duration_s(octaves))
        return moving + self.settle_s if moving > 0 else 0.0

    def at(self, start: Pose, end: Pose, time_s: float) -> Pose:
        """Return the pose ``time_s`` after the start of a move. It is exactly ``end`` once all axes have arrived."""
        pan, tilt, octaves = _distances(start, end)
        if time_s >= self.duration_s(start, end) - self.settle_s:
            return end
        return Pose(
            start.pan_deg + self.pan.distance_after(pan, time_s),
            start.tilt_deg + self.tilt.distance_after(tilt, time_s),
            start.zoom * 2 ** self.zoom.distance_after(octaves, time_s),
        )


def top_speed(head: Head) -> Velocity:
    """Return the top speed of a head on each axis."""
    return Velocity(head.pan.speed, head.tilt.speed, head.zoom.speed)


def _distances(start: Pose, end: Pose) -> tuple[float, float, float]:
    return end.pan_deg - start.pan_deg, end.tilt_deg - start.tilt_deg, math.log2(end.zoom / start.zoom)


AXIS_M5075_G_HEAD = Head(pan=Motor(100.0, 400.0), tilt=Motor(100.0, 400.0), zoom=Motor(1.5, 6.0), settle_s=0.1)
"""The motors of the AXIS M5075-G. The pan speed is from the data sheet; the other values are estimates."""
