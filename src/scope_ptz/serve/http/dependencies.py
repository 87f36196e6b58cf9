"""FastAPI dependencies for the request handlers: the site, the client that sent the request, and a camera by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from fastapi import Depends, Path, Request, WebSocket
from starlette.exceptions import HTTPException
from starlette.requests import HTTPConnection

from scope_ptz.serve.security.access import Access
from scope_ptz.serve.security.rate_limits import RequestKind
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.presets import Presets
from scope_ptz.serve.site.site import Site
from scope_ptz.serve.site.station import Station


def site_of(connection: HTTPConnection) -> Site:
    """Return the site that the application serves."""
    site: Site = connection.app.state.site
    return site


def access_of(connection: HTTPConnection) -> Access:
    """Return the server's access rules."""
    access: Access = connection.app.state.access
    return access


def _site(request: Request) -> Site:
    return site_of(request)


def _access(request: Request) -> Access:
    return access_of(request)


def client_of(connection: HTTPConnection) -> Client:
    """Return the client that sent a request, as stored by ``AccessMiddleware``.

    Raises:
        HTTPException: The request did not pass the middleware.
    """
    client = getattr(connection.state, "client", None)
    if not isinstance(client, Client):
        raise HTTPException(401, "This request needs a token.")
    return client


def _client_dependency(kind: RequestKind, *, needs_operator: bool) -> Callable[[Request], Client]:
    def dependency(request: Request) -> Client:
        client = _operator(request) if needs_operator else client_of(request)
        access_of(request).limits.count(client.key, kind, client.name)
        return client

    return dependency


def _operator(request: Request) -> Client:
    client = client_of(request)
    if not client.is_operator:
        raise HTTPException(403, "This request needs the operator role, but your token has the viewer role.")
    return client


def _station(request: Request, camera: Annotated[str, Path(max_length=120)]) -> Station:
    return site_of(request).station(camera)


def station_of(socket: WebSocket, camera: str) -> Station:
    """Return a camera by name, for a WebSocket.

    Raises:
        UnknownNameError: The site has no such camera.
    """
    return site_of(socket).station(camera)


def presets_of(site: Site, station: Station) -> Presets:
    """Return a camera's presets."""
    return Presets(station, site.library.root / "thumbnails")


SiteDep = Annotated[Site, Depends(_site)]
AccessDep = Annotated[Access, Depends(_access)]
StationDep = Annotated[Station, Depends(_station)]
Viewer = Annotated[Client, Depends(_client_dependency("read", needs_operator=False))]
"""A client with any role, for requests that only read."""
Operator = Annotated[Client, Depends(_client_dependency("command", needs_operator=True))]
"""A client with the operator role, for requests that are commands."""
RunOperator = Annotated[Client, Depends(_client_dependency("run", needs_operator=True))]
"""A client with the operator role, for requests that start a run. Their rate limit is lower."""
StoppingOperator = Annotated[Client, Depends(_operator)]
"""A client with the operator role, for requests that stop a camera, a run or an evaluation. They have no rate limit."""
