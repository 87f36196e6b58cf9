"""What a server has on offer: its list of models, and where its API begins."""

from __future__ import annotations

from typing import Any

from scope_ptz.endpoints.bodies import read_object
from scope_ptz.endpoints.endpoint import Endpoint, Timeouts
from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from scope_ptz.endpoints.retries import Caller
from scope_ptz.endpoints.translate import status_failure

PATIENCE = Timeouts(connect_s=3.0, first_byte_s=3.0, total_s=5.0)
"""The list is a convenience: nobody shall wait long for it."""


async def served_models(endpoint: Endpoint) -> tuple[str, ...]:
    """The names under which a server serves models, as ``GET /models`` lists them.

    Raises:
        ServerFailure: there is no such list.
    """
    return tuple(str(entry["id"]) for entry in await _entries(endpoint))


async def find_api(endpoint: Endpoint) -> tuple[Endpoint, tuple[str, ...]]:
    """The endpoint and its models; when only its address with ``/v1`` has a list, then that one.

    Raises:
        ServerFailure: neither has one.
    """
    try:
        return endpoint, await served_models(endpoint)
    except ServerFailure as failure:
        if failure.kind not in (FailureKind.NOT_FOUND, FailureKind.WRONG_CONTENT_TYPE) or endpoint.url.endswith("/v1"):
            raise
        longer = endpoint.model_copy(update={"url": f"{endpoint.url}/v1"})
        try:
            return longer, await served_models(longer)
        except ServerFailure:
            raise failure from None


async def _entries(endpoint: Endpoint) -> list[dict[str, Any]]:
    from scope_ptz.endpoints.transport import make_client

    quick = endpoint.model_copy(update={"timeouts": PATIENCE, "retries": 0})

    async def ask() -> dict[str, Any]:
        async with make_client(quick) as client, client.stream("GET", f"{quick.url}/models") as response:
            if response.is_success:
                return await read_object(response, quick)
            await response.aread()
            raise status_failure(response.status_code, response.headers, response.text, quick)

    listing, _ = await Caller(quick).call(ask)
    data = listing.get("data", listing.get("models"))
    if not isinstance(data, list):
        raise ServerFailure(FailureKind.MALFORMED, where=quick.url, detail="no list of models")
    return [entry for entry in data if isinstance(entry, dict) and isinstance(entry.get("id"), str) and entry["id"]]
