"""Send requests to a ``scope serve`` server, and convert its errors to the exceptions of a local session."""

from __future__ import annotations

import json
import secrets
from collections.abc import AsyncIterator, Mapping
from types import TracebackType
from typing import Any, NoReturn, Self
from urllib.parse import quote, urlsplit

import httpx2

from scope_ptz.camera.guard.guarded_camera import KeepOutError
from scope_ptz.endpoints.events import EventParser
from scope_ptz.errors import (
    CameraError,
    ConfigError,
    InputError,
    OutputError,
    PerceptionError,
    ScopeError,
    TraceError,
    UnknownNameError,
)
from scope_ptz.settings import load_settings

TIMEOUT = httpx2.Timeout(30.0, connect=10.0)
NO_TIMEOUT = httpx2.Timeout(None, connect=10.0)
"""Timeouts for requests that move the camera, start a run or call a tool. Only connecting has a time limit, because the reply may
take any length of time."""

MAX_REPLY_BYTES = 64_000_000  # longer replies are rejected

_ERRORS: Mapping[str, type[ScopeError]] = {
    "not_possible": InputError,
    "wrong_request": InputError,
    "malformed": InputError,
    "sign_in": ConfigError,
    "not_allowed": ConfigError,
    "cannot_be_written": OutputError,
    "not_stored": TraceError,
    "perception_failed": PerceptionError,
    "kept_out": KeepOutError,
}
"""Exceptions by API error code. The code ``unknown`` raises ``RemoteNameError``, and other unlisted codes raise
``CameraError``."""


class RemoteNameError(UnknownNameError):
    """A name that the server does not know."""

    def __init__(self, message: str) -> None:
        self.kind, self.name, self.known = "name", "", []
        ScopeError.__init__(self, message)


class Connection:
    """Sends requests about a camera to its server. Redirects are not followed, and proxies are not used.

    Args:
        address: The address of the camera, such as ``http://host:8000/yard-gate``.

    Raises:
        ConfigError: The address does not contain a camera name, or contains a password.
    """

    def __init__(self, address: str) -> None:
        parts = urlsplit(address.strip())
        camera = parts.path.strip("/")
        if parts.username is not None or parts.password is not None:
            raise ConfigError("Remove the user name and password from the server's address. Set the token in SCOPE_TOKEN instead.")
        if not parts.hostname or not camera or "/" in camera or parts.query or parts.fragment:
            raise ConfigError(
                "The address of a camera on a server must have the form http://HOST:PORT/CAMERA, for example "
                "http://localhost:8000/highway-works."
            )
        self.server, self.camera = f"{parts.scheme}://{parts.netloc}", camera
        token = load_settings().token
        self._headers = {"Scope-Client": secrets.token_urlsafe(12)}
        if token is not None:
            self._headers["Authorization"] = f"Bearer {token.get_secret_value()}"
        self._base = f"{self.server}/api/v1"
        self._client = httpx2.AsyncClient(headers=self._headers, timeout=TIMEOUT, follow_redirects=False, trust_env=False)

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        await self.close()

    async def close(self) -> None:
        """Close all connections to the server."""
        await self._client.aclose()

    async def request(self, method: str, path: str, body: Mapping[str, Any] | None = None, *, no_timeout: bool = False) -> Any:
        """Send a request, and return the reply as parsed JSON; None if the reply is empty.

        Args:
            method: The HTTP method.
            path: The path below ``/api/v1``. A leading ``~`` represents the camera's path.
            body: The body, which is sent as JSON.
            no_timeout: Whether to wait for the reply indefinitely.

        Raises:
            ScopeError: The server replied with an error. The class of the exception is the same as in a local session.
            CameraError: The server cannot be reached, or its reply is invalid.
        """
        response = await self._send(method, path, body, no_timeout=no_timeout)
        if not response.content:
            return None
        try:
            return response.json()
        except ValueError:
            raise self._not_a_scope_server() from None

    async def picture(self, path: str) -> tuple[bytes, dict[str, Any]]:
        """Download an encoded picture, and return it with the parsed content of its ``Scope-Frame`` header."""
        response = await self._send("GET", path, None)
        try:
            facts = json.loads(response.headers.get("scope-frame", "{}"))
        except ValueError:
            raise self._not_a_scope_server() from None
        return response.content, facts

    def picture_sync(self, path: str) -> bytes:
        """Download an encoded picture. This method is for callers outside the event loop."""
        try:
            with httpx2.Client(headers=self._headers, timeout=TIMEOUT, follow_redirects=False, trust_env=False) as client:
                response = client.get(self._url(path))
        except httpx2.HTTPError as error:
            raise self._unreachable(error) from error
        if not response.is_success:
            self._raise_error(response)
        return response.content

    async def events(self, run: str) -> AsyncIterator[bytes]:
        """Yield the records of a run as JSON as they arrive. A lost connection is re-established.

        Raises:
            CameraError: The connection was lost and cannot be re-established.
        """
        last, failures = -1, 0
        while True:
            parser = EventParser()
            try:
                path = f"/runs/{quote(run)}/events"
                async with self._client.stream("GET", self._url(path), headers={"Last-Event-ID": str(last)}) as response:
                    if not response.is_success:
                        await response.aread()
                        self._raise_error(response)
                    async for piece in response.aiter_bytes():
                        for data in parser.feed(piece):
                            last, failures = last + 1, 0
                            yield data
            except httpx2.HTTPError as error:
                failures += 1
                if failures > 3:
                    raise self._unreachable(error) from error
            else:
                return

    async def _send(self, method: str, path: str, body: Mapping[str, Any] | None, *, no_timeout: bool = False) -> httpx2.Response:
        timeout = NO_TIMEOUT if no_timeout else TIMEOUT
        try:
            response = await self._client.request(method, self._url(path), json=body, timeout=timeout)
        except httpx2.HTTPError as error:
            raise self._unreachable(error) from error
        if len(response.content) > MAX_REPLY_BYTES:
            raise self._not_a_scope_server()
        if not response.is_success:
            self._raise_error(response)
        return response

    def _url(self, path: str) -> str:
        return f"{self._base}/cameras/{quote(self.camera)}{path[1:]}" if path.startswith("~") else self._base + path

    def _raise_error(self, response: httpx2.Response) -> NoReturn:
        try:
            problem = response.json()["error"]
            code, message = str(problem["code"]), str(problem["message"])
        except (ValueError, KeyError, TypeError):
            raise self._not_a_scope_server() from None
        if code == "unknown":
            raise RemoteNameError(message)
        if code == "sign_in":
            message = (
                f"{self.server} requires a token. Create a token on the server with `scope token add`, and set SCOPE_TOKEN to it."
            )
        raise _ERRORS.get(code, CameraError)(message)

    def _unreachable(self, error: Exception) -> CameraError:
        reason = str(error) or type(error).__name__
        return CameraError(
            f"The server {self.server} is not responding: {reason}. Start the server with `scope serve`, or check the address."
        )

    def _not_a_scope_server(self) -> CameraError:
        return CameraError(f"{self.server} responds, but is not a `scope serve` server. Check the address.")
