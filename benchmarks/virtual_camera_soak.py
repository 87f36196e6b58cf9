"""Run a virtual camera for ten minutes with four streaming clients while it moves and other clients disconnect abruptly.

    python benchmarks/virtual_camera_soak.py [--minutes 10] [--scene highway-works] [--json FILE]

Two clients read H.264 over TCP, one over UDP (FFmpeg through PyAV), and one Motion JPEG. The camera runs in a separate process.
The benchmark measures memory over time, frames per second, frames that arrive late or out of order, the processor time of the
camera, and leaked threads and sockets. On a busy machine, frames are late because processor time is short. The wake-up delay of a
sleeping thread shows how busy the machine was. The first part of the run, in which the camera reads its scene and clients start,
is printed but not counted. The age of a frame is the time since its exposure, according to the time stamps in the streams.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import av
import httpx2

from soak.camera_process import END_S, RATE_HZ, Camera, run_camera
from soak.load import disconnect_repeatedly, move_continually
from soak.streams import Stream, read_mjpeg, read_rtsp

SAMPLE_S = 2.0
CLIENT_START_S = 5.0  # after the first frame of a client; FFmpeg analyses a stream first, so the first frames are old


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=10.0, help="duration of the run in minutes (default: 10)")
    parser.add_argument("--scene", default="highway-works", help="scene to serve (default: highway-works)")
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


def soak(scene: str, duration_s: float) -> dict[str, Any]:
    """Run the camera and its clients for a number of seconds, and return the results."""
    camera, ended, rounds = Camera(scene), threading.Event(), list[float]()
    streams = [Stream(name) for name in ("RTSP over TCP (1)", "RTSP over TCP (2)", "RTSP over UDP", "Motion JPEG")]
    work: list[tuple[Stream | None, Callable[[], None]]] = [
        (streams[0], lambda: read_rtsp(streams[0], camera.rtsp_url, "tcp", ended)),
        (streams[1], lambda: read_rtsp(streams[1], camera.rtsp_url, "tcp", ended)),
        (streams[2], lambda: read_rtsp(streams[2], camera.rtsp_url, "udp", ended)),
        (streams[3], lambda: read_mjpeg(streams[3], camera.url, ended)),
        (None, lambda: move_continually(camera.url, ended, rounds)),
        (None, lambda: disconnect_repeatedly(camera, ended)),
    ]
    threads = [threading.Thread(target=run_client, args=each) for each in work]
    for thread in threads:
        thread.start()
    start_s = time.monotonic()
    samples: list[tuple[float, dict[str, Any]]] = []
    while time.monotonic() < start_s + duration_s:
        samples.append((time.monotonic(), camera.sample()))
        if len(samples) % 15 == 1:
            now_s, figures = samples[-1]
            parts = "  ".join(f"{name.removesuffix('_mb')} {figures[name]:.0f}" for name in figures if name.endswith("_mb"))
            numbers = f"{parts} MB  {figures['threads']:2} threads  {figures['sockets']:2} sockets"
            print(f"{now_s - start_s:5.0f} s  {numbers}", flush=True)
        time.sleep(SAMPLE_S)
    end_s = time.monotonic()
    ended.set()
    for thread in threads:
        thread.join(timeout=60)
    gone_s = time.monotonic() + END_S
    while (last := camera.sample())["sessions"] and time.monotonic() < gone_s:
        time.sleep(0.1)
    leaked = camera.end()
    # The second half of the run is always counted, even if starting takes longer on a slow machine.
    started_s = [stream.arrivals_s[0] + CLIENT_START_S for stream in streams if stream.arrivals_s]
    prefetched_s = [at for at, figures in samples if figures["prefetched"]]
    counted_s = min(max([start_s, *rounds[:1], *prefetched_s[:1], *started_s]), start_s + duration_s / 2)
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
        "longest_pause_s": {name: max(figures[f"{name}_pause_s"] for _, figures in counted[1:]) for name in ("machine", "loop")},
        "load": [round(each, 1) for each in os.getloadavg()],
        "streams": {stream.name: stream.results(counted_s, end_s) for stream in streams},
        "server": {name: last[name] for name in ("sent", "dropped", "oldest_sent_s")},
        "clients_total": last["vanished"],
        "sessions_open_at_end": last["sessions"],
        "left_over": leaked,
    }


def run_client(stream: Stream | None, work: Callable[[], None]) -> None:
    """Run a client, and record the error if it fails."""
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
    pauses = results["longest_pause_s"]
    print(
        f"Longest wake-up delay of a sleeping thread: {1000 * pauses['machine']:.0f} ms; of the camera's event loop: "
        f"{1000 * pauses['loop']:.0f} ms; load of the machine: {results['load']}"
    )
    for name, stream in results["streams"].items():
        rate, worst = stream["frames_per_s"], stream["worst_10_s_frames_per_s"]
        figures = [f"{rate:.2f} frames/s ({rate / RATE_HZ:.3f} x {RATE_HZ:g})"]
        if worst is not None:
            figures.append(f"worst 10 s {worst:.1f}")
        if stream["longest_gap_s"] is not None:
            figures.append(f"longest gap {1000 * stream['longest_gap_s']:.0f} ms")
        if stream["median_age_s"] is not None:
            figures.append(f"age {1000 * stream['median_age_s']:.0f} ms, 99% {1000 * stream['p99_age_s']:.0f} ms")
        figures.append(f"{stream['skipped_frames']} of {stream['frames_with_age']} late, {stream['out_of_order']} out of order")
        print(f"{name}: {'; '.join(figures)} {stream['failure']}".rstrip())
    server = results["server"]
    oldest_ms = 1000 * server["oldest_sent_s"]
    print(f"RTSP: {server['sent']} frames sent, {server['dropped']} dropped; maximum age when sent {oldest_ms:.0f} ms")
    print(f"{results['clients_total']} RTSP sessions in total; still open at the end: {results['sessions_open_at_end']}")
    print(f"Leaked: {results['left_over']['threads']} threads, {results['left_over']['sockets']} sockets")


if __name__ == "__main__":
    sys.exit(main())
