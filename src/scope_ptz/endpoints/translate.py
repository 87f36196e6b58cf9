"""Convert exceptions from HTTP libraries and error replies from servers to ``ServerFailure``."""

from __future__ import annotations

import json
import re
import socket
import ssl
import sys
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import Any

from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import FailureKind, ServerFailure, one_line_excerpt

_OVERFLOW = re.compile(
    r"context[ _-]?(length|size|window|overflow)|maximum (context|sequence|model|input)[ _-]?len|max_model_len"
    r"|(prompt|input|conversation) is too long|too many (input )?tokens|longer than the model"
    r"|exceed\w*[^.]{0,40}(context|number of tokens|token limit)|reduce the length|tokens to keep from the initial prompt",
    re.IGNORECASE,
)
"""Matches context overflow messages from vLLM, SGLang, llama.cpp, LM Studio, TGI, OpenAI and others, which share no error code."""

_NO_CREDIT = re.compile(r"insufficient_quota|billing|payment|credits?\b", re.IGNORECASE)


def as_failure(error: BaseException, endpoint: Endpoint) -> ServerFailure | None:
    """Convert an exception from a client library to a failure; None for other exceptions, such as bugs."""
    import httpx2

    chain = list(_chain(error))
    for link in chain:
        if isinstance(link, ServerFailure):
            return link
    openai = sys.modules.get("openai")  # not imported here, because that takes most of a second
    for link in chain:
        if openai is not None and isinstance(link, openai.APIStatusError):
            return status_failure(link.response.status_code, link.response.headers, _body_text(link.response), endpoint)
    for link in chain:
        if isinstance(link, httpx2.TransportError | httpx2.DecodingError | httpx2.InvalidURL):
            kind, detail = _transport_kind(link, chain, endpoint)
            return ServerFailure(kind, where=endpoint.url, detail=one_line_excerpt(detail, endpoint.secret))
    if openai is not None and isinstance(error, openai.APIConnectionError):
        return ServerFailure(FailureKind.REFUSED, where=endpoint.url)
    return None


def _chain(error: BaseException) -> Iterator[BaseException]:
    """Yield an exception, its causes and contexts, and the members of exception groups."""
    pending, visited = [error], set[int]()
    while pending:
        link = pending.pop(0)
        if id(link) in visited:
            continue
        visited.add(id(link))
        yield link
        if isinstance(link, BaseExceptionGroup):
            pending.extend(link.exceptions)
        pending.extend(cause for cause in (link.__cause__, link.__context__) if cause is not None)


def _transport_kind(error: Exception, chain: list[BaseException], endpoint: Endpoint) -> tuple[FailureKind, str]:
    import httpx2

    timeouts = endpoint.timeouts
    if isinstance(error, httpx2.ConnectTimeout | httpx2.PoolTimeout):
        return FailureKind.CONNECT_TIMEOUT, f"the limit is {timeouts.connect_s:g} s"
    if isinstance(error, httpx2.TimeoutException):
        return FailureKind.FIRST_BYTE_TIMEOUT, f"the limit is {timeouts.first_byte_s:g} s"
    if isinstance(error, httpx2.ConnectError | httpx2.ProxyError):
        if any(isinstance(link, socket.gaierror) for link in chain):
            return FailureKind.DNS, endpoint.host
        if any(isinstance(link, ssl.SSLError) for link in chain):
            return FailureKind.TLS, str(next(link for link in chain if isinstance(link, ssl.SSLError)))
        return FailureKind.REFUSED, "" if any(isinstance(link, ConnectionRefusedError) for link in chain) else str(error)
    if isinstance(error, httpx2.RemoteProtocolError):
        cut_off = re.search(r"disconnect|closed|incomplete|without sending", str(error), re.IGNORECASE)
        return (FailureKind.CUT_OFF if cut_off else FailureKind.MALFORMED), str(error)
    if isinstance(error, httpx2.NetworkError):
        return FailureKind.CUT_OFF, "the connection was lost"
    if isinstance(error, httpx2.DecodingError):
        return FailureKind.MALFORMED, str(error)
    return FailureKind.BAD_REQUEST, type(error).__name__


def _body_text(response: Any) -> str:
    try:
        return str(response.text)
    except Exception:  # the body was not read or cannot be decoded; the status is enough
        return ""


