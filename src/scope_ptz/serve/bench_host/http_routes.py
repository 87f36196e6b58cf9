"""The HTTP channel: an agent posts its messages, and each reply is the host's next message."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from scope_ptz.serve.bench_host.evaluation import HostedEvaluation, NotReadyError, NotYourTurnError
from scope_ptz.serve.bench_host.host import Host
from scope_ptz.serve.http.errors import error_reply
from scope_ptz.serve.security.access import Access
from scope_ptz.serve.security.rate_limits import RequestKind
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.error_codes import status_of
from scope_ptz.serve.site.errors import TooManyRequestsError

MESSAGES_PATH = "/api/v1/messages"
PROGRESS_PATH = "/api/v1/evaluation"
HEALTH_PATH = "/api/v1/health"


def http_routes(host: Host, access: Access) -> list[Route]:
    """Return the routes of the HTTP channel, to be mounted behind an ``AccessMiddleware``."""

    async def messages(request: Request) -> Response:
        evaluation = _evaluation(request, "command")
        return JSONResponse((await evaluation.exchange(await request.body())).model_dump(mode="json"))

    async def progress(request: Request) -> Response:
        return JSONResponse(progress_data(_evaluation(request, "read")))

    async def health(_: Request) -> Response:
        return JSONResponse({"status": "ok"})

    def _evaluation(request: Request, kind: RequestKind) -> HostedEvaluation:
        client: Client = request.state.client
        access.limits.count(client.name, kind)
        return host.evaluation(client.name)

    return [
        Route(MESSAGES_PATH, messages, methods=["POST"]),
        Route(PROGRESS_PATH, progress, methods=["GET"]),
        Route(HEALTH_PATH, health, methods=["GET"]),
    ]


def progress_data(evaluation: HostedEvaluation) -> dict[str, Any]:
    """Return an evaluation's progress as JSON data."""
    progress = evaluation.progress
    last = progress.last.model_dump(mode="json") if progress.last is not None else None
    return {**asdict(progress), "last": last}


async def scope_error(_: Request, error: Exception) -> Response:
    """Reply to a request that failed. The messages of unexpected errors stay on the host."""
    status, code = host_status_of(error)
    headers = {"Retry-After": str(round(error.retry_s))} if isinstance(error, TooManyRequestsError) else None
    return error_reply(status, code, public_message(error), headers)


def host_status_of(error: Exception) -> tuple[int, str]:
    """Return the HTTP status and the error code for an error."""
    if isinstance(error, NotYourTurnError):
        return 409, "not_your_turn"
    if isinstance(error, NotReadyError):
        return 503, "not_ready"
    return status_of(error)


def public_message(error: Exception) -> str:
    """Return an error's message for participants. Only errors about message order, readiness and rate limits show details."""
    if isinstance(error, NotYourTurnError | NotReadyError | TooManyRequestsError):
        return str(error)
    return "The host failed. Its operator can find the reason in its log."
