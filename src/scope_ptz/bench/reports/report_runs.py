"""The runs in a report, with their labels, task sets and registered models."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from scope_ptz.bench.judging.judgement_tally import lacks_verdict
from scope_ptz.bench.reports.display_names import split_name, unexpected_model
from scope_ptz.bench.scoring.trials import Evaluation, ModelCard, Trial
from scope_ptz.bench.statistics.clustered import IntervalEstimate, Scores, macro_weights, proportion
from scope_ptz.builtin_names import GRAMMAR, GROUND_TRUTH
from scope_ptz.errors import UnknownNameError
from scope_ptz.registry import Model, Registry

RunKind = Literal["models", "reference", "blind", "person"]
"""Kinds of runs.

"models": a pair of models; "reference": the grammar planner or ground-truth perception; "blind": no perception; "person": a human
baseline.
"""
PERSON_PROVIDER = "person"
"""The planner's provider on the run card of a human baseline."""
SIMULATED_PROVIDER = "simulated"
"""The planner's provider on the run card of a simulated run, whose outcomes were drawn at random."""
MAIN_STRATA = ("core", "imported")
"""Strata whose tasks count towards accuracy."""
FULL_PRECISION = ("fp32", "fp16", "bf16")
"""Precisions of unquantised models."""
CATEGORY_TITLES = {
    "comparative": "Comparative", "counting": "Counting", "descriptor": "Descriptor", "location": "Location",
    "multi_step_command": "Multi-step command", "multi_step_reasoning": "Multi-step reasoning", "ocr": "OCR",
    "single_call": "Single call",
}  # fmt: skip
"""Titles of the categories, in the order used in the paper's table."""


@dataclass(frozen=True, eq=False)
class ReportRun:
    """An evaluation in a report.

    Attributes:
        number: Position in the report, from 1.
        evaluation: The evaluation.
        label: Unique name in the report, which states how the run differs from other runs.
        planner: The planner's model; None if it is not in the registry.
        perception: The perception model; None if it is not in the registry.
        task_difference: How its tasks differ from those of most pairs on the main task set; empty if they do not differ.
    """

    number: int
    evaluation: Evaluation
    label: str
    planner: Model | None
    perception: Model | None
    task_difference: str = ""

    @property
    def kind(self) -> RunKind:
        """The kind of this run."""
        card = self.evaluation.card
        if card.planner.provider == PERSON_PROVIDER:
            return "person"
        if "blind" in (card.perception.name, card.variant):
            return "blind"
        return "models" if card.ranked else "reference"

    @property
    def ranked(self) -> bool:
        """Whether the run uses a pair of models, so that it is included in rankings."""
        return self.kind == "models"

    @property
    def simulated(self) -> bool:
        """Whether the outcomes were drawn at random and no model was run."""
        return self.evaluation.card.planner.provider == SIMULATED_PROVIDER

    @property
    def uses_exact_ground_truth(self) -> bool:
        """Whether perception is the exact ground truth."""
        perception = self.evaluation.card.perception
        return perception.deterministic and perception.name == GROUND_TRUTH

    @property
    def built_in(self) -> bool:
        """Whether both planner and perception are built in rather than models."""
        card = self.evaluation.card
        return self.kind == "reference" and card.planner.deterministic and card.perception.deterministic

    @property
    def is_exact_reference(self) -> bool:
        """Whether the pair is the grammar planner with exact ground-truth perception."""
        planner = self.evaluation.card.planner
        return planner.deterministic and planner.name == GRAMMAR and self.uses_exact_ground_truth and self.kind == "reference"

    @property
    def planner_name(self) -> str:
        """Name of the planner, followed by the name of the served model if it differs."""
        return _display_name(self.evaluation.card.planner, self.planner)

    @property
    def perception_name(self) -> str:
        """Name of the perception model, followed by the name of the served model if it differs."""
        return _display_name(self.evaluation.card.perception, self.perception)

    @property
    def system(self) -> tuple[str, str, str, str]:
        """The evaluated system: planner, perception model, agent with its isolation, and variant."""
        card = self.evaluation.card
        return self.planner_name, self.perception_name, card.agent_label, card.variant

    @property
    def task_set(self) -> tuple[str, str]:
        """The dataset and the split. Only runs on the same task set are compared."""
        return self.evaluation.card.dataset, split_name(self.evaluation.card.split)

    @property
    def memory_gb(self) -> float | None:
        """Memory in GB for serving both models, computed from the registry; None if a model is not in the registry.

        A model in both roles counts once. The grammar planner and ground-truth perception need no memory.
        """
        card = self.evaluation.card
        models = ((card.planner, self.planner), (card.perception, self.perception))
        if any(model is None and not requested.deterministic for requested, model in models):
            return None
        return sum(model.memory_for() for model in {m.name: m for _, m in models if m is not None}.values())

    @cached_property
    def main_trials(self) -> tuple[Trial, ...]:
        """Trials of core and imported tasks, which count towards accuracy."""
        return tuple(t for t in self.evaluation.trials if t.task.stratum in MAIN_STRATA)

    @cached_property
    def scored_trials(self) -> tuple[Trial, ...]:
        """Main trials, except those with an infrastructure failure or a missing verdict of a judge.

        They include unscored trials, which do not count as correct.
        """
        return tuple(t for t in self.main_trials if t.headline != "infrastructure" and not lacks_verdict(t))

    @cached_property
    def tasks(self) -> frozenset[str]:
        """Ids of the tasks that count towards accuracy."""
        return frozenset(t.task.id for t in self.main_trials)

    @cached_property
    def checked_trials(self) -> tuple[Trial, ...]:
        """Scored trials whose verdict comes from the checks."""
        return tuple(t for t in self.scored_trials if t.scored_by == "checks")

    @cached_property
    def macro(self) -> IntervalEstimate | None:
        """Macro accuracy: the unweighted mean over the categories that have trials."""
        return macro(scores_of(self.scored_trials)) if self.scored_trials else None

    @cached_property
    def micro(self) -> IntervalEstimate | None:
        """Micro accuracy: the fraction of correct trials."""
        return proportion(scores_of(self.scored_trials))


