"""Measure how long it takes to list and filter many stored runs.

    python benchmarks/run_store.py [--runs N] [--folders M]

Most runs are rows that are written to the database directly. M additional run folders are used to measure the time of indexing.
The benchmark prints the median and the maximum of 20 repetitions of each query, as wall time and as a percentage of the target
(100 ms).
"""

from __future__ import annotations

import argparse
import json
import random
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from sqlalchemy import insert, select

from scope_ptz.store.indexing import index_runs
from scope_ptz.store.queries import count_matching, distinct_values, list_runs, load_run
from scope_ptz.store.rows import RunFilter
from scope_ptz.store.run_store import RunStore
from scope_ptz.store.schema import FEEDBACK, FRAMES, RUNS, STEPS

TARGET_S = 0.1
NOUNS = ("cones", "workers", "excavators", "vans", "trucks", "signs", "doors", "bollards", "pallets", "forklifts")
PLANNERS, PERCEPTIONS = ("grammar", "qwen3-4b", "gpt-oss-20b"), ("ground-truth", "moondream3", "qwen3-vl-8b")
CAMERAS = ("yard-gate", "highway-works", "harbour-east", "high-street")
OUTCOMES = ("answered",) * 8 + ("clarification", "cancelled", "planner_error", "unfinished")


def fill(store: RunStore, count: int, seed: int = 0) -> None:
    """Write ``count`` runs with three calls and four pictures each."""
    rng, start = random.Random(seed), 1_700_000_000.0
    for first in range(0, count, 5_000):
        runs, steps, frames, feedback = [], [], [], []
        for number in range(first + 1, min(first + 5_000, count) + 1):
            noun = rng.choice(NOUNS)
            runs.append(_run(number, noun, start + number * 60, rng))
            steps += [_step(number, position, noun) for position in range(3)]
            frames += [{"run": number, "name": f"frames/{n:03d}-view.jpg", "position": n} for n in range(4)]
            if rng.random() < 0.05:
                rating = rng.choice((-1, 1))
                feedback.append(
                    {"run": number, "position": None, "rating": rating, "comment": "", "actor": "anna", "created": start}
                )
        with store.database.write_transaction() as connection:
            for table, rows in ((RUNS, runs), (STEPS, steps), (FRAMES, frames), (FEEDBACK, feedback)):
                connection.execute(insert(table), rows)


def _run(number: int, noun: str, started: float, rng: random.Random) -> dict[str, object]:
    outcome, count = rng.choice(OUTCOMES), rng.randrange(20)
    return {
        "id": f"20260101T000000Z-count-the-{noun}-{number:06x}",
        "kind": "instruction",
        "conversation": f"c{number // 10}",
        "actor": "anna",
        "started": started,
        "ended": None if outcome == "unfinished" else started + 5,
        "instruction": f"Pan right {rng.randrange(90)} degrees, then count the {noun} near the gate and tell me their colour",
        "answer": f"I can see {count} {noun} in this view. (Source: the simulator's ground truth.)",
        "outcome": outcome,
        "planner": rng.choice(PLANNERS),
        "perception": rng.choice(PERCEPTIONS),
        "camera": rng.choice(CAMERAS),
        "scene": "highway-works",
        "simulated": 1,
        "version": "0.2.0",
        "steps": 3,
        "calls": 3,
        "failed_calls": 0,
        **dict.fromkeys(("total_s", "planner_s", "perception_s", "camera_s", "render_s"), 0.5),
        "input_tokens": 900,
        "output_tokens": 60,
        "kept": 0,
        "trace_bytes": 9_000,
        "folder_bytes": 400_000,
    }


