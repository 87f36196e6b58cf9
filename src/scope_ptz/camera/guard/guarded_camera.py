"""A camera wrapper that enforces a site's rules."""

from __future__ import annotations

import math
from collections.abc import AsyncGenerator, Awaitable
from contextlib import aclosing
from dataclasses import asdict, replace
from typing import Any

from anyio import to_thread

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, Frame, PresetInfo
from scope_ptz.camera.capabilities import Velocity, check_drive
from scope_ptz.camera.clocks import elapsed_s
from scope_ptz.camera.guard.audit import AuditLog
from scope_ptz.camera.guard.masking import mask_frame
from scope_ptz.camera.guard.motion_math import axis_changes, cap_velocity, merge_axes, pose_after, scale_velocity, velocity_fields
from scope_ptz.camera.guard.rules import CameraRules, nearest_outside
from scope_ptz.camera.guard.wrapper import CameraWrapper
from scope_ptz.camera.lens import DEFAULT_STEP, FocusAction, IrisAction, LensState, check_focus, check_iris
from scope_ptz.errors import CameraError, ConfigError
from scope_ptz.geometry import Axis, Limits, Pose, wrap_pan_deg

STOPPING_S = 0.4
"""Assumed time in seconds that a driven camera takes to react and brake."""

_STEP_S = 0.02  # interval in seconds at which the path of a driven camera is checked

_SPEED_FACTORS = (1.0, 0.5, 0.25, 0.1, 0.04)
"""Factors by which to scale the requested velocity near a limit or a keep-out region, tried in order."""


class KeepOutError(CameraError):
    """A command would aim the camera at a keep-out region, and there is no permitted pose at the region's edge."""


