"""Validate submissions: check each line against the schema, the other lines and the tasks."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from scope_ptz.bench.engine.traces.named_models import card_contradictions, models_of
from scope_ptz.bench.engine.traces.verification import RunToVerify
from scope_ptz.bench.signatures.provenance import Provenance, provenance_of
from scope_ptz.bench.submissions.submission import LINE, Evaluated, Header, TrialLine, secrets_in, tasks_digest, totals_of
from scope_ptz.bench.submissions.submission_traces import copied_trace_faults, runs_in, trace_line_faults
from scope_ptz.bench.submissions.submission_trials import trial_faults
from scope_ptz.bench.tasks.splits import EARLIER_VERSIONS, SPLITS, load_split
from scope_ptz.bench.tasks.task import Task
from scope_ptz.builtin_names import DETERMINISTIC
from scope_ptz.errors import InputError
from scope_ptz.regular_files import check_regular_file
from scope_ptz.version import __version__

MAX_BYTES = 200_000_000
"""Maximum size of a submission in bytes."""
NO_TRACES_NOTE = (
    "not verifiable: the file uses format 1, which has no traces, so its verdicts and calls are only its author's claims"
)
NOT_RANKED_NOTE = "not ranked: {pair} uses the grammar planner or ground-truth perception, which are not models"


@dataclass(frozen=True, slots=True)
class SubmissionFindings:
    """The result of a validation.

    Attributes:
        file: Name of the file.
        faults: One message per fault, with the line number if it concerns a line.
        counts: The total number of trials, and the number of trials with each headline.
        notes: Remarks that are not faults.
        evaluated: Who ran the evaluation; "hosted" only if a signature proves it.
        runs: The runs whose calls can be repeated; empty for format 1.
    """

    file: str
    faults: tuple[str, ...]
    counts: Mapping[str, int] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    evaluated: Evaluated = "self-reported"
    runs: tuple[RunToVerify, ...] = ()

    @property
    def summary(self) -> str:
        """The result as text."""
        counts = ", ".join(f"{number} {name}" for name, number in self.counts.items())
        verdict = f"NOT VALID: {len(self.faults)} fault{'s' * (len(self.faults) > 1)}" if self.faults else "valid"
        return "\n".join([f"{self.file}: {verdict}, {self.evaluated}" + (f" ({counts})" if counts else ""), *self.notes])

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON data."""
        return {
            "file": self.file,
            "valid": not self.faults,
            "faults": list(self.faults),
            "counts": dict(self.counts),
            "notes": list(self.notes),
            "evaluated": self.evaluated,
        }


def check_submission(
    path: Path, tasks: Sequence[Task] | None = None, trusted: Mapping[bytes, str] | None = None
) -> SubmissionFindings:
    """Validate a submission. For format 2, the checks are run again on the traces.

    Args:
        path: The file.
        tasks: The tasks that it must cover. The default is the published split that its header names.
        trusted: The names of trusted hosts by public key. By default, no host is trusted.

    Raises:
        InputError: The file cannot be read, or its split is unknown and no tasks are given.
    """
    rows, faults = _read_rows(path)
    headers = [(number, row) for number, row in rows if isinstance(row, Header)]
    lines = [(number, row) for number, row in rows if isinstance(row, TrialLine)]
    if len(headers) != 1 or headers[0][0] != 1:
        faults.append(f"a submission must have exactly one header, in line 1; this file has {len(headers)} headers")
    if not headers:
        return SubmissionFindings(path.name, tuple(faults))
    header = headers[0][1]
    tasks_by_id = {task.id: task for task in (tasks if tasks is not None else _published_tasks(header))}
    trials = [row for _, row in lines]
    faults += [f"line 1: {fault}" for fault in _header_faults(header, trials, tasks_by_id)]
    for number, row in lines:
        faults += [f"line {number} ({row.task}): {fault}" for fault in trial_faults(row, header, tasks_by_id.get(row.task))]
    faults += _completeness_faults(header, trials, tasks_by_id)
    runs = runs_in(header, trials, tasks_by_id) if header.format == 2 else {}
    faults += _trace_faults(header, lines, runs, tasks_by_id)
    provenance = provenance_of(path, trusted or {})
    faults += provenance.faults
    totals = totals_of(trials)
    models = (header.card.planner, header.card.perception)
    unranked = not header.card.ranked or any(_is_built_in(model.name) for model in models)
    notes = [NOT_RANKED_NOTE.format(pair=header.card.pair)] if unranked else []
    if broken := totals.headlines.get("infrastructure", 0):
        notes.append(f"{broken} of {totals.trials} trials failed because of infrastructure errors and are excluded from accuracy")
    notes += _provenance_notes(header, trials, provenance)
    counts = {"trials": totals.trials, **{str(name): number for name, number in totals.headlines.items()}}
    verifiable = tuple(run for run in runs.values() if isinstance(run, RunToVerify))
    return SubmissionFindings(path.name, tuple(faults), counts, tuple(notes), provenance.evaluated, verifiable)


