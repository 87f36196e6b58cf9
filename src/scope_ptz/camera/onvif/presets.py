"""Access the presets of an ONVIF device by name. Devices identify presets by token, and some garble the names."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import anyio

from scope_ptz.camera.capabilities import check_preset_name
from scope_ptz.camera.onvif.faults import OnvifFaultError
from scope_ptz.errors import CameraError, UnknownNameError

if TYPE_CHECKING:
    from scope_ptz.camera.onvif.client import OnvifClient


MAX_PRESETS = 512
"""Maximum number of presets to read. Some devices list hundreds of empty ones."""

SAVE_RETRIES = 10
"""Maximum number of attempts to save a preset again while the device reports that it is still moving."""


class OnvifPresets:
    """The presets of one profile.

    Args:
        client: The connection.
        profile: Token of the profile.
    """

    def __init__(self, client: OnvifClient, profile: str) -> None:
        self._client, self._profile = client, profile

    async def tokens(self) -> dict[str, str]:
        """Return the tokens by preset name, in the device's order. If presets share a name, later names include the token."""
        presets = await self._client.call("ptz", "GetPresets", ProfileToken=self._profile)
        tokens: dict[str, str] = {}
        for preset in list(presets or ())[:MAX_PRESETS]:
            token = str(preset.token or "")
            if not token:
                continue
            name = readable_name(preset.Name) or f"Preset {token}"
            tokens.setdefault(name if name not in tokens else f"{name} ({token})", token)
        return tokens

    async def token(self, name: str) -> str:
        """Return the token of a preset.

        Raises:
            UnknownNameError: There is no such preset.
        """
        tokens = await self.tokens()
        if name not in tokens:
            raise UnknownNameError("preset", name, tokens)
        return tokens[name]

    async def save(self, name: str) -> None:
        """Save the current position as a preset.

        Raises:
            InputError: The name is invalid.
            CameraError: The device did not save the preset.
        """
        check_preset_name(name)
        arguments = {"ProfileToken": self._profile, "PresetName": name}
        if (token := (await self.tokens()).get(name)) is not None:
            arguments["PresetToken"] = token
        for retries_left in range(SAVE_RETRIES, -1, -1):
            try:
                await self._client.call("ptz", "SetPreset", **arguments)
                break
            except OnvifFaultError as fault:
                if not fault.has_any_code("MovingPTZ") or not retries_left:
                    raise
                await anyio.sleep(0.1)
        if name not in await self.tokens():
            raise CameraError(
                f"The camera at {self._client.address} did not save the preset. The account may lack permission to save presets."
            )

    async def remove(self, name: str) -> None:
        """Remove a preset.

        Raises:
            UnknownNameError: There is no such preset.
        """
        await self._client.call("ptz", "RemovePreset", ProfileToken=self._profile, PresetToken=await self.token(name))

    async def go_to(self, token: str) -> None:
        """Start moving to a preset. No speed is sent, because some devices reject it."""
        await self._client.call("ptz", "GotoPreset", ProfileToken=self._profile, PresetToken=token)


def readable_name(name: object) -> str:
    """Return a preset name without unprintable characters, after repairing UTF-8 that was decoded as Latin-1."""
    text = str(name or "")
    with suppress(UnicodeError):  # the text is already correct, or cannot be repaired
        text = text.encode("latin-1").decode("utf-8")
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())[:60]
