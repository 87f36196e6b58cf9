"""The clock of a camera, and the clock of cameras in the real world."""

from __future__ import annotations

from time import monotonic
from typing import Protocol


class Clock(Protocol):
    """The time of the camera's world, in seconds."""

    def now_s(self) -> float: ...

    async def sleep(self, seconds: float) -> None:
        """Wait for a duration of the camera's world, in seconds."""
        ...


def elapsed_s(clock: Clock) -> float:
    """Return seconds that pass at their own pace, also while scene time is stopped or has another speed."""
    return float(getattr(clock, "elapsed_s", clock.now_s)())


class WallClock:
    """A clock for cameras in the real world. It starts at zero and follows the wall clock."""

    def __init__(self) -> None:
        self._started_s = monotonic()

    def now_s(self) -> float:
        """Return the seconds since the clock was created."""
        return monotonic() - self._started_s

    async def sleep(self, seconds: float) -> None:
        """Wait for a number of seconds."""
        import anyio

        await anyio.sleep(max(0.0, seconds))
