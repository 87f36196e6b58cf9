"""Measure the time of a planning step of the grammar planner over the test instructions and over generated long texts.

    python benchmarks/plan_latency.py [--limit N]

Each instruction is planned twice: as the first step of a run, and again as a later step. Long texts join random test
instructions, or repeat a word or an opening that could multiply the readings. The output states processor time in milliseconds, and
the median as a multiple of the time for parsing a JSON document on the same machine.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import random
import statistics
import sys
import time
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # for the test instructions

from tests.planner.lots import FILES, rows

from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.base import Briefing, State
from scope_ptz.planner.grammar import GrammarPlanner

REFERENCE = json.dumps([{"pan_deg": n, "tilt_deg": -n, "text": "turn right"} for n in range(500)])
LONG_TEXTS = 120
MAX_CHARS = 2000
PRESETS = ("gate", "yard")
JOINTS = (", then ", " and ", ". ", " if ", " until ", ", ", " or ")
REPEATED = (
    "if you see a car and ", "pan left 5 and ", "the man behind the van near the ", "until ", "if ", "a, ", "count ", "(", "not ",
    "zoom in on the ", "go to gate, ", "is there a car or ", "and then ", "1 ",
)  # fmt: skip


def test_instructions() -> list[tuple[str, tuple[str, ...]]]:
    """Return all test instructions with their presets."""
    return [(row.instruction, row.presets) for lot in FILES for row in rows(lot)]


def long_texts(instructions: Sequence[tuple[str, tuple[str, ...]]]) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield texts of up to ``MAX_CHARS`` characters."""
    for part in REPEATED:
        yield (part * MAX_CHARS)[:MAX_CHARS], PRESETS
    rng = random.Random(0)
    for _ in range(LONG_TEXTS):
        size, text = rng.choice((300, 500, 800, 1200, MAX_CHARS)), ""
        while len(text) < size:
            text += rng.choice(instructions)[0] + rng.choice(JOINTS)
        yield text[:size], PRESETS


async def measure(instructions: Sequence[tuple[str, tuple[str, ...]]], limit: int) -> dict[str, list[float]]:
    """Plan instructions and long texts, at most ``limit`` of each, and return the milliseconds by kind."""
    planner = GrammarPlanner()
    times: dict[str, list[float]] = {"first step": [], "later step": [], "long text": []}
    for is_long, texts in ((False, instructions), (True, long_texts(instructions))):
        for text, presets in islice(texts, limit):
            state = State(instruction=text, briefing=Briefing(presets=presets, pose=Pose(), limits=Limits()))
            for kind in ("long text",) if is_long else ("first step", "later step"):
                start = time.process_time()
                await planner.step(state)
                times[kind].append(1e3 * (time.process_time() - start))
    return times


def main() -> None:
    """Measure the planning times and print them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--limit", type=int, default=1_000_000, help="plan at most this many instructions (default: all)")
    references = []
    for _ in range(50):
        start = time.process_time()
        json.loads(REFERENCE)
        references.append(1e3 * (time.process_time() - start))
    reference_ms = statistics.median(references)
    print(f"reference: parsing {len(REFERENCE) / 1000:.0f} kB of JSON takes {reference_ms:.2f} ms of processor time")
    for kind, step_ms in asyncio.run(measure(test_instructions(), parser.parse_args().limit)).items():
        median, p99 = statistics.median(step_ms), statistics.quantiles(step_ms, n=100)[-1]
        print(
            f"{kind}: median {median:.1f} ms = {median / reference_ms:.1f} x reference, p99 {p99:.1f} ms, "
            f"slowest {max(step_ms):.1f} ms, {len(step_ms)} texts"
        )


if __name__ == "__main__":
    main()
