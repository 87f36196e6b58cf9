"""Routes that list, export and keep stored runs, return their pictures, and accept feedback."""

from __future__ import annotations

import os
import tempfile
from functools import partial
from pathlib import Path as FilePath
from typing import Annotated, Literal

from fastapi import APIRouter, Path, Query, Response
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask

from scope_ptz.agent.filmstrip import write_filmstrip
from scope_ptz.agent.trace import picture_names
from scope_ptz.errors import InputError, TraceError
from scope_ptz.factory.run_export import AnyFormat, run_drafts
from scope_ptz.factory.run_export import export_runs as write_export
from scope_ptz.serve.http.dependencies import Operator, SiteDep, Viewer
from scope_ptz.serve.http.errors import responses
from scope_ptz.serve.http.models import FeedbackBody, KeepRequest, Mark, PictureModel, QueryTime, RunDetails, RunList
from scope_ptz.serve.http.run_state import run_filter
from scope_ptz.serve.site.marks import call_for_picture, marks_of
from scope_ptz.serve.site.stored_runs import stored_picture, trace_of_run
from scope_ptz.store.conversations import load_conversation
from scope_ptz.store.feedback import add_feedback, feedback_on, remove_feedback
from scope_ptz.store.queries import MAX_COUNT, distinct_values
from scope_ptz.store.retention import keep
from scope_ptz.store.rows import FeedbackRow, RunKind
from scope_ptz.taskgen.generating.run_draft_file import RunDraft

MAX_EXPORT = 10_000
"""Maximum number of runs in one export."""

MAX_DRAFTS = 100
"""Maximum number of runs to convert to task drafts in one request."""

router = APIRouter(tags=["library"])
RunId = Annotated[str, Path(min_length=1, max_length=120)]
_ERRORS = responses(404, 409, 503)


@router.get("/runs", responses=responses(404, 409, 503))
async def list_runs(
    site: SiteDep,
    client: Viewer,
    text: Annotated[str, Query(max_length=200, description="Words that the instruction or the answer contains")] = "",
    kind: RunKind | None = None,
    camera: Annotated[str | None, Query(max_length=120)] = None,
    planner: Annotated[str | None, Query(max_length=120)] = None,
    perception: Annotated[str | None, Query(max_length=120)] = None,
    outcome: Annotated[str | None, Query(max_length=40)] = None,
    tool: Annotated[str | None, Query(max_length=60)] = None,
    conversation: Annotated[str | None, Query(max_length=60)] = None,
    rating: Annotated[Literal["good", "bad"] | None, Query()] = None,
    since: QueryTime | None = None,
    until: QueryTime | None = None,
    limit: Annotated[int, Query(ge=1, le=500)] = 50,
    after: Annotated[str | None, Query(max_length=60, description="The value of `next` in the previous page")] = None,
) -> RunList:
    """List runs, newest first. Only a conversation's owner can list its runs."""
    if conversation is not None:
        await site.library.in_thread(partial(load_conversation, site.library.store.database, conversation, owner=client.name))
    filters = run_filter(
        text=text,
        kind=kind,
        camera=camera,
        planner=planner,
        perception=perception,
        outcome=outcome,
        tool=tool,
        conversation=conversation,
        rating=rating,
        since=since,
        until=until,
    )
    store = site.library.store
    await site.library.wait_for_indexing()
    page = await site.library.in_thread(partial(store.runs, filters, limit=limit, after=after))
    count = await site.library.in_thread(partial(store.count, filters))
    return RunList(runs=page.runs, next=page.next, count=count, count_is_limit=count >= MAX_COUNT)


@router.get("/runs/values", responses=responses(503))
async def run_values(site: SiteDep, client: Viewer) -> dict[str, list[str]]:  # noqa: ARG001 - checks the token
    """Return the cameras, planners, perception backends and outcomes of all stored runs, for menus."""
    return await site.library.in_thread(partial(distinct_values, site.library.store.database))


