"""A camera's recent poses, from which the pose at the time of exposure is interpolated."""

from __future__ import annotations

import asyncio
from bisect import bisect_left
from collections import deque
from collections.abc import Awaitable, Callable
from contextlib import suppress
from time import monotonic

from scope_ptz.camera.network.errors import CameraTimeoutError, CameraUnreachableError
from scope_ptz.camera.network.streams import GIVE_UP_S
from scope_ptz.geometry import Pose, wrap_pan_deg

MAX_SAMPLES = 128
"""Maximum number of readings to keep; they cover about six seconds."""

POLL_S = 0.05
"""Seconds between readings. At 400 degrees/s², linear interpolation between them has an error of at most 0.13 degrees."""

RETRY_S = 0.25
"""Seconds between attempts while the device cannot be reached."""


class PoseTrack:
    """Pose readings in order of time. All times are in seconds on the same clock."""

    def __init__(self) -> None:
        self._samples: deque[tuple[float, Pose]] = deque(maxlen=MAX_SAMPLES)

    @property
    def oldest_s(self) -> float:
        """Time of the oldest reading; infinity if there is none."""
        return self._samples[0][0] if self._samples else float("inf")

    @property
    def newest_s(self) -> float:
        """Time of the newest reading; minus infinity if there is none."""
        return self._samples[-1][0] if self._samples else float("-inf")

    def add(self, time_s: float, pose: Pose) -> None:
        """Add a reading. It is ignored unless it is newer than all others."""
        if time_s > self.newest_s:
            self._samples.append((time_s, pose))

    def clear(self) -> None:
        """Discard all readings, for example because the camera's motion during an outage is unknown."""
        self._samples.clear()

    def at(self, time_s: float) -> Pose:
        """Return the pose at a time, interpolated between readings. Before the first or after the last one, return the nearest.

        Raises:
            ValueError: There are no readings.
        """
        if not self._samples:
            raise ValueError("a pose track must have a reading before it can return a pose")
        times = [sample_s for sample_s, _ in self._samples]
        index = bisect_left(times, time_s)
        if index == 0:
            return self._samples[0][1]
        if index == len(times):
            return self._samples[-1][1]
        (before_s, before), (after_s, after) = self._samples[index - 1], self._samples[index]
        fraction = (time_s - before_s) / (after_s - before_s)
        pan_deg = before.pan_deg + fraction * wrap_pan_deg(after.pan_deg - before.pan_deg)
        return Pose(
            pan_deg
            if before.pan_deg <= pan_deg <= after.pan_deg or after.pan_deg <= pan_deg <= before.pan_deg
            else wrap_pan_deg(pan_deg),
            before.tilt_deg + fraction * (after.tilt_deg - before.tilt_deg),
            before.zoom * (after.zoom / before.zoom) ** fraction,
        )


class PosePoller:
    """Reads the pose repeatedly while a stream is open. Close it together with the stream.

    If the device cannot be reached, polling resumes after the outage.

    Attributes:
        problem: The reason why the pose cannot be read; empty while it can.

    Args:
        read_pose: A function that reads the pose.
        give_up_s: Seconds without a reading after which the device counts as lost.
    """

    def __init__(self, read_pose: Callable[[], Awaitable[Pose]], *, give_up_s: float = GIVE_UP_S) -> None:
        self._read_pose, self._give_up_s, self._track = read_pose, give_up_s, PoseTrack()
        self.problem = ""
        self._changed = asyncio.Event()
        self._failure: Exception | None = None
        self._task = asyncio.get_running_loop().create_task(self._poll())

    async def at(self, time_s: float) -> Pose | None:
        """Return the pose at a ``time.monotonic`` time; None if the time is before the first reading, or the first after an outage.

        Raises:
            CameraError: The pose cannot be read.
        """
        while self._track.newest_s < time_s:
            if self._failure is not None:
                raise self._failure
            self._changed.clear()
            await self._changed.wait()
        return None if time_s < self._track.oldest_s else self._track.at(time_s)

    async def close(self) -> None:
        """Stop polling, and wait until the last reading has ended."""
        self._task.cancel()
        with suppress(asyncio.CancelledError):
            await self._task

    async def _poll(self) -> None:
        read_s = monotonic()
        try:
            while True:
                before_s = monotonic()
                try:
                    pose = await self._read_pose()
                except (CameraUnreachableError, CameraTimeoutError) as error:
                    if monotonic() - read_s > self._give_up_s:
                        raise
                    self.problem = str(error)
                    self._track.clear()
                    await asyncio.sleep(RETRY_S)
                    continue
                self.problem, read_s = "", monotonic()
                # The device reads its encoders at some point between the request and the reply.
                self._track.add((before_s + read_s) / 2, pose)
                self._changed.set()
                await asyncio.sleep(POLL_S)
        except Exception as error:  # every failure must reach the stream's consumer
            self._failure = error
            self._changed.set()
