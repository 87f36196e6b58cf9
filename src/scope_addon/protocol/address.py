"""The address of a server."""

from __future__ import annotations

from ipaddress import ip_address
from typing import NamedTuple
from urllib.parse import urlsplit

from .errors import AddOnError


class Address(NamedTuple):
    """The address of a server, with a token if it needs one."""

    scheme: str
    host: str
    port: int
    token: str = ""

    @property
    def url(self) -> str:
        """The URL, without the token."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{self.scheme}://{host}:{self.port}"

    @property
    def is_local(self) -> bool:
        """Whether the server is on this machine."""
        try:
            return ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"


def parse_address(url: str, token: str = "") -> Address:
    """Parse the URL of a server.

    Raises:
        AddOnError: The URL is invalid, contains a password, or would send the token unencrypted over a network.
    """
    try:
        parts = urlsplit(url.strip())
        port = parts.port
    except ValueError:
        raise AddOnError("The port in the server's address is not a number.") from None
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise AddOnError("The server's address must look like http://127.0.0.1:8000.")
    if parts.username is not None or parts.password is not None:
        raise AddOnError("Remove the password from the server's address, and enter the token in its own field.")
    address = Address(parts.scheme, parts.hostname, port or (443 if parts.scheme == "https" else 80), token.strip())
    if any(not 33 <= ord(character) <= 126 for character in address.token):
        raise AddOnError("The token contains invalid characters. Copy it again.")
    if address.token and address.scheme == "http" and not address.is_local:
        raise AddOnError("The token would cross the network unencrypted. Use https, or an SSH tunnel to this machine.")
    return address
