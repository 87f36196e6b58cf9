"""Replies to failed requests. Each contains a code for programs and a message for people."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from starlette.exceptions import HTTPException
from starlette.routing import Match

from scope_ptz.errors import ScopeError
from scope_ptz.serve.http.models import ErrorReply
from scope_ptz.serve.site.error_codes import status_of
from scope_ptz.serve.site.errors import TooManyRequestsError

# Codes for errors that the framework raises, by HTTP status.
_CODES = {400: "malformed", 401: "sign_in", 403: "not_allowed", 404: "unknown", 405: "method", 413: "too_large", 415: "media_type"}


def responses(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI entries for an operation's error replies: the given statuses, and those common to all operations."""
    return {status: {"model": ErrorReply} for status in (400, 401, 403, 422, 429, *statuses)}


def add_error_handlers(app: FastAPI) -> None:
    """Add handlers to an application, so that all its error replies have the same form."""
    app.add_exception_handler(ScopeError, _scope_error)
    app.add_exception_handler(RequestValidationError, _invalid_request)
    app.add_exception_handler(HTTPException, http_error)


def error_reply(status: int, code: str, message: str, headers: dict[str, str] | None = None) -> JSONResponse:
    """Return an error reply."""
    # A message may quote a lone surrogate from the request, which cannot be encoded.
    message = message.encode("utf-8", "replace").decode()
    return JSONResponse({"error": {"code": code, "message": message}}, status, headers)


async def _scope_error(_: Request, error: Exception) -> JSONResponse:
    status, code = status_of(error)
    headers = {"Retry-After": str(round(error.retry_s))} if isinstance(error, TooManyRequestsError) else None
    return error_reply(status, code, str(error), headers)


async def _invalid_request(_: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)  # noqa: S101 - registered for this class only
    first = error.errors()[0]
    where = ".".join(str(part)[:60] for part in first["loc"])
    return error_reply(422, "wrong_request", f"{where}: {first['msg']}")


async def http_error(request: Request, error: Exception) -> JSONResponse:
    """Reply to an HTTP error that the framework raised."""
    assert isinstance(error, HTTPException)  # noqa: S101 - registered for this class only
    headers = dict(error.headers) if error.headers else None
    if error.status_code == 405:
        headers = {"Allow": ", ".join(_methods(request))}
    return error_reply(error.status_code, _CODES.get(error.status_code, "failed"), str(error.detail), headers)


def _methods(request: Request) -> list[str]:
    """Return all HTTP methods that a request's path accepts. The framework itself reports only those of one operation."""
    methods: set[str] = set()
    for route in request.app.routes:
        match, _ = route.matches(request.scope)
        if match is not Match.NONE:
            methods |= getattr(route, "methods", None) or set()
    return sorted(methods)
