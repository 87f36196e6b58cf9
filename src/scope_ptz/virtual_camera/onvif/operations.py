"""Types that the services share: operations with the roles that they require, requests and replies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.onvif.username_tokens import Stamp


@dataclass(frozen=True, slots=True)
class Request:
    """A request with parsed arguments.

    Attributes:
        arguments: The arguments by name, parsed by zeep with the types of the WSDL.
        host: The host at which the client reached the device, in the form used in URLs (with brackets for IPv6).
        origin: The scheme, host and port at which the client reached the device.
        stamp: The time at which the client created the request; None if the request does not state it.
    """

    arguments: Any
    host: str
    origin: str
    stamp: Stamp | None = None

    def __getattr__(self, name: str) -> Any:
        """Return an argument; None if the request does not contain it."""
        return getattr(self.arguments, name, None)


Reply = Mapping[str, Any]
"""The values of a reply by the names in the WSDL."""


@dataclass(frozen=True, slots=True)
class Operation:
    """An operation of a service.

    Attributes:
        run: The function that carries out a request and returns the values of the reply.
        role: The role that the sender must have; None if the operation requires no login.
    """

    run: Callable[[Request], Reply]
    role: Role | None = Role.VIEWER


Operations = Mapping[str, Operation]
"""Operations by name."""
