"""What services are made of: operations with the role that they need, and the request that they get."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.onvif.login import Stamp


@dataclass(frozen=True, slots=True)
class Request:
    """A request with parsed arguments.

    Attributes:
        arguments: The arguments by name, as zeep parsed them with the types of the WSDL.
        host: The host by which the client reached the device, as it appears in an address (with brackets for IPv6).
        origin: Scheme, host and port by which the client reached the device.
        stamp: When the client created the request, None if it did not say so.
    """

    arguments: Any
    host: str
    origin: str
    stamp: Stamp | None = None

    def __getattr__(self, name: str) -> Any:
        """Return an argument, None if the request has none of this name."""
        return getattr(self.arguments, name, None)


Reply = Mapping[str, Any]
"""The values of a reply by the names in the WSDL."""


@dataclass(frozen=True, slots=True)
class Operation:
    """What an operation does, and the role that an account needs for it; None for no login."""

    run: Callable[[Request], Reply]
    role: Role | None = Role.VIEWER


Operations = Mapping[str, Operation]
