"""Continuous actions: relative pan, tilt and zoom moves, and a signal that ends the episode."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from scope_ptz.errors import InputError

FINISH_ABOVE = 0.5
"""An action ends the episode if its last number exceeds this. Three in four random actions are therefore moves."""


@dataclass(frozen=True, slots=True)
class MoveScale:
    """The size of the moves that actions of 1 represent.

    Attributes:
        pan_deg: Degrees to the right.
        tilt_deg: Degrees up.
        zoom_factor: Factor by which the magnification is multiplied. An action of -1 divides by it.
    """

    pan_deg: float = 180.0
    tilt_deg: float = 90.0
    zoom_factor: float = 5.0

    def __post_init__(self) -> None:
        values = (self.pan_deg, self.tilt_deg, self.zoom_factor)
        if not all(math.isfinite(v) and v > 0 for v in values) or self.zoom_factor <= 1:
            raise InputError(f"A MoveScale needs positive numbers and a zoom_factor above 1; got {self}.")


@dataclass(frozen=True, slots=True)
class Move:
    """A relative move, and whether the action ends the episode instead. Angles are in degrees."""

    pan_deg: float
    tilt_deg: float
    zoom_factor: float
    finish: bool


def move_space() -> spaces.Box[np.float32]:
    """Return the space of actions: pan, tilt, zoom and finish, each from -1 to 1."""
    return spaces.Box(-1.0, 1.0, (4,), np.float32)


def move_of(action: ArrayLike, scale: MoveScale) -> Move:
    """Convert an action to a move.

    Raises:
        InputError: The action is not four finite numbers. Numbers outside -1 to 1 are clipped.
    """
    try:
        values = np.asarray(action, dtype=np.float64)
    except (TypeError, ValueError):
        values = np.empty(0)
    if values.shape != (4,) or not np.isfinite(values).all():
        raise InputError(f"An action must be four finite numbers from -1 to 1 (pan, tilt, zoom, finish); got {action!r}.")
    pan, tilt, zoom, finish = np.clip(values, -1.0, 1.0).tolist()
    return Move(pan * scale.pan_deg, tilt * scale.tilt_deg, scale.zoom_factor**zoom, finish > FINISH_ABOVE)


def move_action(
    pan_deg: float = 0.0, tilt_deg: float = 0.0, zoom_factor: float = 1.0, *, finish: bool = False, scale: MoveScale | None = None
) -> NDArray[np.float32]:
    """Return the action for a relative move. Moves beyond the scale are clipped.

    Args:
        pan_deg: Degrees to turn right.
        tilt_deg: Degrees to turn up.
        zoom_factor: Factor by which to multiply the magnification.
        finish: Whether to end the episode instead of moving.
        scale: The scale of the environment; the default is ``MoveScale()``.

    Raises:
        InputError: A number is not finite, or the zoom factor is not positive.
    """
    scale = scale or MoveScale()
    if not all(map(math.isfinite, (pan_deg, tilt_deg, zoom_factor))) or zoom_factor <= 0:
        raise InputError(f"A move needs finite numbers and a positive zoom_factor; got {pan_deg}, {tilt_deg}, {zoom_factor}.")
    zoom = math.log(zoom_factor) / math.log(scale.zoom_factor)
    action = np.array([pan_deg / scale.pan_deg, tilt_deg / scale.tilt_deg, zoom, 1.0 if finish else -1.0])
    return np.asarray(np.clip(action, -1.0, 1.0), np.float32)