def _step(run: int, position: int, noun: str) -> dict[str, object]:
    seconds = dict.fromkeys(("total_s", "perception_s", "camera_s", "render_s"), 0.2)
    tool = ("adjust_ptz", "count_objects", "query_answer")[position]
    text = {"arguments": json.dumps({"description": noun}), "message": f"I count 7 {noun}.", "fault": None}
    return {
        "run": run,
        "position": position,
        "step": position + 1,
        "tool": tool,
        "pan_deg": 1.0,
        "tilt_deg": 0.0,
        "zoom": 1.0,
        **text,
        **seconds,
    }


def measure(work: Callable[[], object], repetitions: int = 20) -> tuple[float, float]:
    """Return the median and the maximum wall time of a call in seconds."""
    times = []
    for _ in range(repetitions):
        began = time.perf_counter()
        work()
        times.append(time.perf_counter() - began)
    return statistics.median(times), max(times)


def main() -> None:
    """Fill a store and print the times of the queries."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=100_000, help="number of runs (default: 100000)")
    parser.add_argument("--folders", type=int, default=200, help="number of run folders to index (default: 200)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        root = Path(name)
        with RunStore(root / "many") as store:
            fill(store, options.runs)
            database = store.database
            with database.read_transaction() as connection:
                run_id = connection.execute(select(RUNS.c.id).limit(1).offset(options.runs // 2)).scalar_one()
            cursor = None
            for _ in range(3):
                cursor = store.runs(limit=500, after=cursor).next
            filters = {
                "newest page": RunFilter(),
                "one camera": RunFilter(camera="yard-gate"),
                "one pair": RunFilter(planner="qwen3-4b", perception="moondream3"),
                "failed": RunFilter(outcome="planner_error"),
                "good ratings": RunFilter(rating=1),
                "with a tool": RunFilter(tool="query_answer"),
                "a common word": RunFilter(text="gate"),
                "two words": RunFilter(text="excavators col"),
                "no match": RunFilter(text="zeppelin"),
                "word, camera, outcome, rating": RunFilter(text="cones", camera="yard-gate", outcome="answered", rating=-1),
            }
            work: dict[str, Callable[[], object]] = {}
            for title, chosen in filters.items():
                work[f"list: {title}"] = lambda chosen=chosen: list_runs(database, chosen)  # type: ignore[misc]
                work[f"count: {title}"] = lambda chosen=chosen: count_matching(database, chosen)  # type: ignore[misc]
            work["list: a later page"] = lambda: list_runs(database, RunFilter(), after=cursor)
            work["values for the menus"] = lambda: distinct_values(database)
            work["one run with its calls"] = lambda: load_run(database, run_id)
            size_mb = database.path.stat().st_size / 1e6
            print(f"{options.runs} runs, {size_mb:.0f} MB")
            slowest = 0.0
            for title, task in work.items():
                median_s, longest_s = measure(task)
                slowest = max(slowest, median_s)
                times = f"median {median_s * 1000:.1f} ms, longest {longest_s * 1000:.1f} ms"
                print(f"{title}: {times} ({median_s / TARGET_S:.0%} of the target)")
            print("All lists meet the target." if slowest < TARGET_S else "MISSED: not all lists meet the target.")
        if options.folders:
            measure_indexing(root / "folders", options.folders)


def measure_indexing(root: Path, count: int) -> None:
    """Print the time for indexing run folders, and for checking them again."""
    import shutil

    import scope_ptz

    with scope_ptz.open("highway-works", runs_dir=root) as scope:
        folder = scope.ask("count the cones, then pan right 20 degrees").folder
    assert folder is not None
    for number in range(count - 1):
        shutil.copytree(folder, root / f"{folder.name}-{number}")
    with RunStore(root) as store:
        began = time.perf_counter()
        report = index_runs(store.database, root)
        first_s = time.perf_counter() - began
        again_s, _ = measure(lambda: index_runs(store.database, root), 5)
    first, again = f"{first_s / count * 1000:.2f} ms", f"{again_s / count * 1000:.3f} ms"
    print(f"indexing {report.added} folders: {first} each; again, unchanged: {again} each")


if __name__ == "__main__":
    main()
