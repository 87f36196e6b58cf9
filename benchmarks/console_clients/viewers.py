"""Viewers of the live video by WebSocket and by Motion JPEG."""

from __future__ import annotations

import asyncio
import itertools
import json
import time
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from typing import Any

import httpx2
from websockets.asyncio.client import connect

from console_clients.figures import quantiles


@dataclass
class Viewer:
    """The frames that a viewer has received.

    Attributes:
        name: The name of the viewer.
        arrivals_s: The arrival times of the frames, in seconds since 1970.
        ages_s: The ages of the frames at arrival, in seconds since their exposure; empty if the stream does not state them.
        out_of_order: The number of frames that were not newer than the frame before.
        failure: The error that ended the viewer early; empty if there was none.
    """

    name: str
    arrivals_s: list[float] = field(default_factory=list)
    ages_s: list[float] = field(default_factory=list)
    out_of_order: int = 0
    failure: str = ""

    def results(self, start_s: float, end_s: float) -> dict[str, Any]:
        """Return statistics of an interval."""
        inside = [at for at in self.arrivals_s if start_s <= at < end_s]
        windows = range(int(start_s), int(end_s) - 10, 10)
        earlier = len(self.ages_s) - len(inside)
        return {
            "frames_per_s": len(inside) / (end_s - start_s),
            "worst_10_s_frames_per_s": min((sum(k <= at < k + 10 for at in inside) / 10 for k in windows), default=None),
            "longest_gap_s": max((b - a for a, b in itertools.pairwise(inside)), default=None),
            "age_s": quantiles(self.ages_s[max(0, earlier) :]) if self.ages_s else None,
            "out_of_order": self.out_of_order,
            "failure": self.failure,
        }


async def watch_socket(viewer: Viewer, url: str, ended: asyncio.Event) -> None:
    """Watch by WebSocket, without decoding the pictures."""
    last = 0
    async with connect(f"{url.replace('http', 'ws', 1)}/live?width=1280", proxy=None, max_size=2**24) as socket:
        while not ended.is_set():
            message = await asyncio.wait_for(socket.recv(), 120)
            if isinstance(message, str):
                continue
            facts = json.loads(message[4 : 4 + int.from_bytes(message[:4], "big")])
            viewer.arrivals_s.append(time.time())
            viewer.ages_s.append(time.time() - facts["taken"])
            viewer.out_of_order += facts["number"] <= last
            last = facts["number"]
            await socket.send("drawn")


async def watch_mjpeg(viewer: Viewer, url: str, ended: asyncio.Event) -> None:
    """Watch by Motion JPEG, without decoding the pictures."""
    async with httpx2.AsyncClient(trust_env=False, timeout=120) as client, client.stream("GET", f"{url}/live.mjpeg") as reply:
        async for _ in parts(reply.aiter_raw()):
            viewer.arrivals_s.append(time.time())
            if ended.is_set():
                return


async def parts(chunks: AsyncIterator[bytes]) -> AsyncIterator[int]:
    """Yield the size of each part of a multipart stream once it is complete."""
    buffer = bytearray()
    async for chunk in chunks:
        buffer += chunk
        while (head := buffer.find(b"\r\n\r\n")) >= 0:
            length = next(int(line[16:]) for line in buffer[:head].split(b"\r\n") if line.lower().startswith(b"content-length:"))
            if len(buffer) < head + 4 + length + 2:
                break
            del buffer[: head + 4 + length + 2]
            yield length
