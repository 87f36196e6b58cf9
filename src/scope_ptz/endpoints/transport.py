"""The HTTP client of all model clients. It is imported at the first request, because it imports an HTTP library."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from typing import Any

import httpx2

from scope_ptz.endpoints.bodies import too_large
from scope_ptz.endpoints.endpoint import MAX_BODY_BYTES, Endpoint
from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from scope_ptz.version import __version__

_KEPT_HEADERS = frozenset(
    {"host", "accept", "accept-encoding", "connection", "content-type", "content-length", "transfer-encoding", "user-agent"}
)
_COMPRESSION = 128
"""Factor by which a compressed body may grow."""


def make_client(endpoint: Endpoint, *, key_header: str = "Authorization") -> httpx2.AsyncClient:
    """Return a client that keeps its connections, applies the endpoint's timeouts, and sends no credential but the endpoint's
    key.

    It follows no redirects, because the key must not be sent where the user did not send it.

    Raises:
        ServerFailure: The environment names a proxy or certificates that cannot be used.
    """
    secret = endpoint.secret
    ours = {"user-agent": f"scope-ptz/{__version__}"}
    if secret:
        ours[key_header] = f"Bearer {secret}" if key_header == "Authorization" else secret

    async def only_ours(request: httpx2.Request) -> None:
        # The openai client adds headers from OPENAI_... variables, which are credentials for another server.
        for name in [name for name in request.headers if name.lower() not in _KEPT_HEADERS]:
            del request.headers[name]
        request.headers.update(ours)

    async def capped(response: httpx2.Response) -> None:
        if isinstance(response.stream, httpx2.AsyncByteStream):
            response.stream = _Capped(response.stream, response, endpoint)

    try:
        return _open(endpoint, {"request": [only_ours], "response": [capped]})
    except (ValueError, OSError, ImportError, httpx2.InvalidURL) as error:
        # The original message is not shown, because a proxy's address may contain a password.
        detail = f"the environment's proxy or certificate settings cannot be used ({type(error).__name__})"
        raise ServerFailure(FailureKind.REFUSED, where=endpoint.url, detail=detail) from None


def _open(endpoint: Endpoint, hooks: dict[str, list[Callable[..., Any]]]) -> httpx2.AsyncClient:
    patience = endpoint.timeouts
    return httpx2.AsyncClient(
        timeout=httpx2.Timeout(patience.first_byte_s, connect=patience.connect_s, pool=patience.total_s),
        limits=httpx2.Limits(max_connections=64, max_keepalive_connections=16, keepalive_expiry=30.0),
        headers={"accept-encoding": "identity"},
        trust_env=not endpoint.loopback,  # no proxy leads to this machine, whatever the environment says
        verify=endpoint.url.startswith("https:"),  # loading certificates takes a tenth of a second
        follow_redirects=False,
        event_hooks=hooks,
    )


class _Capped(httpx2.AsyncByteStream):
    """A body that fails above its limit for any reader, including error bodies."""

    def __init__(self, stream: httpx2.AsyncByteStream, response: httpx2.Response, endpoint: Endpoint) -> None:
        compressed = response.headers.get("content-encoding", "identity") != "identity"
        self._stream, self._endpoint, self._status = stream, endpoint, response.status_code
        self._left = MAX_BODY_BYTES // _COMPRESSION if compressed else MAX_BODY_BYTES

    async def __aiter__(self) -> AsyncIterator[bytes]:
        async for chunk in self._stream:
            self._left -= len(chunk)
            if self._left < 0:
                raise too_large(self._endpoint, self._status)
            yield chunk

    async def aclose(self) -> None:
        await self._stream.aclose()
