"""Check whether a chat server works, independently of cameras and planning."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable
from time import perf_counter
from typing import Literal

import anyio
from pydantic import BaseModel, ConfigDict

from scope_ptz.endpoints.catalogue import served_models
from scope_ptz.endpoints.chat import ChatClient
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from scope_ptz.errors import ScopeError

Verdict = Literal["ok", "partly", "failed"]
FATAL_FAILURES = frozenset(
    {FailureKind.REFUSED, FailureKind.DNS, FailureKind.TLS, FailureKind.CONNECT_TIMEOUT, FailureKind.UNAUTHORISED}
)
"""Failure kinds after which no further check can succeed."""
_GREETING = [
    {"role": "system", "content": "You answer in one short sentence."},
    {"role": "user", "content": "Say hello."},
]
UNKNOWN_MODEL_CHECK = "unknown model name"
"""The name of the last check, which is skipped if the server is unreachable or rejects the key."""
_NO_MODEL = "no-model-has-this-name"


class ServerCheck(BaseModel):
    """The result of a check.

    Attributes:
        verdict: "partly" means that SCOPE works with the server, but with limitations; "failed" means that it does not.
        kind: The kind of the server failure; empty if there was none.
    """

    model_config = ConfigDict(frozen=True)

    what: str
    verdict: Verdict
    detail: str = ""
    kind: str = ""
    seconds: float = 0.0


Finding = tuple[Verdict, str]


async def run_check(what: str, check: Callable[[], Awaitable[Finding]]) -> ServerCheck:
    """Run a check. A ``ScopeError`` becomes a failed check; other exceptions propagate."""
    began, kind = perf_counter(), ""
    try:
        verdict, detail = await check()
    except ScopeError as error:
        verdict, detail, kind = "failed", str(error), str(getattr(error, "kind", None) or "")
    return ServerCheck(what=what, verdict=verdict, detail=detail, kind=kind, seconds=round(perf_counter() - began, 3))


async def check_chat(endpoint: Endpoint) -> AsyncIterator[ServerCheck]:
    """Run the checks for a chat server, and yield each result. Stop early if the server is unreachable or rejects the key."""
    single_retry = endpoint.model_copy(update={"retries": 1})
    client = ChatClient(single_retry)
    try:
        yield await run_check("list of models", lambda: _check_listing(single_retry))
        answer = await run_check("reply", lambda: _check_answer(client, stream=False))
        yield answer
        if answer.kind in FATAL_FAILURES:
            return
        yield await run_check("streamed reply", lambda: _check_answer(client, stream=True))
        yield await run_check("two concurrent requests", lambda: _check_concurrency(client))
        yield await run_check(UNKNOWN_MODEL_CHECK, lambda: _check_unknown_model(single_retry))
    finally:
        await client.close()


async def _check_listing(endpoint: Endpoint) -> Finding:
    try:
        served = await served_models(endpoint)
    except ServerFailure as failure:
        if failure.kind in FATAL_FAILURES:
            raise
        return "partly", f"{failure} Specify the model's name with an option."
    if endpoint.model in served:
        return "ok", f"{len(served)} listed, including '{endpoint.model}'"
    return "partly", f"'{endpoint.model}' is not listed; the server lists {', '.join(served[:10]) or 'none'}"


async def _check_answer(client: ChatClient, *, stream: bool) -> Finding:
    reply = await client.complete(_GREETING, stream=stream)
    throughput = f"{reply.output_tokens} tokens in {reply.seconds:.2f} s"
    if not (reply.text or reply.reasoning):
        return "failed", "the reply is empty"
    if not reply.output_tokens:
        return "partly", "the server does not report token counts, so token budgets cannot be enforced and speed cannot be measured"
    if stream and reply.first_token_s is None:
        return "partly", f"{throughput}; the reply was not streamed, but arrived in one piece"
    first = f", the first after {reply.first_token_s:.2f} s" if reply.first_token_s is not None else ""
    return "ok", throughput + first


async def _check_concurrency(client: ChatClient) -> Finding:
    failures: list[ServerFailure] = []

    async def ask() -> None:
        try:
            await client.complete(_GREETING)
        except ServerFailure as failure:
            failures.append(failure)

    async with anyio.create_task_group() as group:
        group.start_soon(ask)
        group.start_soon(ask)
    if failures:
        raise failures[0]
    return "ok", "both were answered"


async def _check_unknown_model(endpoint: Endpoint) -> Finding:
    client = ChatClient(endpoint.model_copy(update={"model": _NO_MODEL}))
    try:
        reply = await client.complete(_GREETING)
    except ServerFailure as failure:
        if failure.kind in (FailureKind.NOT_FOUND, FailureKind.BAD_REQUEST):
            return "ok", f"rejected: {failure.kind.value}"
        return "partly", f"the error does not say that the model is unknown: {failure}"
    finally:
        await client.close()
    return "partly", f"'{reply.model or 'a model'}' answered a request for an unknown model; check that it is the right model"
