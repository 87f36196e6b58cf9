"""Runs as a report sees them: labelled, joined with what the registry knows of their models, and grouped by what they may be
compared with."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from scope_ptz.bench.judging.tally import without_verdict
from scope_ptz.bench.reports.labels import served_instead, split_name
from scope_ptz.bench.scoring.trials import Evaluation, ModelCard, Trial
from scope_ptz.bench.statistics.clustered import Estimate, Scores, macro_weights, share
from scope_ptz.builtin_names import GRAMMAR, GROUND_TRUTH
from scope_ptz.errors import UnknownNameError
from scope_ptz.registry import Model, Registry

Kind = Literal["models", "reference", "blind", "person"]
"""``reference``: the grammar planner or ground-truth eyes took part; ``blind``: nothing was seen; ``person``: a human baseline."""
PERSON = "person"
"""What is no model and makes no noise either: noisy eyes are the ground truth made worse."""
HEADLINE_STRATA = ("core", "imported")
FULL_PRECISION = ("fp32", "fp16", "bf16")
CATEGORY_TITLES = {
    "comparative": "Comparative", "counting": "Counting", "descriptor": "Descriptor", "location": "Location",
    "multi_step_command": "Multi-step command", "multi_step_reasoning": "Multi-step reasoning", "ocr": "OCR",
    "single_call": "Single call",
}  # fmt: skip
"""In the order of the paper's table."""


@dataclass(frozen=True, eq=False)
class Run:
    """One evaluation; a trial is one run of one task in it.

    ``label``: how the report calls it, unlike any other; it says what sets the run apart from others wherever it stands.
    ``planner`` and ``eyes``: None where the registry has no such model. ``elsewhere``: which other tasks it did, in words, when
    they are not those of most pairs of the main task set; empty when they are, and for runs of another task set."""

    number: int
    evaluation: Evaluation
    label: str
    planner: Model | None
    eyes: Model | None
    elsewhere: str = ""

    @property
    def kind(self) -> Kind:
        card = self.evaluation.card
        if card.planner.provider == PERSON:
            return "person"
        if "blind" in (card.perception.name, card.variant):
            return "blind"
        return "models" if card.ranked else "reference"

    @property
    def ranked(self) -> bool:
        return self.kind == "models"

    @property
    def exact_eyes(self) -> bool:
        """Whether its eyes are the simulator's ground truth as it is."""
        eyes = self.evaluation.card.perception
        return eyes.deterministic and eyes.name == GROUND_TRUTH

    @property
    def exact(self) -> bool:
        """Whether no model took part and nothing was made worse: the grammar planner with ground-truth eyes."""
        planner = self.evaluation.card.planner
        return planner.deterministic and planner.name == GRAMMAR and self.exact_eyes and self.kind == "reference"

    @property
    def planner_name(self) -> str:
        """The planner, and what its server served in its place if it did."""
        return _named(self.evaluation.card.planner, self.planner)

    @property
    def eyes_name(self) -> str:
        """The eyes, and what their server served in their place if it did."""
        return _named(self.evaluation.card.perception, self.eyes)

    @property
    def system(self) -> tuple[str, str, str, str]:
        """What was run, whatever the tasks: planner, eyes, agent, variant."""
        card = self.evaluation.card
        return self.planner_name, self.eyes_name, card.agent, card.variant

    @property
    def task_set(self) -> tuple[str, str]:
        """Dataset and split: runs of one task set may be compared."""
        return self.evaluation.card.dataset, split_name(self.evaluation.card.split)

    @property
    def memory_gb(self) -> float | None:
        """Computed memory to serve both models at the precision that the registry gives; one model that is both counts once."""
        if self.planner is None or self.eyes is None:
            return None
        return sum(model.memory_for() for model in {m.name: m for m in (self.planner, self.eyes)}.values())

    @cached_property
    def headline(self) -> tuple[Trial, ...]:
        """Trials of core tasks (or of an imported file's): what accuracy is told of."""
        return tuple(t for t in self.evaluation.trials if t.task.stratum in HEADLINE_STRATA)

    @cached_property
    def scored(self) -> tuple[Trial, ...]:
        """Of these, all that infrastructure did not break and that need no judge, or have a judge's verdict; other unscored ones
        are among them and count as not correct."""
        return tuple(t for t in self.headline if t.headline != "infrastructure" and not without_verdict(t))

    @cached_property
    def tasks(self) -> frozenset[str]:
        """Ids of the tasks that its headline is told of."""
        return frozenset(t.task.id for t in self.headline)

    @cached_property
    def checked(self) -> tuple[Trial, ...]:
        """Of the scored ones those whose verdict is the checks'."""
        return tuple(t for t in self.scored if t.scored_by == "checks")

    @cached_property
    def macro(self) -> Estimate | None:
        """Unweighted mean over the categories that occur."""
        return macro(scores_of(self.scored)) if self.scored else None

    @cached_property
    def micro(self) -> Estimate | None:
        return share(scores_of(self.scored))


def scores_of(trials: Sequence[Trial], right: Iterable[bool] | None = None) -> Scores:
    """Outcomes by category and viewpoint, repeats of a task being one observation; ``right`` replaces the headline."""
    values = [t.headline == "correct" for t in trials] if right is None else list(right)
    return Scores(
        np.array(values, dtype=np.float64),
        tuple(t.task.category for t in trials),
        tuple(viewpoint(t) for t in trials),
        tuple(t.task.id for t in trials),
    )


def macro(scores: Scores) -> Estimate | None:
    """Macro accuracy with its interval; None without data."""
    return share(scores, macro_weights(scores)) if len(scores.values) else None


