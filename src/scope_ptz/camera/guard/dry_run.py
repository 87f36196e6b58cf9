"""A camera wrapper that reports commands instead of carrying them out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from scope_ptz.camera.base import Arrival, Camera, CameraInfo, PresetInfo
from scope_ptz.camera.capabilities import check_drive, check_preset_name
from scope_ptz.camera.guard.guarded_camera import GuardedCamera
from scope_ptz.camera.guard.wrapper import CameraWrapper
from scope_ptz.camera.lens import DEFAULT_STEP, FocusAction, IrisAction, LensState, check_focus, check_iris
from scope_ptz.errors import UnknownNameError
from scope_ptz.geometry import Pose

DRY_RUN = "the dry run: this is where it would be"
DRY_RUN_UNKNOWN_POSE = "the dry run: only the camera knows the pose there"


class DryRunCamera(CameraWrapper):
    """A camera whose commands are reported but not executed.

    ``pose`` returns the target of the last ``move``, or the real pose if there was none. Frames are real and keep their real pose,
    because the camera does not move. Each ``Arrival`` mentions the dry run in ``limited_by``, so that it appears in tool results
    and traces.

    Args:
        camera: The wrapped camera.
        report: A function that is called with a description of each command.
    """

    def __init__(self, camera: Camera, report: Callable[[str], None]) -> None:
        super().__init__(camera)
        self._report = report
        self._pose: Pose | None = None

    @property
    def info(self) -> CameraInfo:
        return replace(self.inner.info, dry_run=True)

    async def pose(self) -> Pose:
        return self._pose or await self.inner.pose()

    async def move(self, pose: Pose) -> Arrival:
        target, clamped = self.info.limits.clamp(pose)
        limited_by = ""
        if isinstance(self.inner, GuardedCamera):
            target, clamped, limited_by = self.inner.nearest_permitted(pose)
        rounded, self._pose = target.as_dict(), target
        reason = limited_by or f"the {' and '.join(clamped)} limit" if clamped else limited_by
        note = f", held back by {reason}" if reason else ""
        self._report(f"would move to pan {rounded['pan_deg']:g}, tilt {rounded['tilt_deg']:g}, zoom {rounded['zoom']:g}x{note}")
        return Arrival(target, clamped, f"{reason}, and by {DRY_RUN}" if reason else DRY_RUN)

    async def go_to_preset(self, name: str) -> Arrival:
        if name not in (known := [preset.name for preset in await self.presets()]):
            raise UnknownNameError("preset", name, known)
        self._report(f"would go to the preset '{name}'")
        return Arrival(await self.pose(), limited_by=DRY_RUN_UNKNOWN_POSE)

    async def go_home(self) -> Arrival:
        self._report("would go home")
        return Arrival(await self.pose(), limited_by=DRY_RUN_UNKNOWN_POSE)

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        check_drive(pan_dps, tilt_dps, zoom_rate, timeout_s)
        self._report(f"would drive at pan {pan_dps:g}°/s, tilt {tilt_dps:g}°/s, zoom {zoom_rate:g} octaves/s for {timeout_s:g} s")

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:
        check_preset_name(name)
        self._report(f"would save the preset '{name}'")
        return PresetInfo(name, description)

    async def remove_preset(self, name: str) -> None:
        if name not in (known := [preset.name for preset in await self.presets()]):
            raise UnknownNameError("preset", name, known)
        self._report(f"would remove the preset '{name}'")

    async def set_focus(self, action: FocusAction, *, step: float = DEFAULT_STEP) -> LensState:
        check_focus(self.info.name, action, self.info.capabilities.focus, step)
        self._report(f"would set the focus: {action}{_step_text(action, step)}")
        return await self.lens()

    async def set_iris(self, action: IrisAction, *, step: float = DEFAULT_STEP) -> LensState:
        check_iris(self.info.name, action, self.info.capabilities.iris, step)
        self._report(f"would set the iris: {action}{_step_text(action, step)}")
        return await self.lens()

    async def stop(self) -> None:
        """Do nothing, because the camera is not moving."""


def _step_text(action: str, step: float) -> str:
    return f" by {step:.0%} of the range" if action in ("near", "far", "open", "close") else ""
