"""Check that the network camera drivers leak nothing in 1,000 connections to a virtual camera.

    python benchmarks/camera_reconnects.py [--times 1000] [--scene high-street] [--driver axis|onvif] [--rtsp]

The camera runs in a separate process (``scope camera serve``), so that the memory, threads and sockets of this process are those of
the driver alone. Each connection opens the camera, moves it continuously, reads a frame of its live stream, and closes it. With
``--rtsp``, streams are H.264 over RTSP. The first tenth of the connections is a warm-up and is not counted.
"""

from __future__ import annotations

import argparse
import gc
import json
import os
import resource
import subprocess
import sys
import threading
import time
from contextlib import aclosing
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import anyio

PASSWORD = "only-for-this-run"  # noqa: S105 - the camera exists only while this program runs


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--times", type=int, default=1000, help="number of connections per driver (default: 1000)")
    parser.add_argument("--scene", default="high-street", help="scene to serve (default: high-street)")
    parser.add_argument("--driver", choices=("axis", "onvif"), help="driver to check (default: both)")
    parser.add_argument("--rtsp", action="store_true", help="stream H.264 over RTSP")
    arguments = parser.parse_args()
    drivers = [arguments.driver] if arguments.driver else ["axis", "onvif"]
    passed = True
    with TemporaryDirectory() as folder:
        os.environ |= {"SCOPE_CAMERA_PASSWORD": PASSWORD, "SCOPE_VIRTUAL_CAMERA_PASSWORD": PASSWORD, "SCOPE_CACHE_DIR": folder}
        command = [sys.executable, "-m", "scope_ptz.cli", "camera", "serve", "--scene", arguments.scene, "--port", "0"]
        command += ["--no-prefetch", "--no-discovery", "--user", "guard:operator", "--json"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as camera:
            assert camera.stdout is not None
            (address,) = json.loads(camera.stdout.readline())["cameras"]
            try:
                for driver in drivers:
                    stream = {"axis": "mjpeg", "onvif": "snapshot"}[driver] if not arguments.rtsp else "rtsp"
                    spec = f"{driver}://guard@{address['url'].partition('://')[2]}?stream={stream}"
                    passed &= anyio.run(reconnect, spec, arguments.times)
            finally:
                camera.terminate()
    return 0 if passed else 1


async def reconnect(spec: str, times: int) -> bool:
    """Open and close a camera many times, and print the resources in use. Return whether nothing leaked."""
    print(f"\n{spec.partition('@')[0]}, stream={spec.rpartition('=')[2]}")
    warm = max(1, times // 10)
    samples: list[dict[str, float]] = []
    for k in range(warm + times):
        if k >= warm and (k - warm) % max(1, times // 10) == 0:
            samples.append(resource_usage())
            print(f"{k - warm:5}  {format_usage(samples[-1])}", flush=True)
        await open_and_close(spec)
    samples.append(resource_usage())
    print(f"{times:5}  {format_usage(samples[-1])}")
    first, last = samples[0], samples[-1]
    cpu_ms = 1000 * (last["cpu_s"] - first["cpu_s"]) / times
    growth = last["memory_mb"] / samples[len(samples) // 2]["memory_mb"]
    print(f"Processor time of one reconnect: {cpu_ms:.0f} ms; memory growth in the second half: {growth:.3f} x")
    return all(last[name] <= first[name] for name in ("threads", "files", "processes"))


async def open_and_close(spec: str) -> None:
    """Open a camera, drive it, read a frame and close it."""
    from scope_ptz.factory.cameras import open_camera

    async with await open_camera(spec) as opened:
        await opened.camera.drive(1.0, timeout_s=1.0)
        async with aclosing(opened.camera.frames()) as stream:
            await anext(stream)


def resource_usage() -> dict[str, float]:
    """Return the resources that this process uses."""
    gc.collect()
    time.sleep(0.2)  # time for threads and processes to end
    used = resource.getrusage(resource.RUSAGE_SELF)
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    workers = sum("AnyIO worker" in thread.name for thread in threading.enumerate())  # kept for later work, up to 40
    return {
        "memory_mb": pages * os.sysconf("SC_PAGE_SIZE") / 1e6,
        "threads": threading.active_count() - workers,
        "files": len(list(Path("/proc/self/fd").iterdir())),
        "processes": len(Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()),
        "cpu_s": used.ru_utime + used.ru_stime,
    }


def format_usage(figures: dict[str, Any]) -> str:
    return (
        f"{figures['memory_mb']:6.1f} MB  {figures['threads']:2} threads  {figures['files']:3} files and sockets  "
        f"{figures['processes']} processes"
    )


if __name__ == "__main__":
    sys.exit(main())
