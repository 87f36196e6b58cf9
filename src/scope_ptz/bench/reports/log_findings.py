"""Describe the contradictions between a log and its traces, for the terminal and the top of a report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from scope_ptz.bench.scoring.trials import Evaluation, LogFault, LogFinding
from scope_ptz.version import __version__

MAX_NAMED = 5
"""Maximum number of findings to list on one line."""
_EFFECTS: dict[LogFault, str] = {
    "tasks-changed": "The tasks of this log were changed after it was written. None of its scores is used",
    "card-differs": "The run card does not name the models of the traces. The scores are not those of the named pair",
    "task-differs": "The log contains other versions of published tasks. The published tasks are used",
    "task-unknown": "The log contains tasks that its split does not have. They do not count as correct",
    "score-differs": "The scores in the log are not used, because they differ from the checks executed on its traces",
    "trace-missing": "Runs have no complete trace. They do not count as correct",
    "trace-damaged": "Traces are damaged or contradict themselves. Their runs do not count as correct",
    "sample-missing": "The finished log lacks runs. They do not count as correct",
    "sample-repeated": "Runs occur more than once. They do not count as correct",
}
"""The effects of findings on the scores, by kind, the most serious kind first."""


def finding_lines(evaluation: Evaluation) -> list[str]:
    """Return a line for each kind of contradiction found in a log, with the names of the first samples."""
    lines = []
    name = Path(evaluation.log).name or evaluation.card.pair
    for kind, effect in _EFFECTS.items():
        found = [finding for finding in evaluation.findings if finding.kind == kind]
        if not found:
            continue
        runs = [finding for finding in found if finding.sample]
        count_text = f" ({len(runs)} of {max(len(evaluation.trials), len(runs))} runs)" if runs else ""
        details = "; ".join(_details_with_samples(found[:MAX_NAMED]))
        more = f"; and {len(found) - MAX_NAMED} more" if len(found) > MAX_NAMED else ""
        version = ""
        if kind == "score-differs" and evaluation.card.package_version != __version__:
            version = f" (the log is from version {evaluation.card.package_version}, the checks are those of {__version__})"
        lines.append(f"{name}: {effect}{version}{count_text}. {details[:1].upper()}{details[1:]}{more}.")
    return lines


def _details_with_samples(findings: Sequence[LogFinding]) -> list[str]:
    """Return the distinct details of findings, each with the names of the affected samples."""
    samples: dict[str, list[str]] = {}
    for finding in findings:
        samples.setdefault(finding.detail, []).extend([finding.sample] if finding.sample else [])
    return [f"{detail}: {', '.join(names)}" if names else detail for detail, names in samples.items()]


def stored_verdict_lines(evaluations: Sequence[Evaluation]) -> list[str]:
    """Return a line about stored verdicts of judges, which cannot be recomputed. Return an empty list if there are none."""
    trials = [trial for evaluation in evaluations for trial in evaluation.trials]
    judged = sum(trial.scored_by == "judge" and trial.headline in ("correct", "incorrect") for trial in trials)
    if not judged:
        return []
    return [
        f"{judged} of {len(trials)} verdicts are stored verdicts of a judge. They cannot be recomputed from traces, so the report "
        "uses the verdicts in the logs."
    ]
