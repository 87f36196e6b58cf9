"""RTCP packets: sender reports, which map time stamps to wall-clock time, and goodbyes (RFC 3550, section 6)."""

from __future__ import annotations

from struct import Struct

REPORT_INTERVAL_S = 5.0  # seconds between sender reports
CNAME = b"camera"  # the source's canonical name, which each report must contain

_NTP_EPOCH_S = 2_208_988_800  # seconds from the NTP epoch (1900) to the Unix epoch (1970)
_SENDER_REPORT = Struct("!BBHIIIIII")
_HEAD = Struct("!BBHI")
_SR, _SDES, _BYE = 200, 202, 203
_VERSION = 2 << 6


def sender_report(ssrc: int, unix_s: float, timestamp: int, packets: int, octets: int) -> bytes:
    """Return a sender report with a source description.

    Args:
        ssrc: The identifier of the RTP source.
        unix_s: Wall-clock time in Unix seconds.
        timestamp: The RTP time stamp for the same instant.
        packets: Number of packets sent so far.
        octets: Number of payload bytes sent so far.
    """
    whole = int(unix_s)
    seconds, fraction = (whole + _NTP_EPOCH_S) & 0xFFFFFFFF, int((unix_s - whole) * 2**32)
    counts = packets & 0xFFFFFFFF, octets & 0xFFFFFFFF
    report = _SENDER_REPORT.pack(_VERSION, _SR, 6, ssrc, seconds, fraction, timestamp, *counts)
    item = bytes((1, len(CNAME))) + CNAME
    item += bytes(4 - len(item) % 4)  # the item list ends with at least one zero byte and is padded to a multiple of four bytes
    return report + _HEAD.pack(_VERSION | 1, _SDES, 1 + len(item) // 4, ssrc) + item


def goodbye(ssrc: int) -> bytes:
    """Return a BYE packet, which announces the end of a source."""
    return _HEAD.pack(_VERSION | 1, _BYE, 1, ssrc)
