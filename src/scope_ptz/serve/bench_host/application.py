"""The host's ASGI application: HTTP and MCP behind the same access checks."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route

from scope_ptz.errors import ScopeError
from scope_ptz.serve.bench_host.host import Host
from scope_ptz.serve.bench_host.http_routes import MESSAGES_PATH, http_routes, scope_error
from scope_ptz.serve.bench_host.mcp_channel import serve_mcp_channel
from scope_ptz.serve.http.errors import http_error
from scope_ptz.serve.security.access import MCP_PATH, Access, AccessMiddleware
from scope_ptz.serve.server import serve_app
from scope_ptz.virtual_camera.http.server import listen


@asynccontextmanager
async def serve_host(host: Host, access: Access, *, port: int = 8000) -> AsyncIterator[int]:
    """Serve a host while the context is open, and yield the port. At the end, all workers are stopped.

    Args:
        host: The host. Its participants' tokens must be the tokens in ``access``.
        access: The access rules, including the address on which to listen.
        port: The port; 0 for any free one.

    Raises:
        ConfigError: The port is in use or not permitted.
    """

    async def root(_: Request) -> Response:
        return PlainTextResponse(f"A host of SCOPE evaluations. Send messages to {MESSAGES_PATH}, or connect to {MCP_PATH}.\n")

    (listener,) = listen(access.host, [port])
    try:
        async with serve_mcp_channel(host, access) as mcp:
            routes = [Route("/", root), *http_routes(host, access), mcp]
            app = Starlette(routes=routes, exception_handlers={HTTPException: http_error, ScopeError: scope_error})
            async with serve_app(AccessMiddleware(app, access), listener, host.closing) as bound_port:
                yield bound_port
    finally:
        await host.close()
