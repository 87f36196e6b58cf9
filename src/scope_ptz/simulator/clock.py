"""The scene clock: explicit scene time, which follows the wall clock only when a person watches."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic

import anyio
import anyio.lowlevel


class SceneClock:
    """A clock in seconds of scene time.

    In evaluation, sleeping advances the clock at once. In real time, the clock follows the wall clock.
    """

    def __init__(self, start_s: float = 0.0, *, realtime: bool = False) -> None:
        self._realtime = realtime
        self._wall_start_s = monotonic()
        self._slept_s = 0.0
        self._held_s = -start_s
        self._hold_since_s = 0.0
        self._holds = 0

    def now_s(self) -> float:
        """Return the scene time, which moves the actors. It stands still while held."""
        return (self._hold_since_s if self._holds else self.elapsed_s()) - self._held_s

    @property
    def held(self) -> bool:
        return self._holds > 0

    def elapsed_s(self) -> float:
        """Return the seconds that have passed for the camera's motors since the clock was created, even while held."""
        return monotonic() - self._wall_start_s if self._realtime else self._slept_s

    async def sleep(self, seconds: float) -> None:
        """Let the given number of seconds pass."""
        if self._realtime:
            await anyio.sleep(max(0.0, seconds))
        else:
            self._slept_s += max(0.0, seconds)
            await anyio.lowlevel.checkpoint()

    @contextmanager
    def hold(self) -> Iterator[None]:
        """Stop scene time while the context is open. Holds may be nested."""
        if not self._holds:
            self._hold_since_s = self.elapsed_s()
        self._holds += 1
        try:
            yield
        finally:
            self._holds -= 1
            if not self._holds:
                self._held_s += self.elapsed_s() - self._hold_since_s
