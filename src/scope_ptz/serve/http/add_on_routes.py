"""Routes for the Blender add-on. The scene that is open in Blender is one of the server's cameras.

The add-on posts a description of its scene and reads requests from a stream of server-sent events. It sends each reply or picture
in a separate request.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from contextlib import aclosing
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request, Response
from fastapi.responses import StreamingResponse
from pydantic import BaseModel, Field

from scope_ptz.camera.blender_addon.connection import AddOnConnection, Picture, Reply
from scope_ptz.camera.blender_addon.scene import SceneDescription
from scope_ptz.errors import CameraError, UnknownNameError
from scope_ptz.serve.http.dependencies import SiteDep, StationDep, StoppingOperator
from scope_ptz.serve.http.errors import responses
from scope_ptz.serve.http.models import Body
from scope_ptz.serve.site.camera_kinds import is_blender_window
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.errors import RefusedByCameraError
from scope_ptz.serve.site.station import Station

MAX_MESSAGE_CHARS = 500  # longer error messages are truncated

router = APIRouter(prefix="/cameras/{camera}/add-on", tags=["add-on"])
Connection = Annotated[str, Path(min_length=1, max_length=60)]
Number = Annotated[int, Path(ge=1, le=2**53)]
_ERRORS = responses(404, 409, 503)


class AddOnModel(BaseModel):
    """A connection to an add-on. ``connection`` is its id, which is part of the path in all further requests."""

    connection: str


class ReplyBody(Body):
    """The reply to a request: its ``result``, or ``error`` if it failed."""

    result: dict[str, Any] | None = None
    error: Annotated[str, Field(min_length=1, max_length=10_000)] | None = None


@router.post("", status_code=201, responses=_ERRORS)
async def connect_add_on(station: StationDep, client: StoppingOperator, body: SceneDescription) -> AddOnModel:
    """Connect a Blender instance with its open scene. The camera must be of the kind `blender-window`.

    Another Blender instance can connect only after the first one has disconnected. A client that connects again replaces its
    earlier connection.
    """
    if not is_blender_window(station.spec):
        raise RefusedByCameraError(
            f"{station.name} is not the open scene of a Blender window. "
            "Start the server with `scope serve --camera blender-window`."
        )
    current = station.add_on.current
    if current is not None and current.owner != client.key:
        raise RefusedByCameraError(f"Another Blender instance is connected to {station.name}. Disconnect it first.")
    connection = station.add_on.connect(body, client.key)
    station.preset_changes += 1
    return AddOnModel(connection=connection.id)


@router.get(
    "/{connection}/requests",
    response_class=StreamingResponse,
    responses={200: {"content": {"text/event-stream": {}}, "description": "The requests to the add-on"}, **_ERRORS},
)
async def add_on_requests(
    site: SiteDep, station: StationDep, client: StoppingOperator, connection: Connection
) -> StreamingResponse:
    """Stream requests to the add-on as server-sent events with the name `request`, until the add-on disconnects.

    An event's data has the fields `number`, `operation` and `arguments`. When the stream ends, the connection ends.
    """
    add_on = _find_connection(station, client, connection)
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    return StreamingResponse(_events(add_on, site.closing), media_type="text/event-stream", headers=headers)


@router.put("/{connection}/scene", status_code=204, responses=_ERRORS)
async def update_add_on_scene(
    station: StationDep, client: StoppingOperator, connection: Connection, body: SceneDescription
) -> Response:
    """Replace the description of the scene, for example after cameras were added or another file was opened."""
    station.add_on.update(_find_connection(station, client, connection), body)
    station.preset_changes += 1
    return Response(status_code=204)


@router.post("/{connection}/replies/{number}", status_code=204, responses=_ERRORS)
async def add_on_reply(
    station: StationDep, client: StoppingOperator, connection: Connection, number: Number, body: ReplyBody
) -> Response:
    """Reply to a request."""
    error = None if body.error is None else CameraError(_one_line(body.error))
    _answer(_find_connection(station, client, connection), number, error or body.result or {})
    return Response(status_code=204)


@router.put(
    "/{connection}/pictures/{number}",
    status_code=204,
    responses=_ERRORS,
    openapi_extra={"requestBody": {"required": True, "content": {"image/png": {"schema": {"type": "string", "format": "binary"}}}}},
)
async def add_on_picture(
    request: Request,
    station: StationDep,
    client: StoppingOperator,
    connection: Connection,
    number: Number,
    version: Annotated[str, Query(max_length=60, description="Identifies the state of the scene in the picture")] = "",
) -> Response:
    """Reply to a request with a picture, a PNG file of at most 32 MiB."""
    add_on = _find_connection(station, client, connection)
    _answer(add_on, number, Picture(await request.body(), version))
    return Response(status_code=204)


@router.delete("/{connection}", status_code=204, responses=_ERRORS)
async def disconnect_add_on(station: StationDep, client: StoppingOperator, connection: Connection) -> Response:
    """Disconnect a Blender instance."""
    _find_connection(station, client, connection).end()
    station.preset_changes += 1
    return Response(status_code=204)


def _find_connection(station: Station, client: Client, connection: str) -> AddOnConnection:
    """Return a camera's current connection, if it has this id and belongs to the client."""
    current = station.add_on.current
    if current is None or current.id != connection or current.owner != client.key:
        raise UnknownNameError("connection", connection, ())
    return current


def _answer(connection: AddOnConnection, number: int, reply: Reply) -> None:
    if not connection.answer(number, reply):
        raise UnknownNameError("pending request", str(number), ())


def _one_line(text: str) -> str:
    """Return the text of the add-on's error on one line, for use in an error message."""
    return "".join(c if c.isprintable() else " " for c in text)[:MAX_MESSAGE_CHARS]


async def _events(connection: AddOnConnection, closing: asyncio.Event) -> AsyncIterator[str]:
    yield ": connected\n\n"
    async with aclosing(connection.requests()) as requests:
        next_request = asyncio.ensure_future(anext(requests, None))
        shutdown = asyncio.ensure_future(closing.wait())
        try:
            while True:
                await asyncio.wait({next_request, shutdown}, return_when=asyncio.FIRST_COMPLETED)
                if closing.is_set() or connection.lost:
                    return
                request = next_request.result()
                yield ": heartbeat\n\n" if request is None else f"event: request\ndata: {json.dumps(request)}\n\n"
                next_request = asyncio.ensure_future(anext(requests, None))
        finally:
            connection.end()
            for task in (next_request, shutdown):
                task.cancel()
            await asyncio.gather(next_request, shutdown, return_exceptions=True)
