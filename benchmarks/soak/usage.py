"""Measure the memory, threads, sockets and processor time of this process, and wake-up delays of threads and tasks."""

from __future__ import annotations

import asyncio
import ctypes
import resource
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import ClassVar

# Memory sizes by the name in the results, with the name in /proc/self/status.
STATUS = {"memory_mb": "VmRSS", "anonymous_mb": "RssAnon", "files_mb": "RssFile"}


class WakeUpDelays:
    """Measures how late a sleeping thread or task wakes up. Long delays mean that the machine or the event loop is busy."""

    STEP_S = 0.02  # duration of each sleep

    def __init__(self) -> None:
        self._longest_s = 0.0
        self._ended = threading.Event()

    def watch(self) -> None:
        """Sleep repeatedly in a thread, and measure the delays."""
        while not self._ended.is_set():
            before_s = time.monotonic()
            time.sleep(self.STEP_S)
            self._longest_s = max(self._longest_s, time.monotonic() - before_s - self.STEP_S)

    async def watch_loop(self) -> None:
        """Sleep repeatedly in a task, and measure the delays."""
        while True:
            before_s = time.monotonic()
            await asyncio.sleep(self.STEP_S)
            self._longest_s = max(self._longest_s, time.monotonic() - before_s - self.STEP_S)

    def longest_s(self) -> float:
        """Return the longest delay since the last call, in seconds."""
        longest_s, self._longest_s = self._longest_s, 0.0
        return longest_s

    def end(self) -> None:
        """Stop ``watch``, so that its thread ends."""
        self._ended.set()


class MallocInfo(ctypes.Structure):
    """The structure ``mallinfo2`` of the GNU C library."""

    _fields_: ClassVar = [
        (name, ctypes.c_size_t)
        for name in ("arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks", "fordblks", "keepcost")
    ]


def counts() -> dict[str, float]:
    """Return the memory, threads, sockets and processor time of this process."""
    sockets = 0
    for descriptor in Path("/proc/self/fd").iterdir():
        with suppress(OSError):
            sockets += str(descriptor.readlink()).startswith("socket:")
    used = resource.getrusage(resource.RUSAGE_SELF)
    return {
        **memory(),
        "threads": threading.active_count(),
        "sockets": sockets,
        "cpu_s": used.ru_utime + used.ru_stime,
    }


def memory() -> dict[str, float]:
    """Return the memory of this process in MB: the total, anonymous and file memory, and the used and free memory of malloc."""
    status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    sizes = {name: int(status[key].split()[0]) * 1024 / 1e6 for name, key in STATUS.items()}
    libc = ctypes.CDLL(None)
    if hasattr(libc, "mallinfo2"):
        libc.mallinfo2.restype = MallocInfo
        info = libc.mallinfo2()
        sizes |= {"malloc_used_mb": (info.uordblks + info.hblkhd) / 1e6, "malloc_free_mb": info.fordblks / 1e6}
    return sizes
