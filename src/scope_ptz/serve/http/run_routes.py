"""Routes that start, follow and cancel runs."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Header, Path, Query
from fastapi.responses import StreamingResponse

from scope_ptz.serve.http.dependencies import RunOperator, SiteDep, StoppingOperator, Viewer
from scope_ptz.serve.http.errors import responses
from scope_ptz.serve.http.models import RunStart, RunState
from scope_ptz.serve.http.run_state import live_events, state_of, stored_events, stored_state
from scope_ptz.serve.site.start_runs import start_instruction
from scope_ptz.serve.site.stored_runs import trace_of_run

router = APIRouter(tags=["runs"])
RunId = Annotated[str, Path(min_length=1, max_length=120)]
_ERRORS = responses(404, 409, 503)


@router.post("/runs", status_code=202, responses=_ERRORS)
async def start_run(site: SiteDep, client: RunOperator, body: RunStart) -> RunState:
    """Start a run and reply immediately. The run continues even if no client follows it at `/runs/{run}/events`."""
    return state_of(await start_instruction(site, client, **dict(body)))


@router.post("/ask", responses=_ERRORS)
async def ask(site: SiteDep, client: RunOperator, body: RunStart) -> RunState:
    """Run an instruction, and reply when the run has ended."""
    handle = await start_instruction(site, client, **dict(body))
    await handle.done.wait()
    if handle.failure is not None:
        raise handle.failure
    return state_of(handle)


@router.get("/runs/{run}", responses=_ERRORS)
async def run_state(site: SiteDep, client: Viewer, run: RunId) -> RunState:  # noqa: ARG001 - checks the token
    """Return the state of a run, whether it is in progress or has ended."""
    handle = site.runner.find(run)
    return state_of(handle) if handle is not None else await stored_state(site, run)


@router.get(
    "/runs/{run}/events",
    response_class=StreamingResponse,
    responses={200: {"content": {"text/event-stream": {}}, "description": "The records of the run"}, **_ERRORS},
)
async def run_events(
    site: SiteDep,
    client: Viewer,  # noqa: ARG001 - checks the token
    run: RunId,
    last_event_id: Annotated[str | None, Header(max_length=20)] = None,
    after: Annotated[int, Query(ge=-1, le=1_000_000, description="Number of the last event that the client has received")] = -1,
) -> StreamingResponse:
    """Stream a run's records as server-sent events until the run ends, from the first record or after event number `after`.

    An event's name is `start`, `decision`, `call` or `end`. Its data is the record in the trace format, and its id is its number. A
    disconnected client can resume with `Last-Event-ID`, even after the server has been restarted.
    """
    if last_event_id is not None and last_event_id.isascii() and last_event_id.isdecimal():
        after = int(last_event_id)
    handle = site.runner.find(run)
    events = live_events(handle, after, site.closing) if handle is not None else stored_events(await trace_of_run(site, run), after)
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    return StreamingResponse(events, media_type="text/event-stream", headers=headers)


@router.post("/runs/{run}/cancel", status_code=202, responses=_ERRORS)
async def cancel_run(site: SiteDep, client: StoppingOperator, run: RunId) -> RunState:  # noqa: ARG001 - checks the token
    """Cancel a run, which then ends with the outcome "cancelled". A run that has already ended does not change."""
    handle = site.runner.find(run)
    if handle is None:
        return await stored_state(site, run)
    handle.cancel()
    return state_of(handle)
