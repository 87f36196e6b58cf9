"""The network interfaces of this machine."""

from __future__ import annotations

import socket
from contextlib import suppress

_ANY_GROUP = ("239.255.255.250", 3702)  # any multicast address serves to find the default route


def local_addresses() -> tuple[str, ...]:
    """Return this machine's IPv4 addresses: those of its host name, that of the default route, and the loopback address."""
    addresses = {"127.0.0.1"}
    with suppress(OSError):  # the machine's own name may not resolve
        addresses.update(str(entry[4][0]) for entry in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET))
    with suppress(OSError):  # there may be no route
        addresses.add(source_address(_ANY_GROUP))
    return tuple(sorted(addresses - {"0.0.0.0"}))  # noqa: S104 - compared, not bound to


def source_address(destination: tuple[str, int]) -> str:
    """Return this machine's IPv4 address on the route to a destination. Nothing is sent.

    Raises:
        OSError: There is no route.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp_socket:
        udp_socket.connect(destination)
        return str(udp_socket.getsockname()[0])
