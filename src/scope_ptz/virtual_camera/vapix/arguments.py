"""The arguments of a VAPIX request, with conversions whose errors name the invalid argument."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from scope_ptz.errors import InputError

MAX_SHOWN_CHARS = 60  # longer text from a client is truncated in error messages


class Arguments:
    """The arguments of a request. All conversions raise ``InputError`` for an invalid value.

    Args:
        values: Argument texts by name. If a request repeats a name, its first value is used.
    """

    def __init__(self, values: Mapping[str, str]) -> None:
        self._values = dict(values)

    def __contains__(self, name: str) -> bool:
        return name in self._values

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def items(self) -> Iterator[tuple[str, str]]:
        """Return pairs of name and text."""
        return iter(self._values.items())

    def text(self, name: str, default: str = "") -> str:
        """Return the text of an argument."""
        return self._values.get(name, default)

    def number(self, name: str, low: float, high: float) -> float:
        """Return a finite number, clamped to a range."""
        return min(max(self._numbers(name, 1)[0], low), high)

    def integer(self, name: str, low: int, high: int) -> int:
        """Return an integer, clamped to a range. Decimals are truncated, as AXIS documents."""
        return int(self.number(name, low, high))

    def numbers(self, name: str, count: int) -> tuple[float, ...]:
        """Return ``count`` finite numbers from a comma-separated list."""
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
            found = [float(part) for part in text.split(",")]
        except ValueError:
            found = []
        if len(found) != count or not all(map(math.isfinite, found)):
            what = "a number" if count == 1 else f"{count} numbers with commas between them"
            raise InputError(f"{name}: expected {what}, got {text[:MAX_SHOWN_CHARS]!r}")
        return found


def check_camera(arguments: Arguments) -> None:
    """Raise ``InputError`` if a request names a video channel other than the only one."""
    if "camera" in arguments and arguments.text("camera") not in ("1", "all"):
        raise InputError(f"camera: there is only camera 1, got {arguments.text('camera')[:MAX_SHOWN_CHARS]!r}")
