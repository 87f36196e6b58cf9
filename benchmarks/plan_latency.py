"""How long the built-in planner takes for a step: median and 95th percentile over the test instructions.

Every instruction is planned cold (nothing cached from earlier ones but the compiled grammar), then once more as a later step
of the same run.
"""

from __future__ import annotations

import asyncio
import json
import statistics
import time
from pathlib import Path

from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.base import Briefing, State
from scope_ptz.planner.grammar import GrammarPlanner
from scope_ptz.planner.grammar.parsing.instruction_parser import parser

DATA = Path(__file__).parents[1] / "tests" / "data" / "instructions.jsonl"


async def measure() -> dict[str, list[float]]:
    """Milliseconds of first and of later steps."""
    planner = GrammarPlanner()
    times: dict[str, list[float]] = {"first step": [], "later step": []}
    for line in DATA.read_text(encoding="utf-8").splitlines():
        row = json.loads(line)
        briefing = Briefing(presets=tuple(row["presets"]), pose=Pose(), limits=Limits())
        state = State(instruction=row["instruction"], briefing=briefing)
        for kind in times:
            start = time.perf_counter()
            await planner.step(state)
            times[kind].append(1e3 * (time.perf_counter() - start))
    return times


def main() -> None:
    start = time.perf_counter()
    parser()
    print(f"compiling the grammar, once a process: {1e3 * (time.perf_counter() - start):.0f} ms")
    for kind, taken in asyncio.run(measure()).items():
        p95 = statistics.quantiles(taken, n=20)[-1]
        print(f"{kind}: median {statistics.median(taken):.2f} ms, p95 {p95:.2f} ms over {len(taken)} instructions")


if __name__ == "__main__":
    main()
