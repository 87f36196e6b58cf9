"""Focus and iris: the actions of a lens, and the state that it reports."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from scope_ptz.errors import CameraError, InputError

FocusAction = Literal["auto", "manual", "once", "near", "far"]
"""A focus action: focus continuously, hold the focus, focus once and hold it (one-push), or step nearer or farther and hold it."""

IrisAction = Literal["auto", "manual", "open", "close"]
"""An iris action: let the camera control the iris, hold the iris, or step it open or closed and hold it."""

FOCUS_ACTIONS: tuple[FocusAction, ...] = get_args(FocusAction)
IRIS_ACTIONS: tuple[IrisAction, ...] = get_args(IrisAction)

DEFAULT_STEP = 0.05
"""Default length of a step, as a fraction of the range."""


@dataclass(frozen=True, slots=True)
class LensState:
    """The reported state of a lens. A value is None if the camera does not report it.

    Attributes:
        autofocus: Whether the camera focuses automatically.
        focus: Focus position, from 0 (nearest) to 1 (farthest).
        autoiris: Whether the camera controls its iris automatically.
        iris: Iris opening, from 0 (closed) to 1 (open).
    """

    autofocus: bool | None = None
    focus: float | None = None
    autoiris: bool | None = None
    iris: float | None = None


def check_focus(camera: str, action: str, offered: tuple[FocusAction, ...], step: float) -> None:
    """Check the arguments of ``Camera.set_focus``.

    Raises:
        InputError: The action is unknown, or the step is not above 0 and at most 1.
        CameraError: The camera does not offer the action.
    """
    _check(camera, "focus", action, FOCUS_ACTIONS, offered, step)


def check_iris(camera: str, action: str, offered: tuple[IrisAction, ...], step: float) -> None:
    """Check the arguments of ``Camera.set_iris``.

    Raises:
        InputError: The action is unknown, or the step is not above 0 and at most 1.
        CameraError: The camera does not offer the action.
    """
    _check(camera, "iris", action, IRIS_ACTIONS, offered, step)


def _check(camera: str, setting: str, action: str, known: tuple[str, ...], offered: tuple[str, ...], step: float) -> None:
    if action not in known:
        raise InputError(f"The {setting} can be set to {', '.join(known)}; got {action[:40]!r}.")
    if not 0 < step <= 1:
        raise InputError(f"A {setting} step must be above 0 and at most 1 (the whole range); got {step}.")
    if not offered:
        raise CameraError(f"The {setting} of {camera} cannot be set.")
    if action not in offered:
        raise CameraError(f"The {setting} of {camera} cannot be set to '{action}'. Supported actions: {', '.join(offered)}.")
