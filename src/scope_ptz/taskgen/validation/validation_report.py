"""The validation report. Datasets store the data that ``as_dict`` returns."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

CORRECT_ATTEMPTS = ("reference", "detour", "twice", "worded")
"""Names of the attempts that must pass."""


@dataclass(frozen=True)
class ValidationFault:
    """An attempt with the wrong result, or a check that a task fails.

    Attributes:
        task: Id of the task.
        attempt: Name of the attempt or check.
        reason: Description of the fault.
    """

    task: str
    attempt: str
    reason: str


@dataclass
class ValidationReport:
    """The counts and faults from a validation.

    Attributes:
        tasks: Number of tasks.
        by_category: Number of core tasks per category.
        by_stratum: Number of tasks per stratum.
        passed: Number of tasks that each attempt passed.
        tried: Number of tasks for which each attempt was run.
        absences: Number of core tasks with the answer "there is none", each of which has a twin.
        from_start: Number of core tasks that can be answered from the start view.
        guessed: Ids of the core tasks that each fixed answer passes, by the answer's name.
        pairs_passed: Number of tasks in ``guessed``, where a task in a pair counts only if both tasks in the pair pass.
        adaptive: Ids of the core tasks that each adaptive agent passes, by the agent's name.
        adaptive_pairs: Number of tasks in ``adaptive``, counted as in ``pairs_passed``.
        faults: Correct attempts that failed, and failed checks.
        adversarial_passes: Adversarial attempts that passed.
        disagreements: Counts and answers from ground-truth perception that differ from the evidence. They do not make a dataset
            unsound.
    """

    tasks: int = 0
    by_category: Counter[str] = field(default_factory=Counter)
    by_stratum: Counter[str] = field(default_factory=Counter)
    passed: Counter[str] = field(default_factory=Counter)
    tried: Counter[str] = field(default_factory=Counter)
    absences: int = 0
    from_start: int = 0
    guessed: dict[str, set[str]] = field(default_factory=dict)
    pairs_passed: dict[str, int] = field(default_factory=dict)
    adaptive: dict[str, set[str]] = field(default_factory=dict)
    adaptive_pairs: dict[str, int] = field(default_factory=dict)
    faults: list[ValidationFault] = field(default_factory=list)
    adversarial_passes: list[ValidationFault] = field(default_factory=list)
    disagreements: list[ValidationFault] = field(default_factory=list)

    @property
    def adversarial_shares(self) -> dict[str, float]:
        """The fraction of all tasks that each adversarial attempt passes."""
        return {name: self.passed[name] / self.tasks for name in sorted(self.tried) if name not in CORRECT_ATTEMPTS and self.tasks}

    @property
    def sound(self) -> bool:
        """Whether all correct attempts and checks passed, and no adversarial attempt passed."""
        return bool(self.tasks) and not self.faults and not self.adversarial_passes

    def adaptive_as_dict(self) -> dict[str, dict[str, float]]:
        """Return the results of the adaptive agents as JSON data. Published datasets do not store them."""
        return _shares(self.adaptive, self.adaptive_pairs, max(1, self.by_stratum["core"]))

    def as_dict(self) -> dict[str, Any]:
        """Return the report as JSON data, with the keys of the published dataset."""
        core = max(1, self.by_stratum["core"])
        correct = [name for name in CORRECT_ATTEMPTS if self.tried[name]]
        return {
            "sound": self.sound,
            "tasks": self.tasks,
            "by_category": dict(self.by_category),
            "by_stratum": dict(self.by_stratum),
            "absences": self.absences,
            "from_start": self.from_start,
            "right_ways": {name: {"passed": self.passed[name], "of": self.tried[name]} for name in correct},
            "cheats": {
                name: {"passed": self.passed[name], "of": self.tried[name], "share_of_all": share}
                for name, share in self.adversarial_shares.items()
            },
            "looked_and_guessed": _shares(self.guessed, self.pairs_passed, core),
            "faults": [vars(fault) for fault in self.faults],
            "cheated": [vars(fault) for fault in self.adversarial_passes],
            "disagreements": [vars(fault) for fault in self.disagreements],
        }


def _shares(passed: dict[str, set[str]], pairs_passed: dict[str, int], core: int) -> dict[str, dict[str, float]]:
    """Return the number and the fraction of core tasks that each agent passes, for single tasks and for whole pairs."""
    return {
        name: {
            "passed": len(ids),
            "share": len(ids) / core,
            "pairs_whole": pairs_passed[name],
            "share_pairs_whole": pairs_passed[name] / core,
        }
        for name, ids in passed.items()
    }
