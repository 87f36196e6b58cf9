"""Serve a site with uvicorn in the running event loop."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import AsyncIterator, Iterator
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager

import anyio
import uvicorn
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route
from starlette.types import ASGIApp

from scope_ptz.serve.http.app import application
from scope_ptz.serve.http.errors import error_reply
from scope_ptz.serve.security.access import MCP_PATH, Access
from scope_ptz.serve.site.site import Site
from scope_ptz.virtual_camera.http.server import listen

SHUTDOWN_S = 5
"""Seconds that open replies have to finish when the server shuts down."""

MAX_CONNECTIONS = 500  # further requests get the status 503


@asynccontextmanager
async def serve(site: Site, access: Access, *, port: int = 8000, app: ASGIApp | None = None) -> AsyncIterator[int]:
    """Serve a site while the context is open, and yield the port.

    Args:
        site: The cameras, models and runs to serve. This function enters the site's context.
        access: The access rules, including the host on which to listen.
        port: The port; 0 for any free one.
        app: The application, wrapped in an ``AccessMiddleware``; by default, the API and MCP.

    Raises:
        ConfigError: The port is in use or not permitted.
    """
    (listener,) = listen(access.host, [port])
    async with site, AsyncExitStack() as stack:
        if app is None:
            app = application(site, access, await stack.enter_async_context(mcp_route(site, access)))
        async with serve_app(app, listener, site.closing) as bound_port:
            yield bound_port


@asynccontextmanager
async def serve_app(app: ASGIApp, listener: socket.socket, closing: asyncio.Event) -> AsyncIterator[int]:
    """Serve an application while the context is open, and yield the port.

    Args:
        app: The application, wrapped in an ``AccessMiddleware``.
        listener: The listening socket, which is closed at the end.
        closing: Set when the server shuts down, so that streams end.
    """
    server = _Server(configuration(app))
    serving = asyncio.create_task(server.serve([listener]))
    try:
        await _wait_until_ready(server, serving)
        yield int(listener.getsockname()[1])
    finally:
        with anyio.CancelScope(shield=True):
            closing.set()
            server.should_exit = True
            await asyncio.gather(serving, return_exceptions=True)


@asynccontextmanager
async def mcp_route(site: Site, access: Access) -> AsyncIterator[Route]:
    """Serve MCP while the context is open, and yield its route, which must be mounted behind an ``AccessMiddleware``.

    If the package ``mcp`` is not installed, the route replies that it is missing.
    """
    try:
        from scope_ptz.serve.mcp.http import serve_mcp
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] not in ("mcp", "mcp_types"):
            raise
        yield Route(MCP_PATH, _mcp_not_installed, methods=["GET", "POST", "DELETE"])
        return
    async with serve_mcp(site, access) as route:
        yield route


async def _mcp_not_installed(_: Request) -> Response:
    return error_reply(
        501, "not_installed", "MCP is not installed on this server. Install it with: pip install 'scope-ptz[serve]'."
    )


def configuration(app: ASGIApp) -> uvicorn.Config:
    """Return the uvicorn configuration for an application."""
    return uvicorn.Config(
        app,
        lifespan="off",
        log_config=None,
        log_level="warning",  # otherwise, uvicorn logs every connection if the program configures logging, as Streamlit does
        access_log=False,
        server_header=False,
        proxy_headers=False,  # address headers from clients are not trusted
        ws="websockets-sansio",
        ws_max_size=64 * 1024,
        ws_per_message_deflate=False,  # pictures are already compressed
        limit_concurrency=MAX_CONNECTIONS,
        timeout_keep_alive=30,
        timeout_graceful_shutdown=SHUTDOWN_S,
    )


async def _wait_until_ready(server: _Server, serving: asyncio.Task[None]) -> None:
    """Wait until a server is listening. If its task ends before that, raise the task's error."""
    waiting = asyncio.ensure_future(server.ready.wait())
    await asyncio.wait({waiting, serving}, return_when=asyncio.FIRST_COMPLETED)
    waiting.cancel()
    if serving.done():
        serving.result()


class _Server(uvicorn.Server):
    """A server that sets ``ready`` once it is listening, and leaves process signals to the surrounding program."""

    def __init__(self, config: uvicorn.Config) -> None:
        super().__init__(config)
        self.ready = asyncio.Event()

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self.ready.set()

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield
