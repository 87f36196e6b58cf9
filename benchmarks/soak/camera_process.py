"""The virtual camera of the soak test, which runs in a separate process, and the object through which the test controls it."""

from __future__ import annotations

import asyncio
import json
import subprocess
import sys
import threading
import time
from typing import Any

from soak.usage import WakeUpDelays, counts

RATE_HZ = 25.0
END_S = 10.0  # maximum time to close connections of disconnected clients and end threads, on a busy machine


def run_camera(scene: str) -> int:
    """Serve a camera until the end of standard input. Each input line is answered with a line of statistics as JSON."""
    from scope_ptz.virtual_camera.heap import use_one_heap

    use_one_heap()  # as ``scope camera serve`` does
    before = counts()
    asyncio.run(serve_camera(scene))
    # Worker threads are stopped with the event loop, but may take a moment to end.
    end_time_s = time.monotonic() + END_S
    while (after := counts())["threads"] > before["threads"] and time.monotonic() < end_time_s:
        time.sleep(0.05)
    leaked = {name: after[name] - before[name] for name in ("threads", "sockets")}
    names = sorted(thread.name for thread in threading.enumerate())
    print(json.dumps({"left_over": leaked, "threads": names}), flush=True)
    return 0


async def serve_camera(scene: str) -> None:
    """Serve a scene by HTTP and RTSP, and answer requests for statistics until the end of standard input."""
    from scope_ptz.factory.cameras.virtual import VirtualCameraOptions, make_devices
    from scope_ptz.virtual_camera.heap import release_memory_regularly
    from scope_ptz.virtual_camera.http.server import listen, serve
    from scope_ptz.virtual_camera.rtsp.server import RtspServer

    devices = make_devices(VirtualCameraOptions(scenes=(scene,)), [])
    reading = devices[0].prefetch()
    machine, loop = WakeUpDelays(), WakeUpDelays()
    threading.Thread(target=machine.watch, name="pauses", daemon=True).start()
    background = [asyncio.create_task(work) for work in (loop.watch_loop(), release_memory_regularly())]
    async with serve(devices, truth=True, rate_hz=RATE_HZ) as (camera,):
        (listener,) = listen(camera.host, [0])
        async with RtspServer(camera.source, realm=camera.vapix.realm).listen(listener) as rtsp:
            camera.vapix.rtsp_port = listener.getsockname()[1]
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
                    "skipped_ticks": camera.source.skipped_frames,
                    "prefetched": reading.done,
                    "machine_pause_s": machine.longest_s(),
                    "loop_pause_s": loop.longest_s(),
                }
                print(json.dumps(figures), flush=True)
    reading.cancel()
    for task in background:
        task.cancel()
    machine.end()


class Camera:
    """The camera's process. Creating the object starts the process and waits for its addresses."""

    def __init__(self, scene: str) -> None:
        command = [sys.executable, sys.argv[0], "--camera", "--scene", scene]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        addresses = self._line()
        self.url, self.rtsp_url = addresses["url"], addresses["rtsp_url"]

    def sample(self) -> dict[str, Any]:
        """Return the current statistics of the camera."""
        assert self._process.stdin is not None
        self._process.stdin.write("sample\n")
        self._process.stdin.flush()
        return self._line()

    def end(self) -> dict[str, int]:
        """Stop the camera and return the resources that its process leaked."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        line = self._line()
        leaked: dict[str, int] = line["left_over"]
        if leaked["threads"]:
            print(f"Leaked threads: {line['threads']}", file=sys.stderr)
        assert self._process.stdout is not None
        self._process.stdout.close()
        if self._process.wait(timeout=60):
            raise SystemExit(f"The camera process exited with code {self._process.returncode}.")
        return leaked

    def _line(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise SystemExit("The camera process exited early. Its error message is printed above.")
        answer: dict[str, Any] = json.loads(line)
        return answer
