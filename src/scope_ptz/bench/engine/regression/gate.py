"""A regression gate for continuous integration, which compares an evaluation with an earlier one task by task."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import fmean

from scope_ptz.bench.judging.judgement_tally import lacks_verdict
from scope_ptz.bench.scoring.trials import Evaluation, Trial
from scope_ptz.bench.statistics.paired import holm, mcnemar_exact
from scope_ptz.errors import InputError

ALL_TASKS = "all"
"""Name of the group of all tasks."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """The paired outcomes of a group of tasks in two evaluations.

    Attributes:
        group: A category, or "all".
        tasks: Number of tasks.
        before: Fraction of correct runs in the earlier evaluation.
        now: Fraction of correct runs in the new evaluation.
        worse: Ids of the tasks that are correct less often than before.
        better: Ids of the tasks that are correct more often than before.
        p: Two-sided p value of McNemar's exact test or, with repeats, of the sign test. For categories, it is adjusted for multiple
            tests with Holm's method.
    """

    group: str
    tasks: int
    before: float
    now: float
    worse: tuple[str, ...]
    better: tuple[str, ...]
    p: float

    def regressed(self, alpha: float) -> bool:
        """Return whether the fraction of correct runs fell significantly at level ``alpha``."""
        return self.now < self.before and self.p < alpha


@dataclass(frozen=True, slots=True)
class GateResult:
    """The result of a regression gate.

    Attributes:
        overall: The comparison over all tasks.
        categories: The comparisons by category.
        unscored_tasks: Ids of the tasks without a scored run in one of the evaluations, because of infrastructure failures or
            missing verdicts of judges.
        alpha: Significance level.
    """

    overall: Comparison
    categories: tuple[Comparison, ...]
    unscored_tasks: tuple[str, ...]
    alpha: float

    @property
    def regressions(self) -> tuple[Comparison, ...]:
        """The comparisons of the task groups that became significantly worse."""
        return tuple(c for c in (self.overall, *self.categories) if c.regressed(self.alpha))

    @property
    def passed(self) -> bool:
        """Whether no task group became significantly worse."""
        return not self.regressions


def compare_evaluations(evaluation: Evaluation, baseline: Evaluation, alpha: float = 0.05) -> GateResult:
    """Compare two evaluations of the same tasks.

    Args:
        evaluation: The new evaluation.
        baseline: The earlier evaluation.
        alpha: Significance level.

    Raises:
        InputError: The evaluations cannot be compared.
    """
    for name, log in (("log", evaluation), ("baseline", baseline)):
        if not log.finished:
            raise InputError(f"The {name} {log.log} has {len(log.trials)} of {log.wanted} runs. Finish the evaluation first.")
    if (evaluation.card.dataset, evaluation.card.dataset_digest) != (baseline.card.dataset, baseline.card.dataset_digest):
        raise InputError(
            f"The logs contain different tasks ({_tasks(evaluation)}; baseline {_tasks(baseline)}), so they cannot be compared. "
            "Run both on the same split of the same dataset."
        )
    before, now = _correct_fractions(baseline.trials), _correct_fractions(evaluation.trials)
    both = sorted(before.keys() & now.keys())
    if not both:
        raise InputError(
            "The logs cannot be compared, because no task is scored in both: infrastructure broke the runs, or no judge gave a "
            "verdict on them. Run the evaluations again, or judge them with 'scope bench rescore'."
        )
    categories = {trial.task.id: trial.task.category for trial in baseline.trials}
    groups = {name: [task for task in both if categories[task] == name] for name in dict.fromkeys(categories.values())}
    comparisons = [_compare(name, tasks, before, now) for name, tasks in groups.items() if tasks]
    adjusted = holm([comparison.p for comparison in comparisons])
    by_category = tuple(
        replace(comparison, p=p if p is not None else 1.0) for comparison, p in zip(comparisons, adjusted, strict=True)
    )
    unscored_tasks = sorted({t.task.id for t in (*baseline.trials, *evaluation.trials)} - set(both))
    return GateResult(_compare(ALL_TASKS, both, before, now), by_category, tuple(unscored_tasks), alpha)


def _tasks(evaluation: Evaluation) -> str:
    card = evaluation.card
    return f"{card.dataset} {card.split}, digest {card.dataset_digest}"


def _correct_fractions(trials: Sequence[Trial]) -> dict[str, float]:
    """Return the fraction of correct runs of each task. Runs with infrastructure failures or missing verdicts are excluded."""
    runs: dict[str, list[bool]] = {}
    for trial in trials:
        if trial.headline != "infrastructure" and not lacks_verdict(trial):
            runs.setdefault(trial.task.id, []).append(trial.headline == "correct")
    return {task: fmean(correct) for task, correct in runs.items()}


def _compare(group: str, tasks: Sequence[str], before: Mapping[str, float], now: Mapping[str, float]) -> Comparison:
    worse = tuple(task for task in tasks if now[task] < before[task])
    better = tuple(task for task in tasks if now[task] > before[task])
    return Comparison(
        group, len(tasks), fmean(before[t] for t in tasks), fmean(now[t] for t in tasks), worse, better,
        mcnemar_exact(len(worse), len(better)),
    )  # fmt: skip
