"""Control the focus and iris of an AXIS camera."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scope_ptz.camera.axis import requests
from scope_ptz.camera.lens import DEFAULT_STEP, FocusAction, IrisAction, LensState, check_focus, check_iris
from scope_ptz.camera.network.lens import wait_until_focused

if TYPE_CHECKING:
    from scope_ptz.camera.axis.client import VapixClient
    from scope_ptz.camera.axis.requests import VapixRequest
    from scope_ptz.camera.capabilities import Capabilities

RANGE_UNITS = 9998
"""Number of steps in the focus and iris ranges, from position 1 to 9999."""


def focus_actions(supported: frozenset[str]) -> tuple[FocusAction, ...]:
    """Return the focus actions of a device, given the names of the ``PTZ.Support`` parameters that are true."""
    automatic: tuple[FocusAction, ...] = ("auto", "manual", "once") if "AutoFocus" in supported else ()
    steps: tuple[FocusAction, ...] = ("near", "far") if "RelativeFocus" in supported else ()
    return automatic + steps


def iris_actions(supported: frozenset[str]) -> tuple[IrisAction, ...]:
    """Return the iris actions of a device, given the names of the ``PTZ.Support`` parameters that are true."""
    automatic: tuple[IrisAction, ...] = ("auto", "manual") if "AutoIris" in supported else ()
    steps: tuple[IrisAction, ...] = ("open", "close") if "RelativeIris" in supported else ()
    return automatic + steps


class AxisLens:
    """The focus and iris of one channel.

    Args:
        name: The camera's name, for error messages.
        client: The connection.
        capabilities: The device's capabilities.
        poll_s: Interval in seconds between readings of the focus while it is moving.
    """

    def __init__(self, name: str, client: VapixClient, capabilities: Capabilities, poll_s: float) -> None:
        self._name, self._client, self._capabilities, self._poll_s = name, client, capabilities, poll_s

    async def state(self) -> LensState:
        """Read the state of the focus and iris."""
        position = await self._client.position()
        return LensState(position.autofocus, _fraction(position.focus_units), position.autoiris, _fraction(position.iris_units))

    async def set_focus(self, action: FocusAction, step: float = DEFAULT_STEP) -> LensState:
        """Set the focus and return when it has settled. A step first turns autofocus off, because autofocus would undo the step.

        Raises:
            InputError: The action or the step is invalid.
            CameraError: The device does not offer the action, refuses it, or does not answer.
        """
        offered, channel = self._capabilities.focus, self._client.channel
        check_focus(self._name, action, offered, step)
        if action in ("auto", "once"):
            await self._send(requests.autofocus(channel, on=True))
        elif "manual" in offered:
            await self._send(requests.autofocus(channel, on=False))
        if action in ("near", "far"):
            await self._send(requests.relative_focus(channel, _step_units(step) * (1 if action == "far" else -1)))
        state = await wait_until_focused(self.state, self._poll_s)
        if action == "once":
            await self._send(requests.autofocus(channel, on=False))
            state = await self.state()
        return state

    async def set_iris(self, action: IrisAction, step: float = DEFAULT_STEP) -> LensState:
        """Set the iris. A step first turns the automatic iris off.

        Raises:
            InputError: The action or the step is invalid.
            CameraError: The device does not offer the action, refuses it, or does not answer.
        """
        offered, channel = self._capabilities.iris, self._client.channel
        check_iris(self._name, action, offered, step)
        if "auto" in offered:
            await self._send(requests.autoiris(channel, on=action == "auto"))
        if action in ("open", "close"):
            await self._send(requests.relative_iris(channel, _step_units(step) * (1 if action == "open" else -1)))
        return await self.state()

    async def _send(self, request: VapixRequest) -> None:
        await self._client.command(request)


def _step_units(fraction: float) -> int:
    return max(1, round(fraction * RANGE_UNITS))


def _fraction(units: float | None) -> float | None:
    return None if units is None else min(max((units - 1) / RANGE_UNITS, 0.0), 1.0)
