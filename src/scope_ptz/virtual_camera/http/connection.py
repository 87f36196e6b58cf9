"""Connections that an application can break off, which HTTP alone does not offer."""

from __future__ import annotations

from typing import Any

from starlette.types import ASGIApp, Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

_ABORT = "scope_ptz.abort"


class BreakableProtocol(H11Protocol):
    """uvicorn's HTTP/1.1 with a way for the application to break the connection off."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        inner: ASGIApp = self.app

        async def app(scope: Scope, receive: Receive, send: Send) -> None:
            scope.setdefault("extensions", {})[_ABORT] = self.transport.abort
            await inner(scope, receive, send)

        self.app = app


async def break_off(scope: Scope, receive: Receive) -> None:
    """Close the connection of a request at once, without another byte."""
    scope["extensions"][_ABORT]()
    while (await receive())["type"] != "http.disconnect":
        pass
