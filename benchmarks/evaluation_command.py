"""Measure the time and memory of ``scope bench run --no-pictures`` with the built-in planner, relative to another checkout.

    python benchmarks/evaluation_command.py [--against FOLDER] [--split NAME] [--rounds N]

The two checkouts take turns, so that a busy machine slows both alike. Both run with this Python, which needs the dependencies of
both. The benchmark prints the medians of processor time and wall time, the largest memory, and the ratios. The first round is not
measured, because it compiles bytecode and fills caches.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from startup import Cost, cost, summary

HERE = Path(__file__).resolve().parents[1]


def evaluation(checkout: Path, split: str) -> Cost:
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
    given = parser.parse_args()
    checkouts = [HERE] if given.against is None else [given.against.resolve(), HERE]
    for checkout in checkouts:
        evaluation(checkout, "lite")
    rounds = [[evaluation(checkout, given.split) for checkout in checkouts] for _ in range(given.rounds)]
    found = [summary(list(costs)) for costs in zip(*rounds, strict=True)]
    for checkout, (cpu_s, wall_s, memory_mb) in zip(checkouts, found, strict=True):
        print(f"{cpu_s:7.1f} s processor {wall_s:7.1f} s wall {memory_mb:7.0f} MB   {checkout}")
    if given.against is not None:
        ratios = [new / old for old, new in zip(*found, strict=True)]
        print(f"{ratios[0]:7.2f} x processor {ratios[1]:7.2f} x wall {ratios[2]:7.2f} x memory")


if __name__ == "__main__":
    main()
