"""MCP over standard input and output, for desktop assistants and coding agents that start the server themselves."""

from __future__ import annotations

import os
import threading
from collections.abc import AsyncIterator
from typing import Any, cast

import anyio
from anyio.from_thread import BlockingPortal
from mcp.server.stdio import stdio_server

from scope_ptz.serve.mcp.server import Context, mcp_server
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.site.clients import LOCAL, Client, Role
from scope_ptz.serve.site.site import Site

_CHUNK_BYTES = 64 * 1024
MAX_LINE_BYTES = 10 * 1024 * 1024  # longer messages end the connection


async def serve_stdio(site: Site, *, role: Role = "operator") -> None:
    """Serve MCP until standard input ends. Standard output carries only protocol messages.

    Args:
        site: The cameras, models and runs. This function enters the site's context.
        role: The client's role.
    """
    client = Client(LOCAL, f"{LOCAL}:mcp", role)

    def client_of(_: Context) -> Client:
        return client

    async with site:
        server = mcp_server(site, RateLimits(), client_of)
        async with BlockingPortal() as portal, stdio_server(stdin=cast(Any, _Lines(portal))) as (incoming, outgoing):
            await server.run(incoming, outgoing, server.create_initialization_options())


class _Lines:
    """The lines of standard input, read in a daemon thread.

    With the SDK's reader, the program could not exit until the client closed standard input, so Ctrl-C would not work.
    No other part of the program can read standard input in the meantime.

    Args:
        portal: The event loop that receives the lines.
    """

    def __init__(self, portal: BlockingPortal) -> None:
        self._portal = portal
        self._send, self._receive = anyio.create_memory_object_stream[str](0)
        self._descriptor = os.dup(0)
        null = os.open(os.devnull, os.O_RDONLY)
        os.dup2(null, 0)
        os.close(null)

    async def __aiter__(self) -> AsyncIterator[str]:
        threading.Thread(target=self._read, name="mcp-stdin", daemon=True).start()
        async with self._receive:
            async for line in self._receive:
                yield line

    def _read(self) -> None:
        incomplete_line = b""
        try:
            # The descriptor is read directly: a thread that holds the lock of a buffered reader at exit would crash the program.
            while (chunk := os.read(self._descriptor, _CHUNK_BYTES)) and len(incomplete_line) <= MAX_LINE_BYTES:
                *lines, incomplete_line = (incomplete_line + chunk).split(b"\n")
                for line in lines:
                    self._portal.call(self._send.send, line.decode("utf-8", "replace"))
            self._portal.call(self._send.aclose)
        except (OSError, RuntimeError, anyio.BrokenResourceError, anyio.ClosedResourceError):
            pass  # the server has ended
