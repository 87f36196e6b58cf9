"""Scene time: explicit, and only as fast as somebody watches."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic

import anyio
import anyio.lowlevel


class SceneClock:
    """Seconds of scene time. In evaluation it advances at once by what is slept; watched by a person it follows the wall clock."""

    def __init__(self, start_s: float = 0.0, *, realtime: bool = False) -> None:
        self._realtime = realtime
        self._wall_start_s = monotonic()
        self._slept_s = 0.0
        self._held_s = -start_s
        self._hold_since_s = 0.0
        self._holds = 0

    def now_s(self) -> float:
        """Scene time, in which actors move; it stands still while held."""
        return (self._hold_since_s if self._holds else self.elapsed_s()) - self._held_s

    @property
    def held(self) -> bool:
        return self._holds > 0

    def elapsed_s(self) -> float:
        """Time that has gone by for the camera's own motors since the clock was made, held or not."""
        return monotonic() - self._wall_start_s if self._realtime else self._slept_s

    async def sleep(self, seconds: float) -> None:
        """Let that much time go by."""
        if self._realtime:
            await anyio.sleep(max(0.0, seconds))
        else:
            self._slept_s += max(0.0, seconds)
            await anyio.lowlevel.checkpoint()

    @contextmanager
    def hold(self) -> Iterator[None]:
        """While this is open scene time stands still. Holds nest."""
        if not self._holds:
            self._hold_since_s = self.elapsed_s()
        self._holds += 1
        try:
            yield
        finally:
            self._holds -= 1
            if not self._holds:
                self._held_s += self.elapsed_s() - self._hold_since_s
