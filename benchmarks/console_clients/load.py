"""A run of the load benchmark, with the server and all clients at the same time."""

from __future__ import annotations

import asyncio
import os
import statistics
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import httpx2
from websockets.exceptions import ConnectionClosed

from console_clients.console_process import Console
from console_clients.conversations import Observations, converse, intrude, stop_often
from console_clients.figures import WakeUpDelays, quantiles
from console_clients.page import Clicks, chromium, open_page
from console_clients.viewers import Viewer, watch_mjpeg, watch_socket

if TYPE_CHECKING:
    from playwright.sync_api import Page

VIEWERS = (("socket", 0), ("socket", 1), ("socket", 2), ("socket", 0), ("mjpeg", 0), ("mjpeg", 1), ("mjpeg", 2))
"""Type of each stream client, and the index of its camera."""

SAMPLE_S = 2.0  # time between two samples of the server's resources
START_S = 15.0
"""Seconds at the start of the run that are not counted, because the server reads scenes and Chromium starts."""

CLOSE_S = 20.0  # maximum time until connections of disconnected clients are closed


class Load:
    """A run of the benchmark: the server, its clients, and the results.

    Args:
        cameras: The names of the three cameras.
        folder: An empty folder for the runs folder.
        with_browser: Whether to run Chromium.
    """

    def __init__(self, cameras: tuple[str, ...], folder: Path, *, with_browser: bool) -> None:
        self._cameras, self._folder, self._with_browser = cameras, folder, with_browser
        self._viewers = [Viewer(f"{kind} {k + 1}: {cameras[number]}") for k, (kind, number) in enumerate(VIEWERS)]
        self._browser = Viewer(f"Chromium: {cameras[0]}")
        self._clicks = Clicks()
        self._observations = Observations()
        self._samples: list[tuple[float, dict[str, float]]] = []

    def run(self, seconds: float) -> dict[str, Any]:
        """Run the clients for a number of seconds and return the results."""
        console = Console(self._cameras, self._folder / "runs")
        try:
            before, delays, start_s = console.sample(), WakeUpDelays(), time.time()
            self._run_clients(console, start_s + seconds)
            end_s, delays_s = time.time(), delays.end()
            left_over = {"sockets": leaked_sockets(console, before["sockets"])}
            stored = self._compare_with_store(console)
        finally:
            code = console.end()
        counted_s = start_s + min(START_S, seconds / 3)
        figures = self._figures(counted_s, end_s)
        return {**figures, "pauses_s": quantiles(delays_s), "exit_code": code, **stored, "left_over": left_over}

    def _run_clients(self, console: Console, end_s: float) -> None:
        loop, ended = asyncio.new_event_loop(), asyncio.Event()
        clients = threading.Thread(target=lambda: loop.run_until_complete(self._clients(console, ended)), daemon=True)
        clients.start()
        try:
            if self._with_browser:
                with chromium() as browser:
                    self._wait(console, end_s, open_page(browser, console, self._cameras[0]))
            else:
                self._wait(console, end_s, None)
        finally:
            loop.call_soon_threadsafe(ended.set)
            clients.join(120)
        if clients.is_alive():
            self._observations.problems.append("Some clients did not end within 120 s.")

    async def _clients(self, console: Console, ended: asyncio.Event) -> None:
        url, cameras, observations = console.url, self._cameras, self._observations
        work = [converse(observations, url, camera, ended) for camera in cameras]
        work += [stop_often(observations, url, cameras, ended), intrude(observations, url, cameras, ended)]
        for viewer, (kind, number) in zip(self._viewers, VIEWERS, strict=True):
            watch = watch_socket if kind == "socket" else watch_mjpeg
            work.append(self._run_viewer(viewer, watch(viewer, f"{url}/cameras/{cameras[number]}", ended)))
        for failure in await asyncio.gather(*work, return_exceptions=True):
            if isinstance(failure, BaseException):
                observations.problems.append(f"{type(failure).__name__}: {failure}")

    async def _run_viewer(self, viewer: Viewer, work: Any) -> None:
        try:
            await work
        except (OSError, httpx2.HTTPError, ConnectionClosed, TimeoutError) as error:
            viewer.failure = f"{type(error).__name__}: {error}"

    def _wait(self, console: Console, end_s: float, page: Page | None) -> None:
        first_s = time.time()
        while time.time() < end_s:
            self._samples.append((time.time(), console.sample()))
            if len(self._samples) % 15 == 1:
                print(progress(time.time() - first_s, self._samples[-1][1]), flush=True)
            if page is None:
                time.sleep(SAMPLE_S)
                continue
            page.wait_for_timeout(SAMPLE_S * 1000)
            self._clicks.stop(page)
            self._clicks.read(page, self._browser)

    def _compare_with_store(self, console: Console) -> dict[str, Any]:
        """Compare the stored runs with the observations of the clients, and record differences as problems."""
        outcomes: dict[str, int] = {}
        with httpx2.Client(base_url=console.url, trust_env=False, timeout=60) as client:
            for run, (calls, outcome) in self._observations.runs.items():
                while (reply := client.get(f"/runs/{run}/details")).status_code == 429:  # hundreds of runs exceed the rate limit
                    time.sleep(max(0.5, float(reply.headers.get("Retry-After", 1.0))))
                stored = reply.raise_for_status().json()
                if (stored["run"]["outcome"], len(stored["steps"])) != (outcome, calls):
                    self._observations.problems.append(f"{run}: {outcome}, {calls} calls seen; stored: {stored['run']}")
                outcomes[outcome] = outcomes.get(outcome, 0) + 1
        return {"runs": outcomes, "problems": self._observations.problems, "intruders": self._observations.intruders}

    def _figures(self, counted_s: float, end_s: float) -> dict[str, Any]:
        viewers = [*self._viewers, *([self._browser] if self._with_browser else [])]
        counted = [(at, figures) for at, figures in self._samples if at >= counted_s] or self._samples[-1:]
        memory = [figures["anonymous_mb"] for _, figures in counted]  # other memory is mapped files, which the kernel can drop
        third = max(1, len(memory) // 3)
        at_start = [took_s for sent_s, took_s in self._observations.stops if sent_s < counted_s]
        (first_s, first), (last_s, last) = counted[0], counted[-1]
        return {
            "counted_seconds": end_s - counted_s,
            "viewers": {each.name: each.results(counted_s, end_s) for each in viewers},
            "stop_s": quantiles([took_s for sent_s, took_s in self._observations.stops if sent_s >= counted_s]),
            "stop_at_start_s": quantiles(at_start) if at_start else None,
            "button": self._clicks.results() if self._with_browser else None,
            "memory_mb": {
                "start": statistics.median(memory[:third]),
                "end": statistics.median(memory[-third:]),
                "most": max(memory),
                "with_files": last["memory_mb"],
            },
            "memory_growth": statistics.median(memory[-third:]) / statistics.median(memory[:third]),
            "threads": {"start": first["threads"], "most": max(each["threads"] for _, each in counted)},
            "cores_used": (last["cpu_s"] - first["cpu_s"]) / max(1e-9, last_s - first_s),
            "load": [round(each, 1) for each in os.getloadavg()],
        }


def progress(elapsed_s: float, figures: dict[str, float]) -> str:
    """Return a line about the server's resources."""
    memory = f"memory {figures['memory_mb']:.0f} MB, of which {figures['anonymous_mb']:.0f} anonymous"
    return f"{elapsed_s:5.0f} s  {memory}  {figures['threads']:.0f} threads  {figures['sockets']:.0f} sockets"


def leaked_sockets(console: Console, before: float) -> float:
    """Return the number of sockets beyond ``before`` that the server has not closed within ``CLOSE_S``."""
    deadline_s = time.monotonic() + CLOSE_S
    while (leaked := console.sample()["sockets"] - before) > 0 and time.monotonic() < deadline_s:
        time.sleep(0.2)
    return leaked
