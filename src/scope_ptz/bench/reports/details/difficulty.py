"""The section on difficulty: a check that harder classes are solved less often, and classes from item statistics."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import fmean
from typing import Literal

from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES, ReportRun, scores_of
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, ReportTable
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.bench.statistics.clustered import IntervalEstimate, proportion, proportion_difference, two_sided_p
from scope_ptz.bench.statistics.paired import holm

DifficultyClass = Literal["easy", "medium", "hard"]
CLASSES: tuple[DifficultyClass, ...] = ("easy", "medium", "hard")
"""The difficulty classes, from easy to hard."""
ALPHA = 0.05
"""Significance level for differences between classes."""
MIN_PAIRS = 8
"""Minimum number of model pairs for item statistics. With 8 pairs, the standard error of a share is at most 0.18."""
EASY_FROM, MEDIUM_FROM = 2 / 3, 1 / 3
"""Thresholds for classes by item statistics: the minimum share of correct trials for easy tasks and for medium tasks."""


@dataclass(frozen=True, slots=True)
class ClassStep:
    """The comparison of two neighbouring difficulty classes within a category.

    Attributes:
        category: The category.
        easier: The easier class.
        harder: The harder class.
        drop: Accuracy on the easier class minus accuracy on the harder class.
        p_adjusted: P value of the difference, adjusted for all steps with Holm's method; None if unknown.
    """

    category: str
    easier: DifficultyClass
    harder: DifficultyClass
    drop: IntervalEstimate
    p_adjusted: float | None

    @property
    def is_contradiction(self) -> bool:
        """Whether the harder class is solved significantly more often."""
        return self.drop.value < 0 and self.p_adjusted is not None and self.p_adjusted < ALPHA


def compare_classes(runs: Sequence[ReportRun]) -> tuple[ClassStep, ...]:
    """Compare the accuracies of neighbouring difficulty classes within each category.

    The trials of all runs are pooled. All trials of a task count as one observation, and tasks are clustered by viewpoint.
    """
    by_class = _by_class(runs)
    comparisons: list[tuple[str, DifficultyClass, DifficultyClass, IntervalEstimate]] = []
    for category in CATEGORY_TITLES:
        present = [name for name in CLASSES if by_class[category, name]]
        for easier, harder in pairwise(present):
            easier_scores, harder_scores = (scores_of(by_class[category, name]) for name in (easier, harder))
            if (drop := proportion_difference(easier_scores, harder_scores)) is not None:
                comparisons.append((category, easier, harder, drop))
    # Without an interval, the variance of one of the classes is unknown, for example because it has only one task.
    adjusted = holm([two_sided_p(drop) if drop.low is not None else None for *_, drop in comparisons])
    return tuple(ClassStep(*step, p) for step, p in zip(comparisons, adjusted, strict=True))


def item_shares(runs: Sequence[ReportRun]) -> dict[str, float]:
    """Return the share of correct trials of each task, by task id. All runs have the same weight, regardless of repeats."""
    by_task: dict[str, list[float]] = defaultdict(list)
    for run in runs:
        own: dict[str, list[bool]] = defaultdict(list)
        for trial in run.scored_trials:
            own[trial.task.id].append(trial.headline == "correct")
        for task, values in own.items():
            by_task[task].append(fmean(values))
    return {task: fmean(values) for task, values in by_task.items()}


def item_class(share: float) -> DifficultyClass:
    """Return the difficulty class for a share of correct trials."""
    return "easy" if share >= EASY_FROM else "medium" if share >= MEDIUM_FROM else "hard"


def difficulty_section(runs: Sequence[ReportRun]) -> Section | None:
    """Return the section that checks the difficulty classes of the tasks; None without model pairs.

    Args:
        runs: The runs of model pairs on the same tasks.
    """
    if not runs:
        return None
    steps = compare_classes(runs)
    tables = [_class_table(runs, steps)]
    text = [
        "Each task has a class of difficulty, which a rule computes from the task: more calls, more objects to distinguish, and a "
        "sweep make a task harder. This section checks the rule against the outcomes: within a category, a harder class must not "
        "be solved more often. The trials of all pairs are pooled, and all trials of a task count as one observation. P values are "
        "adjusted for the number of steps by Holm's method.",
        verdict_text(steps),
    ]
    if len(runs) >= MIN_PAIRS:
        tables += [_cross_table(runs), _item_table(runs)]
        text.append(
            f"There are {len(runs)} pairs, so tasks also have classes by item statistics: easy if at least two thirds of the "
            "trials are correct, medium if at least one third, otherwise hard. Where the two classes differ, the class by item "
            "statistics describes these pairs better. The stored class of a task does not change."
        )
    else:
        text.append(f"Classes by item statistics need at least {MIN_PAIRS} pairs on the same tasks. There are {len(runs)}.")
    return Section("difficulty", "Difficulty of the tasks", tuple(text), (), tuple(tables), frozenset({"items"}))


def verdict_text(steps: Sequence[ClassStep]) -> str:
    """Return sentences that state whether the accuracy falls from each class to the next."""
    if not steps:
        return "No category has tasks of two classes, so the rule cannot be checked."
    wrong = [step for step in steps if step.is_contradiction]
    inverted = [step for step in steps if step.drop.value < 0]
    if wrong:
        names = "; ".join(f"{CATEGORY_TITLES[s.category]}: {s.harder} is solved more often than {s.easier}" for s in wrong)
        return f"Warning: the rule does not hold beyond noise in {len(wrong)} of {len(steps)} steps between classes. {names}."
    shown = sum(step.p_adjusted is not None and step.p_adjusted < ALPHA for step in steps)
    noise = f"; in {len(inverted)} it rises, within noise" if inverted else ""
    falls = f"Accuracy falls in {len(steps) - len(inverted)} of {len(steps)} steps, significantly in {shown}{noise}."
    return f"No step between classes contradicts the rule. {falls}"


def _by_class(runs: Sequence[ReportRun]) -> Mapping[tuple[str, DifficultyClass], list[Trial]]:
    by_class: dict[tuple[str, DifficultyClass], list[Trial]] = defaultdict(list)
    for run in runs:
        for trial in run.scored_trials:
            by_class[trial.task.category, trial.task.difficulty].append(trial)
    return by_class


def _class_table(runs: Sequence[ReportRun], steps: Sequence[ClassStep]) -> ReportTable:
    columns = [Column("category", "Category")]
    for name in CLASSES:
        columns += [
            Column(f"{name}_tasks", f"{name.capitalize()}: tasks", "count"),
            Column(name, f"{name.capitalize()} (%)", "share"),
        ]
    columns += [
        Column("first_drop", "First step down (points)", "points"), Column("second_drop", "Second step down (points)", "points"),
        Column("monotone", "Monotone"),
    ]  # fmt: skip
    by_class, rows = _by_class(runs), []
    for category, title in CATEGORY_TITLES.items():
        cells: list[CellValue] = [title]
        for name in CLASSES:
            trials = by_class[category, name]
            cells += [len({t.task.id for t in trials}), proportion(scores_of(trials)) if trials else ""]
        own = [step for step in steps if step.category == category]
        drops: list[CellValue] = [step.drop for step in own]
        if len(cells) > 1 and any(by_class[category, name] for name in CLASSES):
            rows.append((*cells, *drops, *([""] * (2 - len(drops))), _monotone(own)))
    notes = (
        "Step down: accuracy on an easier class minus accuracy on the next harder class that has tasks. Monotone: “within noise” "
        "if a harder class is solved more often, but the adjusted p value is at least 0.05.",
    )
    return ReportTable("difficulty", "Accuracy by difficulty class, all pairs", tuple(columns), tuple(rows), notes)


def _monotone(steps: Sequence[ClassStep]) -> str:
    if not steps:
        return "one class"
    if any(step.is_contradiction for step in steps):
        return "no"
    return "within noise" if any(step.drop.value < 0 for step in steps) else "yes"


def _cross_table(runs: Sequence[ReportRun]) -> ReportTable:
    """Return a table with the number of tasks by rule-based class and by class from item statistics."""
    facts = {t.task.id: t.task for run in runs for t in run.scored_trials}
    counts = Counter[tuple[str, str, str]]()
    for task, share in item_shares(runs).items():
        counts[facts[task].category, facts[task].difficulty, item_class(share)] += 1
    columns = (
        Column("category", "Category"), Column("rule", "By the rule"),
        *(Column(name, f"{name.capitalize()} by item statistics", "count") for name in CLASSES),
    )  # fmt: skip
    rows: list[tuple[CellValue, ...]] = []
    for category, title in CATEGORY_TITLES.items():
        for rule in CLASSES:
            numbers = [counts[category, rule, name] for name in CLASSES]
            if any(numbers):
                rows.append((title, rule, *numbers))
    return ReportTable("difficulty_items", "Tasks by the rule and by item statistics", columns, tuple(rows))


def _item_table(runs: Sequence[ReportRun]) -> ReportTable:
    facts = {t.task.id: t.task for run in runs for t in run.scored_trials}
    columns = (
        Column("task", "Task"), Column("category", "Category"), Column("rule", "By the rule"),
        Column("items", "By item statistics"), Column("share", "Correct (%)", "share"),
    )  # fmt: skip
    rows = tuple(
        (task, CATEGORY_TITLES[facts[task].category], facts[task].difficulty, item_class(share), share)
        for task, share in sorted(item_shares(runs).items())
    )
    return ReportTable("items", "Difficulty of each task", columns, rows)