def _trace_faults(
    header: Header,
    lines: Sequence[tuple[int, TrialLine]],
    runs: Mapping[tuple[str, int], RunToVerify | str],
    tasks: Mapping[str, Task],
) -> Iterator[str]:
    """Yield faults in the traces of format 2, and in lines that contradict their traces."""
    for number, line in lines:
        if header.format == 1:
            if line.run is not None:
                yield f"line {number} ({line.task}): it has a trace, but only format 2 allows traces"
        elif line.task in tasks:
            for fault in trace_line_faults(header, line, runs.get((line.task, line.epoch))):
                yield f"line {number} ({line.task}): {fault}"
    yield from copied_trace_faults([line for _, line in lines])
    models = [models_of(run.stored_run) for run in runs.values() if isinstance(run, RunToVerify)]
    yield from (f"line 1: {fault}" for fault in card_contradictions(models, header.card))


def _provenance_notes(header: Header, lines: Sequence[TrialLine], provenance: Provenance) -> list[str]:
    """Return notes about the limits of the validation: who ran the evaluation, and which verdicts cannot be recomputed."""
    notes = list(provenance.notes)
    notes += [NO_TRACES_NOTE] if header.format == 1 else []
    if header.card.isolation is not None:
        notes.append(f"the agent was {header.card.isolation}")
    if judged := sum(line.scored_by == "judge" for line in lines):
        notes.append(f"{judged} verdicts come from a judge and cannot be recomputed")
    return notes


def coverage_faults(header: Header, lines: Sequence[TrialLine], tasks: Sequence[Task] | None = None) -> list[str]:
    """Return the reasons why trials do not cover a whole split, such as missing, repeated, unknown or reworded tasks.

    Args:
        header: The header of the submission.
        lines: The trials.
        tasks: The tasks to cover. The default is the published split that the header names.

    Raises:
        InputError: The split is unknown and no tasks are given.
    """
    tasks_by_id = {task.id: task for task in (tasks if tasks is not None else _published_tasks(header))}
    faults = list(_completeness_faults(header, lines, tasks_by_id))
    return faults or list(_digest_faults(header, tasks_by_id))


def _read_rows(path: Path) -> tuple[list[tuple[int, Header | TrialLine]], list[str]]:
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(f"{path} is larger than {MAX_BYTES // 1_000_000} MB, the maximum size of a submission.")
        check_regular_file(path)
        content = path.read_text("utf-8")
    except OSError as error:
        raise InputError(f"The submission {path} cannot be read: {error.strerror}.") from error
    except UnicodeDecodeError as error:
        raise InputError(f"The submission {path} is not UTF-8 text.") from error
    rows: list[tuple[int, Header | TrialLine]] = []
    faults = []
    for number, text in enumerate(content.split("\n"), 1):
        if text.strip():
            try:
                raw = json.loads(text, parse_constant=_reject_constant)
                rows.append((number, LINE.validate_python(raw)))
                faults += [f"line {number}: {field} looks like a secret; remove it" for field in secrets_in(raw)]
            except ValidationError as error:
                first_error = error.errors(include_url=False, include_input=False)[0]
                field = ".".join(map(str, first_error["loc"]))
                faults.append(f"line {number}: {f'{field}: ' if field else ''}{first_error['msg']}")
            except (ValueError, RecursionError) as error:
                faults.append(f"line {number}: not valid JSON ({error})")
    return rows, faults


