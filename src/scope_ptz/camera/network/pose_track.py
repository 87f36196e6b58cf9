"""The recent poses of a camera, from which the pose at an exposure is interpolated."""

from __future__ import annotations

from bisect import bisect_left
from collections import deque

from scope_ptz.geometry import Pose, wrap_pan_deg

MAX_SAMPLES = 128
"""About ten seconds of readings."""


class PoseTrack:
    """Readings of the position with their times, newest last. Times are seconds on any one clock and never go back."""

    def __init__(self) -> None:
        self._samples: deque[tuple[float, Pose]] = deque(maxlen=MAX_SAMPLES)

    @property
    def newest_s(self) -> float:
        """Time of the newest reading; minus infinity if there is none."""
        return self._samples[-1][0] if self._samples else float("-inf")

    def add(self, time_s: float, pose: Pose) -> None:
        """Add a reading."""
        if time_s > self.newest_s:
            self._samples.append((time_s, pose))

    def at(self, time_s: float) -> Pose:
        """Return the pose at a time, interpolated between the readings around it; the nearest one outside of them.

        Raises:
            ValueError: There is no reading.
        """
        if not self._samples:
            raise ValueError("a pose track without readings has no pose")
        times = [sample_s for sample_s, _ in self._samples]
        index = bisect_left(times, time_s)
        if index == 0:
            return self._samples[0][1]
        if index == len(times):
            return self._samples[-1][1]
        (before_s, before), (after_s, after) = self._samples[index - 1], self._samples[index]
        share = (time_s - before_s) / (after_s - before_s)
        pan_deg = before.pan_deg + share * wrap_pan_deg(after.pan_deg - before.pan_deg)
        return Pose(
            pan_deg
            if before.pan_deg <= pan_deg <= after.pan_deg or after.pan_deg <= pan_deg <= before.pan_deg
            else wrap_pan_deg(pan_deg),
            before.tilt_deg + share * (after.tilt_deg - before.tilt_deg),
            before.zoom * (after.zoom / before.zoom) ** share,
        )
