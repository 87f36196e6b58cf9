"""Limit the memory use of a program that creates and releases many pictures in several threads."""

from __future__ import annotations

import ctypes
import sys

import anyio

from scope_ptz.simulator.sheets.memory import release_free_memory

RELEASE_EVERY_S = 60.0  # seconds between two releases of freed memory

_M_ARENA_MAX = -8  # number of the parameter M_ARENA_MAX in calls of mallopt (GNU C library)


def use_one_heap() -> bool:
    """Make all threads of this program share one heap. Call it before threads are started.

    The GNU C library gives each thread its own heap. Short-lived pictures fragment these heaps, so the memory use of a camera with
    streams grows by about 100 MB within minutes. Sharing one heap takes no additional processor time. With another C library or on
    another system, nothing changes.

    Returns:
        Whether the setting was accepted.
    """
    if sys.platform != "linux":
        return False
    try:
        return bool(ctypes.CDLL(None).mallopt(_M_ARENA_MAX, 1))
    except (OSError, AttributeError):  # a C library without this setting
        return False


async def release_memory_regularly(every_s: float = RELEASE_EVERY_S) -> None:
    """Return freed memory to the operating system at regular intervals, until cancelled.

    Pictures of different sizes fragment the heap, so its size would otherwise grow by 1 to 2% in ten minutes of streaming.
    """
    while True:
        await anyio.sleep(every_s)
        await anyio.to_thread.run_sync(release_free_memory)
