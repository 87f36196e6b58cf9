"""Pack H.264 into RTP packets (RFC 3550, RFC 6184, packetization mode 1)."""

from __future__ import annotations

import secrets
from collections.abc import Iterable, Iterator, Sequence
from struct import Struct

CLOCK_HZ = 90_000
PAYLOAD_TYPE = 96
MAX_PAYLOAD_BYTES = 1400
"""Maximum size of a payload in bytes, so that packets fit into Ethernet frames even through a tunnel."""

_HEADER = Struct("!BBHII")
_VERSION = 2 << 6
_MARKER = 0x80
_FU_A, _FU_START, _FU_END = 28, 0x80, 0x40


def payloads(nal_units: Iterable[bytes]) -> list[bytes]:
    """Return the RTP payloads for a picture's NAL units. Units that are too large are split into fragments (FU-A)."""
    result: list[bytes] = []
    for nal in nal_units:
        if len(nal) <= MAX_PAYLOAD_BYTES:
            result.append(nal)
        else:
            result.extend(_fragments(nal))
    return result


def _fragments(nal: bytes) -> Iterator[bytes]:
    indicator, nal_type = (nal[0] & 0xE0) | _FU_A, nal[0] & 0x1F
    step = MAX_PAYLOAD_BYTES - 2
    for start in range(1, len(nal), step):
        is_last = start + step >= len(nal)
        flags = (_FU_START if start == 1 else 0) | (_FU_END if is_last else 0)
        yield bytes((indicator, flags | nal_type)) + nal[start : start + step]


class RtpPacketizer:
    """Builds RTP packets with a sender's source identifier, sequence numbers and time stamps.

    The initial values are random (RFC 3550, section 5.1).
    """

    def __init__(self) -> None:
        self.ssrc = secrets.randbits(32)
        self.sequence = secrets.randbits(16)
        self._offset = secrets.randbits(32)

    def timestamp(self, time_s: float) -> int:
        """Return the RTP time stamp for a ``time.monotonic`` time."""
        return (round(time_s * CLOCK_HZ) + self._offset) & 0xFFFFFFFF

    def packets(self, contents: Sequence[bytes], taken_s: float) -> list[bytes]:
        """Return the packets for a picture. The marker bit is set in the last one.

        Args:
            contents: The payloads.
            taken_s: The ``time.monotonic`` time at which the picture was taken.
        """
        timestamp, last = self.timestamp(taken_s), len(contents) - 1
        result = []
        for k, content in enumerate(contents):
            marker = _MARKER if k == last else 0
            result.append(_HEADER.pack(_VERSION, marker | PAYLOAD_TYPE, self.sequence, timestamp, self.ssrc) + content)
            self.sequence = (self.sequence + 1) & 0xFFFF
        return result
