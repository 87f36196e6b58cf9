"""Determine a model's served name: the name under which its server provides it."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.endpoints.endpoint import Endpoint
    from scope_ptz.registry import Model, Registry, Role

_LOG = logging.getLogger(__name__)


async def with_served_name(endpoint: Endpoint, name: str | None, model: Model | None, option: str) -> Endpoint:
    """Return the endpoint with the model's served name.

    If the server serves exactly one model and it is not the requested one, that model is used and a warning is logged.

    Args:
        endpoint: The server.
        name: The served name; None to look it up in the server's model list.
        model: The requested model; None if the user specified only a server.
        option: Name of the command-line option, for the error message.

    Raises:
        InputError: The server serves several models, and the user did not choose one.
    """
    from scope_ptz.endpoints.catalogue import find_api
    from scope_ptz.endpoints.failures import ServerFailure

    if name:
        return endpoint.model_copy(update={"model": name})
    registered_names = model.served_names() if model else ()
    try:
        endpoint, served = await find_api(endpoint)
    except ServerFailure:
        served = ()  # some servers have no model list; if the server is unreachable, the first request reports it
    by_lower_case = {name.lower(): name for name in served}
    match = next((by_lower_case[name.lower()] for name in registered_names if name.lower() in by_lower_case), None)
    if match is None and len(served) == 1:
        match = served[0]
        if model is not None:
            _LOG.warning("note: the server at %s serves '%s', which is used instead of %s.", endpoint.url, match, model.repo)
    if match is None and not registered_names and served:
        raise InputError(f"The server at {endpoint.url} serves several models. Choose one with {option}: {', '.join(served[:20])}.")
    return endpoint.model_copy(update={"model": match or (registered_names[0] if registered_names else "")})


def registered_model(registry: Registry, served: str, role: Role) -> Model | None:
    """Return the registry entry for a served name; None if no such model is registered."""
    candidates = (model for model in registry.models.values() if role in model.roles)
    return next((model for model in candidates if served.lower() in (name.lower() for name in model.served_names())), None)
