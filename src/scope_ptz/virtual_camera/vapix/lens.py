"""Focus and iris commands in ``ptz.cgi``, with positions from 1 to 9999."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scope_ptz.virtual_camera.vapix.arguments import Arguments

if TYPE_CHECKING:
    from scope_ptz.virtual_camera.lens import VirtualLens

MAX_POSITION = 9999
COMMANDS = ("focus", "rfocus", "continuousfocusmove", "autofocus", "iris", "riris", "autoiris")
"""Arguments of ``ptz.cgi`` that adjust the lens."""

LIMITS = {"MinIris": 1, "MaxIris": MAX_POSITION, "MinFocus": 1, "MaxFocus": MAX_POSITION}

_ON_OFF = ("on", "off")


def state(lens: VirtualLens) -> dict[str, object]:
    """Return the lens values for the reply to ``query=position``."""
    return {
        "iris": _position(lens.iris),
        "focus": _position(lens.focus),
        "autofocus": "on" if lens.autofocus else "off",
        "autoiris": "on" if lens.autoiris else "off",
    }


def adjust(lens: VirtualLens, arguments: Arguments) -> None:
    """Carry out the focus and iris commands in a request. A manual command turns the automatic mode off.

    Raises:
        InputError: An argument is invalid. In this case, nothing changes.
    """
    numbers = {
        name: arguments.number(name, low, high) for name, (low, high) in _RANGES.items() if name in arguments
    }  # validate all values before applying any
    switches = {name: arguments.choice(name, _ON_OFF) == "on" for name in ("autofocus", "autoiris") if name in arguments}
    if "autofocus" in switches:
        lens.set_autofocus(on=switches["autofocus"])
    if "autoiris" in switches:
        lens.set_autoiris(on=switches["autoiris"])
    if "focus" in numbers:
        lens.move_focus(_fraction(numbers["focus"]))
    if "rfocus" in numbers:
        lens.move_focus(lens.focus + numbers["rfocus"] / (MAX_POSITION - 1))
    if "continuousfocusmove" in numbers:
        lens.drive_focus(numbers["continuousfocusmove"] / 100)
    if "iris" in numbers:
        lens.set_iris(_fraction(numbers["iris"]))
    if "riris" in numbers:
        lens.set_iris(lens.iris + numbers["riris"] / (MAX_POSITION - 1))


_RANGES = {
    "focus": (1, MAX_POSITION),
    "rfocus": (-MAX_POSITION, MAX_POSITION),
    "continuousfocusmove": (-100, 100),
    "iris": (1, MAX_POSITION),
    "riris": (-MAX_POSITION, MAX_POSITION),
}


def _position(fraction: float) -> int:
    return round(1 + fraction * (MAX_POSITION - 1))


def _fraction(position: float) -> float:
    return (position - 1) / (MAX_POSITION - 1)
