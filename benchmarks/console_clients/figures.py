"""Statistics of measured times, and the wake-up delay of a sleeping thread, which shows how busy the machine is."""

from __future__ import annotations

import math
import statistics
import threading
import time


class WakeUpDelays:
    """Measures how late a sleeping thread wakes up. Long delays mean that the machine is busy."""

    STEP_S = 0.02  # duration of each sleep

    def __init__(self) -> None:
        self.delays_s: list[float] = []
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def _watch(self) -> None:
        while not self._ended.is_set():
            before_s = time.monotonic()
            time.sleep(self.STEP_S)
            self.delays_s.append(time.monotonic() - before_s - self.STEP_S)

    def end(self) -> list[float]:
        """Stop the thread and return its wake-up delays in seconds."""
        self._ended.set()
        self._thread.join()
        return self.delays_s


def quantiles(values: list[float]) -> dict[str, float]:
    """Return the median, the 95th percentile, the maximum and the count of a list of values."""
    ordered = sorted(values)
    return {
        "median": statistics.median(ordered),
        "p95": ordered[math.ceil(0.95 * len(ordered)) - 1],
        "most": ordered[-1],
        "count": len(ordered),
    }


def in_ms(figures: dict[str, float]) -> str:
    """Format quantiles in milliseconds."""
    median, p95, maximum = (f"{1000 * figures[name]:.0f} ms" for name in ("median", "p95", "most"))
    return f"median {median}, 95th percentile {p95}, maximum {maximum}"
