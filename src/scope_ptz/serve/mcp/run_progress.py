"""Wait for a run on behalf of a client, with progress, and cancel the run if the client cancels its call."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable
from contextlib import aclosing, suppress
from time import monotonic

import anyio

from scope_ptz.agent.records import Called, Decided, Ended, Started
from scope_ptz.errors import ScopeError
from scope_ptz.planner.base import CallTools
from scope_ptz.serve.mcp.tool import CallContext
from scope_ptz.serve.site.run_handle import Record, RunHandle
from scope_ptz.serve.site.station import Station

HEARTBEAT_S = 2.0
"""Seconds between progress notifications while nothing else is reported. Many clients abort calls that report no progress."""


async def follow(call: CallContext, station: Station, start: Awaitable[RunHandle]) -> RunHandle:
    """Start a run, wait until it has ended, and return its handle.

    If the call is cancelled or the server shuts down, the run is cancelled, which stops the camera.

    Args:
        call: The call, whose client receives the progress.
        station: The camera.
        start: Starts the run. A camera's first run opens the camera, which can take a while.
    """
    sender, handle = _ProgressSender(call), None
    heartbeat = asyncio.ensure_future(_report_time(sender, station))
    try:
        handle = await start
        async with anyio.create_task_group() as group:
            group.start_soon(_cancel_when_closing, call.site.closing, handle)
            await _report_records(sender, handle)
            group.cancel_scope.cancel()
    finally:
        heartbeat.cancel()
        with anyio.CancelScope(shield=True):
            await asyncio.gather(heartbeat, return_exceptions=True)
            if handle is not None and not handle.done.is_set():
                handle.cancel()
                await handle.done.wait()
    return handle


class _ProgressSender:
    """Numbers a call's notifications, because their progress must increase."""

    def __init__(self, call: CallContext) -> None:
        self._call, self._number, self._started_s = call, 0, monotonic()

    @property
    def elapsed_s(self) -> float:
        return monotonic() - self._started_s

    async def send(self, message: str) -> None:
        self._number += 1
        await self._call.progress(float(self._number), message)


async def _report_records(sender: _ProgressSender, handle: RunHandle) -> None:
    """Report a run's records until the run has ended."""
    async with aclosing(handle.events()) as events:
        async for event in events:
            await sender.send(record_text(event.record))


async def _report_time(sender: _ProgressSender, station: Station) -> None:
    while True:
        await anyio.sleep(HEARTBEAT_S)
        camera_note = "; the camera is being opened"
        if (opened := station.open_camera) is not None:
            with suppress(ScopeError):
                pose = (await opened.camera.pose()).as_dict()
                camera_note = f"; the camera is at pan {pose['pan_deg']:g}, tilt {pose['tilt_deg']:g}, zoom {pose['zoom']:g}x"
        await sender.send(f"In progress for {sender.elapsed_s:.0f} s{camera_note}.")


async def _cancel_when_closing(closing: asyncio.Event, handle: RunHandle) -> None:
    await closing.wait()
    handle.cancel()


def record_text(record: Record) -> str:
    """Describe a run's record, without text that may come from a picture."""
    match record:
        case Started():
            return "The run has started."
        case Decided(step=step, decision=CallTools(calls=calls)):
            return f"Step {step}: {', '.join(call.name[:60] for call in calls)}."
        case Decided():
            return "The planner has finished."
        case Called(outcome=outcome):
            return f"{outcome.call.name[:60]} {'failed' if outcome.error is not None else 'is done'}."
        case Ended(outcome=outcome):
            return f"The run has ended: {outcome}."
