"""Admit only authorised requests to the API, the page, WebSockets and media."""

from __future__ import annotations

import asyncio
import base64
import json
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from scope_ptz.errors import ConfigError
from scope_ptz.serve.security.origins import LOOPBACK_NAMES, Origins, is_loopback
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.security.sessions import COOKIE, Sessions
from scope_ptz.serve.security.tokens import TokenFile
from scope_ptz.serve.site.clients import LOCAL, Client

MAX_BODY_BYTES = 256 * 1024
"""Maximum size of a request body, in bytes."""

MAX_PICTURE_BYTES = 32 * 1024 * 1024
"""Maximum size of a picture that the Blender add-on sends, in bytes. A PNG with 3840 x 2160 pixels is rarely larger."""

_PICTURE_PATH = re.compile(r"/api/v1/cameras/[^/]+/add-on/[^/]+/pictures/[0-9]+")

OPEN_PATHS = frozenset({"/api/v1/session", "/api/v1/health", "/sign-in"})
"""Paths that need no token: sign-in and the health check."""

MCP_PATH = "/mcp"
"""The path of the MCP server."""

PROGRAM_PATHS = ("/api", MCP_PATH)
"""Prefixes of the paths that serve programs instead of browsers."""

SIGN_IN_PATH = "/sign-in"  # where browsers without a session are redirected

AUTHORISATION_CHECK_INTERVAL_S = 2.0
"""Seconds between checks that the client whose request is in progress is still authorised."""

API_POLICY = "default-src 'none'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
"""The API's content security policy. It allows nothing, because the API's replies are not pages."""

_CLIENT_KEY = re.compile(r"[A-Za-z0-9_-]{1,64}")  # valid values of the header ``Scope-Client``, which distinguishes browser tabs


@dataclass(slots=True)
class Access:
    """A server's access rules.

    Attributes:
        host: The address that the server listens on.
        tokens: The token file. If it is None, no token is needed, and every program on this machine is an operator.
        hosts: Additional host names for the server, such as the name of a reverse proxy.
        limits: Rate limits for requests.
        sessions: The sessions of signed-in browsers.

    Raises:
        ConfigError: The server would accept requests from the network, or have additional host names, without tokens.
    """

    host: str
    tokens: TokenFile | None = None
    hosts: Iterable[str] = ()
    limits: RateLimits = field(default_factory=RateLimits)
    sessions: Sessions = field(default_factory=Sessions)

    def __post_init__(self) -> None:
        if not is_loopback(self.host) and (self.tokens is None or not self.tokens.tokens):
            raise ConfigError(
                f"The server would be open to the network at {self.host} without tokens. Create a token with "
                "`scope token add NAME --role operator`, or listen on this machine only."
            )
        if self.hosts and (self.tokens is None or not self.tokens.tokens):
            raise ConfigError(
                "A server with additional host names needs tokens. Create a token with `scope token add NAME --role operator`."
            )

    @property
    def needs_token(self) -> bool:
        """Whether clients must present a token."""
        return self.tokens is not None

    def origins(self) -> Origins:
        """Return the object that checks the ``Host`` and ``Origin`` headers of requests."""
        listening = () if self.host in ("0.0.0.0", "::") else (self.host,)  # noqa: S104 - compared, not bound to
        return Origins({*LOOPBACK_NAMES, *listening, *self.hosts})

    def client(self, headers: dict[str, str]) -> Client | None:
        """Return the client that sent a request; None if the request has neither a valid token nor a valid session.

        Args:
            headers: The request's headers, by lower-case name.
        """
        client_key = headers.get("scope-client", "")
        tab_suffix = f":{client_key}" if _CLIENT_KEY.fullmatch(client_key) else ""
        if self.tokens is None:
            return Client(LOCAL, f"{LOCAL}{tab_suffix}", "operator")
        if (secret := _token_secret(headers.get("authorization", ""))) is not None:
            token = self.tokens.find(secret)
            return None if token is None else Client(token.name, f"{token.name}{tab_suffix}", token.role)
        session = self.sessions.find(cookie_of(headers))
        if session is None or not self.tokens.is_valid(session.token):
            return None
        return Client(session.token.name, f"{session.token.name}:{session.key}{tab_suffix}", session.token.role)