class GuardedCamera(CameraWrapper):
    """A camera that obeys its site's rules.

    It does not aim at keep-out regions. These regions and the masks are black in its frames. A move to a forbidden pose
    ends at the nearest permitted pose, and its ``Arrival`` names the rule.

    Args:
        camera: The wrapped camera.
        rules: The rules.
        audit: The audit log for commands and moves; None to record nothing.

    Raises:
        ConfigError: The rules exclude every pose within the device's limits.
    """

    def __init__(self, camera: Camera, rules: CameraRules, audit: AuditLog | None = None) -> None:
        super().__init__(camera)
        self._rules, self._audit = rules, audit
        self._last_move_s = -math.inf
        self._limits = self._narrow(camera.info.limits)

    @property
    def info(self) -> CameraInfo:
        return replace(self.inner.info, limits=self._limits)

    @property
    def rules(self) -> CameraRules:
        """The rules that the camera obeys."""
        return self._rules

    def record_instruction(self, instruction: str) -> None:
        """Record an instruction from a person in the audit log."""
        self._record("instruction", text=instruction)

    async def move(self, pose: Pose) -> Arrival:
        target, clamped, limited_by = self.nearest_permitted(pose)
        current = await self.inner.pose()
        if self._within_dead_zone(current, target):
            self._record("skipped", target=target, reason="dead zone")
            return Arrival(current, clamped, limited_by or f"the dead zone of {self._rules.dead_zone_deg:g} degrees")
        await self._wait_for_interval()
        self._record("move", target=target, requested=pose)
        arrival = await self._carry_out(self.inner.move(target))
        return Arrival(arrival.pose, merge_axes(clamped, arrival.clamped), limited_by or arrival.limited_by)

    async def go_to_preset(self, name: str) -> Arrival:
        await self._wait_for_interval()
        self._record("preset", name=name)
        return await self._correct(await self._carry_out(self.inner.go_to_preset(name)))

    async def go_home(self) -> Arrival:
        await self._wait_for_interval()
        self._record("home")
        return await self._correct(await self._carry_out(self.inner.go_home()))

    async def frame(self) -> Frame:
        return await self._mask(await self.inner.frame())

    async def frames(self, *, rate_hz: float = 25.0) -> AsyncGenerator[Frame]:
        async with aclosing(self.inner.frames(rate_hz=rate_hz)) as stream:
            async for frame in stream:
                yield await self._mask(frame)

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        """Move at constant velocities for as long as the rules permit, but at most ``timeout_s``.

        An axis at a soft limit is not driven beyond it. Near a limit or a keep-out region, the camera is driven more slowly or for
        a shorter time, so that it stops before reaching it.

        Raises:
            KeepOutError: The camera would enter a keep-out region immediately.
        """
        check_drive(pan_dps, tilt_dps, zoom_rate, timeout_s)
        current = await self.inner.pose()
        requested = cap_velocity(Velocity(pan_dps, tilt_dps, zoom_rate), self.inner.info.capabilities.top_speed)
        for factor in _SPEED_FACTORS:
            velocity = self._without_limited_axes(current, scale_velocity(requested, factor))
            permitted_s = self._permitted_time_s(current, velocity, timeout_s)
            if velocity != Velocity() and permitted_s > 0.0:
                self._record("drive", velocity=velocity, timeout_s=round(permitted_s, 3))
                await self.inner.drive(velocity.pan_dps, velocity.tilt_dps, velocity.zoom_rate, timeout_s=permitted_s)
                return
        self._record("drive", velocity=Velocity(), timeout_s=0.0)
        await self.inner.stop()
        if region := self._rules.region_at(
            pose_after(current, scale_velocity(requested, _SPEED_FACTORS[-1]), STOPPING_S + _STEP_S)
        ):
            raise KeepOutError(f"The camera cannot be driven into the keep-out region '{region.name}'. It has stopped.")

    async def centre_on(self, x: float, y: float, *, zoom_factor: float = 1.0) -> Arrival:
        """Centre a point in the picture, using the device's own command if the rules permit the resulting pose."""
        current = await self.inner.pose()
        target = self.info.towards(current, x, y, zoom_factor)
        permitted, clamped, _ = self.nearest_permitted(target)
        if clamped or self._within_dead_zone(current, permitted):
            return await self.move(target)
        await self._wait_for_interval()
        self._record("centre", x=x, y=y, zoom_factor=zoom_factor, target=target)
        return await self._correct(await self._carry_out(self.inner.centre_on(x, y, zoom_factor=zoom_factor)))

    async def set_focus(self, action: FocusAction, *, step: float = DEFAULT_STEP) -> LensState:
        check_focus(self.info.name, action, self.info.capabilities.focus, step)
        self._record("focus", action=action, step=step)
        return await self._carry_out_lens_command(self.inner.set_focus(action, step=step))

    async def set_iris(self, action: IrisAction, *, step: float = DEFAULT_STEP) -> LensState:
        check_iris(self.info.name, action, self.info.capabilities.iris, step)
        self._record("iris", action=action, step=step)
        return await self._carry_out_lens_command(self.inner.set_iris(action, step=step))

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

    def _narrow(self, device: Limits) -> Limits:
        try:
            return self._rules.soft_limits.within(device)
        except ValueError as error:
            raise ConfigError(f"The rules for {self.inner.info.name} cannot be applied: {error}.") from error

    def nearest_permitted(self, pose: Pose) -> tuple[Pose, tuple[Axis, ...], str]:
        """Return the nearest permitted pose, the clamped axes, and a phrase that names the keep-out region, if any.

        Raises:
            KeepOutError: There is no permitted pose at the edge of the keep-out region.
        """
        target, clamped = self._limits.clamp(pose)
        region = self._rules.region_at(target)
        if region is None:
            return target, clamped, ""
        outside = nearest_outside(target, self._rules.keep_out, self._limits)
        if outside is None:
            raise KeepOutError(f"The pose {target} aims at the keep-out region '{region.name}'. Choose another direction.")
        axes: list[Axis] = [axis for axis, moved in axis_changes(target, outside) if moved]
        return outside, merge_axes(clamped, axes), f"the keep-out region '{region.name}'"

    async def _correct(self, arrival: Arrival) -> Arrival:
        """Move to the nearest permitted pose if the rules forbid the pose that the device's own command reached."""
        target, clamped, limited_by = self.nearest_permitted(arrival.pose)
        if not clamped:
            return arrival
        moved = await self._carry_out(self.inner.move(target))
        return Arrival(moved.pose, merge_axes(arrival.clamped, clamped), limited_by)

    async def _carry_out(self, command: Any) -> Arrival:
        """Await a move and record its outcome."""
        try:
            arrival: Arrival = await command
        except BaseException as error:
            self._record("failed", error=type(error).__name__)
            raise
        finally:
            self._last_move_s = elapsed_s(self.clock)
        self._record("arrived", pose=arrival.pose, clamped=arrival.clamped)
        return arrival

    async def _carry_out_lens_command(self, command: Awaitable[LensState]) -> LensState:
        """Await a lens command and record its outcome."""
        try:
            state = await command
        except BaseException as error:
            self._record("failed", error=type(error).__name__)
            raise
        self._record("lens", **asdict(state))
        return state

    def _within_dead_zone(self, current: Pose, target: Pose) -> bool:
        zone_deg = self._rules.dead_zone_deg
        turned_deg = max(abs(wrap_pan_deg(target.pan_deg - current.pan_deg)), abs(target.tilt_deg - current.tilt_deg))
        return 0.0 < turned_deg < zone_deg and math.isclose(current.zoom, target.zoom, rel_tol=1e-3)

    async def _wait_for_interval(self) -> None:
        remaining_s = self._last_move_s + self._rules.min_interval_s - elapsed_s(self.clock)
        if remaining_s > 0:
            await self.clock.sleep(remaining_s)

    def _without_limited_axes(self, current: Pose, velocity: Velocity) -> Velocity:
        """Return the velocity, with zero for each axis that would pass a soft limit before it could stop."""
        stopped = self._axes_beyond_limits(pose_after(current, velocity, STOPPING_S + _STEP_S))
        return Velocity(
            0.0 if "pan" in stopped else velocity.pan_dps,
            0.0 if "tilt" in stopped else velocity.tilt_dps,
            0.0 if "zoom" in stopped else velocity.zoom_rate,
        )

    def _axes_beyond_limits(self, pose: Pose) -> set[Axis]:
        """Return the axes on which a pose is beyond a soft limit, except those that the device itself stops."""
        return set(self._limits.clamp(pose)[1]) - set(self.inner.info.limits.clamp(pose)[1])

    def _permitted_time_s(self, current: Pose, velocity: Velocity, timeout_s: float) -> float:
        """Return how long the camera can be driven without passing a limit or entering a keep-out region, in seconds."""
        if not self._rules.keep_out and self._limits == self.inner.info.limits:
            return timeout_s
        time_s = 0.0
        while time_s < timeout_s:
            ahead = pose_after(current, velocity, time_s + STOPPING_S + _STEP_S)
            if self._rules.region_at(ahead) or self._axes_beyond_limits(ahead):
                return time_s
            time_s += _STEP_S
        return timeout_s

    async def _mask(self, frame: Frame) -> Frame:
        rules = self._rules
        if not rules.keep_out and not rules.masks:
            return frame
        return await to_thread.run_sync(mask_frame, frame, rules.keep_out, rules.masks)

    def _record(self, event: str, **fields: Any) -> None:
        if self._audit is not None:
            json_fields = {
                name: value.as_dict()
                if isinstance(value, Pose)
                else velocity_fields(value)
                if isinstance(value, Velocity)
                else value
                for name, value in fields.items()
            }
            self._audit.write(event, **json_fields)
