"""The recent poses of a camera, from which the pose at an exposure is interpolated."""

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
"""Maximum number of readings to keep, which cover about six seconds."""

POLL_S = 0.05
"""Seconds between two readings. At 400 degrees/s², linear interpolation between them is off by at most 0.13 degrees."""

RETRY_S = 0.25
"""Seconds before the next reading while the device cannot be reached."""


class PoseTrack:
    """Readings of the pose with their times, newest last. Times are seconds on a single clock and never decrease."""

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
        """Add a reading. It is ignored unless it is newer than the newest one."""
        if time_s > self.newest_s:
            self._samples.append((time_s, pose))

    def clear(self) -> None:
        """Forget all readings. After an outage, nobody knows how the camera moved in the meantime."""
        self._samples.clear()

    def at(self, time_s: float) -> Pose:
        """Return the pose at a time, interpolated between readings. Outside the readings, return the nearest.

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
    """Reads the pose repeatedly while a stream is open. Close it with the stream.

    If the device cannot be reached, the readings continue after the outage.

    Attributes:
        problem: Why the pose cannot be read at present; empty if it can.

    Args:
        read_pose: Reads the pose.
        give_up_s: Seconds without a reading after which the device is lost.
    """

    def __init__(self, read_pose: Callable[[], Awaitable[Pose]], *, give_up_s: float = GIVE_UP_S) -> None:
        self._read_pose, self._give_up_s, self._track = read_pose, give_up_s, PoseTrack()
        self.problem = ""
        self._changed = asyncio.Event()
        self._failure: Exception | None = None
        self._task = asyncio.get_running_loop().create_task(self._poll())

    async def at(self, time_s: float) -> Pose | None:
        """Return the pose at a time on ``time.monotonic``; None if it is before the first reading, or the first after an outage.

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
        """Stop reading and wait until the last reading has ended."""
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
                # The device reads its encoders somewhere between the request and the reply.
                self._track.add((before_s + read_s) / 2, pose)
                self._changed.set()
                await asyncio.sleep(POLL_S)
        except Exception as error:  # any failure must reach the consumer of the stream
            self._failure = error
            self._changed.set()
