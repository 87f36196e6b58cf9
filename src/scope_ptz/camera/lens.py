"""Focus and iris: the actions of a lens, and the state that it reports."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from scope_ptz.errors import CameraError, InputError

FocusAction = Literal["auto", "manual", "once", "near", "far"]
"""Focus continuously, hold the focus, focus once and hold (one-push), or step nearer or farther and hold."""

IrisAction = Literal["auto", "manual", "open", "close"]
"""Let the camera set the iris, hold it, or step it open or closed and hold it."""

FOCUS_ACTIONS: tuple[FocusAction, ...] = get_args(FocusAction)
IRIS_ACTIONS: tuple[IrisAction, ...] = get_args(IrisAction)

DEFAULT_STEP = 0.05
"""Default length of a step, as a fraction of the range."""


@dataclass(frozen=True, slots=True)
class LensState:
    """The state that a lens reports. None means that the camera does not report the value.

    Attributes:
        autofocus: Whether the camera focuses automatically.
        focus: Position of the focus from 0 (nearest) to 1 (farthest).
        autoiris: Whether the camera sets its iris automatically.
        iris: Opening of the iris from 0 (closed) to 1 (open).
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


def _check(camera: str, what: str, action: str, known: tuple[str, ...], offered: tuple[str, ...], step: float) -> None:
    if action not in known:
        raise InputError(f"The {what} can be set to {', '.join(known)}; got {action[:40]!r}.")
    if not 0 < step <= 1:
        raise InputError(f"A step of the {what} must be above 0 and at most 1 (the whole range); got {step}.")
    if not offered:
        raise CameraError(f"The {what} of {camera} cannot be set.")
    if action not in offered:
        raise CameraError(f"The {what} of {camera} cannot be set to '{action}'. It offers {', '.join(offered)}.")
