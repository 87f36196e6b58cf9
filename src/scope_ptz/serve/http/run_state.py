"""Read the state and the records of runs, whether in progress or stored."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import aclosing
from datetime import datetime
from functools import partial
from typing import Any

from pydantic import BaseModel, ValidationError

from scope_ptz.agent.trace import Trace
from scope_ptz.errors import InputError
from scope_ptz.serve.http.models import RunState
from scope_ptz.serve.site.run_handle import RunHandle
from scope_ptz.serve.site.site import Site
from scope_ptz.serve.site.stored_runs import records_of, trace_of_run
from scope_ptz.store.request_file import read_request
from scope_ptz.store.rows import UNFINISHED, RunFilter

HEARTBEAT_S = 15.0
"""Seconds without an event after which an event stream sends a comment to keep the connection alive."""


def state_of(handle: RunHandle) -> RunState:
    """Return the state of a run in progress."""
    ended, request = handle.ended, handle.request
    return RunState(
        id=handle.id,
        camera=request.camera,
        kind=request.kind,
        instruction=handle.instruction,
        conversation=request.conversation,
        actor=request.actor,
        running=not handle.done.is_set(),
        outcome=ended.outcome if ended is not None else UNFINISHED,
        answer=ended.text if ended is not None else "",
        events=len(handle.records),
        preview=list(handle.preview),
    )


async def stored_state(site: Site, run_id: str) -> RunState:
    """Return the state of a run that is not in memory.

    Raises:
        UnknownNameError: There is no such run.
    """
    trace = await trace_of_run(site, run_id)
    request = await site.library.in_thread(partial(read_request, trace.folder))
    started, ended = trace.started, trace.ended
    return RunState(
        id=run_id,
        camera=request.camera or started.scene or started.camera,
        kind=request.kind,
        instruction=started.instruction,
        conversation=request.conversation,
        actor=request.actor,
        running=False,
        outcome=ended.outcome if ended is not None else UNFINISHED,
        answer=ended.text if ended is not None else "",
        events=len(records_of(trace)),
        preview=[],
    )


async def live_events(handle: RunHandle, after: int, closing: asyncio.Event) -> AsyncIterator[str]:
    """Yield the records of a run in progress as server-sent events until the run ends, with comments during pauses.

    Args:
        handle: The run.
        after: Number of the record after which to begin; -1 to begin with the first record.
        closing: Set when the server shuts down, which ends the events.
    """
    async with aclosing(handle.events(after)) as events:
        next_event = asyncio.ensure_future(anext(events, None))
        shutdown = asyncio.ensure_future(closing.wait())
        try:
            while True:
                done, _ = await asyncio.wait({next_event, shutdown}, timeout=HEARTBEAT_S, return_when=asyncio.FIRST_COMPLETED)
                if next_event in done:
                    event = next_event.result()
                    if event is None:
                        return
                    yield sse(event.number, event.record)
                    next_event = asyncio.ensure_future(anext(events, None))
                elif shutdown in done:
                    return
                else:
                    yield ": the run is in progress\n\n"
        finally:
            for task in (next_event, shutdown):
                task.cancel()
            await asyncio.gather(next_event, shutdown, return_exceptions=True)


async def stored_events(trace: Trace, after: int) -> AsyncIterator[str]:
    """Yield a stored run's records as server-sent events, beginning after record number ``after``."""
    for number, record in enumerate(records_of(trace)):
        if number > after:
            yield sse(number, record)


def sse(number: int, record: BaseModel) -> str:
    """Format a record as a server-sent event."""
    name: str = record.event  # type: ignore[attr-defined] # every record has this field
    return f"id: {number}\nevent: {name}\ndata: {record.model_dump_json()}\n\n"


def run_filter(*, since: datetime | None, until: datetime | None, rating: str | None, **fields: Any) -> RunFilter:
    """Create the filter for stored runs that a request specifies.

    Args:
        since: Select runs that started at this time or later; None for no limit.
        until: Select runs that started before this time; None for no limit.
        rating: ``good`` or ``bad`` to select rated runs; None for all runs.
        **fields: Other fields of ``RunFilter``.

    Raises:
        InputError: A time is outside the supported range, or the filter's text is too long.
    """
    ratings = {"good": 1, "bad": -1, None: None}
    try:
        for time in (since, until):
            if time is not None:
                time.timestamp()
        return RunFilter(since=since, until=until, rating=ratings[rating], **fields)  # type: ignore[arg-type]
    except (ValidationError, OverflowError, OSError, ValueError) as error:
        raise InputError("A time in the filter is outside the supported range, or the filter's text is too long.") from error
