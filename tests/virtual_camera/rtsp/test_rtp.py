"""Packets of H.264 and reports, read by an independent parser."""

from __future__ import annotations

from itertools import pairwise
from struct import unpack

from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.virtual_camera.rtsp.rtcp import goodbye, sender_report
from scope_ptz.virtual_camera.rtsp.rtp import MAX_PAYLOAD_BYTES, RtpPacketizer, payloads
from tests.support.rtsp_client import Depacketizer, RtpPacket, SenderReport

_BORDERS = [1, 2, *(MAX_PAYLOAD_BYTES * k + d for k in (1, 2, 3) for d in range(-6, 7))]


@given(
    st.lists(st.tuples(st.sampled_from([0x67, 0x68, 0x65, 0x41, 0x01]), st.sampled_from(_BORDERS)), min_size=1, max_size=4),
    st.randoms(),
)
def test_pictures_survive_packets(shapes: list[tuple[int, int]], random: object) -> None:
    nals = [bytes([header]) + random.randbytes(size) for header, size in shapes]  # type: ignore[attr-defined]
    packetizer, depacketizer = RtpPacketizer(), Depacketizer()
    packets = packetizer.packets(payloads(nals), 12.5)
    assert all(len(packet) <= 12 + MAX_PAYLOAD_BYTES for packet in packets)
    parsed = [RtpPacket.parse(packet) for packet in packets]
    assert [packet.marker for packet in parsed] == [False] * (len(parsed) - 1) + [True]
    assert {packet.timestamp for packet in parsed} == {packetizer.timestamp(12.5)}
    assert [depacketizer.add(packet) for packet in parsed][-1] == nals


def test_sequence_numbers_and_time_stamps_wrap() -> None:
    packetizer = RtpPacketizer()
    packetizer.sequence = 65534
    numbers = [RtpPacket.parse(packet).sequence for packet in packetizer.packets([b"\x41a"] * 4, 0.0)]
    assert numbers == [65534, 65535, 0, 1]
    week_s = 7 * 24 * 3600.0
    stamps = [packetizer.timestamp(week_s + k) for k in range(60_000)]
    assert all((later - sooner) % 2**32 == 90_000 for sooner, later in pairwise(stamps))
    assert all(0 <= stamp < 2**32 for stamp in stamps)


def test_senders_start_anywhere() -> None:
    packetizers = [RtpPacketizer() for _ in range(8)]
    assert (
        len({packetizer.ssrc for packetizer in packetizers}) == len({packetizer.timestamp(1.0) for packetizer in packetizers}) == 8
    )


def test_a_report_says_which_time_a_time_stamp_is() -> None:
    data = sender_report(0xABCD, 1_800_000_000.25, 4_000_000_000, 2**32 + 5, 77)
    report = SenderReport.parse(data)
    assert report == SenderReport(0xABCD, 1_800_000_000.25, 4_000_000_000, 5, 77)
    assert report.taken_s((4_000_000_000 - 45_000) % 2**32) == 1_799_999_999.75
    # A description of the source follows; the length of each part counts words of four bytes, less one.
    source = data[28:]
    assert (source[0], source[1], len(source)) == (0x81, 202, 4 * (unpack("!H", source[2:4])[0] + 1))


def test_a_goodbye_names_its_source() -> None:
    assert goodbye(0x01020304) == bytes([0x81, 203, 0, 1, 1, 2, 3, 4])
