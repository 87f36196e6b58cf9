"""The arguments of a VAPIX request, and their conversion to numbers and words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from scope_ptz.errors import InputError

MAX_SHOWN_CHARS = 60  # longer text from a client is truncated in error messages


class Arguments:
    """The arguments of a request. If a value is invalid, conversions raise an ``InputError`` that names the argument.

    Args:
        values: The text of each argument, by name.
    """

    def __init__(self, values: Mapping[str, str]) -> None:
        self._values = dict(values)

    def __contains__(self, name: str) -> bool:
        return name in self._values

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def items(self) -> Iterator[tuple[str, str]]:
        """Return the arguments as pairs of name and text."""
        return iter(self._values.items())

    def text(self, name: str, default: str = "") -> str:
        """Return the text of an argument."""
        return self._values.get(name, default)

    def number(self, name: str, low: float, high: float) -> float:
        """Return an argument as a finite number, clamped to a range."""
        return min(max(self._numbers(name, 1)[0], low), high)

    def integer(self, name: str, low: int, high: int) -> int:
        """Return an argument as an integer, clamped to a range. Any fractional part is dropped, as AXIS specifies."""
        return int(self.number(name, low, high))

    def numbers(self, name: str, count: int) -> tuple[float, ...]:
        """Parse a comma-separated argument as ``count`` finite numbers."""
        return tuple(self._numbers(name, count))

    def choice(self, name: str, known: tuple[str, ...]) -> str:
        """Return an argument that must be one of the known words."""
        value = self._values[name]
        if value not in known:
            raise InputError(f"{name}: unknown value: {value[:MAX_SHOWN_CHARS]}")
        return value

    def _numbers(self, name: str, count: int) -> list[float]:
        text = self._values[name]
        try:
            numbers = [float(part) for part in text.split(",")]
        except ValueError:
            numbers = []
        if len(numbers) != count or not all(map(math.isfinite, numbers)):
            expected = "a number" if count == 1 else f"{count} comma-separated numbers"
            raise InputError(f"{name}: expected {expected}, got {text[:MAX_SHOWN_CHARS]!r}")
        return numbers


def check_camera(arguments: Arguments) -> None:
    """Raise ``InputError`` if a request names a video channel that does not exist."""
    if "camera" in arguments and arguments.text("camera") not in ("1", "all"):
        raise InputError(f"camera: the only camera is 1, got {arguments.text('camera')[:MAX_SHOWN_CHARS]!r}")
