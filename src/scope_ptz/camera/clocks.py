"""The interface of a camera's clock, and the clock of real cameras."""

from __future__ import annotations

from time import monotonic
from typing import Protocol


class Clock(Protocol):
    """The time of the camera's world, in seconds."""

    def now_s(self) -> float: ...

    async def sleep(self, seconds: float) -> None:
        """Wait for a number of seconds of the camera's world."""
        ...


def elapsed_s(clock: Clock) -> float:
    """Return the elapsed seconds of a clock, which advance even if scene time is stopped or runs at another speed."""
    return float(getattr(clock, "elapsed_s", clock.now_s)())


class WallClock:
    """A clock for real cameras. It starts at zero and runs in real time."""

    def __init__(self) -> None:
        self._started_s = monotonic()

    def now_s(self) -> float:
        """Return the seconds since the clock was created."""
        return monotonic() - self._started_s

    async def sleep(self, seconds: float) -> None:
        """Wait for a number of seconds."""
        import anyio

        await anyio.sleep(max(0.0, seconds))
