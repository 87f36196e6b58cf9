"""What arrives on a connection: requests, packets, and everything that is neither."""

from __future__ import annotations

import asyncio
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.virtual_camera.rtsp.messages import (
    MAX_BODY_BYTES,
    MAX_LINE_BYTES,
    InterleavedPacket,
    MalformedError,
    RefusedError,
    Reply,
    Request,
    TunnelRequest,
    read_message,
)
from scope_ptz.virtual_camera.rtsp.transport_header import TransportOffer, choose_transport


def read(content: bytes) -> Request | TunnelRequest | InterleavedPacket | None:
    async def run() -> Request | TunnelRequest | InterleavedPacket | None:
        reader = asyncio.StreamReader(limit=MAX_LINE_BYTES)
        reader.feed_data(content)
        reader.feed_eof()
        return await read_message(reader, await reader.readexactly(1))

    return asyncio.run(run())


def test_a_request_with_a_body() -> None:
    content = b"SET_PARAMETER rtsp://camera/a RTSP/1.0\r\nCSeq: 7\r\nContent-length:  4\r\nX: a: b\r\n\r\nbodyrest"
    headers = {"cseq": "7", "content-length": "4", "x": "a: b"}
    assert read(content) == Request("SET_PARAMETER", "rtsp://camera/a", headers, b"body")


def test_lines_may_end_without_carriage_return() -> None:
    assert read(b"OPTIONS * RTSP/1.0\nCSeq: 1\n\n") == Request("OPTIONS", "*", {"cseq": "1"})


@pytest.mark.parametrize("line", [b"\n", b"\r\n"])
def test_empty_lines_between_requests_are_skipped(line: bytes) -> None:
    assert read(line) is None


def test_packets_between_requests() -> None:
    assert read(b"$\x01\x00\x03abc") == InterleavedPacket(1, b"abc")


@pytest.mark.parametrize(
    ("content", "status"),
    [
        (b"PUT / HTTP/1.1\r\nHost: camera\r\n\r\n", 505),
        (b"OPTIONS * RTSP/2.0\r\nCSeq: 1\r\n\r\n", 505),
        (b"OPTIONS *\r\n\r\n", 400),
        (b"options * RTSP/1.0\r\nCSeq: 1\r\n\r\n", 400),
        (b"OPTIONS  * RTSP/1.0\r\nCSeq: 1\r\n\r\n", 400),
        (b"OPTIONS rtsp://\xff/ RTSP/1.0\r\nCSeq: 1\r\n\r\n", 400),
        (b"OPTIONS * RTSP/1.0\r\n\r\n", 400),
        (b"OPTIONS * RTSP/1.0\r\nCSeq: one\r\n\r\n", 400),
        (b"OPTIONS * RTSP/1.0\r\nCSeq: 99999999999\r\n\r\n", 400),
        (b"OPTIONS * RTSP/1.0\r\nCSeq 1\r\n\r\n", 400),
        (b"OPTIONS * RTSP/1.0\r\nCSeq: 1\r\nRequire: \x00\r\n\r\n", 400),
        (b"OPTIONS * RTSP/1.0\r\nCSeq: 1\r\nContent-Length: -1\r\n\r\n", 400),
        (b"OPTIONS * RTSP/1.0\r\nCSeq: 1\r\nContent-Length: %d\r\n\r\n" % (MAX_BODY_BYTES + 1), 413),
        (b"OPTIONS * RTSP/1.0\r\nCSeq: 1\r\nContent-Length: " + b"9" * 5000 + b"\r\n\r\n", 413),
        (b"OPTIONS /" + b"a" * 2 * MAX_LINE_BYTES + b" RTSP/1.0\r\n\r\n", 414),
        (b"OPTIONS * RTSP/1.0\r\nX: " + b"a" * 2 * MAX_LINE_BYTES + b"\r\n\r\n", 413),
        (b"OPTIONS * RTSP/1.0\r\n" + b"X: a\r\n" * 1000 + b"\r\n", 413),
    ],
)
def test_what_is_no_request_is_refused(content: bytes, status: int) -> None:
    with pytest.raises(MalformedError) as caught:
        read(content)
    assert caught.value.status == status


@given(
    st.binary(min_size=1, max_size=400),
    st.sampled_from([b"", b"$", b"OPTIONS * RTSP/1.0\r\n", b"PLAY rtsp://a RTSP/1.0\r\nCSeq: 1\r\n"]),
)
def test_any_bytes_are_a_message_a_refusal_or_unfinished(content: bytes, start: bytes) -> None:
    with suppress(MalformedError, asyncio.IncompleteReadError):
        assert isinstance(read(start + content), Request | TunnelRequest | InterleavedPacket | None)


def test_a_reply_repeats_the_sequence_number_and_headers() -> None:
    reply = Reply(401, (("WWW-Authenticate", "a"), ("WWW-Authenticate", "b")), b"why")
    expected = "RTSP/1.0 401 Unauthorized|CSeq: 3|WWW-Authenticate: a|WWW-Authenticate: b|Content-Length: 3||why"
    assert reply.encode("3").decode() == expected.replace("|", "\r\n")


@pytest.mark.parametrize(
    ("header", "offer"),
    [
        ("RTP/AVP/TCP;unicast;interleaved=2-3", TransportOffer(True, (2, 3))),
        ("RTP/AVP/TCP;interleaved=4", TransportOffer(True, (4, 5))),
        ("RTP/AVP/TCP;unicast", TransportOffer(True, None)),
        ("RTP/AVP;unicast;client_port=5000-5001", TransportOffer(False, (5000, 5001))),
        ("RTP/AVP/UDP;unicast;client_port=5000;mode=play", TransportOffer(False, (5000, 5001))),
        ("RTP/AVP;multicast;port=5-6, RTP/SAVP;client_port=1-2 , rtp/avp/tcp;interleaved=0-1", TransportOffer(True, (0, 1))),
        ("RTP/AVP/TCP;interleaved=300-301,RTP/AVP;CLIENT_PORT=6000-6001", TransportOffer(False, (6000, 6001))),
        ("RTP/AVP;client_port=80-81,RTP/AVP;client_port=6000-6001", TransportOffer(False, (6000, 6001))),
    ],
)
def test_the_first_transport_that_the_server_knows_is_chosen(header: str, offer: TransportOffer) -> None:
    assert choose_transport(header) == offer


UNKNOWN_TRANSPORTS = [
    "RTP/AVP;unicast",
    "RTP/AVP;multicast",
    "RTP/AVP;client_port=1-70000",
    "RTP/AVP;client_port=-",
    "RTP/AVP;client_port=5000-5000",
    "RTP/AVP/TCP;interleaved=1-1",
    "RTP/AVP/TCP;interleaved=0-256",
    'RTP/AVP;unicast;client_port=5000-5001;mode="RECORD"',
]


@given(st.text(max_size=80) | st.sampled_from(UNKNOWN_TRANSPORTS))
def test_other_transports_are_refused(header: str) -> None:
    with pytest.raises(RefusedError) as caught:
        choose_transport(header)
    assert caught.value.status == 461


def test_heads_of_tunnels_are_http_requests() -> None:
    head = b"POST /axis-media/media.amp HTTP/1.0\r\nx-sessioncookie: abc\r\n\r\nbody"
    assert read(head) == TunnelRequest("POST", {"x-sessioncookie": "abc"})
    assert read(b"GET / HTTP/1.1\r\n\r\n") == TunnelRequest("GET", {})
