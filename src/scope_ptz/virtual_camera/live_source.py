"""A device's live video. Each frame is exposed once for all streams, and only while at least one client is watching."""

from __future__ import annotations

from collections import deque
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from time import monotonic

import anyio
from anyio import to_thread
from anyio.abc import TaskGroup

from scope_ptz.virtual_camera.device import Exposure, VirtualDevice


class LiveSource:
    """Exposes frames at a constant rate and provides the newest one to every subscriber.

    A slow subscriber misses frames but does not delay the others. Frames are exposed only while ``run`` is running.

    Args:
        device: The camera.
        rate_hz: Frames per second.
        latency_s: Simulated delay in seconds from the exposure of a frame to its delivery, like that of a real camera's encoder.
    """

    def __init__(self, device: VirtualDevice, *, rate_hz: float = 25.0, latency_s: float = 0.0) -> None:
        self.device, self.rate_hz, self.latency_s = device, rate_hz, latency_s
        self.skipped_frames = 0
        """Number of frames that were skipped because earlier exposures took too long."""
        self._newest: Exposure | None = None
        self._number = 0
        self._changed = anyio.Event()
        self._has_subscribers = anyio.Event()
        self._subscribers = 0

    @property
    def subscribers(self) -> int:
        """Number of clients that are watching."""
        return self._subscribers

    async def run(self) -> None:
        """Expose frames whenever at least one client is watching. Run this in a task group, and cancel it to stop."""
        while True:
            await self._has_subscribers.wait()
            async with anyio.create_task_group() as group:
                await self._expose_while_watched(group)

    @asynccontextmanager
    async def subscribe(self) -> AsyncIterator[AsyncIterator[Exposure]]:
        """Return a context manager that provides an endless iterator over exposures. Each step waits for a new frame."""
        self._subscribers += 1
        self._has_subscribers.set()
        try:
            yield self._exposures()
        finally:
            self._subscribers -= 1
            if not self._subscribers:
                self._has_subscribers = anyio.Event()
                self._newest = None

    async def _exposures(self) -> AsyncIterator[Exposure]:
        last_number = self._number if self._newest is None else self._number - 1
        while True:
            while self._number == last_number or self._newest is None:
                await self._changed.wait()
            last_number = self._number
            yield self._newest

    async def _expose_while_watched(self, group: TaskGroup) -> None:
        period_s, due_s = 1.0 / self.rate_hz, monotonic()
        delayed: deque[Exposure] = deque()
        while self._subscribers:
            exposure = await to_thread.run_sync(self.device.expose)
            if self.latency_s:
                delayed.append(exposure)
                group.start_soon(self._publish_later, delayed)
            else:
                self._publish(exposure)
            due_s += period_s
            if (behind_s := monotonic() - due_s) > 0:
                skipped = int(behind_s / period_s)
                self.skipped_frames += skipped
                due_s += skipped * period_s
            await anyio.sleep(max(0.0, due_s - monotonic()))
        group.cancel_scope.cancel()

    async def _publish_later(self, delayed: deque[Exposure]) -> None:
        exposure = delayed.popleft()
        await anyio.sleep(max(0.0, exposure.taken_s + self.latency_s - monotonic()))
        self._publish(exposure)

    def _publish(self, exposure: Exposure) -> None:
        self._newest = exposure
        self._number += 1
        changed, self._changed = self._changed, anyio.Event()
        changed.set()
