"""Measure the live view in Chromium: frames per second and the time from exposure to canvas, idle and during instructions.

Also measure how long the stop button takes during instructions.

    python benchmarks/console_latency.py [--seconds 20] [--scene highway-works] [--json FILE]

The console runs in a separate process. In the second part, a client gives one instruction after another. The exposure of a
simulated camera is the moment at which its pose and time are read, so rendering is part of the latency. The targets are 20 frames
per second, a latency of 150 ms at the 95th percentile, and 100 ms for the stop button.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import httpx2

from console_clients.console_process import Console
from console_clients.conversations import INSTRUCTIONS
from console_clients.figures import WakeUpDelays, in_ms, quantiles
from console_clients.page import Clicks, chromium, open_page, read_page
from console_clients.report import report_clicks
from console_clients.viewers import Viewer

if TYPE_CHECKING:
    from playwright.sync_api import Page

TARGET_FRAMES_PER_S, TARGET_AGE_S = 20.0, 0.15
STOPS, STOP_EVERY_S = 30, 0.7
SETTLE_S = 8.0  # time for the page, the server and the scene to start


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=20.0, help="duration of each part in seconds (default: 20)")
    parser.add_argument("--scene", default="highway-works", help="scene to show (default: highway-works)")
    parser.add_argument("--json", type=Path, help="also write the results to this file")
    options = parser.parse_args()
    delays = WakeUpDelays()
    with tempfile.TemporaryDirectory() as folder:
        console = Console((options.scene,), Path(folder) / "runs")
        try:
            with chromium() as browser:
                page = open_page(browser, console, options.scene)
                page.wait_for_timeout(SETTLE_S * 1000)
                results = {"idle": watch(page, console, options.seconds)}
                ended = threading.Event()
                agent = threading.Thread(target=give_instructions, args=(console.url, options.scene, ended))
                agent.start()
                results["while the agent works"] = watch(page, console, options.seconds)
                stops = stop_often(page)
                ended.set()
                agent.join()
        finally:
            console.end()
    results["stop"] = stops
    results["machine"] = {"lateness_s": quantiles(delays.end()), "load": [round(each, 1) for each in os.getloadavg()]}
    if options.json is not None:
        options.json.write_text(json.dumps(results, indent=1))
    for name in ("idle", "while the agent works"):
        report(name, results[name])
    report_clicks(results["stop"])
    print(f"Wake-up delay of a sleeping thread: {in_ms(results['machine']['lateness_s'])}; load: {results['machine']['load']}")
    return 0


def give_instructions(url: str, camera: str, ended: threading.Event) -> None:
    """Give one instruction after another until ``ended`` is set."""
    with httpx2.Client(base_url=url, trust_env=False, timeout=120) as client:
        for instruction in itertools.cycle(INSTRUCTIONS):
            if ended.is_set():
                return
            reply = client.post("/ask", json={"camera": camera, "instruction": instruction})
            if reply.status_code == 429:  # runs that are stopped early follow each other too quickly
                time.sleep(1.0)
            elif reply.status_code != 409:  # 409: it was stopped before its first step
                reply.raise_for_status()


def watch(page: Page, console: Console, seconds: float) -> dict[str, Any]:
    """Observe the page for a number of seconds, and return statistics of the frames that it drew."""
    read_page(page)
    before, began_s = console.sample(), time.monotonic()
    page.wait_for_timeout(seconds * 1000)
    drawn, after, took_s = read_page(page)["drawn"], console.sample(), time.monotonic() - began_s
    gaps = [b[0] - a[0] for a, b in itertools.pairwise(drawn)]
    return {
        "frames_per_s": len(drawn) / took_s,
        "age_s": quantiles([age for _, age, _ in drawn]),
        "gap_s": quantiles(gaps),
        "cores_used": (after["cpu_s"] - before["cpu_s"]) / took_s,
        "processor_s_per_frame": (after["cpu_s"] - before["cpu_s"]) / len(drawn),
    }


def stop_often(page: Page) -> dict[str, Any]:
    """Click the stop button repeatedly, and return statistics of the clicks."""
    clicks, viewer = Clicks(), Viewer("the page")
    for _ in range(STOPS):
        clicks.stop(page)
        page.wait_for_timeout(STOP_EVERY_S * 1000)
        clicks.read(page, viewer)
    return clicks.results()


def report(name: str, figures: dict[str, Any]) -> None:
    """Print the statistics of one part."""
    rate, age = figures["frames_per_s"], figures["age_s"]
    print(f"{name}: {rate:.1f} frames/s ({rate / TARGET_FRAMES_PER_S:.2f} times the target of {TARGET_FRAMES_PER_S:g})")
    print(f"  from exposure to canvas: {in_ms(age)} (95th percentile: {age['p95'] / TARGET_AGE_S:.2f} times the target)")
    print(f"  between frames: {in_ms(figures['gap_s'])}")
    print(
        f"  server: {figures['cores_used']:.2f} cores, {1000 * figures['processor_s_per_frame']:.1f} ms of processor time per frame"
    )


if __name__ == "__main__":
    sys.exit(main())
