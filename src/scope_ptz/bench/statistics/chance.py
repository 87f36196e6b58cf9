"""Correct accuracy for chance: what remains after contrast pairs count whole and the level of constant answers is subtracted.

A contrast pair is two tasks of like wording. In one of them the thing in question is present, in the other it is absent
(``Task.pair``). An agent that always gives the same answer can pass one of the two, but not both. A task of a pair therefore
counts only if both tasks of the pair are correct (Gardner et al. 2020, "Evaluating Models' Local Decision Boundaries via Contrast
Sets": contrast consistency). Tasks without a pair, or whose twin was not run, count as they are.

The chance-corrected accuracy of a category k is (p_k - c_k) / (1 - c_k), where p_k is its pair-consistent accuracy and c_k that of
the best constant answer. This is Abbott's formula (Abbott 1925, "A Method of Computing the Effectiveness of an Insecticide"),
which Cohen's kappa also uses. It is 0 at chance level, 1 if everything is correct, and negative below chance. The chance-corrected
macro accuracy is its unweighted mean over the categories.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import fsum

import numpy as np

from scope_ptz.bench.statistics.clustered import IntervalEstimate, Scores, macro_weights, proportion

MAX_CHANCE = 0.999
"""Categories with a higher chance level are left out of chance-corrected accuracy, because they cannot exceed chance."""


@dataclass(frozen=True, slots=True)
class ConstantAgentScore:
    """The score of an agent that gives the same answer to every task.

    Attributes:
        answer: The constant answer.
        correct: Number of tasks that it passes.
        consistent: Number of tasks that it passes if a task of a pair counts only if both tasks of the pair pass.
        tasks: Number of tasks that expect an answer, a clarifying question or a refusal.
    """

    answer: str
    correct: int
    consistent: int
    tasks: int

    @property
    def share(self) -> float:
        """The fraction of the tasks that it passes."""
        return self.correct / self.tasks if self.tasks else 0.0

    @property
    def consistent_share(self) -> float:
        """The fraction of the tasks that it passes, with pairs counted whole."""
        return self.consistent / self.tasks if self.tasks else 0.0


@dataclass(frozen=True, slots=True)
class ChanceLevel:
    """What constant answers win on a set of tasks.

    Attributes:
        tasks: Number of tasks.
        without_calls: The best constant answer of an agent that makes no calls, by the checks.
        accepted: The most accepted constant reply, if only answers and outcomes were checked.
        looking: The best constant answer of an agent that moves as asked and looks once, by the checks.
        adaptive: The same agent with the best constant answer of each category.
        by_category: The largest pair-consistent fraction of the tasks of each category that a constant answer wins after moving as
            asked and looking once.
    """

    tasks: int
    without_calls: ConstantAgentScore
    accepted: ConstantAgentScore
    looking: ConstantAgentScore
    adaptive: ConstantAgentScore
    by_category: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class ChanceCorrected:
    """Accuracy beside its chance-corrected value. All values are macro averages over the categories.

    Attributes:
        consistent: Pair-consistent accuracy.
        chance: Mean of the chance levels of the categories.
        corrected: Chance-corrected accuracy.
    """

    consistent: IntervalEstimate
    chance: float
    corrected: IntervalEstimate


def whole_pairs(correct: Sequence[bool], units: Sequence[str], twins: Sequence[str | None]) -> list[bool]:
    """Return the outcomes with pairs counted whole.

    Args:
        correct: The outcomes of tasks or of trials of one repeat.
        units: The task of each outcome.
        twins: The other task of its pair; None without a pair.

    Returns:
        Each outcome, but False if the twin has an incorrect outcome. A twin without an outcome changes nothing.
    """
    by_unit = dict(zip(units, correct, strict=True))
    return [value and by_unit.get(twin, True) if twin is not None else value for value, twin in zip(correct, twins, strict=True)]


def chance_corrected(scores: Scores, by_category: Mapping[str, float]) -> ChanceCorrected | None:
    """Return the chance-corrected accuracy of pair-consistent outcomes.

    The estimate is a weighted sum of category means, so its interval is that of the weighted proportion, transformed linearly.

    Args:
        scores: The pair-consistent outcomes, with the category as stratum.
        by_category: The chance level of each category.

    Returns:
        None if there are no outcomes in categories whose chance level is known and at most ``MAX_CHANCE``.
    """
    kept = [i for i, name in enumerate(scores.strata) if by_category.get(str(name), 1.0) <= MAX_CHANCE]
    if not kept:
        return None
    units = scores.unit_of_each
    known = Scores(
        np.array([scores.values[i] for i in kept], dtype=np.float64),
        tuple(scores.strata[i] for i in kept),
        tuple(scores.clusters[i] for i in kept),
        tuple(units[i] for i in kept),
    )
    equal = macro_weights(known)
    unscaled = {name: weight / (1 - by_category[str(name)]) for name, weight in equal.items()}
    scale, offset = fsum(unscaled.values()), fsum(weight * by_category[str(name)] for name, weight in unscaled.items())
    consistent, weighted = proportion(known, equal), proportion(known, {name: w / scale for name, w in unscaled.items()})
    if consistent is None or weighted is None:
        return None
    chance = fsum(weight * by_category[str(name)] for name, weight in equal.items())

    def corrected(value: float) -> float:
        return scale * value - offset

    estimate = replace(
        weighted,
        value=corrected(weighted.value),
        low=None if weighted.low is None else corrected(weighted.low),
        high=None if weighted.high is None else corrected(weighted.high),
        se=None if weighted.se is None else scale * weighted.se,
    )
    return ChanceCorrected(consistent, chance, estimate)
