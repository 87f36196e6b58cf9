"""Device addresses, and rewriting of the URLs that a device reports so that they point to its own address."""

from __future__ import annotations

import re
from dataclasses import dataclass
from ipaddress import ip_address
from urllib.parse import urlsplit, urlunsplit

from scope_ptz.camera.network.errors import ForeignAddressError
from scope_ptz.errors import InputError

_HTTP_SCHEMES = ("http", "https")
_HOST = re.compile(r"[A-Za-z0-9._-]+|\[[0-9A-Fa-f:.]+\]")


@dataclass(frozen=True, slots=True)
class DeviceAddress:
    """The address of a device. Credentials are sent only to this host and port.

    Attributes:
        host: Host name, IPv4 address, or bracketed IPv6 address.
        port: Port of the web interface.
        tls: Whether the connection is encrypted.
    """

    host: str
    port: int
    tls: bool = False

    @property
    def base_url(self) -> str:
        """The base URL of the device, without a trailing slash."""
        return f"{'https' if self.tls else 'http'}://{self.host}:{self.port}"

    def __str__(self) -> str:
        standard = 443 if self.tls else 80
        return self.host if self.port == standard else f"{self.host}:{self.port}"

    @property
    def is_loopback(self) -> bool:
        """Whether the address is a loopback address."""
        try:
            return ip_address(self.host.strip("[]")).is_loopback
        except ValueError:
            return self.host.lower() == "localhost"

    def has_origin(self, scheme: str, host: str, port: int | None) -> bool:
        """Return whether a scheme, host and port match this address. If the port is None, the scheme's default port is used."""
        own_scheme = "https" if self.tls else "http"
        port = port or (443 if scheme == "https" else 80)
        return (scheme, host.strip("[]").lower(), port) == (own_scheme, self.host.strip("[]").lower(), self.port)

    def pin_http(self, url: str) -> str:
        """Rewrite a URL from the device to the scheme, host and port of this address.

        Devices behind network address translation report addresses in their local network. The path and the query are kept, and
        credentials are removed.

        Raises:
            ForeignAddressError: The URL is not an HTTP URL.
        """
        parts = urlsplit(url)
        if parts.scheme not in ("", *_HTTP_SCHEMES) or (not parts.scheme and not url.startswith("/")):
            raise ForeignAddressError(
                f"The camera at {self} returned a URL that is not HTTP ({parts.scheme[:20]}:). It was rejected."
            )
        path = "/" + parts.path.lstrip("/")
        return self.base_url + urlunsplit(("", "", path, parts.query, ""))

    def pin_rtsp(self, url: str, default_port: int = 554) -> str:
        """Rewrite a stream URL from the device to the host of this address, keeping the stream's port.

        Raises:
            ForeignAddressError: The URL is not an RTSP URL, or its port is invalid.
        """
        parts = urlsplit(url)
        try:
            port = parts.port or default_port
        except ValueError:
            port = 0
        if parts.scheme not in ("rtsp", "rtsps") or not 0 < port < 65536:
            raise ForeignAddressError(f"The camera at {self} returned a stream URL that is not a valid RTSP URL. It was rejected.")
        return urlunsplit((parts.scheme, f"{self.host}:{port}", "/" + parts.path.lstrip("/"), parts.query, ""))


def parse_address(text: str, *, tls: bool = False) -> tuple[str, DeviceAddress]:
    """Parse ``user@host[:port]``.

    Args:
        text: The address. The user name is optional.
        tls: Whether the connection is encrypted, which determines the default port.

    Returns:
        The user name (empty if there is none) and the address.

    Raises:
        InputError: The host or the port is invalid, or the text contains a password. The message does not repeat the text.
    """
    user, _, place = text.rstrip("/").rpartition("@")
    if ":" in user:
        raise InputError("The camera's address must not contain a password. Set SCOPE_CAMERA_PASSWORD instead.")
    host, colon, port = place.rpartition(":") if not place.endswith("]") and ":" in place else (place, "", "")
    if not _HOST.fullmatch(host):
        raise InputError("The camera's address must be user@host or user@host:port, for example operator@10.0.0.7.")
    if colon and not (port.isdecimal() and 0 < int(port) < 65536):
        raise InputError("The port in the camera's address must be a number from 1 to 65535.")
    return user, DeviceAddress(host, int(port) if colon else (443 if tls else 80), tls)
