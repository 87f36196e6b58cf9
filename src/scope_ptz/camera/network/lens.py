"""Wait until a device's focus has settled."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from time import monotonic

import anyio

from scope_ptz.camera.lens import LensState
from scope_ptz.errors import CameraError

SETTLED_READINGS = 6
"""Number of consecutive equal readings after which the focus counts as settled."""

UNREPORTED_FOCUS_WAIT_S = 2.0
"""Seconds to wait for a device that does not report its focus position."""

TIMEOUT_S = 15.0


async def wait_until_focused(read: Callable[[], Awaitable[LensState]], poll_s: float) -> LensState:
    """Wait until the focus has settled, and return the lens state.

    Args:
        read: A function that reads the lens state.
        poll_s: Seconds between two readings.

    Raises:
        CameraError: The focus is still moving after ``TIMEOUT_S`` seconds.
    """
    state, started_s, equal = await read(), monotonic(), 0
    if state.focus is None:
        await anyio.sleep(UNREPORTED_FOCUS_WAIT_S)
        return await read()
    while monotonic() - started_s < TIMEOUT_S:
        await anyio.sleep(poll_s)
        before, state = state, await read()
        equal = equal + 1 if state.focus == before.focus else 0
        if equal >= SETTLED_READINGS:
            return state
    raise CameraError(f"The focus is still moving after {TIMEOUT_S:g} s. Set it to manual, or check that no one else is moving it.")
