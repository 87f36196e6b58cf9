"""A virtual camera for ten minutes: four clients stream, it moves all the time, and other clients vanish without a word.

    python benchmarks/virtual_camera_soak.py [--minutes 10] [--scene highway-works] [--json FILE]

Two clients read H.264 over TCP, one over UDP (FFmpeg through PyAV), and one Motion JPEG. The camera runs in a process of its own.
What counts is memory over time, frames per second, frames that arrive late or out of order, the processor time of the camera, and
threads and sockets that are left over at the end. The first part of the run, in which the camera reads its scene and clients start,
is printed and not counted. Ages are measured from the exposure, by the time stamps in the streams.
"""

from __future__ import annotations

import argparse
import asyncio
import itertools
import json
import os
import resource
import socket
import statistics
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import av
import httpx2

RATE_HZ = 25.0
LATE_S = 0.5
SAMPLE_S = 2.0
END_S = 5.0
VANISH_EVERY_S = 0.5
CLIENT_START_S = 5.0  # from the first frame of a client: FFmpeg analyses a stream before it hands out frames, which are old then
POSES = [(pan, tilt, zoom) for zoom in (1, 3500, 9999) for pan, tilt in ((0, 0), (90, -20), (179, 5), (-90, -10))]
"""Pan and tilt in degrees, zoom in the camera's units. Moves go round them."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--scene", default="highway-works")
    parser.add_argument("--json", type=Path, help="also write the results to this file")
    parser.add_argument("--camera", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.camera:
        return run_camera(arguments.scene)
    results = soak(arguments.scene, 60 * arguments.minutes)
    if arguments.json is not None:
        arguments.json.write_text(json.dumps(results, indent=1))
    report(results)
    return 0


# The camera, in a process of its own -------------------------------------------------------------------------------------


def run_camera(scene: str) -> int:
    """Serve a camera. Every line on standard input is answered by a line of numbers; its end ends the camera."""
    before = counts()
    asyncio.run(serve_camera(scene))
    # Worker threads are told to end with the event loop, and need a moment.
    ends_s = time.monotonic() + END_S
    while (after := counts())["threads"] > before["threads"] and time.monotonic() < ends_s:
        time.sleep(0.05)
    left = {name: after[name] - before[name] for name in ("threads", "sockets")}
    names = sorted(thread.name for thread in threading.enumerate())
    print(json.dumps({"left_over": left, "threads": names}), flush=True)
    return 0


async def serve_camera(scene: str) -> None:
    from scope_ptz.factory.virtual_cameras import VirtualCameraOptions, make_devices
    from scope_ptz.virtual_camera.http.server import listen, serve
    from scope_ptz.virtual_camera.rtsp.server import RtspServer

    devices = make_devices(VirtualCameraOptions(scenes=(scene,)), [])
    reading = devices[0].prefetch()
    async with serve(devices, truth=True, rate_hz=RATE_HZ) as (camera,):
        (listener,) = listen(camera.host, [0])
        async with RtspServer(camera.source, realm=camera.unit.realm).listen(listener) as rtsp:
            camera.unit.rtsp_port = listener.getsockname()[1]
            print(json.dumps({"url": camera.url, "rtsp_url": camera.rtsp_url}), flush=True)
            while await asyncio.to_thread(sys.stdin.readline):
                sent = rtsp.statistics
                figures = {
                    **counts(),
                    "sessions": rtsp.sessions,
                    "sent": sent.sent,
                    "dropped": sent.dropped,
                    "oldest_sent_s": sent.oldest_s,
                    "vanished": sent.sessions,
                    "skipped_ticks": camera.source.late_frames,
                }
                print(json.dumps(figures), flush=True)
    reading.cancel()


def counts() -> dict[str, float]:
    """Return what this process holds and has used."""
    handles = 0
    for each in Path("/proc/self/fd").iterdir():
        with suppress(OSError):
            handles += str(each.readlink()).startswith("socket:")
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    used = resource.getrusage(resource.RUSAGE_SELF)
    return {
        "memory_mb": pages * os.sysconf("SC_PAGE_SIZE") / 1e6,
        "threads": threading.active_count(),
        "sockets": handles,
        "cpu_s": used.ru_utime + used.ru_stime,
    }


class Camera:
    """The camera's process, as the soak test sees it."""

    def __init__(self, scene: str) -> None:
        command = [sys.executable, __file__, "--camera", "--scene", scene]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        addresses = self._line()
        self.url, self.rtsp_url = addresses["url"], addresses["rtsp_url"]

    def sample(self) -> dict[str, Any]:
        """Return the current numbers."""
        assert self._process.stdin is not None
        self._process.stdin.write("sample\n")
        self._process.stdin.flush()
        return self._line()

    def end(self) -> dict[str, int]:
        """End the camera and return what is left over in its process."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        line = self._line()
        left: dict[str, int] = line["left_over"]
        if left["threads"]:
            print(f"Threads that are left over: {line['threads']}", file=sys.stderr)
        assert self._process.stdout is not None
        self._process.stdout.close()
        if self._process.wait(timeout=60):
            raise SystemExit(f"The camera ended with code {self._process.returncode}.")
        return left

    def _line(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise SystemExit("The camera ended early. Its error is above.")
        answer: dict[str, Any] = json.loads(line)
        return answer


# Clients -----------------------------------------------------------------------------------------------------------------


@dataclass
class Stream:
    """What a client has received.

    Attributes:
        name: Of the client.
        arrivals_s: When frames arrived, on ``time.monotonic``.
        ages_s: Their ages on arrival, None where the stream does not say.
        disorder: Number of frames that were not newer than the one before.
        failure: Why the client ended, if it did.
    """

    name: str
    arrivals_s: list[float] = field(default_factory=list)
    ages_s: list[float | None] = field(default_factory=list)
    disorder: int = 0
    failure: str = ""

    def note(self, age_s: float | None, *, newer: bool) -> None:
        self.arrivals_s.append(time.monotonic())
        self.ages_s.append(age_s)
        self.disorder += not newer

    def results(self, start_s: float, end_s: float) -> dict[str, Any]:
        """Return the figures of an interval."""
        inside = [(at, age) for at, age in zip(self.arrivals_s, self.ages_s, strict=True) if start_s <= at < end_s]
        ages = sorted(age for _, age in inside if age is not None)
        windows = range(int(start_s), int(end_s) - 10, 10)
        return {
            "frames_per_s": len(inside) / (end_s - start_s),
            "worst_10_s_frames_per_s": min((sum(k <= at < k + 10 for at, _ in inside) / 10 for k in windows), default=None),
            "median_age_s": statistics.median(ages) if ages else None,
            "p99_age_s": ages[int(0.99 * (len(ages) - 1))] if ages else None,
            "late_frames": sum(age > LATE_S for age in ages),
            "frames_with_age": len(ages),
            "out_of_order": self.disorder,
            "failure": self.failure,
        }


def read_rtsp(stream: Stream, url: str, transport: str, ended: threading.Event) -> None:
    """Read H.264 without decoding it."""
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
                stream.note(age_s, newer=packet.pts is None or packet.pts > last)
                last = packet.pts if packet.pts is not None else last


def read_mjpeg(stream: Stream, url: str, ended: threading.Event) -> None:
    """Read Motion JPEG without decoding it."""
    last_s = 0.0
    with httpx2.Client(trust_env=False, timeout=30) as session, session.stream("GET", f"{url}/axis-cgi/mjpg/video.cgi") as reply:
        for headers in parts(reply.iter_bytes()):
            if ended.is_set():
                return
            taken_s = float(headers["x-scope-taken"])
            stream.note(time.time() - taken_s, newer=taken_s > last_s)
            last_s = taken_s


def parts(chunks: Iterator[bytes]) -> Iterator[dict[str, str]]:
    """Yield the headers of each part once it is complete."""
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


def move_all_the_time(url: str, ended: threading.Event, rounds: list[float]) -> None:
    """Go round the poses, by absolute and by continuous moves. Note when each round is complete."""
    with httpx2.Client(base_url=url, trust_env=False, timeout=30) as session:
        while True:
            for pan, tilt, zoom in POSES:
                for query in (f"pan={pan}&tilt={tilt}&zoom={zoom}", "continuouspantiltmove=15,5", "continuouspantiltmove=0,0"):
                    session.get(f"/axis-cgi/com/ptz.cgi?{query}").raise_for_status()
                    if ended.wait(1.6 if query.startswith("pan=") else 0.2):
                        return
            rounds.append(time.monotonic())


def vanish_all_the_time(camera: Camera, ended: threading.Event) -> None:
    """Come, take a few bytes or none, and leave without a word."""
    for vanish in itertools.cycle([vanish_tcp, vanish_udp, vanish_mjpeg, vanish_silent]):
        with suppress(OSError):
            vanish(camera, ended)
        if ended.wait(VANISH_EVERY_S):
            return


def vanish_tcp(camera: Camera, ended: threading.Event) -> None:
    with connected(camera.rtsp_url) as connection:
        play(connection, camera.rtsp_url, "RTP/AVP/TCP;unicast;interleaved=0-1")
        connection.recv(10_000)
        ended.wait(0.3)  # without reading


def vanish_udp(camera: Camera, _: threading.Event) -> None:
    with connected(camera.rtsp_url) as connection, socket.socket(type=socket.SOCK_DGRAM) as rtp:
        rtp.bind(("127.0.0.1", 0))
        rtp.settimeout(5)
        port = rtp.getsockname()[1]
        play(connection, camera.rtsp_url, f"RTP/AVP;unicast;client_port={port}-{port + 1}")
        rtp.recv(2000)


def vanish_mjpeg(camera: Camera, ended: threading.Event) -> None:
    with connected(camera.url) as connection:
        connection.sendall(b"GET /axis-cgi/mjpg/video.cgi HTTP/1.1\r\nHost: camera\r\n\r\n")
        connection.recv(10_000)
        ended.wait(0.3)


def vanish_silent(camera: Camera, _: threading.Event) -> None:
    with connected(camera.rtsp_url) as connection:
        connection.sendall(b"DESCRIBE rtsp://cam")


def connected(url: str) -> socket.socket:
    """Return a connection that is reset when it is closed."""
    host, _, port = url.partition("://")[2].partition("/")[0].partition(":")
    connection = socket.create_connection((host, int(port)), timeout=10)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    return connection


def play(connection: socket.socket, url: str, transport: str) -> None:
    """Set a stream up and play it."""
    connection.sendall(f"SETUP {url} RTSP/1.0\r\nCSeq: 1\r\nTransport: {transport}\r\n\r\n".encode())
    reply = connection.recv(4000).decode()
    token = reply.partition("Session: ")[2].partition(";")[0]
    connection.sendall(f"PLAY {url} RTSP/1.0\r\nCSeq: 2\r\nSession: {token}\r\n\r\n".encode())


# The run -----------------------------------------------------------------------------------------------------------------


def soak(scene: str, duration_s: float) -> dict[str, Any]:
    """Run for a time and return the results."""
    camera, ended, rounds = Camera(scene), threading.Event(), list[float]()
    streams = [Stream(name) for name in ("RTSP over TCP (1)", "RTSP over TCP (2)", "RTSP over UDP", "Motion JPEG")]
    work: list[tuple[Stream | None, Callable[[], None]]] = [
        (streams[0], lambda: read_rtsp(streams[0], camera.rtsp_url, "tcp", ended)),
        (streams[1], lambda: read_rtsp(streams[1], camera.rtsp_url, "tcp", ended)),
        (streams[2], lambda: read_rtsp(streams[2], camera.rtsp_url, "udp", ended)),
        (streams[3], lambda: read_mjpeg(streams[3], camera.url, ended)),
        (None, lambda: move_all_the_time(camera.url, ended, rounds)),
        (None, lambda: vanish_all_the_time(camera, ended)),
    ]
    threads = [threading.Thread(target=guarded, args=each) for each in work]
    for thread in threads:
        thread.start()
    start_s = time.monotonic()
    samples: list[tuple[float, dict[str, Any]]] = []
    while time.monotonic() < start_s + duration_s:
        samples.append((time.monotonic(), camera.sample()))
        if len(samples) % 15 == 1:
            now_s, figures = samples[-1]
            numbers = f"{figures['memory_mb']:6.0f} MB  {figures['threads']:2} threads  {figures['sockets']:2} sockets"
            print(f"{now_s - start_s:5.0f} s  {numbers}", flush=True)
        time.sleep(SAMPLE_S)
    end_s = time.monotonic()
    ended.set()
    for thread in threads:
        thread.join(timeout=60)
    last = camera.sample()
    left = camera.end()
    # Half of the run is counted even if a slow machine needs longer to start.
    started_s = [stream.arrivals_s[0] + CLIENT_START_S for stream in streams if stream.arrivals_s]
    counted_s = min(max([start_s, *rounds[:1], *started_s]), start_s + duration_s / 2)
    counted = [(at, figures) for at, figures in samples if at >= counted_s]
    memory = [figures["memory_mb"] for _, figures in counted]
    third = max(1, len(memory) // 3)
    first, final = counted[0], counted[-1]
    return {
        "seconds": end_s - start_s,
        "counted_seconds": end_s - counted_s,
        "memory_mb": {"start": statistics.median(memory[:third]), "end": statistics.median(memory[-third:]), "peak": max(memory)},
        "memory_growth": statistics.median(memory[-third:]) / statistics.median(memory[:third]),
        "cores_used": (final[1]["cpu_s"] - first[1]["cpu_s"]) / (final[0] - first[0]),
        "skipped_ticks": final[1]["skipped_ticks"] - first[1]["skipped_ticks"],
        "streams": {stream.name: stream.results(counted_s, end_s) for stream in streams},
        "server": {name: last[name] for name in ("sent", "dropped", "oldest_sent_s")},
        "clients_that_came": last["vanished"],
        "sessions_open_after_all_left": last["sessions"],
        "left_over": left,
    }


def guarded(stream: Stream | None, work: Callable[[], None]) -> None:
    """Run a client and note why it ended."""
    try:
        work()
    except (OSError, av.FFmpegError, httpx2.HTTPError, StopIteration) as error:
        if stream is None:
            raise
        stream.failure = f"{type(error).__name__}: {error}"


def report(results: dict[str, Any]) -> None:
    """Print the results."""
    print(f"\nCounted: {results['counted_seconds']:.0f} of {results['seconds']:.0f} s")
    memory, growth = results["memory_mb"], results["memory_growth"]
    print(f"Memory: {memory['start']:.0f} MB, later {memory['end']:.0f} MB: {growth:.3f} x; at most {memory['peak']:.0f} MB")
    print(f"Processor time of the camera: {results['cores_used']:.2f} cores; {results['skipped_ticks']} exposures skipped")
    for name, stream in results["streams"].items():
        rate, worst = stream["frames_per_s"], stream["worst_10_s_frames_per_s"]
        figures = [f"{rate:.2f} frames/s ({rate / RATE_HZ:.3f} x {RATE_HZ:g})"]
        if worst is not None:
            figures.append(f"worst 10 s {worst:.1f}")
        if stream["median_age_s"] is not None:
            figures.append(f"age {1000 * stream['median_age_s']:.0f} ms, 99% {1000 * stream['p99_age_s']:.0f} ms")
        figures.append(f"{stream['late_frames']} of {stream['frames_with_age']} late, {stream['out_of_order']} out of order")
        print(f"{name}: {'; '.join(figures)} {stream['failure']}".rstrip())
    server = results["server"]
    oldest_ms = 1000 * server["oldest_sent_s"]
    print(f"RTSP: {server['sent']} pictures sent, {server['dropped']} left out; oldest when sent {oldest_ms:.0f} ms")
    print(
        f"{results['clients_that_came']} RTSP sessions in all; open after all have left: {results['sessions_open_after_all_left']}"
    )
    print(f"Left over: {results['left_over']['threads']} threads, {results['left_over']['sockets']} sockets")


if __name__ == "__main__":
    sys.exit(main())