def scores_of(trials: Sequence[Trial], correct: Iterable[bool] | None = None) -> Scores:
    """Return the outcomes of trials, with categories as strata, viewpoints as clusters and tasks as units.

    Args:
        trials: The trials.
        correct: Whether each trial counts as correct. By default, this depends on the headline.
    """
    values = [t.headline == "correct" for t in trials] if correct is None else list(correct)
    return Scores(
        np.array(values, dtype=np.float64),
        tuple(t.task.category for t in trials),
        tuple(viewpoint(t) for t in trials),
        tuple(t.task.id for t in trials),
    )


def macro(scores: Scores) -> IntervalEstimate | None:
    """Return macro accuracy with its interval; None if there are no outcomes."""
    return proportion(scores, macro_weights(scores)) if len(scores.values) else None


def viewpoint(trial: Trial) -> str:
    """Return the name of the viewpoint by which a trial is clustered."""
    return f"{trial.task.scene}/{trial.task.viewpoint}"


def report_runs(evaluations: Sequence[Evaluation], registry: Registry) -> tuple[ReportRun, ...]:
    """Return the runs for a report, in the order used in the paper's table.

    Runs are sorted by perception model, then by the size of the planner. Runs on splits other than core come later, and unranked
    runs come last.
    """
    splits = {split_name(e.card.split) for e in evaluations}
    unlabelled = [
        ReportRun(0, e, "", _registry_model(e.card.planner, registry), _registry_model(e.card.perception, registry))
        for e in evaluations
    ]
    labels = [_label(run, with_split=len(splits) > 1) for run in unlabelled]
    shared = {label for label, number in Counter(labels).items() if number > 1}
    labels = [
        f"{label}, timed alone" if label in shared and not e.card.contended else label
        for label, e in zip(labels, evaluations, strict=True)
    ]
    counts, seen = Counter(labels), Counter[str]()
    runs = []
    for run, label in zip(unlabelled, labels, strict=True):
        seen[label] += 1
        runs.append(replace(run, label=f"{label} #{seen[label]}" if counts[label] > 1 else label))
    ordered = sorted(runs, key=_sort_key)
    common = main_tasks(ordered)
    notes = [_task_difference(run, common) if run in runs_of_main_set(ordered) else "" for run in ordered]
    return tuple(
        replace(run, number=number, task_difference=note, label=f"{run.label} [{note}]" if note else run.label)
        for number, (run, note) in enumerate(zip(ordered, notes, strict=True), 1)
    )


def _display_name(card: ModelCard, model: Model | None) -> str:
    served = unexpected_model(card, model)
    return card.name if served is None else f"{card.name} (served: {served})"


