"""Destinations for packets: channels of the RTSP connection, or a pair of UDP sockets."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Protocol

from scope_ptz.virtual_camera.rtsp.messages import RefusedError

SEND_TIMEOUT_S = 10.0
"""Seconds after which a client that has stopped reading counts as disconnected."""

UNSENT_BYTES = 32 * 1024
"""Maximum number of bytes in the kernel's send buffer, where packets that become too old can no longer be dropped."""

BATCH_PACKETS = 12  # packets per write; the age of a picture is checked before each write
_PORT_ATTEMPTS = 50  # maximum number of attempts to find two adjacent free ports


class Sink(Protocol):
    """Sends packets to a client."""

    async def send(self, packets: Sequence[bytes]) -> bool:
        """Send RTP packets. Return False if they were dropped.

        Raises:
            OSError: The client has disconnected.
        """

    def report(self, packet: bytes) -> None:
        """Send an RTCP packet."""

    def close(self) -> None:
        """Release the sink's resources."""


def limit_send_buffers(writer: asyncio.StreamWriter) -> None:
    """Limit a connection's send buffers, so that writes wait when the client is too slow."""
    writer.transport.set_write_buffer_limits(high=0)
    raw = writer.get_extra_info("socket")
    if hasattr(socket, "TCP_NOTSENT_LOWAT"):
        with suppress(OSError):
            raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, UNSENT_BYTES)


class InterleavedSink:
    """Sends packets over the RTSP connection.

    Args:
        writer: The connection.
        channels: Numbers of the interleaved channels for RTP and RTCP.
    """

    def __init__(self, writer: asyncio.StreamWriter, channels: tuple[int, int]) -> None:
        self._writer, self.channels = writer, channels

    async def send(self, packets: Sequence[bytes]) -> bool:
        self._writer.write(b"".join(_frame_packet(self.channels[0], packet) for packet in packets))
        try:
            async with asyncio.timeout(SEND_TIMEOUT_S):
                await self._writer.drain()
        except TimeoutError:
            raise ConnectionError("The client has stopped reading.") from None
        return True

    def report(self, packet: bytes) -> None:
        if not self._writer.transport.is_closing():
            self._writer.write(_frame_packet(self.channels[1], packet))

    def close(self) -> None:
        """Do nothing, because requests use the same connection."""


def _frame_packet(channel: int, packet: bytes) -> bytes:
    return b"$" + bytes((channel,)) + len(packet).to_bytes(2, "big") + packet


class UdpSink:
    """Sends packets over UDP to the host at the other end of the RTSP connection.

    Args:
        rtp: A socket for RTP that is connected to the client.
        rtcp: A socket for RTCP that is connected to the client.
    """

    def __init__(self, rtp: asyncio.DatagramTransport, rtcp: asyncio.DatagramTransport) -> None:
        self._rtp, self._rtcp = rtp, rtcp
        self.ports: tuple[int, int] = (rtp.get_extra_info("sockname")[1], rtcp.get_extra_info("sockname")[1])

    async def send(self, packets: Sequence[bytes]) -> bool:
        if self._rtp.is_closing():
            raise ConnectionError("The client has disconnected.")
        if self._rtp.get_write_buffer_size():  # type: ignore[attr-defined] # the network is congested, and queued packets would only become too old
            return False
        for packet in packets:
            self._rtp.sendto(packet)
        await asyncio.sleep(0)
        return True

    def report(self, packet: bytes) -> None:
        if not self._rtcp.is_closing():
            self._rtcp.sendto(packet)

    def close(self) -> None:
        self._rtp.close()
        self._rtcp.close()


class _Receiver(asyncio.DatagramProtocol):
    def __init__(self, on_packet: Callable[[], None], on_unreachable: Callable[[], None]) -> None:
        self._on_packet, self._on_unreachable = on_packet, on_unreachable

    def datagram_received(self, _data: bytes, _addr: object) -> None:
        self._on_packet()

    def error_received(self, exc: Exception) -> None:
        if isinstance(exc, ConnectionRefusedError):  # the client's port is closed
            self._on_unreachable()


async def open_udp(
    local_host: str, remote_host: str, ports: tuple[int, int], on_packet: Callable[[], None], on_unreachable: Callable[[], None]
) -> UdpSink:
    """Open two adjacent UDP ports for RTP and RTCP, and connect them to a client's ports.

    Args:
        local_host: Address of this end of the RTSP connection.
        remote_host: Address of the other end. Packets are never sent elsewhere.
        ports: The client's ports.
        on_packet: Called for each packet from the client, such as an RTCP report.
        on_unreachable: Called when the client's ports turn out to be closed.

    Raises:
        RefusedError: No ports are free, or the client's ports cannot be reached.
    """
    loop = asyncio.get_running_loop()
    try:
        pair = _bind_pair(local_host)
    except OSError as error:
        raise RefusedError(503) from error
    opened: list[asyncio.DatagramTransport] = []
    try:
        for udp_socket, port in zip(pair, ports, strict=True):
            udp_socket.connect((remote_host, port))
            endpoint = await loop.create_datagram_endpoint(lambda: _Receiver(on_packet, on_unreachable), sock=udp_socket)
            opened.append(endpoint[0])
    except OSError as error:
        for udp_socket in pair:
            udp_socket.close()
        for transport in opened:
            transport.abort()
        raise RefusedError(461) from error
    return UdpSink(opened[0], opened[1])


def _bind_pair(host: str) -> tuple[socket.socket, socket.socket]:
    """Bind UDP sockets to an even port and the next one."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    for _ in range(_PORT_ATTEMPTS):
        first, second = (socket.socket(family, socket.SOCK_DGRAM) for _ in range(2))
        try:
            first.bind((host, 0))
            port = first.getsockname()[1]
            second.bind((host, port ^ 1))
        except (OSError, OverflowError):
            first.close()
            second.close()
            continue
        for udp_socket in (first, second):
            udp_socket.setblocking(False)
        return (first, second) if port % 2 == 0 else (second, first)
    raise OSError("There is no free pair of UDP ports.")
