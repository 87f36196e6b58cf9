"""Clients that give instructions, stop cameras, and try to move cameras that others control."""

from __future__ import annotations

import asyncio
import itertools
import json
import time
from contextlib import suppress
from dataclasses import dataclass, field

import httpx2

STOP_EVERY_S = 3.0
MOVE_EVERY_S = 2.0
INSTRUCTIONS = (
    "count the cones",
    "pan right by 25 degrees",
    "how many people are there?",
    "zoom in 2x",
    "count the cars",
    "tilt down by 5 degrees",
    "scan the scene for people",
    "go home",
)


@dataclass
class Observations:
    """The observations of the clients.

    Attributes:
        runs: For each run, the number of tool calls and the outcome that its events reported.
        stops: Each ``stop`` request: the Unix time at which it was sent, and the seconds until it was answered.
        intruders: For each status code, the number of replies to moves of a client that is not in control.
        problems: Unexpected replies and errors.
    """

    runs: dict[str, tuple[int, str]] = field(default_factory=dict)
    stops: list[tuple[float, float]] = field(default_factory=list)
    intruders: dict[int, int] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)


async def converse(observations: Observations, url: str, camera: str, ended: asyncio.Event) -> None:
    """Give one instruction after another, and follow each run to its end."""
    async with httpx2.AsyncClient(base_url=url, headers={"Scope-Client": f"talk-{camera}"}, trust_env=False, timeout=120) as client:
        conversation = (await client.post("/conversations", json={"camera": camera})).json()["id"]
        for instruction in itertools.cycle(INSTRUCTIONS):
            if ended.is_set():
                return
            body = {"camera": camera, "instruction": instruction, "conversation": conversation}
            reply = await client.post("/runs", json=body)
            if reply.status_code == 409 and reply.json()["error"]["code"] == "stopped":
                continue
            if reply.status_code != 202:
                observations.problems.append(f"{camera}: {instruction}: {reply.status_code} {reply.text[:200]}")
                await asyncio.sleep(1.0)
                continue
            run = reply.json()["id"]
            observations.runs[run] = await follow(client, run)
            await asyncio.sleep(0.5)


async def follow(client: httpx2.AsyncClient, run: str) -> tuple[int, str]:
    """Follow the events of a run, and return the number of its tool calls and its outcome."""
    calls, outcome, name = 0, "", ""
    async with client.stream("GET", f"/runs/{run}/events") as events:
        async for line in events.aiter_lines():
            if line.startswith("event: "):
                name = line[7:]
                calls += name == "call"
            elif line.startswith("data: ") and name == "end":
                outcome = json.loads(line[6:])["outcome"]
    return calls, outcome


async def stop_often(observations: Observations, url: str, cameras: tuple[str, ...], ended: asyncio.Event) -> None:
    """Stop one camera after another, regardless of who controls it."""
    async with httpx2.AsyncClient(base_url=url, headers={"Scope-Client": "stopper"}, trust_env=False, timeout=30) as client:
        for camera in itertools.cycle(cameras):
            sent_s, began_s = time.time(), time.perf_counter()
            reply = await client.post(f"/cameras/{camera}/stop")
            observations.stops.append((sent_s, time.perf_counter() - began_s))
            if reply.status_code != 204:
                observations.problems.append(f"stop: {reply.status_code} {reply.text[:200]}")
            if await wait_for_end(ended, STOP_EVERY_S):
                return


async def intrude(observations: Observations, url: str, cameras: tuple[str, ...], ended: asyncio.Event) -> None:
    """Try to move cameras that a conversation controls."""
    async with httpx2.AsyncClient(base_url=url, headers={"Scope-Client": "intruder"}, trust_env=False, timeout=30) as client:
        for camera in itertools.cycle(cameras):
            if await wait_for_end(ended, MOVE_EVERY_S):
                return
            if (await client.get(f"/cameras/{camera}/control")).json()["holder"] is None:
                continue  # its conversation has not begun
            status = (await client.post(f"/cameras/{camera}/move", json={"pan_deg": 90.0})).status_code
            observations.intruders[status] = observations.intruders.get(status, 0) + 1


async def wait_for_end(ended: asyncio.Event, seconds: float) -> bool:
    """Wait for a number of seconds or until ``ended`` is set, and return whether it is set."""
    with suppress(TimeoutError):
        await asyncio.wait_for(ended.wait(), seconds)
    return ended.is_set()