def _task_difference(run: ReportRun, common: frozenset[str]) -> str:
    """Describe how the tasks of a run differ from the common tasks; return an empty string if they do not differ."""
    if run.tasks == common:
        return ""
    if run.tasks < common:
        return f"{len(run.tasks)} of the {len(common)} tasks"
    return f"{len(run.tasks)} tasks, {len(run.tasks & common)} of the {len(common)} shared"


def _label(run: ReportRun, *, with_split: bool) -> str:
    card = run.evaluation.card
    pair = f"{run.planner_name} + {run.perception_name}"
    parts = [f"person {card.planner.name}" if card.planner.provider == PERSON_PROVIDER else pair]
    parts += [f"agent {card.agent_label}"] if card.agent != "scope" else []
    parts += [card.variant] if card.variant else []
    parts += [f"{split_name(card.split)} split"] if with_split and card.split != "core" else []
    return ", ".join(parts)


def _registry_model(card: ModelCard, registry: Registry) -> Model | None:
    try:
        return registry.model(card.registry) if card.registry else None
    except UnknownNameError:
        return None


def _sort_key(run: ReportRun) -> tuple[bool, bool, str, str, float, str, str]:
    card = run.evaluation.card
    size = run.planner.size_b if run.planner else 0.0
    return not run.ranked, card.split != "core", card.split, run.perception_name, size, run.planner_name, run.label


def main_task_set(runs: Sequence[ReportRun]) -> tuple[str, str] | None:
    """Return the task set with the most ranked runs. Ties are resolved by the number of trials."""
    counts: dict[tuple[str, str], tuple[int, int]] = {}
    for run in runs:
        if run.main_trials:
            ranked, trials = counts.get(run.task_set, (0, 0))
            counts[run.task_set] = (ranked + run.ranked, trials + len(run.main_trials))
    return max(counts, key=lambda task_set: counts[task_set]) if counts else None


def runs_of_main_set(runs: Sequence[ReportRun]) -> tuple[ReportRun, ...]:
    """Return the runs on the main task set that have scored trials."""
    main = main_task_set(runs)
    return tuple(run for run in runs if run.task_set == main and run.scored_trials)


def main_tasks(runs: Sequence[ReportRun]) -> frozenset[str]:
    """Return the ids of the tasks that most model pairs (or, without pairs, most runs) on the main task set cover."""
    main = runs_of_main_set(runs)
    comparable = runs_on_same_tasks(pairs_of(main)) or runs_on_same_tasks(main)
    return comparable[0].tasks if comparable else frozenset()


def primary_runs(runs: Sequence[ReportRun]) -> tuple[ReportRun, ...]:
    """Return one run per system: the run with the most scored trials. Ties go to the first run."""
    best: dict[tuple[str, str, str, str], ReportRun] = {}
    for run in runs:
        if run.system not in best or len(run.scored_trials) > len(best[run.system].scored_trials):
            best[run.system] = run
    return tuple(run for run in runs if best[run.system] is run)


def pairs_of(main: Sequence[ReportRun]) -> tuple[ReportRun, ...]:
    """Return one run per ranked system. A variant is excluded if the unchanged pair is present."""
    ranked = [run for run in main if run.ranked]
    unchanged = {run.system[:3] for run in ranked if not run.system[3]}
    return primary_runs([run for run in ranked if not run.system[3] or run.system[:3] not in unchanged])


def runs_on_same_tasks(ranked: Sequence[ReportRun]) -> tuple[ReportRun, ...]:
    """Return the runs that cover the most common set of tasks. Ties are resolved by the number of tasks."""
    if not ranked:
        return ()
    counts = Counter(run.tasks for run in ranked)
    common = max(counts, key=lambda tasks: (counts[tasks], len(tasks)))
    return tuple(run for run in ranked if run.tasks == common)


def timing_run(run: ReportRun, runs: Sequence[ReportRun]) -> ReportRun:
    """Return the run from which a system's latency is taken.

    This is the finished run without contention that has the most trials or, if there is none, ``run`` itself.
    """
    same_system = [other for other in runs if other.system == run.system and other.main_trials]
    alone = [other for other in same_system if not other.evaluation.card.contended and other.evaluation.finished]
    return max(alone, key=lambda other: len(other.main_trials)) if alone else run


def is_mixture(model: Model) -> bool:
    """Return whether a model is a mixture of experts, which has fewer active than total parameters."""
    return model.active_b < model.size_b
