"""Count the test instructions that the grammar planner plans correctly, answers with a question, or plans wrongly.

    python -m benchmarks.plan_correctness [--show VERDICT] [--lot NAME]

A wrong move is a plan that moves the camera otherwise than expected, or makes only the first part of the moves. A wrong look is a
plan with other counts or questions, and with the expected moves or none. Rows of the split ``held-out`` are counted separately and
never listed.
"""

from __future__ import annotations

import argparse
from collections import Counter

from tests.planner.lots import FILES, VERDICTS, planned, rows, verdict


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--show", choices=VERDICTS[1:], action="append", default=[], help="list instructions with this verdict")
    parser.add_argument("--lot", choices=FILES, help="count only this lot")
    options = parser.parse_args()
    print(f"{'lot':<24}{'rows':>6}" + "".join(f"{name:>14}" for name in VERDICTS))
    total: Counter[str] = Counter()
    shown: list[str] = []
    for lot in [options.lot] if options.lot else FILES:
        for split in ("dev", "held-out"):
            counts: Counter[str] = Counter()
            for row in rows(lot, split):
                plan = planned(row)
                name = verdict(row, plan)
                counts[name] += 1
                if name in options.show and split == "dev":
                    calls = "; ".join(f"{c.name}({c.arguments})" for c in plan.calls)
                    shown.append(f"[{name}] {row.instruction}\n    {plan.clarification or calls}")
            if counts:
                _print_counts(f"{lot} {split}", counts)
                total += counts
    _print_counts("all", total)
    print("\n".join(shown))


def _print_counts(label: str, counts: Counter[str]) -> None:
    size = sum(counts.values())
    print(f"{label:<24}{size:>6}" + "".join(f"{counts[name]:>6} {counts[name] / size:>6.1%} " for name in VERDICTS))


if __name__ == "__main__":
    main()
