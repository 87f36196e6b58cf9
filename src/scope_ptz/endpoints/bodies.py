"""Read a server's replies: limit their size, decode them, and make them safe to store and print."""

from __future__ import annotations

import json
import re
from collections.abc import AsyncGenerator
from typing import TYPE_CHECKING, Any

from scope_ptz.endpoints.endpoint import MAX_BODY_BYTES, Endpoint
from scope_ptz.endpoints.failures import FailureKind, ServerFailure, one_line_excerpt, scrub
from scope_ptz.endpoints.translate import error_body

if TYPE_CHECKING:
    from httpx2 import Response


_MAX_QUOTED_BYTES = 80
"""Maximum number of bytes of an invalid body to quote in an error message."""

_JSON_TYPE = re.compile(r"^(application|text)/([\w.+-]+\+)?json$")
_UNSAFE = re.compile("[\\x00-\\x08\\x0b\\x0c\\x0e-\\x1f\\x7f-\\x9f\\ud800-\\udfff]")
# The same characters in JSON: escape sequences and raw bytes.
_UNSAFE_ESCAPE = re.compile(rb"\\u(00[0189]|[dD][89a-fA-F])|\\[bf]|[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]|\xc2[\x80-\x9f]")


def content_type(response: Response) -> str:
    """Return the media type of a response in lower case; empty if the server sent none."""
    return str(response.headers.get("content-type", "")).partition(";")[0].strip().lower()


def is_json(media_type: str) -> bool:
    """Return whether a media type is JSON. A missing media type counts as JSON."""
    return not media_type or _JSON_TYPE.match(media_type) is not None


def wrong_type_failure(media_type: str, endpoint: Endpoint, status: int) -> ServerFailure:
    """Return a failure for a reply with the wrong content type."""
    return ServerFailure(
        FailureKind.WRONG_CONTENT_TYPE, where=endpoint.url, status=status, detail=f"content type {media_type or 'missing'}"[:100]
    )


def too_large_failure(endpoint: Endpoint, status: int) -> ServerFailure:
    """Return a failure for a reply larger than ``MAX_BODY_BYTES``."""
    return ServerFailure(FailureKind.TOO_LARGE, where=endpoint.url, status=status, detail=f"over {MAX_BODY_BYTES // 2**20} MB")


async def chunks(response: Response, endpoint: Endpoint) -> AsyncGenerator[bytes, None]:
    """Yield the decompressed body in chunks.

    Raises:
        ServerFailure: The body exceeds ``MAX_BODY_BYTES``, or the server stopped sending after the first chunk.
    """
    import httpx2

    received = 0
    try:
        async for chunk in response.aiter_bytes():
            received += len(chunk)
            if received > MAX_BODY_BYTES:
                raise too_large_failure(endpoint, response.status_code)
            yield chunk
    except httpx2.ReadTimeout:
        if not received:
            raise
        detail = f"no data for {endpoint.timeouts.first_byte_s:g} s in the middle of the reply"
        raise ServerFailure(FailureKind.CUT_OFF, where=endpoint.url, status=response.status_code, detail=detail) from None


async def read_object(response: Response, endpoint: Endpoint) -> dict[str, Any]:
    """Read the body of a response as a JSON object.

    Raises:
        ServerFailure: The content type is wrong, or the body is empty, is too large, is not a JSON object, or is an error message.
    """
    media_type = content_type(response)
    if not is_json(media_type):
        raise wrong_type_failure(media_type, endpoint, response.status_code)
    body = b"".join([chunk async for chunk in chunks(response, endpoint)])
    return load_object(body, endpoint, response.status_code)


def load_object(body: bytes, endpoint: Endpoint, status: int) -> dict[str, Any]:
    """Parse a JSON object from bytes. The API key and characters that are unsafe in files or terminals are replaced.

    Raises:
        ServerFailure: The body is empty, is not a JSON object, or is an error message.
    """
    if not body.strip():
        raise ServerFailure(FailureKind.EMPTY, where=endpoint.url, status=status, detail="an empty body")
    try:
        # Non-strict parsing accepts raw line breaks in strings, which some servers send.
        data: Any = json.loads(scrub(body.decode("utf-8"), endpoint.secret), strict=False)
    except (ValueError, RecursionError) as error:
        detail = f"{_json_error(error)} in '{one_line_excerpt(body[:_MAX_QUOTED_BYTES].decode(errors='replace'), endpoint.secret)}'"
        raise ServerFailure(FailureKind.MALFORMED, where=endpoint.url, status=status, detail=detail) from None
    if not isinstance(data, dict):
        raise ServerFailure(
            FailureKind.MALFORMED, where=endpoint.url, status=status, detail=f"a JSON {type(data).__name__} instead of an object"
        )
    content: dict[str, Any] = _make_safe(data) if _UNSAFE_ESCAPE.search(body) else data
    failure = error_body(content, endpoint, status)
    if failure is not None:
        raise failure
    return content


def _json_error(error: Exception) -> str:
    if isinstance(error, json.JSONDecodeError):
        return f"not JSON: {error.msg} at character {error.pos}"
    return "not JSON: nested too deeply" if isinstance(error, RecursionError) else "not UTF-8, or a number has too many digits"


def _make_safe(value: Any) -> Any:
    if isinstance(value, str):
        return safe_text(value)
    if isinstance(value, list):
        return [_make_safe(item) for item in value]
    if isinstance(value, dict):
        return {safe_text(name): _make_safe(item) for name, item in value.items()}
    return value


def safe_text(text: str) -> str:
    """Replace control characters, which terminals interpret, and lone surrogates, which cannot be encoded as UTF-8."""
    return _UNSAFE.sub("\ufffd", text)
