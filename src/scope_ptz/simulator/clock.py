"""The scene clock. It follows the wall clock in real-time mode; otherwise it advances only when ``sleep`` is called."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic

import anyio
import anyio.lowlevel

from scope_ptz.errors import InputError

MIN_SPEED, MAX_SPEED = 0.1, 10.0
"""Minimum and maximum speed of scene time relative to motor time."""

MAX_TIME_S = 86_400.0
"""The latest scene time to which a clock can be set, in seconds (one day)."""


def check_time(time_s: float) -> None:
    """Check a scene time in seconds.

    Raises:
        InputError: The time is not between 0 s and one day.
    """
    if not 0.0 <= time_s <= MAX_TIME_S:  # also false for NaN
        raise InputError(f"Scene time must be from 0 to {MAX_TIME_S:g} seconds; got {time_s}.")


def check_speed(speed: float) -> None:
    """Check a speed of scene time.

    Raises:
        InputError: The speed is not between 0.1 and 10.
    """
    if not MIN_SPEED <= speed <= MAX_SPEED:
        raise InputError(f"The speed of scene time must be from {MIN_SPEED:g} to {MAX_SPEED:g}; got {speed}.")


class SceneClock:
    """A clock that measures scene time in seconds.

    In an evaluation, sleeping advances the clock instantly. In real-time mode, the clock follows the wall clock.

    Viewers can pause scene time, seek, and change the speed. The camera's motors are not affected.
    """

    def __init__(self, start_s: float = 0.0, *, realtime: bool = False) -> None:
        self._realtime = realtime
        self._wall_start_s = monotonic()
        self._slept_s = 0.0
        self._base_s = 0.0
        self._held_s = -start_s
        self._speed = 1.0
        self._stopped_at_s = 0.0
        self._stops = 0
        self._holds = 0
        self._playing = True

    def now_s(self) -> float:
        """Return the scene time in seconds, which determines where actors are. It stops while the clock is held or paused."""
        passed_s = (self._stopped_at_s if self._stops else self.elapsed_s()) - self._base_s
        return passed_s * self._speed - self._held_s

    @property
    def held(self) -> bool:
        """Whether the clock is inside a ``hold`` context. A paused clock is not held, so moves still take time."""
        return self._holds > 0

    @property
    def playing(self) -> bool:
        """Whether scene time passes whenever the clock is not held. False after ``pause``."""
        return self._playing

    @property
    def speed(self) -> float:
        """The speed of scene time relative to motor time."""
        return self._speed

    def elapsed_s(self) -> float:
        """Return the motor time: seconds since the clock was created, including the time while it was held."""
        return monotonic() - self._wall_start_s if self._realtime else self._slept_s

    async def sleep(self, seconds: float) -> None:
        """Wait for a number of seconds of motor time. Outside real-time mode, this advances the clock and returns immediately."""
        if self._realtime:
            await anyio.sleep(max(0.0, seconds))
        else:
            self._slept_s += max(0.0, seconds)
            await anyio.lowlevel.checkpoint()

    @contextmanager
    def hold(self) -> Iterator[None]:
        """Stop scene time while the context is open. Holds may be nested."""
        self._holds += 1
        self._stop()
        try:
            yield
        finally:
            self._holds -= 1
            self._continue()

    def play(self) -> None:
        """Resume scene time after ``pause``. The call has no effect if scene time is not paused."""
        if not self._playing:
            self._playing = True
            self._continue()

    def pause(self) -> None:
        """Stop scene time until ``play`` is called."""
        if self._playing:
            self._playing = False
            self._stop()

    def seek(self, time_s: float) -> None:
        """Set the scene time, which may be earlier or later than the current time.

        Raises:
            InputError: The time is not between 0 s and one day.
        """
        check_time(time_s)
        self._start_from(time_s, self._speed)

    def set_speed(self, speed: float) -> None:
        """Change the speed of scene time, starting now.

        Raises:
            InputError: The speed is not between 0.1 and 10.
        """
        check_speed(speed)
        self._start_from(self.now_s(), speed)

    def _start_from(self, time_s: float, speed: float) -> None:
        self._base_s = self._stopped_at_s = self.elapsed_s()
        self._held_s, self._speed = -time_s, speed

    def _stop(self) -> None:
        if not self._stops:
            self._stopped_at_s = self.elapsed_s()
        self._stops += 1

    def _continue(self) -> None:
        self._stops -= 1
        if not self._stops:
            self._held_s += (self.elapsed_s() - self._stopped_at_s) * self._speed
