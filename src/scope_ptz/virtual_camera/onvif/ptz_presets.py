"""The preset and home operations of the ONVIF PTZ service."""

from __future__ import annotations

from scope_ptz.errors import CameraError, InputError, UnknownNameError
from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.device import DevicePreset, VirtualDevice
from scope_ptz.virtual_camera.onvif.media_profiles import find_profile
from scope_ptz.virtual_camera.onvif.operations import Operation, Operations, Reply, Request
from scope_ptz.virtual_camera.onvif.ptz_configuration import PtzConfiguration
from scope_ptz.virtual_camera.onvif.ptz_service import PtzService
from scope_ptz.virtual_camera.onvif.soap import SoapFault, invalid_argument


class PresetOperations:
    """The operations for presets and the home position. A preset's token is its number.

    Args:
        device: The camera.
        configuration: Its PTZ configuration.
        service: The PTZ service, which converts poses to ONVIF positions.
    """

    def __init__(self, device: VirtualDevice, configuration: PtzConfiguration, service: PtzService) -> None:
        self._device, self._configuration, self._service = device, configuration, service

    def operations(self) -> Operations:
        """Return the operations by name."""
        return {
            "GetPresets": Operation(self._presets),
            "SetPreset": Operation(self._set, Role.ADMINISTRATOR),
            "RemovePreset": Operation(self._remove, Role.ADMINISTRATOR),
            "GotoPreset": Operation(self._go_to, Role.OPERATOR),
            "GotoHomePosition": Operation(self._go_home, Role.OPERATOR),
            "SetHomePosition": Operation(self._set_home, Role.ADMINISTRATOR),
        }

    def _presets(self, request: Request) -> Reply:
        find_profile(self._device, request.ProfileToken)
        return {
            "Preset": [
                {"token": str(preset.number), "Name": preset.name, "PTZPosition": self._service.position(preset.pose)}
                for preset in self._device.presets()
            ]
        }

    def _set(self, request: Request) -> Reply:
        find_profile(self._device, request.ProfileToken)
        if self._device.is_moving():
            raise SoapFault("A preset cannot be saved while the camera is moving.", "Action", "MovingPTZ", receiver=True)
        old = None if not request.PresetToken else self._preset(request.PresetToken)
        name = request.PresetName or (old.name if old else self._unused_name())
        same = next((preset for preset in self._device.presets() if preset.name == name), None)
        if same is not None and same != old:
            raise invalid_argument("Another preset has this name.", "PresetExist")
        try:
            preset = self._device.save_preset(name, number=old.number if old else None)
        except InputError as error:
            raise invalid_argument(str(error), "InvalidPresetName") from error
        except CameraError as error:
            raise SoapFault(str(error), "Action", "TooManyPresets", receiver=True) from error
        return {"PresetToken": str(preset.number)}

    def _remove(self, request: Request) -> Reply:
        find_profile(self._device, request.ProfileToken)
        self._device.remove_preset(self._preset(request.PresetToken).number)
        return {}

    def _go_to(self, request: Request) -> Reply:
        find_profile(self._device, request.ProfileToken)
        fraction, zoom_fraction = self._configuration.speed_fractions(request.Speed)
        self._device.move(self._preset(request.PresetToken).pose, speed_fraction=fraction, zoom_fraction=zoom_fraction)
        return {}

    def _go_home(self, request: Request) -> Reply:
        find_profile(self._device, request.ProfileToken)
        fraction, zoom_fraction = self._configuration.speed_fractions(request.Speed)
        self._device.move(self._device.home, speed_fraction=fraction, zoom_fraction=zoom_fraction)
        return {}

    def _set_home(self, request: Request) -> Reply:
        find_profile(self._device, request.ProfileToken)
        self._device.set_home()
        return {}

    def _preset(self, token: str | None) -> DevicePreset:
        try:
            return self._device.preset(int(token or "", 10))
        except (ValueError, UnknownNameError) as error:
            raise invalid_argument(f"There is no preset '{str(token)[:64]}'.", "NoToken") from error

    def _unused_name(self) -> str:
        names = {preset.name for preset in self._device.presets()}
        return next(name for k in range(1, len(names) + 2) if (name := f"Preset {k}") not in names)
