"""Control the focus and iris of an ONVIF device through its imaging service."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from scope_ptz.camera.lens import FocusAction, IrisAction, LensState
from scope_ptz.camera.network.errors import CameraReplyError
from scope_ptz.camera.network.lens import wait_until_focused
from scope_ptz.camera.onvif.faults import OnvifFaultError
from scope_ptz.camera.onvif.spaces import Ends, LinearScale, parse_range
from scope_ptz.errors import CameraError

if TYPE_CHECKING:
    from scope_ptz.camera.onvif.client import OnvifClient


@dataclass(frozen=True, slots=True)
class LensOptions:
    """The lens options that a device reports.

    Attributes:
        focus_modes: The focus modes: AUTO, MANUAL or both.
        positions: Range of absolute focus positions; None if they are not supported.
        distances: Range of relative focus moves; None if they are not supported.
        exposure_modes: The exposure modes: AUTO, MANUAL or both.
        iris_db: Range of the iris attenuation in dB; None if the iris cannot be set.
    """

    focus_modes: tuple[str, ...] = ()
    positions: Ends | None = None
    distances: Ends | None = None
    exposure_modes: tuple[str, ...] = ()
    iris_db: Ends | None = None


class OnvifLens:
    """The focus and iris of one video source.

    The driver assumes that positive distances focus farther away, and that the iris is open at the end of its range that is closer
    to 0 dB.

    Args:
        client: The connection.
        source: Token of the video source.
        options: The reported lens options.
    """

    def __init__(self, client: OnvifClient, source: str, options: LensOptions) -> None:
        self._client, self._source, self._options = client, source, options
        automatic, manual = "AUTO" in options.focus_modes, "MANUAL" in options.focus_modes
        steps = options.positions is not None or (options.distances is not None and options.distances[0] < 0 < options.distances[1])
        focus: dict[FocusAction, bool] = {
            "auto": automatic, "manual": manual, "once": automatic and manual, "near": steps, "far": steps,
        }  # fmt: skip
        self.focus_actions: tuple[FocusAction, ...] = tuple(action for action, offered in focus.items() if offered)
        manual_exposure = "MANUAL" in options.exposure_modes
        iris: dict[IrisAction, bool] = {
            "auto": "AUTO" in options.exposure_modes and options.iris_db is not None,
            "manual": manual_exposure and options.iris_db is not None,
            "open": manual_exposure and options.iris_db is not None,
            "close": manual_exposure and options.iris_db is not None,
        }
        self.iris_actions: tuple[IrisAction, ...] = tuple(action for action, offered in iris.items() if offered)
        self._focus_scale = None if options.positions is None else LinearScale(options.positions, (0.0, 1.0))
        self._iris_scale = None
        if options.iris_db is not None:
            low_is_open = abs(options.iris_db[0]) < abs(options.iris_db[1])
            self._iris_scale = LinearScale(options.iris_db, (1.0, 0.0) if low_is_open else (0.0, 1.0))

    async def state(self, name: str = "") -> LensState:
        """Read the state of the focus and iris.

        Args:
            name: The camera's name, for the error message.

        Raises:
            CameraError: Neither the focus nor the iris can be set, or the device does not respond.
        """
        if not self.focus_actions and not self.iris_actions:
            raise CameraError(f"The focus and the iris of {name} cannot be set.")
        settings = await self._call("GetImagingSettings")
        focus, exposure = getattr(settings, "Focus", None), getattr(settings, "Exposure", None)
        iris = getattr(exposure, "Iris", None)
        return LensState(
            _is_auto(getattr(focus, "AutoFocusMode", None)),
            await self._focus_position(),
            _is_auto(getattr(exposure, "Mode", None)),
            None if iris is None or self._iris_scale is None else _clamp_fraction(self._iris_scale.to_value(float(iris))),
        )

    async def set_focus(self, action: FocusAction, step: float, poll_s: float) -> LensState:
        """Set the focus and return when it has settled. A step first turns autofocus off, because autofocus would undo the step.

        Args:
            action: The focus action.
            step: Length of a step as a fraction of the range.
            poll_s: Interval in seconds between readings of the focus while it is moving.

        Raises:
            CameraError: The device refuses the request, or does not respond.
        """
        if action in ("auto", "once"):
            await self._set_mode("Focus", "AutoFocusMode", "AUTO")
        elif "MANUAL" in self._options.focus_modes:
            await self._set_mode("Focus", "AutoFocusMode", "MANUAL")
        if action in ("near", "far"):
            await self._call("Move", Focus=await self._step(step if action == "far" else -step))
        state = await wait_until_focused(self.state, poll_s)
        if action == "once":
            await self._set_mode("Focus", "AutoFocusMode", "MANUAL")
            state = await self.state()
        return state

    async def set_iris(self, action: IrisAction, step: float) -> LensState:
        """Set the iris.

        Raises:
            CameraError: The device refuses the request, does not respond, or does not report its iris.
        """
        if action in ("auto", "manual"):
            await self._set_mode("Exposure", "Mode", action.upper())
            return await self.state()
        now, scale = (await self.state()).iris, self._iris_scale
        if now is None or scale is None:
            raise CameraError("The camera does not report its iris position, so the iris cannot be opened or closed by a step.")
        await self._set_mode(
            "Exposure", "Mode", "MANUAL", Iris=scale.to_units(_clamp_fraction(now + (step if action == "open" else -step)))
        )
        return await self.state()

    async def _step(self, fraction: float) -> dict[str, Any]:
        """Return the focus move for a step by a fraction of the range: relative if the device supports it, otherwise absolute."""
        distances, positions = self._options.distances, self._options.positions
        if distances is not None and distances[0] < 0 < distances[1]:
            span = distances[1] if positions is None else min(positions[1] - positions[0], distances[1])
            return {"Relative": {"Distance": max(fraction * span, distances[0])}}
        position = await self._focus_position()
        if position is None or self._focus_scale is None:
            raise CameraError("The camera does not report its focus position, so the focus cannot be moved by a step.")
        return {"Absolute": {"Position": self._focus_scale.to_units(_clamp_fraction(position + fraction))}}

    async def _set_mode(self, group: str, field: str, mode: str, **values: float) -> None:
        """Change the mode, and optionally other values, in a group of imaging settings, leaving the rest of the group unchanged."""
        settings = getattr(await self._call("GetImagingSettings"), group, None)
        if settings is None:
            settings = {field: mode, **values}
        else:
            settings[field] = mode
            for name, value in values.items():
                settings[name] = value
        await self._call("SetImagingSettings", ImagingSettings={group: settings}, ForcePersistence=False)

    async def _focus_position(self) -> float | None:
        """Return the focus position as a fraction of its range; None if the device does not report it."""
        if self._focus_scale is None:
            return None
        try:
            status = await self._call("GetStatus")
        except (OnvifFaultError, CameraReplyError):
            return None
        position = getattr(getattr(status, "FocusStatus20", None), "Position", None)
        return None if position is None else _clamp_fraction(self._focus_scale.to_value(float(position)))

    async def _call(self, operation: str, **arguments: Any) -> Any:
        return await self._client.call("imaging", operation, VideoSourceToken=self._source, **arguments)


async def open_lens(client: OnvifClient, source: str) -> OnvifLens:
    """Read a device's lens options and return its lens. The options are empty if it has no working imaging service."""

    async def read_options(operation: str) -> Any:
        try:
            return await client.call("imaging", operation, VideoSourceToken=source)
        except (OnvifFaultError, CameraReplyError):
            return None

    options, moves = await read_options("GetOptions"), await read_options("GetMoveOptions")
    focus, exposure = getattr(options, "Focus", None), getattr(options, "Exposure", None)
    lens_options = LensOptions(
        tuple(map(str, getattr(focus, "AutoFocusModes", None) or ())),
        parse_range(getattr(getattr(moves, "Absolute", None), "Position", None)),
        parse_range(getattr(getattr(moves, "Relative", None), "Distance", None)),
        tuple(map(str, getattr(exposure, "Mode", None) or ())),
        parse_range(getattr(exposure, "Iris", None)),
    )
    return OnvifLens(client, source, lens_options)


def _is_auto(mode: object) -> bool | None:
    return None if mode is None else str(mode) == "AUTO"


def _clamp_fraction(fraction: float) -> float:
    return min(max(fraction, 0.0), 1.0)