@router.get(
    "/runs/export",
    response_class=FileResponse,
    responses={
        200: {"content": {"application/x-ndjson": {}, "application/zip": {}}, "description": "The file"},
        **responses(404, 409, 503),
    },
)
async def export_runs(
    site: SiteDep,
    client: Viewer,  # noqa: ARG001 - checks the token
    export_format: Annotated[AnyFormat, Query(alias="format")] = "jsonl",
    text: Annotated[str, Query(max_length=200)] = "",
    camera: Annotated[str | None, Query(max_length=120)] = None,
    outcome: Annotated[str | None, Query(max_length=40)] = None,
    rating: Annotated[Literal["good", "bad"] | None, Query()] = None,
    since: QueryTime | None = None,
    until: QueryTime | None = None,
) -> FileResponse:
    """Download runs: as data, as chat messages for fine-tuning, as task drafts, or as folders with all pictures."""
    filters = run_filter(
        text=text,
        camera=camera,
        outcome=outcome,
        rating=rating,
        since=since,
        until=until,
    )
    store = site.library.store
    descriptor, name = tempfile.mkstemp(suffix=f".{export_format}")
    os.close(descriptor)
    path = FilePath(name)
    try:
        ids = (await site.library.in_thread(partial(store.ids, filters)))[:MAX_EXPORT]
        await site.library.in_thread(partial(write_export, store, ids, path, export_format))
    except BaseException:
        await site.library.in_thread(partial(path.unlink, missing_ok=True))
        raise
    media_type, suffix = ("application/zip", "zip") if export_format == "zip" else ("application/x-ndjson", "jsonl")
    return FileResponse(
        path,
        media_type=media_type,
        filename=f"{'drafts' if export_format == 'drafts' else 'runs'}.{suffix}",
        background=BackgroundTask(path.unlink, missing_ok=True),
    )


@router.get("/runs/drafts", responses=responses(409, 503))
async def list_run_drafts(
    site: SiteDep,
    client: Viewer,  # noqa: ARG001 - checks the token
    text: Annotated[str, Query(max_length=200)] = "",
    camera: Annotated[str | None, Query(max_length=120)] = None,
    outcome: Annotated[str | None, Query(max_length=40)] = None,
    since: QueryTime | None = None,
    until: QueryTime | None = None,
) -> list[RunDraft]:
    """Convert the newest runs with positive feedback to drafts of benchmark tasks.

    Runs that cannot become drafts are listed with the reason.
    """
    filters = run_filter(text=text, camera=camera, outcome=outcome, rating="good", since=since, until=until)
    store = site.library.store
    await site.library.wait_for_indexing()
    page = await site.library.in_thread(partial(store.runs, filters, limit=MAX_DRAFTS))
    return await site.library.in_thread(lambda: list(run_drafts(store, [run.id for run in page.runs])))


@router.get("/runs/{run}/details", responses=_ERRORS)
async def run_details(site: SiteDep, client: Viewer, run: RunId) -> RunDetails:  # noqa: ARG001 - checks the token
    """Return the stored data for a run: its times, calls, pictures and feedback."""
    store = site.library.store
    await site.library.wait_for_indexing()
    stored = await site.library.in_thread(partial(store.run, run))
    feedback = await site.library.in_thread(partial(feedback_on, store.database, run))
    return RunDetails(run=stored.run, steps=stored.steps, frames=stored.frames, feedback=feedback)


@router.get("/runs/{run}/pictures", responses=_ERRORS)
async def list_pictures(site: SiteDep, client: Viewer, run: RunId) -> list[PictureModel]:  # noqa: ARG001 - checks the token
    """List a run's pictures with their marks."""
    trace = await trace_of_run(site, run)
    pictures = []
    for name, position in picture_names(trace).items():
        call = trace.calls[position] if position is not None else None
        marks = [Mark(**mark) for mark in marks_of(call_for_picture(trace, name), name)]
        message = str((call.outcome.result or {}).get("message", "")) if call is not None else ""
        tool = call.outcome.call.name if call is not None else None
        pictures.append(PictureModel(name=name, position=position, tool=tool, message=message, marks=marks))
    return pictures