class AccessMiddleware:
    """ASGI middleware that admits only authorised clients and sets security headers on replies.

    It stores the client in ``scope["state"]["client"]``; None for the paths that need no token.

    Args:
        app: The wrapped application.
        access: The access rules.
        page_policy: The content security policy for everything outside ``PROGRAM_PATHS``.
    """

    def __init__(self, app: ASGIApp, access: Access, *, page_policy: str = API_POLICY) -> None:
        self._app, self._access, self._page_policy = app, access, page_policy
        self._origins = access.origins()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = _headers(scope)
        is_websocket = scope["type"] == "websocket"
        reply = _Reply(scope, send, API_POLICY if scope["path"].startswith(PROGRAM_PATHS) else self._page_policy)
        if problem := self._origins.problem(headers, method=scope.get("method", "GET"), websocket=is_websocket):
            await reply.refuse(403, "refused", problem)
            return
        if is_websocket and (tab := parse_qs(scope.get("query_string", b"").decode("latin-1")).get("client")):
            headers.setdefault("scope-client", tab[0])  # a page cannot set WebSocket headers
        client = self._access.client(headers)
        if client is None and scope["path"] not in OPEN_PATHS:
            if not is_websocket and _wants_page(scope, headers):
                await reply.redirect(SIGN_IN_PATH)
            else:
                await reply.refuse(
                    401, "sign_in", "This request needs a token. Send it as `Authorization: Bearer TOKEN`, or sign in."
                )
            return
        max_bytes = max_body_bytes(scope["path"])
        if int(headers.get("content-length", "0") or 0) > max_bytes:
            await reply.refuse(413, "too_large", f"The body of a request must have at most {max_bytes} bytes.")
            return
        scope.setdefault("state", {})["client"] = client
        if client is None or not self._access.needs_token:
            await self._app(scope, _limit_body(receive, max_bytes), reply.send)
        else:
            await self._serve_while_authorised(client, headers, scope, _limit_body(receive, max_bytes), reply)

    async def _serve_while_authorised(
        self, client: Client, headers: dict[str, str], scope: Scope, receive: Receive, reply: _Reply
    ) -> None:
        """Serve a request, and end it if the client's token is removed or its session ends in the meantime.

        Without this check, a client could continue to watch a stream indefinitely.
        """
        serving = asyncio.ensure_future(self._app(scope, receive, reply.send))
        try:
            while not (await asyncio.wait({serving}, timeout=AUTHORISATION_CHECK_INTERVAL_S))[0]:
                if self._access.client(headers) != client:
                    serving.cancel()
                    await asyncio.gather(serving, return_exceptions=True)
                    await reply.end()
                    return
            serving.result()
        finally:
            if not serving.done():
                serving.cancel()
                await asyncio.gather(serving, return_exceptions=True)


