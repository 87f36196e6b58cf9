"""Under which name a server serves the model that is wanted."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scope_ptz.cli.endings import complain
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.endpoints.endpoint import Endpoint
    from scope_ptz.registry import Model, Registry, Role


async def named(endpoint: Endpoint, wanted: str | None, model: Model | None, option: str) -> Endpoint:
    """The endpoint with the name under which its server serves the model."""
    from scope_ptz.endpoints.catalogue import find_api
    from scope_ptz.endpoints.failures import ServerFailure

    if wanted:
        return endpoint.model_copy(update={"model": wanted})
    likely = model.served_names() if model else ()
    try:
        endpoint, served = await find_api(endpoint)
    except ServerFailure:
        served = ()  # A server need not have a list. One that is not there at all will be told of by the first real call.
    by_name = {name.lower(): name for name in served}
    match = next((by_name[name.lower()] for name in likely if name.lower() in by_name), None)
    if match is None and len(served) == 1:
        match = served[0]
        if model is not None:
            complain(f"note: the server at {endpoint.url} serves '{match}'; it is asked in place of {model.repo}.")
    if match is None and not likely and served:
        raise InputError(f"The server at {endpoint.url} serves several models. Name one with {option}: {', '.join(served[:20])}.")
    return endpoint.model_copy(update={"model": match or (likely[0] if likely else "")})


def recognised(registry: Registry, served: str, role: Role) -> Model | None:
    """What the registry knows of a model by the name that a server gives it."""
    matches = (m for m in registry.models.values() if role in m.roles)
    return next((m for m in matches if served.lower() in (n.lower() for n in m.served_names())), None)
