"""The focus and iris of a virtual device, and their effect on its picture."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

SHARP_FOCUS = 0.62
"""The focus position at which the scene is sharp. The lens is parfocal, so this does not depend on the zoom."""

AUTO_IRIS = 0.5
"""The iris opening at which the scene is correctly exposed."""

TRAVEL_S = 3.0
"""Time in seconds for the focus to travel its whole range at top speed."""

_BLUR_PX = 12.0  # standard deviation of the blur for a focus error of the whole range, at 1x in an image 1280 pixels wide
_MAX_BLUR_PX = 8.0  # maximum standard deviation of the blur in an image 1280 pixels wide
_IRIS_STOPS = 4.0  # stops (factors of two) of light between the closed and the open iris
_GAMMA = 2.2  # exponent that converts pixel values to light


@dataclass(frozen=True, slots=True)
class _State:
    """The state of a lens: its modes, its manual iris opening, and the last focus motion.

    The motion goes from ``start`` to ``end``, begins at the time ``started_s``, and has a ``speed`` in fractions of the range per
    second.
    """

    autofocus: bool = True
    autoiris: bool = True
    iris: float = AUTO_IRIS
    start: float = SHARP_FOCUS
    end: float = SHARP_FOCUS
    speed: float = 0.0
    started_s: float = 0.0


class VirtualLens:
    """A lens with focus and iris. Positions are fractions of their ranges: 0 is near or closed, 1 is far or open.

    Commands must come from a single thread. ``VirtualDevice.expose`` may run in another thread at the same time.

    Args:
        now_s: A function that returns the motor time in seconds.
    """

    def __init__(self, now_s: Callable[[], float]) -> None:
        self._now_s, self._state = now_s, _State()

    @property
    def autofocus(self) -> bool:
        return self._state.autofocus

    @property
    def autoiris(self) -> bool:
        return self._state.autoiris

    @property
    def iris(self) -> float:
        return AUTO_IRIS if self._state.autoiris else self._state.iris

    @property
    def focus(self) -> float:
        """The current focus position."""
        state = self._state
        distance = state.end - state.start
        travelled = state.speed * (self._now_s() - state.started_s)
        return state.end if travelled >= abs(distance) else state.start + math.copysign(travelled, distance)

    @property
    def is_focusing(self) -> bool:
        """Whether the focus is moving."""
        return self.focus != self._state.end

    def set_autofocus(self, *, on: bool) -> None:
        """Turn autofocus on or off. When turned on, it starts focusing immediately; when turned off, it keeps the current focus."""
        if on:
            self._travel(SHARP_FOCUS, 1 / TRAVEL_S, autofocus=True)
        else:
            self.stop_focus()

    def move_focus(self, position: float) -> None:
        """Move the focus to a position. This turns autofocus off."""
        self._travel(_clamp(position), 1 / TRAVEL_S)

    def drive_focus(self, speed: float) -> None:
        """Move the focus towards the far end (``speed`` above 0) or the near end of its range. This turns autofocus off.

        Args:
            speed: Signed fraction of the top speed, from -1 to 1; 0 stops the focus.
        """
        if not speed:
            self.stop_focus()
        else:
            self._travel(1.0 if speed > 0 else 0.0, min(abs(speed), 1.0) / TRAVEL_S)

    def stop_focus(self) -> None:
        """Stop the focus. This turns autofocus off."""
        self._travel(self.focus, 0.0)

    def set_autoiris(self, *, on: bool) -> None:
        """Turn the automatic iris on or off. When turned off, it keeps the current opening."""
        self._state = replace(self._state, autoiris=on, iris=self.iris)

    def set_iris(self, opening: float) -> None:
        """Open the iris to a fraction of its range. This turns the automatic iris off."""
        self._state = replace(self._state, autoiris=False, iris=_clamp(opening))

    def apply(self, image: NDArray[np.uint8], zoom: float) -> NDArray[np.uint8]:
        """Apply the lens to an image: blur it if it is out of focus, and darken or brighten it according to the iris.

        Args:
            image: Array of shape ``(H, W, 3)``, uint8. It is returned unchanged if the lens is in focus and the iris is automatic.
            zoom: The magnification. The depth of field decreases as it increases.
        """
        width = image.shape[1]
        blur_px = min(_BLUR_PX * abs(self.focus - SHARP_FOCUS) * math.sqrt(zoom), _MAX_BLUR_PX) * width / 1280
        if blur_px > 0.2:
            image = np.asarray(cv2.GaussianBlur(image, (0, 0), blur_px), np.uint8)
        stops = _IRIS_STOPS * (self.iris - AUTO_IRIS)
        if stops:
            light = (np.arange(256) / 255.0) ** _GAMMA * 2.0**stops
            image = np.asarray(cv2.LUT(image, np.round(255 * np.clip(light, 0, 1) ** (1 / _GAMMA)).astype(np.uint8)), np.uint8)
        return image

    def _travel(self, end: float, speed: float, *, autofocus: bool = False) -> None:
        current, now_s = self.focus, self._now_s()
        self._state = replace(self._state, autofocus=autofocus, start=current, end=end, speed=speed, started_s=now_s)


def _clamp(value: float) -> float:
    return min(max(value, 0.0), 1.0)