@router.get(
    "/runs/{run}/pictures/{part}/{name}",
    response_class=Response,
    responses={200: {"content": {"image/jpeg": {}, "image/png": {}}, "description": "The picture"}, **_ERRORS},
)
async def run_picture(
    site: SiteDep,
    client: Viewer,  # noqa: ARG001 - checks the token
    run: RunId,
    part: Literal["frames", "pictures"],
    name: Annotated[str, Path(min_length=1, max_length=60)],
    marks: Annotated[bool, Query(description="Draw the marks on the picture")] = False,
) -> Response:
    """Return a picture from a run, either as it was taken or with numbered boxes drawn on it."""
    data = await stored_picture(site, run, f"{part}/{name}", marks=marks)
    media_type = "image/jpeg" if marks or name.endswith(".jpg") else "image/png"
    return Response(data, media_type=media_type, headers={"Cache-Control": "private, max-age=3600"})


@router.get(
    "/runs/{run}/filmstrip",
    response_class=Response,
    responses={200: {"content": {"image/png": {}}, "description": "The filmstrip"}, **_ERRORS},
)
async def filmstrip(site: SiteDep, client: Viewer, run: RunId) -> Response:  # noqa: ARG001 - checks the token
    """Return a run's filmstrip: one image that shows all its steps."""
    trace = await trace_of_run(site, run)
    if trace.ended is None:
        raise InputError("The run is still in progress. Its filmstrip will be available once it has ended.")

    def read() -> bytes:
        path: FilePath | None = trace.folder / "filmstrip.png"
        assert path is not None  # noqa: S101 - for the type checker
        if not path.is_file() and (path := write_filmstrip(trace)) is None:
            raise TraceError("This run has no pictures.")
        return path.read_bytes()

    return Response(await site.library.in_thread(read), media_type="image/png")


@router.put("/runs/{run}/kept", status_code=204, responses=_ERRORS)
async def keep_run(site: SiteDep, client: Operator, run: RunId, body: KeepRequest) -> Response:  # noqa: ARG001 - checks the token
    """Set whether to keep a run when old runs are removed."""
    await site.library.in_thread(partial(keep, site.library.store.database, run, kept=body.kept))
    return Response(status_code=204)


@router.get("/runs/{run}/feedback", tags=["feedback"], responses=_ERRORS)
async def list_feedback(site: SiteDep, client: Viewer, run: RunId) -> list[FeedbackRow]:  # noqa: ARG001 - checks the token
    """List the feedback on a run."""
    return await site.library.in_thread(partial(feedback_on, site.library.store.database, run))


@router.post("/runs/{run}/feedback", status_code=201, tags=["feedback"], responses=_ERRORS)
async def give_feedback(site: SiteDep, client: Operator, run: RunId, body: FeedbackBody) -> FeedbackRow:
    """Rate a run or one of its calls. Later feedback by the same person on the same run or call replaces earlier feedback."""
    await site.library.wait_for_indexing()
    return await site.library.in_thread(
        partial(
            add_feedback,
            site.library.store.database,
            run,
            body.rating,
            body.comment,
            actor=client.name,
            position=body.position,
        )
    )


@router.delete("/feedback/{number}", status_code=204, tags=["feedback"], responses=_ERRORS)
async def withdraw_feedback(site: SiteDep, client: Operator, number: Annotated[int, Path(ge=0, le=2**53)]) -> Response:
    """Withdraw feedback that the client gave."""
    await site.library.in_thread(partial(remove_feedback, site.library.store.database, number, actor=client.name))
    return Response(status_code=204)
