"""Focus and iris of an AXIS camera."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scope_ptz.camera.axis import requests
from scope_ptz.errors import CameraError, InputError

if TYPE_CHECKING:
    from scope_ptz.camera.axis.client import VapixClient
    from scope_ptz.camera.axis.device import AxisDevice

MAX_STEPS = 9999
"""The most steps of one command."""


class LensControls:
    """Focus and iris. Every method raises ``CameraError`` if the camera lacks the function or does not answer."""

    def __init__(self, client: VapixClient, device: AxisDevice) -> None:
        self._client, self._device = client, device

    async def set_autofocus(self, *, on: bool) -> None:
        """Turn autofocus on or off. Turned on, it focuses at once."""
        self._check_supported("AutoFocus", "autofocus")
        await self._client.command(requests.autofocus(self._client.channel, on=on))

    async def step_focus(self, steps: int) -> None:
        """Move the focus by steps of the device, positive to focus farther away. It turns autofocus off.

        Raises:
            InputError: The number of steps is beyond -9999 to 9999.
        """
        self._check_supported("RelativeFocus", "focus in steps")
        _check_steps(steps)
        if "AutoFocus" in self._device.supported:
            await self._client.command(requests.autofocus(self._client.channel, on=False))
        await self._client.command(requests.relative_focus(self._client.channel, steps))

    async def set_autoiris(self, *, on: bool) -> None:
        """Turn the automatic iris on or off."""
        self._check_supported("AutoIris", "an automatic iris")
        await self._client.command(requests.autoiris(self._client.channel, on=on))

    async def step_iris(self, steps: int) -> None:
        """Move the iris by steps of the device, positive to open it. It turns the automatic iris off.

        Raises:
            InputError: The number of steps is beyond -9999 to 9999.
        """
        self._check_supported("RelativeIris", "iris in steps")
        _check_steps(steps)
        if "AutoIris" in self._device.supported:
            await self._client.command(requests.autoiris(self._client.channel, on=False))
        await self._client.command(requests.relative_iris(self._client.channel, steps))

    def _check_supported(self, function: str, words: str) -> None:
        if function not in self._device.supported:
            raise CameraError(f"{self._device.model or 'The camera'} has no {words}.")


def _check_steps(steps: int) -> None:
    if not -MAX_STEPS <= steps <= MAX_STEPS:
        raise InputError(f"The number of steps is -{MAX_STEPS} to {MAX_STEPS}, got {steps}.")