def status_failure(status: int, headers: Mapping[str, str], body: str, endpoint: Endpoint) -> ServerFailure:
    """Return a failure for a redirect or a reply with an error status."""
    parsed = _ErrorBody(body)
    if 300 <= status < 400:
        kind, parsed.message = FailureKind.NOT_FOUND, f"it redirects to {headers.get('location', 'an unknown address')}"
    elif status in (400, 413, 422, 500) and parsed.is_overflow:
        kind = FailureKind.CONTEXT_OVERFLOW
    elif status in (401, 402, 403, 407) or (status == 429 and parsed.has_no_credit):
        kind = FailureKind.UNAUTHORISED
    elif status == 429:
        kind = FailureKind.RATE_LIMITED
    elif status == 404:
        kind = FailureKind.NOT_FOUND
    elif status >= 500 or status in (408, 409, 425):
        kind = FailureKind.SERVER_ERROR
    else:
        kind = FailureKind.BAD_REQUEST
    detail = one_line_excerpt(parsed.message, endpoint.secret)
    return ServerFailure(kind, where=endpoint.url, status=status, retry_after_s=retry_after_s(headers), detail=detail)


def error_body(body: dict[str, Any], endpoint: Endpoint, status: int = 200) -> ServerFailure | None:
    """Return a failure for an error message in a reply with a success status; None if the reply is not an error message."""
    if not body.get("error") and body.get("object") != "error" and not _is_only_message(body):
        return None
    parsed = _ErrorBody(json.dumps(body))
    if parsed.is_overflow:
        kind = FailureKind.CONTEXT_OVERFLOW
    elif parsed.tags & {"429", "rate_limit_exceeded"}:
        kind = FailureKind.RATE_LIMITED
    elif parsed.tags & {"401", "403", "invalid_api_key"}:
        kind = FailureKind.UNAUTHORISED
    else:
        kind = FailureKind.ERROR_BODY
    return ServerFailure(kind, where=endpoint.url, status=status, detail=one_line_excerpt(parsed.message, endpoint.secret))


_MESSAGE_FIELDS = frozenset({"detail", "message"})
_ERROR_FIELDS = _MESSAGE_FIELDS | {"code", "error", "status", "status_code", "statusCode", "title", "type", "success", "request_id"}


def _is_only_message(body: dict[str, Any]) -> bool:
    """Return whether a body contains only a message, which is how gateways and simple frameworks report errors."""
    return body.keys() <= _ERROR_FIELDS and any(body.get(name) for name in _MESSAGE_FIELDS)


class _ErrorBody:
    """The parsed body of an error reply.

    Attributes:
        message: The messages in the usual fields, or the body without markup if there are none.
        tags: The error codes and types.
    """

    def __init__(self, body: str) -> None:
        try:
            data = json.loads(body)
        except (ValueError, RecursionError):
            data = None
        levels = [data, data.get("error")] if isinstance(data, dict) else [data]
        messages, self.tags = [level for level in levels if isinstance(level, str)], set[str]()
        for level in levels:
            if isinstance(level, dict):
                messages += [_as_text(level[name]) for name in ("message", "detail") if level.get(name)]
                self.tags |= {str(level[name]) for name in ("code", "type", "status") if level.get(name)}
        self.message = "; ".join(dict.fromkeys(messages)) or re.sub(r"<[^>]*>", " ", body[:4000])

    @property
    def is_overflow(self) -> bool:
        return any(_OVERFLOW.search(text) for text in (self.message, *self.tags))

    @property
    def has_no_credit(self) -> bool:
        """Whether the account has run out of credit, so that waiting does not help."""
        return any(_NO_CREDIT.search(text) for text in (self.message, *self.tags))


def _as_text(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value)[:4000]


def retry_after_s(headers: Mapping[str, str]) -> float | None:
    """Return the pause in seconds requested by the Retry-After header; None if it is missing or invalid."""
    milliseconds = _number(headers.get("retry-after-ms"))
    if milliseconds is not None:
        return milliseconds / 1000
    value = headers.get("retry-after")
    seconds = _number(value)
    if seconds is not None or not value:
        return seconds
    try:
        date = parsedate_to_datetime(value)
    except (ValueError, TypeError, IndexError, OverflowError):
        return None
    date = date if date.tzinfo is not None else date.replace(tzinfo=UTC)
    return max(0.0, (date - datetime.now(UTC)).total_seconds())


def _number(value: str | None) -> float | None:
    try:
        number = float(value) if value else None
    except ValueError:
        return None
    return number if number is not None and 0 <= number < 1e7 else None
