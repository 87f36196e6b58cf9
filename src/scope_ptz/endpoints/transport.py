"""The HTTP client for all model clients. This module imports an HTTP library, so import it only when sending a request."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from typing import Any

import httpx2

from scope_ptz.endpoints.bodies import too_large_failure
from scope_ptz.endpoints.endpoint import MAX_BODY_BYTES, Endpoint
from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from scope_ptz.version import __version__

_ALLOWED_HEADERS = frozenset(
    {"host", "accept", "accept-encoding", "connection", "content-type", "content-length", "transfer-encoding", "user-agent"}
)
_MAX_COMPRESSION = 128
"""Assumed maximum compression ratio. Compressed bodies are limited to ``MAX_BODY_BYTES`` divided by this number."""


def make_client(endpoint: Endpoint, *, key_header: str = "Authorization") -> httpx2.AsyncClient:
    """Create a client that applies the endpoint's timeouts and sends no credentials except the endpoint's key.

    It does not follow redirects, because the key must be sent only to the URL that the user specified.

    Raises:
        ServerFailure: The environment's proxy or certificate settings are invalid.
    """
    secret = endpoint.secret
    own_headers = {"user-agent": f"scope-ptz/{__version__}"}
    if secret:
        own_headers[key_header] = f"Bearer {secret}" if key_header == "Authorization" else secret

    async def replace_headers(request: httpx2.Request) -> None:
        # The openai client adds headers from OPENAI_... variables, which contain credentials for another server.
        for name in [name for name in request.headers if name.lower() not in _ALLOWED_HEADERS]:
            del request.headers[name]
        request.headers.update(own_headers)

    async def limit_body(response: httpx2.Response) -> None:
        if isinstance(response.stream, httpx2.AsyncByteStream):
            response.stream = _LimitedBody(response.stream, response, endpoint)

    try:
        return _create_client(endpoint, {"request": [replace_headers], "response": [limit_body]})
    except (ValueError, OSError, ImportError, httpx2.InvalidURL) as error:
        # Do not show the original message, because a proxy URL may contain a password.
        detail = f"the environment's proxy or certificate settings cannot be used ({type(error).__name__})"
        raise ServerFailure(FailureKind.REFUSED, where=endpoint.url, detail=detail) from None


def _create_client(endpoint: Endpoint, hooks: dict[str, list[Callable[..., Any]]]) -> httpx2.AsyncClient:
    timeouts = endpoint.timeouts
    return httpx2.AsyncClient(
        timeout=httpx2.Timeout(timeouts.first_byte_s, connect=timeouts.connect_s, pool=timeouts.total_s),
        limits=httpx2.Limits(max_connections=64, max_keepalive_connections=16, keepalive_expiry=30.0),
        headers={"accept-encoding": "identity"},
        trust_env=not endpoint.is_loopback,  # requests to this machine never use a proxy
        verify=endpoint.url.startswith("https:"),  # certificates load slowly and are required only for HTTPS
        follow_redirects=False,
        event_hooks=hooks,
    )


class _LimitedBody(httpx2.AsyncByteStream):
    """A response body that raises ``ServerFailure`` if it exceeds its size limit, even if a library reads it."""

    def __init__(self, stream: httpx2.AsyncByteStream, response: httpx2.Response, endpoint: Endpoint) -> None:
        compressed = response.headers.get("content-encoding", "identity") != "identity"
        self._stream, self._endpoint, self._status = stream, endpoint, response.status_code
        self._bytes_left = MAX_BODY_BYTES // _MAX_COMPRESSION if compressed else MAX_BODY_BYTES

    async def __aiter__(self) -> AsyncIterator[bytes]:
        async for chunk in self._stream:
            self._bytes_left -= len(chunk)
            if self._bytes_left < 0:
                raise too_large_failure(self._endpoint, self._status)
            yield chunk

    async def aclose(self) -> None:
        await self._stream.aclose()
