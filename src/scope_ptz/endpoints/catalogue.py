"""Find the models that a server lists, and the base URL of its API."""

from __future__ import annotations

from typing import Any

from scope_ptz.endpoints.bodies import read_object
from scope_ptz.endpoints.endpoint import Endpoint, Timeouts
from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from scope_ptz.endpoints.retries import Caller
from scope_ptz.endpoints.translate import status_failure

QUICK_TIMEOUTS = Timeouts(connect_s=3.0, first_byte_s=3.0, total_s=5.0)
"""Short timeouts for optional information, such as the model list."""


async def served_models(endpoint: Endpoint) -> tuple[str, ...]:
    """Return the names of the models that a server lists under ``GET /models``.

    Raises:
        ServerFailure: The server is unreachable or has no model list.
    """
    return tuple(str(entry["id"]) for entry in await _entries(endpoint))


async def find_api(endpoint: Endpoint) -> tuple[Endpoint, tuple[str, ...]]:
    """Return the endpoint and the models that it lists. If only its ``/v1`` URL has a list, return the endpoint with that URL.

    Raises:
        ServerFailure: Neither URL has a model list.
    """
    try:
        return endpoint, await served_models(endpoint)
    except ServerFailure as failure:
        if failure.kind not in (FailureKind.NOT_FOUND, FailureKind.WRONG_CONTENT_TYPE) or endpoint.url.endswith("/v1"):
            raise
        with_v1 = endpoint.model_copy(update={"url": f"{endpoint.url}/v1"})
        try:
            return with_v1, await served_models(with_v1)
        except ServerFailure:
            raise failure from None


async def _entries(endpoint: Endpoint) -> list[dict[str, Any]]:
    from scope_ptz.endpoints.transport import make_client

    quick = endpoint.model_copy(update={"timeouts": QUICK_TIMEOUTS, "retries": 0})

    async def fetch() -> dict[str, Any]:
        async with make_client(quick) as client, client.stream("GET", f"{quick.url}/models") as response:
            if response.is_success:
                return await read_object(response, quick)
            await response.aread()
            raise status_failure(response.status_code, response.headers, response.text, quick)

    listing, _ = await Caller(quick).call(fetch)
    data = listing.get("data", listing.get("models"))
    if not isinstance(data, list):
        raise ServerFailure(FailureKind.MALFORMED, where=quick.url, detail="no model list")
    return [entry for entry in data if isinstance(entry, dict) and isinstance(entry.get("id"), str) and entry["id"]]
