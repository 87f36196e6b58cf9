"""The interface of a camera's clock, and the clock of real cameras."""

from __future__ import annotations

from time import monotonic
from typing import Protocol


class Clock(Protocol):
    """A camera's clock: real time, or the time of a simulated scene."""

    def now_s(self) -> float: ...

    async def sleep(self, seconds: float) -> None:
        """Wait for a number of seconds on this clock."""
        ...


def elapsed_s(clock: Clock) -> float:
    """Return a clock's elapsed seconds, which advance even if scene time is paused or runs at a different speed."""
    return float(getattr(clock, "elapsed_s", clock.now_s)())


class WallClock:
    """A clock for real cameras, which starts at zero and runs in real time."""

    def __init__(self) -> None:
        self._started_s = monotonic()

    def now_s(self) -> float:
        """Return the seconds since the clock was created."""
        return monotonic() - self._started_s

    async def sleep(self, seconds: float) -> None:
        """Wait for a number of seconds."""
        import anyio

        await anyio.sleep(max(0.0, seconds))
