"""Measure the success of scripted policies on active search by the number of looks.

    python benchmarks/search_baselines.py [--episodes 200] [--scene highway-works ...]

Every policy searches for the same targets from the same starts. The output is the table of docs/gymnasium.md.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from statsmodels.stats.proportion import proportion_confint  # type: ignore[import-untyped]

from scope_ptz.gym import SearchEnv, SearchOutcome, search_score, success_within
from scope_ptz.gym.baselines import Greedy, RandomActions, RandomLooks, SearchPolicy, Sweep, run_search

BUDGETS = (1, 2, 4, 8, 16, 30)
SCENES = ("highway-works", "freight-yard", "station-square", "high-street")
RUNS: tuple[tuple[str, type[SearchPolicy], str], ...] = (
    ("random actions", RandomActions, "noisy"),
    ("random looks", RandomLooks, "noisy"),
    ("sweep", Sweep, "noisy"),
    ("greedy", Greedy, "noisy"),
    ("greedy", Greedy, "ground-truth"),
)


def main() -> int:
    """Run the searches and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--episodes", type=int, default=200, help="searches of each policy, spread over the scenes (default: 200)")
    parser.add_argument("--scene", action="append", help="scene to search in; repeatable (default: all four built-in scenes)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the first search (default: 0)")
    arguments = parser.parse_args()
    scenes = arguments.scene or SCENES
    print(f"| policy | perception | {' | '.join(f'≤ {b}' for b in BUDGETS)} | 95% interval | looks | score |")
    print("|---|---|" + "---:|" * (len(BUDGETS) + 3))
    for name, policy, perception in RUNS:
        outcomes = [
            outcome
            for number, scene in enumerate(scenes)
            for outcome in run_searches(scene, policy(), perception, range(number, arguments.episodes, len(scenes)), arguments.seed)
        ]
        print(table_row(name, perception, outcomes), flush=True)
    return 0


def run_searches(scene: str, policy: SearchPolicy, perception: str, numbers: Sequence[int], seed: int) -> list[SearchOutcome]:
    """Run searches in a scene. One scene is open at a time."""
    env = SearchEnv(scene, perception=perception, frames=False, max_looks=BUDGETS[-1])
    try:
        return [run_search(env, policy, seed + number) for number in numbers]
    finally:
        env.close()


def table_row(name: str, perception: str, outcomes: Sequence[SearchOutcome]) -> str:
    """Return a row: success within each budget, the interval of the last one, mean looks of successes, and the score."""
    shares = success_within(outcomes, BUDGETS)
    successes = [outcome.looks for outcome in outcomes if outcome.success]
    low, high = proportion_confint(len(successes), len(outcomes), method="wilson")
    looks = f"{sum(successes) / len(successes):.1f}" if successes else "-"
    score = sum(search_score(o.success, o.looks, BUDGETS[-1]) for o in outcomes) / len(outcomes)
    cells = [f"{share:.0%}" for share in shares]
    return f"| {name} | {perception} | {' | '.join(cells)} | {low:.0%} to {high:.0%} | {looks} | {score:.2f} |"


if __name__ == "__main__":
    sys.exit(main())
