"""What repeats of a task tell."""

from __future__ import annotations

from collections.abc import Iterable
from math import comb


def pass_all(runs: int, passed: int, k: int) -> float | None:
    """pass^k of one task: the share of the ways to choose k of its runs in which all passed, C(c, k) / C(n, k) (Yao et al. 2024).

    Unbiased for the probability that k further runs all pass. None with fewer than k runs.
    """
    if not 0 <= passed <= runs or k < 1:
        raise ValueError("passed lies between 0 and runs, and k is 1 or more")
    return comb(passed, k) / comb(runs, k) if k <= runs else None


def mean_pass_all(tasks: Iterable[tuple[int, int]], k: int) -> tuple[float | None, int]:
    """pass^k averaged over tasks given as (runs, passed), and how many tasks had k runs or more."""
    shares = [share for runs, passed in tasks if (share := pass_all(runs, passed, k)) is not None]
    return (sum(shares) / len(shares) if shares else None), len(shares)
