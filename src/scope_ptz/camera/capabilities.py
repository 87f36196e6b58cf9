"""Optional camera capabilities beyond moving to a pose and taking a picture, with checks for their arguments."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from scope_ptz.camera.lens import FocusAction, IrisAction
from scope_ptz.errors import InputError

MAX_PRESET_NAME = 31
"""Maximum length of a preset name in characters: the limit of AXIS cameras, applied to all cameras."""

MAX_DRIVE_TIMEOUT_S = 10.0
"""Maximum time in seconds for which a driven camera keeps moving without another command."""


@dataclass(frozen=True, slots=True)
class Velocity:
    """A velocity: pan and tilt in degrees per second, zoom in octaves (doublings of magnification) per second."""

    pan_dps: float = 0.0
    tilt_dps: float = 0.0
    zoom_rate: float = 0.0


@dataclass(frozen=True, slots=True)
class Capabilities:
    """The capabilities of a camera beyond moving to a pose and taking a picture.

    Attributes:
        top_speed: The maximum velocity for ``drive``; an axis with a maximum of 0 cannot be driven.
        edits_presets: Whether presets can be saved and removed.
        focus: The supported actions of ``set_focus``; empty if the focus cannot be set.
        iris: The supported actions of ``set_iris``; empty if the iris cannot be set.
    """

    top_speed: Velocity = field(default_factory=Velocity)
    edits_presets: bool = False
    focus: tuple[FocusAction, ...] = ()
    iris: tuple[IrisAction, ...] = ()

    @property
    def drives(self) -> bool:
        """Whether at least one axis can be driven."""
        return self.top_speed != Velocity()


NO_CAPABILITIES = Capabilities()
"""The capabilities of a camera that only moves to poses and takes pictures."""


def check_drive(pan_dps: float, tilt_dps: float, zoom_rate: float, timeout_s: float) -> None:
    """Check the arguments of ``Camera.drive``.

    Raises:
        InputError: A number is not finite, or the timeout is not between 0 and 10 s.
    """
    for name, value in (("pan_dps", pan_dps), ("tilt_dps", tilt_dps), ("zoom_rate", zoom_rate)):
        if not math.isfinite(value):
            raise InputError(f"{name} must be a finite number; got {value}.")
    if not 0 < timeout_s <= MAX_DRIVE_TIMEOUT_S:
        raise InputError(f"timeout_s must be above 0 and at most {MAX_DRIVE_TIMEOUT_S:g} seconds; got {timeout_s}.")


def check_preset_name(name: str) -> None:
    """Check the name of a new preset.

    Raises:
        InputError: The name is empty or too long, or contains unprintable characters.
    """
    if not name.strip() or name != name.strip() or not name.isprintable() or len(name) > MAX_PRESET_NAME:
        raise InputError(
            f"A preset name must have 1 to {MAX_PRESET_NAME} printable characters, without spaces at either end; got {name[:60]!r}."
        )
