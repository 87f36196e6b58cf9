"""Types shared by the services: operations with their required roles, requests and replies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.onvif.username_tokens import CreationTime


@dataclass(frozen=True, slots=True)
class Request:
    """A request with parsed arguments.

    Attributes:
        arguments: The arguments by name, parsed by zeep according to the WSDL.
        host: The host at which the client reached the device, in the form used in URLs (bracketed for IPv6).
        origin: The scheme, host and port at which the client reached the device.
        created_at: The time at which the client created the request; None if the request does not include it.
    """

    arguments: Any
    host: str
    origin: str
    created_at: CreationTime | None = None

    def __getattr__(self, name: str) -> Any:
        """Return an argument; None if the request does not contain it."""
        return getattr(self.arguments, name, None)


Reply = Mapping[str, Any]
"""The values in a reply, keyed by their names in the WSDL."""


@dataclass(frozen=True, slots=True)
class Operation:
    """An operation of a service.

    Attributes:
        run: A function that handles a request and returns the values in the reply.
        role: The minimum role of the sender; None if the operation requires no authentication.
    """

    run: Callable[[Request], Reply]
    role: Role | None = Role.VIEWER


Operations = Mapping[str, Operation]
"""Operations by name."""
