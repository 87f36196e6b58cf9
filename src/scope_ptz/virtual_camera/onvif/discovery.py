"""WS-Discovery: devices announce themselves and respond to probes over UDP multicast."""

from __future__ import annotations

import asyncio
import logging
import socket
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from ipaddress import ip_address
from time import time
from typing import cast

from scope_ptz.camera.network.interfaces import local_addresses, source_address
from scope_ptz.errors import ConfigError
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.identity import device_uuid
from scope_ptz.virtual_camera.onvif.device_service import PATHS, scopes
from scope_ptz.virtual_camera.onvif.discovery_messages import DiscoveryMessages, Target, parse_query
from scope_ptz.virtual_camera.onvif.wsdl import DEVICE

GROUP = "239.255.255.250"
PORT = 3702
"""The multicast address and port of WS-Discovery."""

MAX_DATAGRAM_BYTES = 8192
"""Maximum size of a datagram in bytes. Larger datagrams are ignored."""

logger = logging.getLogger(__name__)

Address = tuple[str, int]


@dataclass(frozen=True, slots=True)
class DiscoverableCamera:
    """A device to announce, with the port of its web server.

    Attributes:
        device: The device.
        http_port: Port of its web server.
        tls: Whether the web server uses HTTPS.
    """

    device: VirtualDevice
    http_port: int
    tls: bool = False


class _Responder(asyncio.DatagramProtocol):
    def __init__(self, cameras: Sequence[DiscoverableCamera], host: str) -> None:
        instance = int(time())
        self._messages = [(camera, DiscoveryMessages(_target(camera, host), instance)) for camera in cameras]
        self._local_only = ip_address(host).is_loopback
        self._transport: asyncio.DatagramTransport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = cast("asyncio.DatagramTransport", transport)

    def announce(self, group: Address, *, leaving: bool = False) -> None:
        """Announce that the devices have joined the network, or that they are leaving it."""
        for camera, messages in self._messages:
            if not camera.device.down:
                self._send(messages.bye() if leaving else messages.hello(), group)

    def datagram_received(self, data: bytes, address: Address) -> None:
        if len(data) > MAX_DATAGRAM_BYTES or (self._local_only and not _is_on_this_machine(address)):
            return
        query = parse_query(data)
        for camera, messages in self._messages:
            if query is not None and not camera.device.down and query.matches(messages.target):
                with suppress(OSError):  # there may be no route to the client
                    xaddr = messages.target.xaddr or _xaddr(source_address(address), camera)
                    self._send(messages.match(query, xaddr), address)

    def error_received(self, error: Exception) -> None:
        logger.debug("WS-Discovery: %s", error)

    def _send(self, data: bytes, address: Address) -> None:
        if self._transport is not None and not self._transport.is_closing():
            self._transport.sendto(data, address)


@asynccontextmanager
async def serve_discovery(
    cameras: Sequence[DiscoverableCamera], *, host: str = "127.0.0.1", port: int = PORT
) -> AsyncIterator[int]:
    """Return a context manager that announces cameras, responds to probes, and provides the UDP port.

    Cameras on the loopback interface respond only to probes from programs on this machine. Many clients cannot choose the
    interface, so probes that such programs send through another interface are accepted too.

    Args:
        cameras: The cameras.
        host: Address of the network interface on which the HTTP servers listen; ``0.0.0.0`` for the default interface.
        port: The UDP port; 0 for any free port, which clients must then know.

    Raises:
        ConfigError: The interface cannot be used for multicast.
    """
    try:
        interface = socket.gethostbyname(host)  # ONVIF uses WS-Discovery over IPv4
        listener = _listen(interface, port)
    except OSError as error:
        reason = error.strerror or str(error)
        raise ConfigError(f"WS-Discovery cannot use UDP port {port} on {host}: {reason}. Turn discovery off.") from error
    group = (GROUP, listener.getsockname()[1])
    loop = asyncio.get_running_loop()
    transport, responder = await loop.create_datagram_endpoint(lambda: _Responder(cameras, interface), sock=listener)
    try:
        responder.announce(group)
        yield group[1]
        responder.announce(group, leaving=True)
    finally:
        transport.close()


def _listen(interface: str, port: int) -> socket.socket:
    listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        # Other programs on this machine may share the port, because multicast datagrams reach all of its sockets.
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        # Bind to the multicast address if the system allows it (Windows does not), so that only multicast packets arrive.
        try:
            listener.bind((GROUP, port))
        except OSError:
            listener.bind((interface, port))
        _join(listener, interface)
        listener.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(interface))
        listener.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
        listener.setblocking(False)
    except OSError:
        listener.close()
        raise
    if ip_address(interface).is_loopback or ip_address(interface).is_unspecified:
        for other in local_addresses():
            with suppress(OSError):  # the interface may not support multicast, or may already have joined the group
                _join(listener, other)
    return listener


def _join(listener: socket.socket, interface: str) -> None:
    listener.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(GROUP) + socket.inet_aton(interface))


def _is_on_this_machine(client: Address) -> bool:
    """Return whether a client is on this machine: the route to a local address starts at that address."""
    try:
        return source_address(client) == client[0]
    except OSError:
        return False


def _target(camera: DiscoverableCamera, host: str) -> Target:
    xaddr = "" if ip_address(host).is_unspecified else _xaddr(host, camera)
    return Target(device_uuid(camera.device), tuple(scopes(camera.device)), xaddr)


def _xaddr(host: str, camera: DiscoverableCamera) -> str:
    return f"{'https' if camera.tls else 'http'}://{host}:{camera.http_port}{PATHS[DEVICE]}"
