"""HTTP connections that the application can abort in the middle of a reply."""

from __future__ import annotations

from typing import Any

from starlette.types import ASGIApp, Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

_ABORT = "scope_ptz.abort"


class AbortableProtocol(H11Protocol):
    """uvicorn's HTTP/1.1 protocol, extended so that the application can abort the connection."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        inner: ASGIApp = self.app

        async def app(scope: Scope, receive: Receive, send: Send) -> None:
            scope.setdefault("extensions", {})[_ABORT] = self.transport.abort
            await inner(scope, receive, send)

        self.app = app

    def connection_lost(self, exc: Exception | None) -> None:
        super().connection_lost(exc)
        # uvicorn does not cancel the keep-alive timer of a reset connection, so the timer would keep the connection in memory.
        self._unset_keepalive_if_required()


async def abort_connection(scope: Scope, receive: Receive) -> None:
    """Close a request's connection immediately, without sending any more data."""
    scope["extensions"][_ABORT]()
    while (await receive())["type"] != "http.disconnect":
        pass
