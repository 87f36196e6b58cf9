"""Parse the ``Transport`` header, in which clients list the packet transports that they accept."""

from __future__ import annotations

from dataclasses import dataclass

from scope_ptz.virtual_camera.rtsp.messages import RefusedError

MAX_OFFERS = 16  # further offers in a header are ignored
MIN_PORT = 1024  # packets are never sent to the ports of system services

_TCP, _UDP = ("RTP/AVP/TCP",), ("RTP/AVP", "RTP/AVP/UDP")


@dataclass(frozen=True, slots=True)
class TransportOffer:
    """A transport that a client accepts.

    Attributes:
        interleaved: Whether packets are sent over the RTSP connection instead of UDP.
        pair: The channel numbers (TCP) or the client's ports (UDP) for RTP and RTCP; None if the server chooses the channels.
    """

    interleaved: bool
    pair: tuple[int, int] | None


def choose_transport(header: str) -> TransportOffer:
    """Return the first transport in a header that the server supports.

    Raises:
        RefusedError: The server supports none of them.
    """
    for offer in header.split(",")[:MAX_OFFERS]:
        protocol, *rest = (part.strip() for part in offer.split(";"))
        options = {name.lower(): value for name, _, value in (part.partition("=") for part in rest)}
        if "multicast" in options or options.get("mode", "PLAY").strip('"').upper() != "PLAY":
            continue
        if protocol.upper() in _TCP:
            if "interleaved" not in options:
                return TransportOffer(True, None)
            if (pair := _parse_pair(options["interleaved"], 0, 255)) is not None:
                return TransportOffer(True, pair)
        elif protocol.upper() in _UDP and (pair := _parse_pair(options.get("client_port", ""), MIN_PORT, 65535)) is not None:
            return TransportOffer(False, pair)
    raise RefusedError(461)


def _parse_pair(text: str, minimum: int, maximum: int) -> tuple[int, int] | None:
    """Parse two different numbers from ``a-b``, or ``a`` and ``a + 1`` from ``a`` alone. Return None if they are invalid."""
    first, dash, second = text.partition("-")
    if not (first.isdecimal() and len(first) < 6 and (not dash or (second.isdecimal() and len(second) < 6))):
        return None
    pair = int(first), int(second) if dash else int(first) + 1
    return pair if pair[0] != pair[1] and all(minimum <= number <= maximum for number in pair) else None
