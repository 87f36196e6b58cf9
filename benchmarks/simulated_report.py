"""Write a full report of simulated runs: the paper's 19 pairs with known strengths. No model is run.

    python benchmarks/simulated_report.py OUT [--seed 0] [--pages]

OUT/logs contains the simulated evaluations, and OUT/report the report that ``scope bench report`` generates from them. Success
probabilities by category and latencies are those of the paper's tables. The output states how many of the 95% intervals contain the
known value.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # The generator is in the tests.

from tests.bench.reports.simulated.recovery import interval_coverage
from tests.bench.reports.simulated.runs import full_sweep, store

from scope_ptz.bench.human_runs import read_result
from scope_ptz.bench.reports.terminal import terminal_lines
from scope_ptz.bench.reports.writer import write_report
from scope_ptz.bench.tasks.splits import load_split
from scope_ptz.registry import load_registry


def main() -> int:
    """Draw the runs, write the report, and print its summary and how well it recovers the known strengths."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="folder to write")
    parser.add_argument("--seed", type=int, default=0, help="seed of all draws (default: 0)")
    parser.add_argument("--pages", action="store_true", help="write a page for each failed task")
    arguments = parser.parse_args()
    paths = store(full_sweep(arguments.seed), arguments.out / "logs")
    report = write_report(
        [read_result(path) for path in paths],
        load_registry(),
        arguments.out / "report",
        tasks={task.id: task for task in load_split("core")},
        pages=arguments.pages,
    )
    print("\n".join(terminal_lines(report)))
    for quantity, (inside, total) in interval_coverage(report).items():
        print(f"{quantity}: {inside} of {total} intervals contain the known value")
    print(arguments.out / "report" / "index.html")
    return 0


if __name__ == "__main__":
    sys.exit(main())
