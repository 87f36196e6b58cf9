"""Motion JPEG is split into its pictures, however the bytes arrive."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.camera.network.errors import CameraReplyError, PictureError
from scope_ptz.camera.network.mjpeg import MAX_HEADER_BYTES, MjpegParser, parse_boundary

PICTURES = st.lists(
    st.binary(min_size=1, max_size=60).map(lambda body: b"\xff\xd8" + body.replace(b"-", b"+") + b"\xff\xd9"), max_size=6
)


def _body(pictures: list[bytes], *, lengths: bool, newline: bytes) -> bytes:
    parts = []
    for picture in pictures:
        length = b"Content-Length: %d" % len(picture) + newline if lengths else b""
        parts.append(b"--frame" + newline + b"Content-Type: image/jpeg" + newline + length + newline + picture + newline)
    return b"".join(parts) + b"--frame" + newline


@given(
    pictures=PICTURES,
    lengths=st.booleans(),
    newline=st.sampled_from([b"\r\n", b"\n"]),
    cuts=st.lists(st.integers(0, 600), max_size=12),
)
def test_pictures_survive_any_chunking(pictures: list[bytes], lengths: bool, newline: bytes, cuts: list[int]) -> None:
    body = b"preamble" + newline + _body(pictures, lengths=lengths, newline=newline)
    edges = sorted({0, len(body), *(cut for cut in cuts if cut < len(body))})
    parser = MjpegParser(parse_boundary("multipart/x-mixed-replace; boundary=frame"))
    found = [picture for a, b in pairwise(edges) for picture in parser.feed(body[a:b])]
    assert found == pictures


@given(chunks=st.lists(st.binary(max_size=200), max_size=20))
def test_any_bytes_end_in_pictures_or_an_error(chunks: list[bytes]) -> None:
    parser = MjpegParser(b"--b")
    try:
        for chunk in chunks:
            parser.feed(chunk)
    except PictureError:
        pass


@pytest.mark.parametrize("announced", ["boundary=--my", 'boundary="my"', "boundary=my; x=y"])
def test_boundaries_with_and_without_dashes(announced: str) -> None:
    assert parse_boundary(f"multipart/x-mixed-replace;{announced}") == b"--my"


@pytest.mark.parametrize("announced", ["", "image/jpeg", "multipart/x-mixed-replace", "text/html; boundary=x"])
def test_what_is_no_stream_is_refused(announced: str) -> None:
    with pytest.raises(CameraReplyError, match="not multipart"):
        parse_boundary(announced)


def test_memory_is_bounded() -> None:
    endless = MjpegParser(b"--b")
    with pytest.raises(PictureError, match="too long"):
        for _ in range(MAX_HEADER_BYTES):
            endless.feed(b"--b\r\nX: y")
    junk = MjpegParser(b"--boundary")
    for _ in range(100):
        junk.feed(b"x" * 10_000)
    assert len(junk._buffer) < 100
    with pytest.raises(PictureError, match="16 MB"):
        MjpegParser(b"--b").feed(b"--b\r\nContent-Length: 99999999\r\n\r\n")
