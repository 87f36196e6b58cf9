"""A camera that keeps the rules of its site."""

from __future__ import annotations

import math
from collections.abc import AsyncGenerator
from contextlib import aclosing
from dataclasses import replace
from typing import Any

from anyio import to_thread

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, PresetInfo
from scope_ptz.camera.capabilities import Velocity, check_drive
from scope_ptz.camera.guard.audit import AuditLog
from scope_ptz.camera.guard.masking import masked
from scope_ptz.camera.guard.rules import CameraRules, nearest_outside
from scope_ptz.camera.guard.wrapper import CameraWrapper
from scope_ptz.errors import CameraError, ConfigError
from scope_ptz.geometry import Axis, Limits, Pose, wrap_pan_deg

STOPPING_S = 0.4
"""Time that a driven camera is assumed to need for reaction and braking."""

_STEP_S = 0.02

_SHARES = (1.0, 0.5, 0.25, 0.1, 0.04)
"""Shares of the requested velocity that are tried near a limit or a keep-out region."""


class KeepOutError(CameraError):
    """A command would aim the camera at a keep-out region, and there is no way around."""


class GuardedCamera(CameraWrapper):
    """A camera that is never aimed beyond its site's rules and whose frames show nothing that they hide.

    A move beyond a rule ends at the nearest permitted pose, and its ``Arrival`` says what held it back.

    Args:
        camera: The camera inside.
        rules: The rules.
        audit: Where commands and moves are recorded; None records nothing.

    Raises:
        ConfigError: The rules leave nothing of the device's limits.
    """

    def __init__(self, camera: Camera, rules: CameraRules, audit: AuditLog | None = None) -> None:
        super().__init__(camera)
        self._rules, self._audit = rules, audit
        self._last_move_s = -math.inf
        self._limits = self._narrowed(camera.info.limits)

    @property
    def info(self) -> CameraInfo:
        return replace(self.inner.info, limits=self._limits)

    def record_instruction(self, instruction: str) -> None:
        """Record what a person asked for."""
        self._record("instruction", text=instruction)

    async def move(self, pose: Pose) -> Arrival:
        target, clamped, limited_by = self._permitted(pose)
        here = await self.inner.pose()
        if self._within_dead_zone(here, target):
            self._record("skipped", target=target, reason="dead zone")
            return Arrival(here, clamped, limited_by or f"the dead zone of {self._rules.dead_zone_deg:g} degrees")
        await self._wait_for_turn()
        self._record("move", target=target, requested=pose)
        arrival = await self._carried_out(self.inner.move(target))
        return Arrival(arrival.pose, _joined(clamped, arrival.clamped), limited_by or arrival.limited_by)

    async def go_to_preset(self, name: str) -> Arrival:
        await self._wait_for_turn()
        self._record("preset", name=name)
        return await self._corrected(await self._carried_out(self.inner.go_to_preset(name)))

    async def go_home(self) -> Arrival:
        await self._wait_for_turn()
        self._record("home")
        return await self._corrected(await self._carried_out(self.inner.go_home()))

    async def frame(self) -> Frame:
        return await self._masked(await self.inner.frame())

    async def frames(self, *, rate_hz: float = 25.0) -> AsyncGenerator[Frame]:
        async with aclosing(self.inner.frames(rate_hz=rate_hz)) as stream:
            async for frame in stream:
                yield await self._masked(frame)

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        """Move at constant velocities for as long as the rules permit, at most ``timeout_s``.

        An axis that a soft limit stops is not driven. Near a limit or a keep-out region the camera is driven more slowly and for
        a shorter time, so that it stands still before it gets there.

        Raises:
            KeepOutError: The camera would run into a keep-out region at once.
        """
        check_drive(pan_dps, tilt_dps, zoom_rate, timeout_s)
        here = await self.inner.pose()
        requested = _capped(Velocity(pan_dps, tilt_dps, zoom_rate), self.inner.info.capabilities.top_speed)
        for share in _SHARES:
            velocity = self._free_axes(here, _scaled(requested, share))
            free_s = self._free_time_s(here, velocity, timeout_s)
            if velocity != Velocity() and free_s > 0.0:
                self._record("drive", velocity=velocity, timeout_s=round(free_s, 3))
                await self.inner.drive(velocity.pan_dps, velocity.tilt_dps, velocity.zoom_rate, timeout_s=free_s)
                return
        self._record("drive", velocity=Velocity(), timeout_s=0.0)
        await self.inner.stop()
        if region := self._rules.region_at(_advanced(here, _scaled(requested, _SHARES[-1]), STOPPING_S + _STEP_S)):
            raise KeepOutError(f"The camera cannot be driven into the keep-out region '{region.name}'. It has stopped.")

    async def stop(self) -> None:
        self._record("stop")
        await self.inner.stop()

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:
        saved = await self.inner.save_preset(name, description)
        self._record("preset saved", name=name)
        return saved

    async def remove_preset(self, name: str) -> None:
        await self.inner.remove_preset(name)
        self._record("preset removed", name=name)

    async def close(self) -> None:
        try:
            await self.inner.close()
        finally:
            if self._audit is not None:
                self._audit.close()

    def _narrowed(self, device: Limits) -> Limits:
        try:
            return self._rules.soft_limits.within(device)
        except ValueError as error:
            raise ConfigError(f"The rules of {self.inner.info.name} cannot be kept: {error}.") from error

    def _permitted(self, pose: Pose) -> tuple[Pose, tuple[Axis, ...], str]:
        """Return the nearest permitted pose, the clamped axes, and what held the camera back."""
        target, clamped = self._limits.clamp(pose)
        region = self._rules.region_at(target)
        if region is None:
            return target, clamped, ""
        outside = nearest_outside(target, self._rules.keep_out, self._limits)
        if outside is None:
            raise KeepOutError(f"The pose {target} aims at the keep-out region '{region.name}'. Choose another direction.")
        axes: list[Axis] = [axis for axis, moved in _changes(target, outside) if moved]
        return outside, _joined(clamped, axes), f"the keep-out region '{region.name}'"

    async def _corrected(self, arrival: Arrival) -> Arrival:
        """Leave a pose that a preset of the device had and that the rules do not permit."""
        target, clamped, limited_by = self._permitted(arrival.pose)
        if not clamped:
            return arrival
        moved = await self._carried_out(self.inner.move(target))
        return Arrival(moved.pose, _joined(arrival.clamped, clamped), limited_by)

    async def _carried_out(self, command: Any) -> Arrival:
        """Await a move and record how it ended."""
        try:
            arrival: Arrival = await command
        except BaseException as error:
            self._record("failed", error=type(error).__name__)
            raise
        finally:
            self._last_move_s = self.clock.now_s()
        self._record("arrived", pose=arrival.pose, clamped=arrival.clamped)
        return arrival

    def _within_dead_zone(self, here: Pose, target: Pose) -> bool:
        zone_deg = self._rules.dead_zone_deg
        turned_deg = max(abs(wrap_pan_deg(target.pan_deg - here.pan_deg)), abs(target.tilt_deg - here.tilt_deg))
        return 0.0 < turned_deg < zone_deg and math.isclose(here.zoom, target.zoom, rel_tol=1e-3)

    async def _wait_for_turn(self) -> None:
        left_s = self._last_move_s + self._rules.min_interval_s - self.clock.now_s()
        if left_s > 0:
            await self.clock.sleep(left_s)

    def _free_axes(self, here: Pose, velocity: Velocity) -> Velocity:
        """Return the velocity without axes that would leave the limits before they can stop."""
        stopped = self._beyond(_advanced(here, velocity, STOPPING_S + _STEP_S))
        return Velocity(
            0.0 if "pan" in stopped else velocity.pan_dps,
            0.0 if "tilt" in stopped else velocity.tilt_dps,
            0.0 if "zoom" in stopped else velocity.zoom_rate,
        )

    def _beyond(self, pose: Pose) -> set[Axis]:
        """Return the axes on which a pose is beyond a rule. The device itself stops at its own limits."""
        return set(self._limits.clamp(pose)[1]) - set(self.inner.info.limits.clamp(pose)[1])

    def _free_time_s(self, here: Pose, velocity: Velocity, timeout_s: float) -> float:
        """Return how long the camera can be driven so that it stands still before a limit or a keep-out region."""
        if not self._rules.keep_out and self._limits == self.inner.info.limits:
            return timeout_s
        time_s = 0.0
        while time_s < timeout_s:
            ahead = _advanced(here, velocity, time_s + STOPPING_S + _STEP_S)
            if self._rules.region_at(ahead) or self._beyond(ahead):
                return time_s
            time_s += _STEP_S
        return timeout_s

    async def _masked(self, frame: Frame) -> Frame:
        rules = self._rules
        if not rules.keep_out and not rules.masks:
            return frame
        return await to_thread.run_sync(masked, frame, rules.keep_out, rules.masks)

    def _record(self, event: str, **fields: Any) -> None:
        if self._audit is not None:
            plain = {
                name: value.as_dict() if isinstance(value, Pose) else _as_dict(value) if isinstance(value, Velocity) else value
                for name, value in fields.items()
            }
            self._audit.write(event, **plain)


