"""Find ONVIF devices on the local networks with WS-Discovery. No password is required or sent."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Iterable
from dataclasses import dataclass
from urllib.parse import unquote, urlsplit
from uuid import uuid4

import anyio

from scope_ptz.camera.network.interfaces import local_addresses
from scope_ptz.errors import CameraError, ConfigError, InputError

GROUP, PORT = "239.255.255.250", 3702
"""The multicast address and port of WS-Discovery."""

MAX_DATAGRAM_BYTES = 64 * 1024
MAX_DEVICES = 500

_DISCOVERY = "http://schemas.xmlsoap.org/ws/2005/04/discovery"
_PROBE = (
    '<?xml version="1.0" encoding="utf-8"?>'
    '<e:Envelope xmlns:e="http://www.w3.org/2003/05/soap-envelope" xmlns:a="http://schemas.xmlsoap.org/ws/2004/08/addressing"'
    ' xmlns:d="http://schemas.xmlsoap.org/ws/2005/04/discovery" xmlns:n="http://www.onvif.org/ver10/network/wsdl">'
    "<e:Header><a:MessageID>urn:uuid:{number}</a:MessageID>"
    "<a:To>urn:schemas-xmlsoap-org:ws:2005:04:discovery</a:To>"
    "<a:Action>http://schemas.xmlsoap.org/ws/2005/04/discovery/Probe</a:Action></e:Header>"
    "<e:Body><d:Probe><d:Types>n:NetworkVideoTransmitter</d:Types></d:Probe></e:Body></e:Envelope>"
)


@dataclass(frozen=True, slots=True, order=True)
class DiscoveredDevice:
    """A device that responded to the search.

    Attributes:
        address: Host and port of the web interface, as in a camera spec.
        name: The reported name.
        model: The reported model.
        tls: Whether the web interface uses HTTPS.
    """

    address: str
    name: str
    model: str
    tls: bool = False

    @property
    def spec(self) -> str:
        """The camera spec, with a placeholder for the user name."""
        return f"onvif://USER@{self.address}" + ("?tls=on" if self.tls else "")


async def discover(interfaces: Iterable[str] = (), *, wait_s: float = 3.0, port: int = PORT) -> list[DiscoveredDevice]:
    """Search for devices, and return those that respond, sorted by address.

    Args:
        interfaces: IPv4 addresses of this machine's interfaces; by default, those from ``local_addresses``.
        wait_s: Seconds to wait for responses.
        port: The UDP port on which devices listen.

    Raises:
        InputError: An interface is not an IPv4 address.
        CameraError: No interface can be searched.
        ConfigError: lxml is not installed.
    """
    _import_parser()
    devices: dict[str, DiscoveredDevice] = {}
    loop, transports = asyncio.get_running_loop(), []
    failure = "there are no interfaces"
    for interface in tuple(interfaces) or local_addresses():
        try:
            udp_socket = _open(interface)
        except OSError as error:
            failure = error.strerror or str(error)
            continue
        transport, _ = await loop.create_datagram_endpoint(lambda: _Collector(devices), sock=udp_socket)
        transports.append(transport)
    if not transports:
        raise CameraError(f"No network interface can be searched for cameras: {failure}.")
    try:
        for _ in range(2):  # datagrams may be lost
            for transport in transports:
                transport.sendto(_PROBE.format(number=uuid4()).encode(), (GROUP, port))
            await anyio.sleep(wait_s / 2)
    finally:
        for transport in transports:
            transport.close()
    return sorted(devices.values())


def parse_match(data: bytes, sender: str) -> list[DiscoveredDevice]:
    """Return the devices in a response; an empty list if the datagram is not a response.

    Args:
        data: The datagram.
        sender: The address from which it came.
    """
    from lxml import etree

    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    try:
        root = etree.fromstring(data, parser)
    except (etree.XMLSyntaxError, ValueError):
        return []
    if root.getroottree().docinfo.doctype:
        return []
    devices = []
    for match in root.iterfind(f".//{{{_DISCOVERY}}}ProbeMatch"):
        urls = (match.findtext(f"{{{_DISCOVERY}}}XAddrs") or "").split()
        endpoints = [endpoint for url in urls if (endpoint := _parse_address(url))]
        if not endpoints:
            continue
        # If there are several addresses, prefer the sender's, because it can be reached.
        host, port, tls = next((endpoint for endpoint in endpoints if endpoint[0] == sender), endpoints[0])
        scopes = (match.findtext(f"{{{_DISCOVERY}}}Scopes") or "").split()
        standard = 443 if tls else 80
        url_host = f"[{host}]" if ":" in host else host
        address = url_host if port == standard else f"{url_host}:{port}"
        devices.append(DiscoveredDevice(address, _scope(scopes, "name"), _scope(scopes, "hardware"), tls))
    return devices


class _Collector(asyncio.DatagramProtocol):
    def __init__(self, devices: dict[str, DiscoveredDevice]) -> None:
        self._devices = devices

    def datagram_received(self, data: bytes, address: tuple[str, int]) -> None:
        if len(data) > MAX_DATAGRAM_BYTES:
            return
        for device in parse_match(data, address[0]):
            if len(self._devices) < MAX_DEVICES:
                self._devices.setdefault(device.address, device)

    def error_received(self, error: Exception) -> None:
        """Ignore network errors such as an unreachable host, because a probe does not require a response."""


def _open(interface: str) -> socket.socket:
    try:
        packed_address = socket.inet_aton(interface)
    except OSError:
        raise InputError(
            f"An interface must be specified by its IPv4 address, for example 192.168.1.20; got '{interface[:40]}'."
        ) from None
    udp_socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        udp_socket.bind((interface, 0))
        udp_socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, packed_address)
        udp_socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 1)
        udp_socket.setblocking(False)
    except OSError:
        udp_socket.close()
        raise
    return udp_socket


def _parse_address(text: str) -> tuple[str, int, bool] | None:
    """Return the host, the port and whether the URL is HTTPS; None if it is not an HTTP URL."""
    try:
        parts = urlsplit(text)
        port = parts.port
    except ValueError:
        return None
    if parts.scheme not in ("http", "https") or not parts.hostname or not all(c.isalnum() or c in ".-:_" for c in parts.hostname):
        return None
    tls = parts.scheme == "https"
    return parts.hostname, port or (443 if tls else 80), tls


def _scope(scopes: list[str], category: str) -> str:
    """Return the name or hardware in a device's scopes as one printable line; empty if there is none."""
    start = f"onvif://www.onvif.org/{category}/"
    text = next((unquote(scope[len(start) :]) for scope in scopes if scope.lower().startswith(start)), "")
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())[:60]


def _import_parser() -> None:
    try:
        import lxml.etree  # noqa: F401 - used to parse responses
    except ImportError:
        raise ConfigError("Discovery requires lxml. Install it with: pip install 'scope-ptz[camera]'") from None
