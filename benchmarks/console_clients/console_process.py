"""The console in a separate process, and its use of memory, threads, sockets and processor time."""

from __future__ import annotations

import itertools
import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path


def use_two_cores() -> None:
    """Restrict this process and its child processes to two processor cores."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:2])


async def read_scene(name: str) -> None:
    """Decode all pictures of a scene to the cache on disk, so that the run does not measure decoding."""
    from scope_ptz.camera.simulated import SimulatedCamera
    from scope_ptz.factory.cameras import open_camera

    async with await open_camera(f"sim:{name}") as opened:
        assert isinstance(opened.camera, SimulatedCamera)
        opened.camera.prefetch().wait(600)


class Console:
    """A console in a separate process.

    Args:
        cameras: The names of the cameras that it serves.
        runs: The runs folder.
    """

    def __init__(self, cameras: tuple[str, ...], runs: Path) -> None:
        names = itertools.chain.from_iterable(("--camera", name) for name in cameras)
        command = [sys.executable, "-m", "scope_ptz.cli", "console", "--port", "0", "--json", *names, "--runs-dir", str(runs)]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise SystemExit("The console did not start. Its error message is printed above.")
        self.root: str = json.loads(line)["url"]
        self.url = f"{self.root}/api/v1"
        self._folder = Path(f"/proc/{self._process.pid}")

    def sample(self) -> dict[str, float]:
        """Return the memory, threads, TCP sockets and processor time of the process."""
        status = dict(line.split(":", 1) for line in (self._folder / "status").read_text().splitlines())
        times = (self._folder / "stat").read_text().rpartition(")")[2].split()
        tables = [(self._folder / "net" / name).read_text().splitlines()[1:] for name in ("tcp", "tcp6")]
        tcp = {f"socket:[{line.split()[9]}]" for table in tables for line in table}
        sockets = 0
        for each in (self._folder / "fd").iterdir():
            with suppress(OSError):
                sockets += str(each.readlink()) in tcp
        return {
            "memory_mb": int(status["VmRSS"].split()[0]) * 1024 / 1e6,
            "anonymous_mb": int(status["RssAnon"].split()[0]) * 1024 / 1e6,
            "threads": int(status["Threads"]),
            "sockets": sockets,
            "cpu_s": (int(times[11]) + int(times[12])) / os.sysconf("SC_CLK_TCK"),
        }

    def end(self) -> int:
        """Interrupt the process and return its exit code."""
        self._process.send_signal(signal.SIGINT)
        try:
            return self._process.wait(180)  # on a busy disk, unmapping files takes long
        finally:
            if self._process.poll() is None:
                self._process.kill()
            assert self._process.stdout is not None
            self._process.stdout.close()
