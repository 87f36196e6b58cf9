"""Measure the time and memory of ``scope bench run --no-pictures`` with the built-in planner, relative to another checkout.

    python benchmarks/evaluation_command.py [--against FOLDER] [--split NAME] [--rounds N]

The two checkouts are run in turn, so that other load on the machine slows both equally. Both run with this Python, which must have
the dependencies of both. The benchmark prints the medians of processor time and wall-clock time, the maximum memory, and the
ratios. A first run on the split lite is not measured, because it compiles bytecode and fills caches.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from startup import Cost, cost, summary

THIS_CHECKOUT = Path(__file__).resolve().parents[1]


def run_evaluation(checkout: Path, split: str) -> Cost:
    """Run an evaluation with the code of a checkout and return its cost."""
    with tempfile.TemporaryDirectory() as folder:
        options = ["--split", split, "--no-pictures", "--out", folder]
        program = [sys.executable, "-m", "scope_ptz.cli", "bench", "run", *options]
        return cost(["env", f"PYTHONPATH={checkout / 'src'}", *program], folder)


def main() -> None:
    """Run the evaluations and print their costs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--against", type=Path, metavar="FOLDER", help="checkout to compare with, for example a git worktree")
    parser.add_argument("--split", default="core", help="split of the dataset (default: core)")
    parser.add_argument("--rounds", type=int, default=3, help="number of runs in each checkout (default: 3)")
    arguments = parser.parse_args()
    checkouts = [THIS_CHECKOUT] if arguments.against is None else [arguments.against.resolve(), THIS_CHECKOUT]
    for checkout in checkouts:
        run_evaluation(checkout, "lite")
    rounds = [[run_evaluation(checkout, arguments.split) for checkout in checkouts] for _ in range(arguments.rounds)]
    summaries = [summary(list(costs)) for costs in zip(*rounds, strict=True)]
    for checkout, (cpu_s, wall_s, memory_mb) in zip(checkouts, summaries, strict=True):
        print(f"{cpu_s:7.1f} s processor {wall_s:7.1f} s wall-clock {memory_mb:7.0f} MB   {checkout}")
    if arguments.against is not None:
        ratios = [new / old for old, new in zip(*summaries, strict=True)]
        print(f"{ratios[0]:7.2f} x processor {ratios[1]:7.2f} x wall-clock {ratios[2]:7.2f} x memory")


if __name__ == "__main__":
    main()
