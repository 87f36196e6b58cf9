"""Measure the time of a planning step of the grammar planner: median and 95th percentile over the test instructions.

    python benchmarks/plan_latency.py [--limit N]

Each instruction is planned twice: as the first step of a run, and again as a later step. Times are relative to the time for parsing
a JSON document on the same machine, because absolute times on a shared machine are not comparable.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import statistics
import time
from pathlib import Path

from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.base import Briefing, State
from scope_ptz.planner.grammar import GrammarPlanner

DATA = Path(__file__).parents[1] / "tests" / "data" / "instructions.jsonl"
REFERENCE = json.dumps([{"pan_deg": n, "tilt_deg": -n, "text": "turn right"} for n in range(500)])


async def measure(limit: int) -> dict[str, list[float]]:
    """Plan up to ``limit`` instructions and return the milliseconds of first steps, later steps and the reference."""
    planner = GrammarPlanner()
    times: dict[str, list[float]] = {"first step": [], "later step": [], "reference": []}
    for line in DATA.read_text(encoding="utf-8").splitlines()[:limit]:
        row = json.loads(line)
        briefing = Briefing(presets=tuple(row["presets"]), pose=Pose(), limits=Limits())
        state = State(instruction=row["instruction"], briefing=briefing)
        for kind in ("first step", "later step"):
            start = time.perf_counter()
            await planner.step(state)
            times[kind].append(1e3 * (time.perf_counter() - start))
        start = time.perf_counter()
        json.loads(REFERENCE)
        times["reference"].append(1e3 * (time.perf_counter() - start))
    return times


def main() -> None:
    """Measure the planning times and print their ratios to the reference."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--limit", type=int, default=1_000_000, help="plan at most this many instructions (default: all)")
    times = asyncio.run(measure(parser.parse_args().limit))
    reference = statistics.median(times.pop("reference"))
    print(f"reference: parsing {len(REFERENCE) / 1000:.0f} kB of JSON takes {reference:.2f} ms")
    for kind, step_ms in times.items():
        median, p95 = statistics.median(step_ms), statistics.quantiles(step_ms, n=20)[-1]
        print(f"{kind}: median {median / reference:.1f} x reference, p95 {p95 / reference:.1f} x, {len(step_ms)} instructions")


if __name__ == "__main__":
    main()