def _reject_constant(name: str) -> float:
    """Raise ``ValueError`` for NaN and Infinity, which are not valid JSON."""
    raise ValueError(f"{name} is not allowed in JSON")


def _published_tasks(header: Header) -> Sequence[Task]:
    if header.card.split not in (*SPLITS, *chain(*EARLIER_VERSIONS.values())):
        raise InputError(
            f"The submission is for '{header.card.split}', which is not a published split. Give its tasks with --tasks."
        )
    versions = [load_split(name) for name in (header.card.split, *EARLIER_VERSIONS.get(header.card.split, ()))]
    return next((tasks for tasks in versions if tasks_digest(tasks) == header.tasks_digest), versions[0])


def _header_faults(header: Header, lines: Sequence[TrialLine], tasks: Mapping[str, Task]) -> Iterator[str]:
    totals = totals_of(lines)
    if header.totals.trials != totals.trials:
        yield f"the totals state {header.totals.trials} trials, but the file contains {totals.trials}"
    for kind, stated, counted in (
        ("headline", header.totals.headlines, totals.headlines),
        ("error mode", header.totals.error_modes, totals.error_modes),
    ):
        for name in sorted({*stated, *counted}):
            if stated.get(name, 0) != counted.get(name, 0):
                stated_number, number = stated.get(name, 0), counted.get(name, 0)
                yield f"the totals state {stated_number} trials with {kind} {name}, but the file contains {number}"
    datasets = {task.dataset for task in tasks.values()}
    if header.card.dataset not in {"+".join(sorted(datasets)), *datasets}:
        yield f"the header states the dataset {header.card.dataset}, but the tasks belong to {', '.join(sorted(datasets))}"
    yield from _digest_faults(header, tasks)
    if header.tasks != len(tasks):
        yield f"the header states {header.tasks} tasks, but the split has {len(tasks)}"
    expected = len(tasks) * header.card.epochs
    if header.wanted != expected:
        yield f"the header states {header.wanted} trials, but {len(tasks)} tasks with {header.card.epochs} repeats make {expected}"
    for model in (header.card.planner, header.card.perception):
        if _is_built_in(model.name) and not model.deterministic:
            yield f"{model.name} is built in, so 'deterministic' must be true in the header"
    if (version := _parse_version(header.card.package_version)) is None:
        yield f"the package version {header.card.package_version} is not a version number"
    elif version > (_parse_version(__version__) or ()):
        yield (
            f"the submission was written by scope-ptz {header.card.package_version}, which is newer than the installed version "
            f"({__version__}); update scope-ptz first"
        )


def _is_built_in(name: str) -> bool:
    return name.lower().replace("_", "-") in DETERMINISTIC


def _digest_faults(header: Header, tasks: Mapping[str, Task]) -> Iterator[str]:
    if header.tasks_digest != tasks_digest(tasks.values()):
        yield "the task digest differs, so the wording, categories or selection of tasks does not match the split"


def _parse_version(text: str) -> tuple[int, ...] | None:
    numbers = text.split("+")[0].split(".")[:3]
    return tuple(int(n) for n in numbers) if all(n.isdigit() for n in numbers) else None


def _completeness_faults(header: Header, lines: Sequence[TrialLine], tasks: Mapping[str, Task]) -> Iterator[str]:
    """Yield a fault for each duplicate, unknown or missing trial."""
    counts = Counter((line.task, line.epoch) for line in lines)
    for task, epoch in sorted(key for key, number in counts.items() if number > 1):
        yield f"{task}, repeat {epoch}, occurs {counts[task, epoch]} times"
    for task in sorted({task for task, _ in counts} - set(tasks)):
        yield f"{task} is not a task of the split"
    for task in sorted(tasks):
        missing = [epoch for epoch in range(1, header.card.epochs + 1) if (task, epoch) not in counts]
        if missing:
            yield f"{task} is missing" + (f" (repeats {', '.join(map(str, missing))})" if header.card.epochs > 1 else "")