class _Reply:
    """Sends a reply with security headers."""

    def __init__(self, scope: Scope, send: Send, policy: str) -> None:
        self._scope, self._send, self._policy = scope, send, policy
        self._begun = self._ended = False

    async def send(self, message: Message) -> None:
        self._begun |= message["type"] in ("http.response.start", "websocket.accept")
        self._ended |= message["type"] == "websocket.close" or (
            message["type"] == "http.response.body" and not message.get("more_body", False)
        )
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            headers.setdefault("Content-Security-Policy", self._policy)
            headers["X-Content-Type-Options"] = "nosniff"
            headers["X-Frame-Options"] = "DENY"
            headers["Referrer-Policy"] = "same-origin"  # with "no-referrer", browsers send forms without their origin
            headers["Cross-Origin-Resource-Policy"] = "same-origin"
            headers["Cross-Origin-Opener-Policy"] = "same-origin"
            headers["Permissions-Policy"] = "camera=(), microphone=(), geolocation=()"
            if self._scope["path"].startswith(PROGRAM_PATHS):
                headers.setdefault("Cache-Control", "no-store")
        await self._send(message)

    async def refuse(self, status: int, code: str, message: str) -> None:
        if self._scope["type"] == "websocket":
            # If the WebSocket has not been accepted yet, the client gets the HTTP status 403 instead.
            await self._send({"type": "websocket.close", "code": 1008, "reason": message[:120]})
            return
        body = json.dumps({"error": {"code": code, "message": message}}).encode()
        extra = [(b"www-authenticate", b"Bearer")] if status == 401 else []
        await self._send_complete(status, [(b"content-type", b"application/json"), *extra], body)

    async def end(self) -> None:
        """End an unfinished reply, because its client is no longer authorised."""
        if self._ended:
            return
        if not self._begun or self._scope["type"] == "websocket":
            await self.refuse(401, "sign_in", "Your token was removed, or your session has ended. Sign in again.")
        else:
            await self.send({"type": "http.response.body", "body": b""})

    async def redirect(self, path: str) -> None:
        await self._send_complete(303, [(b"location", path.encode())], b"")

    async def _send_complete(self, status: int, headers: list[tuple[bytes, bytes]], body: bytes) -> None:
        headers.append((b"content-length", str(len(body)).encode()))
        await self.send({"type": "http.response.start", "status": status, "headers": headers})
        await self._send({"type": "http.response.body", "body": body})


def cookie_of(headers: dict[str, str]) -> str:
    """Return the value of the session cookie; empty if there is none."""
    try:
        morsel = SimpleCookie(headers.get("cookie", "")).get(COOKIE)
    except CookieError:
        return ""
    return morsel.value if morsel is not None else ""


def _headers(scope: Scope) -> dict[str, str]:
    """Return a request's headers by lower-case name.

    The values of a repeated header are joined, which gives a valid value only for cookies. An invalid content length is replaced
    with one above the limit, so that the request is refused.
    """
    result: dict[str, str] = {}
    for name, value in scope["headers"]:
        key = name.decode("latin-1").lower()
        text = value.decode("latin-1")
        result[key] = f"{result[key]}; {text}" if key in result else text
    if not result.get("content-length", "0").isdecimal():
        result["content-length"] = str(MAX_PICTURE_BYTES + 1)
    return result


def _token_secret(authorization: str) -> str | None:
    """Return the token in an ``Authorization`` header; None if there is none.

    Most clients send a bearer token. Video players and home automation systems support only Basic authentication, in which the
    password is the token and the user name is ignored.
    """
    scheme, _, value = authorization.partition(" ")
    if scheme.lower() == "basic":
        try:
            _, _, value = base64.b64decode(value, validate=True).decode("utf-8").partition(":")
        except ValueError:
            return None
        return value or None
    return value.strip() or None if scheme.lower() == "bearer" else None


def _wants_page(scope: Scope, headers: dict[str, str]) -> bool:
    is_page = not scope["path"].startswith(PROGRAM_PATHS) and "text/html" in headers.get("accept", "")
    return bool(scope.get("method") == "GET" and is_page)


def max_body_bytes(path: str) -> int:
    """Return the maximum size of a request body, in bytes."""
    return MAX_PICTURE_BYTES if _PICTURE_PATH.fullmatch(path) else MAX_BODY_BYTES


def _limit_body(receive: Receive, max_bytes: int) -> Receive:
    """Wrap ``receive`` so that it reports a disconnect once the body exceeds the limit. The length in the headers is ignored."""
    received_bytes = 0

    async def limited_receive() -> Any:
        nonlocal received_bytes
        message = await receive()
        received_bytes += len(message.get("body", b"")) if message["type"] == "http.request" else 0
        return {"type": "http.disconnect"} if received_bytes > max_bytes else message

    return limited_receive
