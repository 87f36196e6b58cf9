"""Clients that read a stream until its end and record when each frame arrived."""

from __future__ import annotations

import itertools
import statistics
import struct
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import av
import httpx2

LATE_S = 0.5  # age above which a frame is late, and gap between frames above which the gap is reported


@dataclass
class Stream:
    """The frames that a client has received.

    Attributes:
        name: The name of the client.
        arrivals_s: The arrival times of the frames, in seconds of ``time.monotonic``.
        ages_s: The ages of the frames at arrival in seconds; None if the stream does not state the age.
        out_of_order: The number of frames that were not newer than the frame before.
        failure: The error that ended the client early; empty if there was none.
    """

    name: str
    arrivals_s: list[float] = field(default_factory=list)
    ages_s: list[float | None] = field(default_factory=list)
    out_of_order: int = 0
    failure: str = ""

    def record_frame(self, age_s: float | None, *, newer: bool) -> None:
        """Record a frame that arrives now. ``newer`` states whether it is newer than the frame before."""
        self.arrivals_s.append(time.monotonic())
        self.ages_s.append(age_s)
        self.out_of_order += not newer

    def results(self, start_s: float, end_s: float) -> dict[str, Any]:
        """Return statistics of an interval."""
        inside = [(at, age) for at, age in zip(self.arrivals_s, self.ages_s, strict=True) if start_s <= at < end_s]
        ages = sorted(age for _, age in inside if age is not None)
        windows = range(int(start_s), int(end_s) - 10, 10)
        return {
            "frames_per_s": len(inside) / (end_s - start_s),
            "longest_gap_s": max((b - a for (a, _), (b, _) in itertools.pairwise(inside)), default=None),
            "gaps": [(round(a - start_s, 1), round(b - a, 2)) for (a, _), (b, _) in itertools.pairwise(inside) if b - a > LATE_S],
            "worst_10_s_frames_per_s": min((sum(k <= at < k + 10 for at, _ in inside) / 10 for k in windows), default=None),
            "median_age_s": statistics.median(ages) if ages else None,
            "p99_age_s": ages[int(0.99 * (len(ages) - 1))] if ages else None,
            "skipped_frames": sum(age > LATE_S for age in ages),
            "frames_with_age": len(ages),
            "out_of_order": self.out_of_order,
            "failure": self.failure,
        }


def read_rtsp(stream: Stream, url: str, transport: str, ended: threading.Event) -> None:
    """Read H.264 by RTSP, without decoding it."""
    last = -1
    options = {"rtsp_transport": transport, "fpsprobesize": "0", "analyzeduration": "200000"}
    with av.open(url, options=options, timeout=30) as container:
        for packet in container.demux(video=0):
            if ended.is_set():
                return
            if packet.size:
                age_s = None
                if packet.has_sidedata("prft"):
                    age_s = time.time() - struct.unpack_from("=q", bytes(packet.get_sidedata("prft")))[0] / 1e6
                stream.record_frame(age_s, newer=packet.pts is None or packet.pts > last)
                last = packet.pts if packet.pts is not None else last


def read_mjpeg(stream: Stream, url: str, ended: threading.Event) -> None:
    """Read Motion JPEG without decoding it."""
    last_s = 0.0
    with httpx2.Client(trust_env=False, timeout=30) as session, session.stream("GET", f"{url}/axis-cgi/mjpg/video.cgi") as reply:
        for headers in parts(reply.iter_bytes()):
            if ended.is_set():
                return
            taken_s = float(headers["x-scope-taken"])
            stream.record_frame(time.time() - taken_s, newer=taken_s > last_s)
            last_s = taken_s


def parts(chunks: Iterator[bytes]) -> Iterator[dict[str, str]]:
    """Yield the headers of each part of a multipart stream when the part is complete."""
    buffer = b""
    while True:
        while b"\r\n\r\n" not in buffer:
            buffer += next(chunks)
        head, _, buffer = buffer.partition(b"\r\n\r\n")
        headers = {name.lower(): value for name, _, value in (line.partition(": ") for line in head.decode().split("\r\n")[1:])}
        length = int(headers["content-length"]) + 2
        while len(buffer) < length:
            buffer += next(chunks)
        buffer = buffer[length:]
        yield headers
