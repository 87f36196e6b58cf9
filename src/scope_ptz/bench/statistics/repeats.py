"""Statistics for tasks that were run several times."""

from __future__ import annotations

from collections.abc import Iterable
from math import comb


def pass_all(runs: int, passed: int, k: int) -> float | None:
    """Return pass^k for one task: C(c, k) / C(n, k) if c of n runs passed (Yao et al. 2024).

    It is an unbiased estimate of the probability that all k runs pass.

    Args:
        runs: Number of runs.
        passed: Number of runs that passed.
        k: Number of runs that must all pass.

    Returns:
        The estimate, or None with fewer than k runs.

    Raises:
        ValueError: ``passed`` is not between 0 and ``runs``, or ``k`` is below 1.
    """
    if not 0 <= passed <= runs or k < 1:
        raise ValueError("passed must be between 0 and runs, and k must be at least 1")
    return comb(passed, k) / comb(runs, k) if k <= runs else None


def mean_pass_all(tasks: Iterable[tuple[int, int]], k: int) -> tuple[float | None, int]:
    """Return the mean pass^k over tasks, given as (runs, passed), and the number of tasks with at least k runs."""
    shares = [share for runs, passed in tasks if (share := pass_all(runs, passed, k)) is not None]
    return (sum(shares) / len(shares) if shares else None), len(shares)
