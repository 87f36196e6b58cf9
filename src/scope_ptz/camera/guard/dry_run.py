"""A camera that reports what it would do and never moves."""

from __future__ import annotations

from collections.abc import Callable

from scope_ptz.camera.base import Arrival, Camera, PresetInfo
from scope_ptz.camera.capabilities import check_drive, check_preset_name
from scope_ptz.camera.guard.wrapper import CameraWrapper
from scope_ptz.errors import UnknownNameError
from scope_ptz.geometry import Pose


class DryRunCamera(CameraWrapper):
    """A camera whose commands are reported and not carried out.

    ``pose`` returns where the camera would be. Frames are real and carry their real pose, because the camera stays where it is.

    Args:
        camera: The camera inside.
        report: Called with one sentence for each command.
    """

    def __init__(self, camera: Camera, report: Callable[[str], None]) -> None:
        super().__init__(camera)
        self._report = report
        self._pose: Pose | None = None

    async def pose(self) -> Pose:
        return self._pose or await self.inner.pose()

    async def move(self, pose: Pose) -> Arrival:
        self._pose, clamped = self.info.limits.clamp(pose)
        where = self._pose.as_dict()
        self._report(f"would move to pan {where['pan_deg']:g}, tilt {where['tilt_deg']:g}, zoom {where['zoom']:g}x")
        return Arrival(self._pose, clamped)

    async def go_to_preset(self, name: str) -> Arrival:
        if name not in (known := [preset.name for preset in await self.presets()]):
            raise UnknownNameError("preset", name, known)
        self._report(f"would go to the preset '{name}'")
        return Arrival(await self.pose())

    async def go_home(self) -> Arrival:
        self._report("would go home")
        return Arrival(await self.pose())

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

    async def stop(self) -> None:
        """Do nothing: nothing moves."""