def viewpoint(trial: Trial) -> str:
    """What trials are clustered by."""
    return f"{trial.task.scene}/{trial.task.viewpoint}"


def collect(evaluations: Sequence[Evaluation], registry: Registry) -> tuple[Run, ...]:
    """Runs in the order of the paper's table: by eyes, then by the planner's size; other splits and reference runs last."""
    splits = {split_name(e.card.split) for e in evaluations}
    bare = [Run(0, e, "", _known(e.card.planner, registry), _known(e.card.perception, registry)) for e in evaluations]
    wanted = [_label(run, with_split=len(splits) > 1) for run in bare]
    shared = {label for label, number in Counter(wanted).items() if number > 1}
    wanted = [
        f"{label}, timed alone" if label in shared and not e.card.contended else label
        for label, e in zip(wanted, evaluations, strict=True)
    ]
    times, seen = Counter(wanted), Counter[str]()
    runs = []
    for run, label in zip(bare, wanted, strict=True):
        seen[label] += 1
        runs.append(replace(run, label=f"{label} #{seen[label]}" if times[label] > 1 else label))
    ordered = sorted(runs, key=_order)
    common = main_tasks(ordered)
    apart = [_elsewhere(run, common) if run in of_main_set(ordered) else "" for run in ordered]
    return tuple(
        replace(run, number=number, elsewhere=words, label=f"{run.label} [{words}]" if words else run.label)
        for number, (run, words) in enumerate(zip(ordered, apart, strict=True), 1)
    )


def _named(card: ModelCard, model: Model | None) -> str:
    served = served_instead(card, model)
    return card.name if served is None else f"{card.name} (served: {served})"


def _elsewhere(run: Run, common: frozenset[str]) -> str:
    """What a run did in place of the common tasks; empty when it did these."""
    if run.tasks == common:
        return ""
    if run.tasks < common:
        return f"{len(run.tasks)} of the {len(common)} tasks"
    return f"{len(run.tasks)} tasks, {len(run.tasks & common)} of the {len(common)} shared"


def _label(run: Run, *, with_split: bool) -> str:
    card = run.evaluation.card
    pair = f"{run.planner_name} + {run.eyes_name}"
    parts = [f"person {card.planner.name}" if card.planner.provider == PERSON else pair]
    parts += [f"agent {card.agent}"] if card.agent != "scope" else []
    parts += [card.variant] if card.variant else []
    parts += [f"{split_name(card.split)} split"] if with_split and card.split != "core" else []
    return ", ".join(parts)


def _known(card: ModelCard, registry: Registry) -> Model | None:
    try:
        return registry.model(card.registry) if card.registry else None
    except UnknownNameError:
        return None


def _order(run: Run) -> tuple[bool, bool, str, str, float, str, str]:
    card = run.evaluation.card
    size = run.planner.size_b if run.planner else 0.0
    return not run.ranked, card.split != "core", card.split, run.eyes_name, size, run.planner_name, run.label


def main_task_set(runs: Sequence[Run]) -> tuple[str, str] | None:
    """The task set with the most ranked runs that have headline tasks; of equals the one with more trials."""
    having = [run for run in runs if run.headline]
    weight: dict[tuple[str, str], tuple[int, int]] = {}
    for run in having:
        ranked, trials = weight.get(run.task_set, (0, 0))
        weight[run.task_set] = (ranked + run.ranked, trials + len(run.headline))
    return max(weight, key=lambda key: weight[key]) if weight else None


def of_main_set(runs: Sequence[Run]) -> tuple[Run, ...]:
    """The runs of the main task set that have anything to tell."""
    main = main_task_set(runs)
    return tuple(run for run in runs if run.task_set == main and run.scored)


def main_tasks(runs: Sequence[Run]) -> frozenset[str]:
    """The tasks that most model pairs of the main task set did; without any pair, that most of its runs did."""
    main = of_main_set(runs)
    alike = on_the_same_tasks(pairs_of(main)) or on_the_same_tasks(main)
    return alike[0].tasks if alike else frozenset()


def primary(runs: Sequence[Run]) -> tuple[Run, ...]:
    """One run a system: the one with the most headline tasks scored, of equals the first."""
    best: dict[tuple[str, str, str, str], Run] = {}
    for run in runs:
        if run.system not in best or len(run.scored) > len(best[run.system].scored):
            best[run.system] = run
    return tuple(run for run in runs if best[run.system] is run)


def pairs_of(main: Sequence[Run]) -> tuple[Run, ...]:
    """The ranked systems of a task set; a variant of a pair that is there as it is belongs to the sensitivity section."""
    ranked = [run for run in main if run.ranked]
    plain = {run.system[:3] for run in ranked if not run.system[3]}
    return primary([run for run in ranked if not run.system[3] or run.system[:3] not in plain])


def on_the_same_tasks(ranked: Sequence[Run]) -> tuple[Run, ...]:
    """The runs over the set of tasks that most of them did, of equals the larger set: means over others are not comparable."""
    if not ranked:
        return ()
    counted = Counter(run.tasks for run in ranked)
    common = max(counted, key=lambda tasks: (counted[tasks], len(tasks)))
    return tuple(run for run in ranked if run.tasks == common)


def timed(run: Run, runs: Sequence[Run]) -> Run:
    """The run from which a system's latency is taken: a finished one without contention if there is any, of these the longest."""
    same = [other for other in runs if other.system == run.system and other.headline]
    alone = [other for other in same if not other.evaluation.card.contended and other.evaluation.finished]
    return max(alone, key=lambda other: len(other.headline)) if alone else run


def is_mixture(model: Model) -> bool:
    """Mixture of experts: fewer parameters are active than there are."""
    return model.active_b < model.size_b
