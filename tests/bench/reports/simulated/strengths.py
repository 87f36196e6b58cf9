"""The known strengths of the simulated pairs, from the paper's tables or chosen here."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from statistics import NormalDist, fmean

import numpy as np
from numpy.typing import NDArray

from scope_ptz.bench.reports.details.paper import PaperAccuracy, load_paper
from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES
from tests.bench.reports.simulated.items import Item, viewpoints_of

SLOPE = 1.0
"""Effect of an item's difficulty on the log odds of success."""
VIEWPOINT_EFFECT = 0.35
"""Effect of a viewpoint on the log odds of success of every pair: plus or minus this, with equal probability."""
PANORAMA_RATIO = 1.224
"""Perception time of a panorama relative to the current view."""
UNSCORED_SHARE = 0.01
"""Share of unsuccessful trials whose answer cannot be parsed."""
JUDGE_AGREEMENT = 0.93
"""Probability that a verdict of the judge agrees with the checks."""
JUDGE_UNPARSEABLE = 0.01
"""Share of trials on which the judge gives no verdict."""
LOST_SHARE = 0.004
"""Share of trials that infrastructure breaks."""
LOST_SHARE_OF_ONE_PAIR = 0.05
"""Share of trials that infrastructure breaks in the pair ``HIGH_LOSS``."""
HIGH_LOSS = ("qwen3-32b", "moondream3")
"""The pair with many trials lost to infrastructure."""
LOWEST, HIGHEST = 0.02, 0.985
"""Limits of success probabilities: no task always fails or always succeeds."""

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Pair:
    """A simulated pair.

    Attributes:
        planner: Name of the planner in the registry.
        perception: Name of the perception model in the registry, or "ground-truth".
        accuracy: Expected accuracy by category.
        perception_share: Share of failures that are failures of perception.
        planner_s: Median seconds of the planner per trial.
        perception_s: Median seconds of a perception call on the current view.
        tool_calls: Mean number of tool calls per trial.
        lost: Share of trials that infrastructure breaks.
        contended: Whether the latency is measured under contention.
    """

    planner: str
    perception: str
    accuracy: dict[str, float]
    perception_share: float
    planner_s: float
    perception_s: float
    tool_calls: float
    lost: float = LOST_SHARE
    contended: bool = False

    @property
    def label(self) -> str:
        """Label of the pair in a report."""
        return f"simulated-{self.planner} + {self.perception_name}"

    @property
    def perception_name(self) -> str:
        """Name of the perception model in run cards."""
        return self.perception if self.perception == "ground-truth" else f"simulated-{self.perception}"

    @cached_property
    def macro(self) -> float:
        """Expected macro accuracy."""
        return fmean(self.accuracy.values())

    def corrected(self, category: str) -> float:
        """Return the accuracy expected in a category if perception failures counted as correct. Unscored failures have no mode."""
        accuracy = self.accuracy[category]
        return accuracy + (1 - accuracy) * (1 - UNSCORED_SHARE) * self.perception_share

    def with_perfect_perception(self) -> Pair:
        """Return the same planner with ground-truth perception."""
        accuracy = {name: min(HIGHEST, self.corrected(name)) for name in self.accuracy}
        return Pair(self.planner, "ground-truth", accuracy, 0.0, self.planner_s, 0.002, self.tool_calls)


def paper_pairs() -> tuple[Pair, ...]:
    """Return the 19 pairs of the paper, with the accuracies and latencies of its tables."""
    paper = load_paper()
    latency = {row.name: row for row in paper.latency}
    return tuple(
        Pair(
            row.planner,
            row.eyes,
            {name: min(HIGHEST, max(LOWEST, row.category(name) / 100)) for name in CATEGORY_TITLES},
            perception_share(row),
            latency[row.planner].median_s,
            latency[row.eyes].median_s,
            latency[row.planner].tool_calls,
            LOST_SHARE_OF_ONE_PAIR if (row.planner, row.eyes) == HIGH_LOSS else LOST_SHARE,
            contended=row.eyes == "moondream3",
        )
        for row in paper.accuracy
    )


def perception_share(row: PaperAccuracy) -> float:
    """Return the share of failures that are perception failures: larger for larger planners, as in the paper."""
    return 0.35 if row.planner.startswith("qwen3-4b") else 0.5 if row.planner == "qwen3-32b" else 0.6


def success_probabilities(
    pair: Pair, items: tuple[Item, ...], effects: dict[str, float], population: Numbers | None = None
) -> Numbers:
    """Return the probability of success on each item, of shape ``(items,)``.

    The intercept of each category is chosen so that the mean probability, over its items and both values of a viewpoint's effect,
    is the known accuracy.

    Args:
        pair: The pair.
        items: The items.
        effects: The effect of each viewpoint.
        population: Difficulties over which the mean is the known accuracy (default: those of the items of each category).
    """
    probabilities = np.zeros(len(items))
    for category, accuracy in pair.accuracy.items():
        members = [n for n, item in enumerate(items) if item.facts.category == category]
        z = np.array([items[n].difficulty for n in members])
        shift = np.array([effects[f"{items[n].facts.scene}/{items[n].facts.viewpoint}"] for n in members])
        intercept = _intercept(z if population is None else population, accuracy)
        probabilities[members] = _expit(intercept - SLOPE * z + shift)
    return probabilities


def viewpoint_effects(items: tuple[Item, ...], seed: int) -> dict[str, float]:
    """Return the effect of each viewpoint in one replicate. It is the same for all pairs."""
    rng = np.random.default_rng([seed, 1])
    names = viewpoints_of(items)
    return dict(zip(names, rng.choice([-VIEWPOINT_EFFECT, VIEWPOINT_EFFECT], len(names)).tolist(), strict=True))


def normal_population() -> Numbers:
    """Return difficulties that represent the standard normal distribution."""
    return np.array([NormalDist().inv_cdf((n + 0.5) / 200) for n in range(200)])


def _intercept(z: Numbers, accuracy: float) -> float:
    low, high = -20.0, 20.0
    for _ in range(60):
        middle = (low + high) / 2
        mean = np.mean([_expit(middle - SLOPE * z + effect) for effect in (-VIEWPOINT_EFFECT, VIEWPOINT_EFFECT)])
        low, high = (middle, high) if mean < accuracy else (low, middle)
    return (low + high) / 2


def _expit(x: Numbers) -> Numbers:
    return 1 / (1 + np.exp(-x))
