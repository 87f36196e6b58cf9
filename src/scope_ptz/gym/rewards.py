"""Rewards from the benchmark's checks. The reward is the sum of named terms."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import get_args

from scope_ptz.bench.scoring.checks import CheckName, CheckResult
from scope_ptz.bench.scoring.verdict import Verdict
from scope_ptz.errors import InputError, UnknownNameError

VERDICT = "verdict"
CHECKS: tuple[str, ...] = get_args(CheckName)
DEFAULT_WEIGHTS: Mapping[str, float] = {VERDICT: 1.0, **dict.fromkeys(CHECKS, 0.1)}
"""The default weight of each term. If only the verdict has a weight, the reward equals the benchmark's score."""


class CheckRewards:
    """The rewards for one episode.

    When a check begins to pass, its term is its weight; when it stops passing, its term is minus its weight. Over an episode, a
    check's terms therefore add up to partial credit that cannot be collected twice. At the end of a correct run, the term
    "verdict" is its weight.

    Args:
        weights: Weights that replace the defaults. Omitted terms keep their default weights.

    Raises:
        UnknownNameError: A term is neither a check nor "verdict".
        InputError: A weight is not finite.
    """

    def __init__(self, weights: Mapping[str, float] | None = None) -> None:
        for name, weight in (weights or {}).items():
            if name not in DEFAULT_WEIGHTS:
                raise UnknownNameError("reward term", name, DEFAULT_WEIGHTS)
            if not math.isfinite(weight):
                raise InputError(f"The weight of the reward term '{name}' must be a finite number; got {weight}.")
        self._weights = {**DEFAULT_WEIGHTS, **(weights or {})}
        self._passing = frozenset[str]()

    def begin(self, checks: Iterable[CheckResult]) -> None:
        """Begin an episode. Checks that pass before the first action earn nothing."""
        self._passing = _passed_checks(checks)

    def terms(self, checks: Iterable[CheckResult], verdict: Verdict | None = None) -> dict[str, float]:
        """Return the nonzero reward terms of a step.

        Args:
            checks: The results of the checks after the step.
            verdict: The verdict if the step ended the episode.
        """
        passing = _passed_checks(checks)
        terms = {name: self._weights[name] for name in CHECKS if name in passing - self._passing}
        terms |= {name: -self._weights[name] for name in CHECKS if name in self._passing - passing}
        self._passing = passing
        if verdict is not None and verdict.headline == "correct":
            terms[VERDICT] = self._weights[VERDICT]
        return {name: value for name, value in terms.items() if value}


def _passed_checks(checks: Iterable[CheckResult]) -> frozenset[str]:
    return frozenset(check.name for check in checks if check.passed)
