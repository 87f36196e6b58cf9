"""Parse the ``Transport`` header, in which a client lists the transports that it accepts for packets."""

from __future__ import annotations

from dataclasses import dataclass

from scope_ptz.virtual_camera.rtsp.messages import RefusedError

MAX_OFFERS = 16  # further offers in a header are ignored
MIN_PORT = 1024  # packets are never sent to the ports of system services

_TCP, _UDP = ("RTP/AVP/TCP",), ("RTP/AVP", "RTP/AVP/UDP")


@dataclass(frozen=True, slots=True)
class TransportOffer:
    """A transport that a client offers.

    Attributes:
        interleaved: Whether packets go over the RTSP connection, instead of UDP.
        pair: Channel numbers (TCP) or the client's ports (UDP) for RTP and RTCP; None if the server may choose the channels.
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
            if (pair := _pair(options["interleaved"], 0, 255)) is not None:
                return TransportOffer(True, pair)
        elif protocol.upper() in _UDP and (pair := _pair(options.get("client_port", ""), MIN_PORT, 65535)) is not None:
            return TransportOffer(False, pair)
    raise RefusedError(461)


def _pair(text: str, least: int, most: int) -> tuple[int, int] | None:
    """Parse two different numbers from ``a-b``, or from ``a`` alone, which means ``a`` and ``a + 1``; None if they are invalid."""
    first, dash, second = text.partition("-")
    if not (first.isdecimal() and len(first) < 6 and (not dash or (second.isdecimal() and len(second) < 6))):
        return None
    pair = int(first), int(second) if dash else int(first) + 1
    return pair if pair[0] != pair[1] and all(least <= each <= most for each in pair) else None
