"""The memory that a virtual camera returns to the operating system."""

from __future__ import annotations

import anyio
import pytest

from scope_ptz.virtual_camera import heap

pytestmark = pytest.mark.anyio


async def test_memory_is_released_until_the_camera_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    releases, enough = [0], anyio.Event()

    def release() -> None:
        releases[0] += 1
        if releases[0] == 3:
            anyio.from_thread.run_sync(enough.set)

    monkeypatch.setattr(heap, "release_free_memory", release)
    async with anyio.create_task_group() as group:
        group.start_soon(heap.release_memory_regularly, 0.0)
        with anyio.fail_after(20):
            await enough.wait()
        group.cancel_scope.cancel()
    assert releases[0] >= 3