def _as_dict(velocity: Velocity) -> dict[str, float]:
    """Return a velocity as a dictionary."""
    return {"pan_dps": velocity.pan_dps, "tilt_dps": velocity.tilt_dps, "zoom_rate": velocity.zoom_rate}


def _capped(velocity: Velocity, top: Velocity) -> Velocity:
    def cap(speed: float, limit: float) -> float:
        return math.copysign(min(abs(speed), limit), speed)

    return Velocity(
        cap(velocity.pan_dps, top.pan_dps), cap(velocity.tilt_dps, top.tilt_dps), cap(velocity.zoom_rate, top.zoom_rate)
    )


def _scaled(velocity: Velocity, share: float) -> Velocity:
    return Velocity(velocity.pan_dps * share, velocity.tilt_dps * share, velocity.zoom_rate * share)


def _advanced(pose: Pose, velocity: Velocity, seconds: float) -> Pose:
    zoom = pose.zoom * 2.0 ** max(-10.0, min(10.0, velocity.zoom_rate * seconds))
    return Pose(pose.pan_deg + velocity.pan_dps * seconds, pose.tilt_deg + velocity.tilt_dps * seconds, zoom)


def _changes(start: Pose, end: Pose) -> tuple[tuple[Axis, bool], ...]:
    return ("pan", start.pan_deg != end.pan_deg), ("tilt", start.tilt_deg != end.tilt_deg)


def _joined(*axes: Any) -> tuple[Axis, ...]:
    """Return axes of several reports once each, in the order pan, tilt, zoom."""
    found = {axis for group in axes for axis in group}
    order: tuple[Axis, ...] = ("pan", "tilt", "zoom")
    return tuple(axis for axis in order if axis in found)
