"""The entries of a leaderboard: validated submissions with their scores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from statistics import median

import numpy as np
from pydantic import ValidationError

from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES
from scope_ptz.bench.signatures.detached import signature_path
from scope_ptz.bench.signatures.provenance import Provenance, provenance_of
from scope_ptz.bench.statistics.clustered import IntervalEstimate, Scores, macro_weights, proportion
from scope_ptz.bench.submissions.submission import LINE, Header, TrialLine, tasks_digest
from scope_ptz.bench.submissions.submission_checks import check_submission
from scope_ptz.bench.tasks.task import Task
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.errors import InputError

SUBMISSION_PATTERN = "*.jsonl"
MAX_BROKEN_FRACTION = 0.02
"""Maximum fraction of trials with an infrastructure failure. Entries above it are not ranked."""


@dataclass(frozen=True, slots=True)
class TaskSet:
    """A set of tasks that submissions may cover.

    Attributes:
        name: Name of the split or the task file.
        tasks: The tasks.
        facts: The properties of the tasks, by id. They contain the viewpoint, by which intervals are clustered.
    """

    name: str
    tasks: tuple[Task, ...]
    facts: Mapping[str, TaskFacts]

    @property
    def digest(self) -> str:
        """The digest by which submissions identify their tasks."""
        return tasks_digest(self.tasks)


@dataclass(frozen=True)
class LeaderboardEntry:
    """A submission on a leaderboard.

    Attributes:
        file: File name of the submission.
        header: The header.
        lines: The trials.
        provenance: Who evaluated the submission.
        task_set: The tasks that the submission covers.
    """

    file: str
    header: Header
    lines: tuple[TrialLine, ...]
    provenance: Provenance
    task_set: TaskSet

    @property
    def name(self) -> str:
        """Name of the agent or planner."""
        card = self.header.card
        return card.planner.name if card.agent == "scope" else card.agent

    @property
    def is_baseline(self) -> bool:
        """Whether the planner is built in, so that the entry is a reference rather than a competitor."""
        return self.header.card.planner.deterministic

    @property
    def uses_ground_truth(self) -> bool:
        """Whether perception was the simulator's ground truth rather than a model."""
        return self.header.card.perception.deterministic

    @property
    def labels(self) -> tuple[str, ...]:
        """The labels of the result: "hosted" or "self-reported", and the isolation of the agent."""
        isolation = str(getattr(self.header.card, "isolation", None) or "")
        if self.provenance.evaluated == "hosted":
            return ("hosted",)
        claimed = () if isolation in ("", "hosted") else (isolation,)
        return ("self-reported", *claimed)

    @property
    def broken(self) -> int:
        """Number of trials with an infrastructure failure."""
        return sum(line.headline == "infrastructure" for line in self.lines)

    @property
    def ranked(self) -> bool:
        """Whether the entry has a rank."""
        return not self.is_baseline and self.broken <= MAX_BROKEN_FRACTION * len(self.lines)

    @cached_property
    def accuracy(self) -> IntervalEstimate | None:
        """Macro accuracy with its interval; None if every trial had an infrastructure failure."""
        scores = self._scores(None)
        return proportion(scores, macro_weights(scores)) if len(scores.values) else None

    def accuracy_in_category(self, category: str) -> IntervalEstimate | None:
        """Return the accuracy in a category; None if there are no trials in the category."""
        return proportion(self._scores(category))

    @property
    def latency_s(self) -> float | None:
        """Median duration of a run in seconds; None if no run has a duration."""
        durations = [line.times.total_s for line in self.lines if line.times.total_s > 0]
        return median(durations) if durations else None

    def _scores(self, category: str | None) -> Scores:
        lines = [
            line for line in self.lines if line.headline != "infrastructure" and (category is None or line.category == category)
        ]
        facts = [self.task_set.facts[line.task] for line in lines]
        return Scores(
            np.array([float(line.headline == "correct") for line in lines]),
            tuple(line.category for line in lines),
            tuple((fact.scene, fact.viewpoint) for fact in facts),
            tuple(line.task for line in lines),
        )


@dataclass(frozen=True, slots=True)
class RefusedSubmission:
    """A submission that is not listed, and the reason."""

    file: str
    reason: str


def read_entries(
    folder: Path, task_sets: Sequence[TaskSet], trusted: Mapping[bytes, str]
) -> tuple[list[LeaderboardEntry], list[RefusedSubmission]]:
    """Read and validate the submissions in a folder.

    Args:
        folder: The folder. The files ``*.jsonl`` in it are submissions, with signatures next to them.
        task_sets: The tasks that submissions may cover.
        trusted: The public keys of trusted hosts.

    Returns:
        The valid entries, and the refused submissions. A second submission of the same evaluation is refused.

    Raises:
        InputError: The folder cannot be read.
    """
    if not folder.is_dir():
        raise InputError(f"{folder} is not a folder. Give the folder that contains the submissions (*.jsonl).")
    by_digest = {tasks.digest: tasks for tasks in task_sets}
    entries: list[LeaderboardEntry] = []
    refused: list[RefusedSubmission] = []
    # Signed files come first, so that an unsigned copy is refused instead of the signed file.
    files = sorted(folder.glob(SUBMISSION_PATTERN), key=lambda file: (not signature_path(file).exists(), file.name))
    for file in files:
        try:
            entry = _read_entry(file, by_digest, trusted)
        except InputError as error:
            refused.append(RefusedSubmission(file.name, str(error).rstrip(".")))
            continue
        earlier = next((e.file for e in entries if e.header.card.run_id == entry.header.card.run_id), None)
        if earlier is None:
            entries.append(entry)
        else:
            refused.append(RefusedSubmission(file.name, f"it contains the same evaluation as {earlier}"))
    return entries, refused


def _read_entry(file: Path, by_digest: Mapping[str, TaskSet], trusted: Mapping[bytes, str]) -> LeaderboardEntry:
    """Read the entry from a submission. Raises ``InputError`` if the submission is not valid."""
    header = _header(file)
    tasks = by_digest.get(header.tasks_digest)
    if tasks is None:
        raise InputError("its tasks are unknown; give the task file with --tasks")
    provenance, findings = provenance_of(file, trusted), check_submission(file, tasks.tasks, trusted)
    if findings.faults:
        more = f", and {len(findings.faults) - 1} more faults" if len(findings.faults) > 1 else ""
        raise InputError(f"{findings.faults[0]}{more}")
    rows = [LINE.validate_json(text) for text in file.read_text("utf-8").split("\n") if text.strip()]
    lines = tuple(row for row in rows if isinstance(row, TrialLine))
    return LeaderboardEntry(file.name, header, lines, provenance, tasks)


def _header(file: Path) -> Header:
    try:
        with file.open(encoding="utf-8") as stream:
            row = LINE.validate_json(stream.readline())
    except (OSError, ValidationError, UnicodeDecodeError) as error:
        raise InputError("its first line is not the header of a submission") from error
    if not isinstance(row, Header):
        raise InputError("its first line is not the header of a submission")
    return row


def categories_of(entries: Sequence[LeaderboardEntry]) -> dict[str, str]:
    """Return the titles of the categories that occur in entries, by category."""
    present = {line.category for entry in entries for line in entry.lines}
    return {name: title for name, title in CATEGORY_TITLES.items() if name in present}
