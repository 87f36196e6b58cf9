"""Control the focus and iris of an ONVIF device through its Imaging service."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from scope_ptz.camera.lens import FocusAction, IrisAction, LensState
from scope_ptz.camera.network.errors import CameraReplyError
from scope_ptz.camera.network.lens import wait_until_focused
from scope_ptz.camera.onvif.faults import OnvifFaultError
from scope_ptz.camera.onvif.spaces import Ends, LinearScale, ends_of
from scope_ptz.errors import CameraError

if TYPE_CHECKING:
    from scope_ptz.camera.onvif.client import OnvifClient


@dataclass(frozen=True, slots=True)
class LensOptions:
    """The lens options that a device reports.

    Attributes:
        focus_modes: Its focus modes: AUTO, MANUAL or both.
        positions: Range of absolute focus positions; None if it has none.
        distances: Range of relative focus moves; None if it has none.
        exposure_modes: Its exposure modes: AUTO, MANUAL or both.
        iris_db: Range of the iris, as attenuation in dB; None if it cannot be set.
    """

    focus_modes: tuple[str, ...] = ()
    positions: Ends | None = None
    distances: Ends | None = None
    exposure_modes: tuple[str, ...] = ()
    iris_db: Ends | None = None


class OnvifLens:
    """The focus and iris of one video source.

    The driver assumes that positive distances focus farther away, and that the iris is open at the end of its range nearer to 0 dB.

    Args:
        client: The connection.
        source: Token of the video source.
        options: The options that the device reports.
    """

    def __init__(self, client: OnvifClient, source: str, options: LensOptions) -> None:
        self._client, self._source, self._options = client, source, options
        automatic, manual = "AUTO" in options.focus_modes, "MANUAL" in options.focus_modes
        steps = options.positions is not None or (options.distances is not None and options.distances[0] < 0 < options.distances[1])
        focus: dict[FocusAction, bool] = {
            "auto": automatic, "manual": manual, "once": automatic and manual, "near": steps, "far": steps,
        }  # fmt: skip
        self.focus_actions: tuple[FocusAction, ...] = tuple(action for action, offered in focus.items() if offered)
        held = "MANUAL" in options.exposure_modes
        iris: dict[IrisAction, bool] = {
            "auto": "AUTO" in options.exposure_modes and options.iris_db is not None,
            "manual": held and options.iris_db is not None,
            "open": held and options.iris_db is not None,
            "close": held and options.iris_db is not None,
        }
        self.iris_actions: tuple[IrisAction, ...] = tuple(action for action, offered in iris.items() if offered)
        self._focus_scale = None if options.positions is None else LinearScale(options.positions, (0.0, 1.0))
        self._iris_scale = None
        if options.iris_db is not None:
            low_is_open = abs(options.iris_db[0]) < abs(options.iris_db[1])
            self._iris_scale = LinearScale(options.iris_db, (1.0, 0.0) if low_is_open else (0.0, 1.0))

    async def state(self, name: str = "") -> LensState:
        """Read the state of focus and iris.

        Args:
            name: The camera's name, for the error message.

        Raises:
            CameraError: Neither the focus nor the iris can be set, or the device does not answer.
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
            None if iris is None or self._iris_scale is None else _within(self._iris_scale.to_value(float(iris))),
        )

    async def set_focus(self, action: FocusAction, step: float, poll_s: float) -> LensState:
        """Set the focus and return when it has settled. A step turns autofocus off first, because autofocus would undo the step.

        Args:
            action: The focus action.
            step: Length of a step as a fraction of the range.
            poll_s: Interval, in seconds, at which the focus is read while it moves.

        Raises:
            CameraError: The device refuses the request, or does not answer.
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
            CameraError: The device refuses the request, or does not answer.
        """
        if action in ("auto", "manual"):
            await self._set_mode("Exposure", "Mode", action.upper())
            return await self.state()
        now, scale = (await self.state()).iris, self._iris_scale
        if now is None or scale is None:
            raise CameraError("The camera does not report its iris, so it cannot be opened or closed by a step.")
        await self._set_mode(
            "Exposure", "Mode", "MANUAL", Iris=scale.to_units(_within(now + (step if action == "open" else -step)))
        )
        return await self.state()

    async def _step(self, fraction: float) -> dict[str, Any]:
        """Return a focus move by a fraction of the range: relative if the device supports it, otherwise absolute."""
        distances, positions = self._options.distances, self._options.positions
        if distances is not None and distances[0] < 0 < distances[1]:
            span = distances[1] if positions is None else min(positions[1] - positions[0], distances[1])
            return {"Relative": {"Distance": max(fraction * span, distances[0])}}
        here = await self._focus_position()
        if here is None or self._focus_scale is None:
            raise CameraError("The camera does not report its focus, so it cannot be moved by a step.")
        return {"Absolute": {"Position": self._focus_scale.to_units(_within(here + fraction))}}

    async def _set_mode(self, group: str, field: str, mode: str, **values: float) -> None:
        """Change one group of the settings. Its other values are sent back as the device reports them."""
        settings = getattr(await self._call("GetImagingSettings"), group, None)
        if settings is None:
            settings = {field: mode, **values}
        else:
            settings[field] = mode
            for name, value in values.items():
                settings[name] = value
        await self._call("SetImagingSettings", ImagingSettings={group: settings}, ForcePersistence=False)

    async def _focus_position(self) -> float | None:
        """Return the focus position as a fraction of its range; None if the device reports none."""
        if self._focus_scale is None:
            return None
        try:
            status = await self._call("GetStatus")
        except (OnvifFaultError, CameraReplyError):
            return None
        position = getattr(getattr(status, "FocusStatus20", None), "Position", None)
        return None if position is None else _within(self._focus_scale.to_value(float(position)))

    async def _call(self, operation: str, **arguments: Any) -> Any:
        return await self._client.call("imaging", operation, VideoSourceToken=self._source, **arguments)


async def open_lens(client: OnvifClient, source: str) -> OnvifLens:
    """Read the lens options of a device. They are empty if the device has no working Imaging service."""

    async def ask(operation: str) -> Any:
        try:
            return await client.call("imaging", operation, VideoSourceToken=source)
        except (OnvifFaultError, CameraReplyError):
            return None

    options, moves = await ask("GetOptions"), await ask("GetMoveOptions")
    focus, exposure = getattr(options, "Focus", None), getattr(options, "Exposure", None)
    found = LensOptions(
        tuple(map(str, getattr(focus, "AutoFocusModes", None) or ())),
        ends_of(getattr(getattr(moves, "Absolute", None), "Position", None)),
        ends_of(getattr(getattr(moves, "Relative", None), "Distance", None)),
        tuple(map(str, getattr(exposure, "Mode", None) or ())),
        ends_of(getattr(exposure, "Iris", None)),
    )
    return OnvifLens(client, source, found)


def _is_auto(mode: object) -> bool | None:
    return None if mode is None else str(mode) == "AUTO"


def _within(fraction: float) -> float:
    return min(max(fraction, 0.0), 1.0)
