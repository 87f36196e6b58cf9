"""Correct accuracy for chance: require both tasks in a contrast pair to be correct, and subtract the score of constant answers.

A contrast pair is two tasks with similar wording (``Task.pair``). The thing in question is present in one task and absent in the
other. An agent that always gives the same answer can pass one of the two tasks, but not both. Therefore, a task in a pair counts
only if both tasks in the pair are correct (Gardner et al. 2020, "Evaluating Models' Local Decision Boundaries via Contrast
Sets": contrast consistency). Tasks without a pair, or whose twin was not run, are counted individually.

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
"""Categories with a higher chance level are excluded from chance-corrected accuracy, which divides by 1 minus the chance level."""


@dataclass(frozen=True, slots=True)
class ConstantAgentScore:
    """The score of an agent that gives the same answer to every task.

    Attributes:
        answer: The constant answer.
        correct: Number of tasks that it passes.
        consistent: Pair-consistent number of passed tasks: a task in a pair counts only if the agent passes both tasks in the pair.
        tasks: Number of tasks that expect an answer, a clarifying question or a refusal.
    """

    answer: str
    correct: int
    consistent: int
    tasks: int

    @property
    def share(self) -> float:
        """The fraction of tasks that the agent passes."""
        return self.correct / self.tasks if self.tasks else 0.0

    @property
    def consistent_share(self) -> float:
        """The pair-consistent fraction of tasks that the agent passes."""
        return self.consistent / self.tasks if self.tasks else 0.0


@dataclass(frozen=True, slots=True)
class ChanceLevel:
    """The scores of constant agents on a set of tasks.

    Attributes:
        tasks: Number of tasks.
        without_calls: The best score of an agent without calls, according to all checks.
        accepted: The best score according to the answer and outcome checks alone.
        looking: The best score of an agent that moves as instructed and observes once, according to all checks.
        adaptive: The score of the same agent with the best constant answer for each category.
        by_category: The best pair-consistent accuracy of the same agent in each category.
    """

    tasks: int
    without_calls: ConstantAgentScore
    accepted: ConstantAgentScore
    looking: ConstantAgentScore
    adaptive: ConstantAgentScore
    by_category: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class ChanceCorrected:
    """Pair-consistent and chance-corrected accuracy, as macro averages over the categories.

    Attributes:
        consistent: Pair-consistent accuracy.
        chance: Mean of the chance levels of the categories.
        corrected: Chance-corrected accuracy.
    """

    consistent: IntervalEstimate
    chance: float
    corrected: IntervalEstimate


def pair_consistent(correct: Sequence[bool], units: Sequence[str], twins: Sequence[str | None]) -> list[bool]:
    """Return pair-consistent outcomes: a task counts as correct only if both tasks in its pair are correct.

    Args:
        correct: The outcomes of tasks, or of the trials in one repeat.
        units: The task of each outcome.
        twins: The other task in the pair for each outcome; None for unpaired tasks.

    Returns:
        The outcomes, where an outcome is False if its twin is incorrect. A twin without an outcome has no effect.
    """
    by_unit = dict(zip(units, correct, strict=True))
    return [value and by_unit.get(twin, True) if twin is not None else value for value, twin in zip(correct, twins, strict=True)]


def chance_corrected(scores: Scores, by_category: Mapping[str, float]) -> ChanceCorrected | None:
    """Return the chance-corrected accuracy of pair-consistent outcomes.

    The estimate is a weighted sum of category means, so its interval is a linear transformation of the weighted proportion's
    interval.

    Args:
        scores: The pair-consistent outcomes, with the category as stratum.
        by_category: The chance level of each category.

    Returns:
        The accuracy; None without outcomes in categories whose chance level is known and does not exceed ``MAX_CHANCE``.
    """
    included = [i for i, name in enumerate(scores.strata) if by_category.get(str(name), 1.0) <= MAX_CHANCE]
    if not included:
        return None
    units = scores.unit_of_each
    known = Scores(
        np.array([scores.values[i] for i in included], dtype=np.float64),
        tuple(scores.strata[i] for i in included),
        tuple(scores.clusters[i] for i in included),
        tuple(units[i] for i in included),
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
