"""Check that a request names this server as its host, and that it was not sent by a page from another site."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from ipaddress import ip_address
from urllib.parse import urlsplit

LOOPBACK_NAMES = frozenset({"localhost", "127.0.0.1", "::1"})


def is_loopback(host: str) -> bool:
    """Return whether a listening address can be reached only from this machine."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


class Origins:
    """Checks that requests do not come from pages on other sites.

    Such a page must not be able to use the session of the browser that shows it, or a server on loopback that needs no token. Its
    requests have the other site in their ``Origin`` header. If the other site's name resolves to this server (DNS rebinding), the
    origin matches the host, but the ``Host`` header contains a name that is not one of the server's.

    Args:
        hosts: The server's host names and addresses, without ports.
    """

    def __init__(self, hosts: Iterable[str]) -> None:
        self._hosts = frozenset(host.lower() for host in hosts)

    def problem(self, headers: Mapping[str, str], *, method: str, websocket: bool = False) -> str:
        """Return why a request is refused; empty if it is allowed.

        Args:
            headers: The request's headers, by lower-case name.
            method: The HTTP method.
            websocket: Whether the request opens a WebSocket.
        """
        host = headers.get("host", "")
        if _host_name(host) not in self._hosts:
            return "The Host header does not name this server. Add the name to the server with `--name`."
        origin = headers.get("origin")
        if origin is not None and urlsplit(origin).netloc.lower() != host.lower():
            return "Requests from pages of other sites are refused."
        if headers.get("sec-fetch-site", "none") in ("cross-site", "same-site") and not _is_link(headers, method, websocket):
            return "Requests from pages of other sites are refused."
        return ""


def _is_link(headers: Mapping[str, str], method: str, websocket: bool) -> bool:
    """Return whether a browser sent the request to open a page, for example from a link on another site, which is harmless."""
    fetch = headers.get("sec-fetch-mode"), headers.get("sec-fetch-dest")
    return method == "GET" and not websocket and fetch == ("navigate", "document")


def _host_name(host: str) -> str:
    """Return the name in a ``Host`` header, without the port and the brackets of IPv6; empty if the header is invalid."""
    try:
        parts = urlsplit(f"//{host}")
        port_is_number = parts.port is None or parts.port >= 0
    except ValueError:
        return ""
    if parts.path or parts.query or parts.fragment or parts.username is not None or not port_is_number:
        return ""
    return (parts.hostname or "").lower()
