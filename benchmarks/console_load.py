"""Run the console under load: a browser, seven stream clients and three conversations on three cameras, on two processor cores.

    python benchmarks/console_load.py [--seconds 600] [--scene highway-works ...] [--no-browser] [--json FILE]

The console runs in a separate process. Four clients watch by WebSocket and three by Motion JPEG. Chromium shows the page and
clicks its stop button. Each conversation gives one instruction after another and follows the events of each run. Two more clients
interfere: one sends ``stop``, which any operator may do; the other tries to move cameras that a conversation controls, which must
always fail. At the end, the store must contain every run as the clients saw it.

The benchmark measures the frames per second of each viewer (target: at least 10), the time until ``stop`` is answered (target:
below 200 ms, or 100 ms for the button in the page), memory over time, and the sockets that are still open after all clients have
disconnected. On a busy machine, clients and server wait for processor time. The wake-up delay of a sleeping thread shows how long.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import sys
import tempfile
from pathlib import Path

from console_clients.console_process import read_scene, use_two_cores
from console_clients.load import Load
from console_clients.report import report

SCENES = ("highway-works", "high-street", "station-square")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=600.0, help="duration of the run in seconds (default: 600)")
    parser.add_argument("--scene", nargs=3, default=SCENES, help="three scenes to serve as cameras")
    parser.add_argument("--no-browser", action="store_true", help="run without Chromium")
    parser.add_argument("--json", type=Path, help="also write the results to this file")
    options = parser.parse_args()
    use_two_cores()
    for scene in options.scene:
        asyncio.run(read_scene(scene))
    with tempfile.TemporaryDirectory() as folder:
        results = Load(tuple(options.scene), Path(folder), with_browser=not options.no_browser).run(options.seconds)
    if options.json is not None:
        options.json.write_text(json.dumps(results, indent=1))
    report(results)
    return 0


if __name__ == "__main__":
    sys.exit(main())
