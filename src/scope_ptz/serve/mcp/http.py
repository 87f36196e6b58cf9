"""MCP over streamable HTTP, with the same access checks as the HTTP API."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace

from mcp.server.auth.middleware.bearer_auth import AuthenticatedUser
from mcp.server.auth.provider import AccessToken
from mcp.server.streamable_http_manager import StreamableHTTPSessionManager
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from scope_ptz.serve.http.errors import http_error
from scope_ptz.serve.mcp.server import Context, mcp_server
from scope_ptz.serve.security.access import MAX_BODY_BYTES, MCP_PATH, Access, AccessMiddleware
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.site import Site
from scope_ptz.version import __version__

MAX_SESSIONS = 200
"""Maximum number of sessions for clients that use the older protocol version. The current version has no sessions."""


@asynccontextmanager
async def serve_mcp(site: Site, access: Access) -> AsyncIterator[Route]:
    """Serve MCP while the context is open, and yield the route, which must be mounted behind an ``AccessMiddleware``.

    The middleware checks ``Host``, ``Origin`` and the token of each request, so the transport's own checks are not used.

    Args:
        site: The site, whose context the caller must enter.
        access: The access rules, whose rate limits apply.
    """
    server = mcp_server(site, access.limits, client_of)
    manager = StreamableHTTPSessionManager(server, max_request_body_size=MAX_BODY_BYTES, max_sessions=MAX_SESSIONS)
    async with manager.run():
        yield Route(MCP_PATH, McpEndpoint(manager, site.closing))


def mcp_application(access: Access, mcp: Route) -> ASGIApp:
    """Return an application that serves only MCP."""

    async def root(_: Request) -> Response:
        return PlainTextResponse(f"SCOPE {__version__}. MCP is at {MCP_PATH}.\n")

    return AccessMiddleware(Starlette(routes=[Route("/", root), mcp], exception_handlers={HTTPException: http_error}), access)


def mcp_client(client: Client) -> Client:
    """Return a copy of a client with a separate key for MCP.

    The key differs from those of other programs with the same token, so that only one of them controls a camera. A client that
    identifies itself with the header ``Scope-Client`` keeps its key.
    """
    return replace(client, key=f"{client.key}:mcp") if client.key == client.name else client


class McpEndpoint:
    """Passes requests to the session manager, and ends streams when the server shuts down."""

    def __init__(self, manager: StreamableHTTPSessionManager, closing: asyncio.Event) -> None:
        self._manager, self._closing = manager, closing

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        client = mcp_client(scope["state"]["client"])
        scope["state"]["mcp_client"] = client
        # A session in the older protocol can be used only by the client that created it.
        scope["user"] = AuthenticatedUser(AccessToken(token="", client_id=client.key, scopes=[]))
        if scope["method"] != "GET":
            await self._manager.handle_request(scope, receive, send)
            return
        await self._stream(scope, receive, send)

    async def _stream(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a session's stream in the older protocol, which would otherwise last until the client closes it."""
        begun = ended = False

        async def observed_send(message: Message) -> None:
            nonlocal begun, ended
            begun |= message["type"] == "http.response.start"
            ended |= message["type"] == "http.response.body" and not message.get("more_body", False)
            await send(message)

        stream = asyncio.ensure_future(self._manager.handle_request(scope, receive, observed_send))
        closing = asyncio.ensure_future(self._closing.wait())
        try:
            await asyncio.wait({stream, closing}, return_when=asyncio.FIRST_COMPLETED)
            if stream.done():
                stream.result()
        finally:
            for task in (stream, closing):
                task.cancel()
            await asyncio.gather(stream, closing, return_exceptions=True)
        if begun and not ended:
            await send({"type": "http.response.body", "body": b""})


def client_of(context: Context) -> Client:
    """Return the client that sent a request."""
    request = context.request
    assert isinstance(request, Request)  # noqa: S101 - the transport attaches the request to each message
    client: Client = request.scope["state"]["mcp_client"]
    return client
