"""Check the samples of a log as a whole: none is missing, repeated or copied, and the tasks match the run card.

A sample that is missing from a finished log or occurs twice results in an unscored trial, which does not count as correct. If the
tasks of a finished log do not match the run card, none of the log's scores are used.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence

from inspect_ai.log import EvalLog

from scope_ptz.bench.engine.entries import Entry, digest
from scope_ptz.bench.engine.stored_run import sample_name
from scope_ptz.bench.engine.traces.named_models import card_contradictions
from scope_ptz.bench.engine.traces.scored_trials import published_task_entry, unscored_trial
from scope_ptz.bench.engine.traces.traced_trials import TracedTrial
from scope_ptz.bench.scoring.trials import LogFinding, RunCard, Trial


def check_completeness(traced: Sequence[TracedTrial], header: EvalLog, card: RunCard) -> tuple[list[Trial], tuple[LogFinding, ...]]:
    """Check that a log is complete, and return its trials and all findings. Missing and repeated samples become unscored trials.

    Args:
        traced: The trials of the samples in the log.
        header: The header of the log.
        card: The run card of the log.
    """
    findings = [finding for item in traced for finding in item.findings]
    by_name: dict[str, list[TracedTrial]] = defaultdict(list)
    for item in traced:
        by_name[item.trial.sample].append(item)
    trials = {name: copies[0].trial for name, copies in by_name.items()}
    entries = {item.entry.facts.id: item.entry for item in traced}
    for name, detail in _repetitions(by_name, card.epochs):
        first = by_name[name][0]
        trials[name] = unscored_trial(first.entry, first.trial.epoch, detail, first.trial.judgements)
        findings.append(LogFinding(kind="sample-repeated", sample=name, detail=detail))
    models = [item.models for item in traced]
    findings += [LogFinding(kind="card-differs", detail=detail) for detail in card_contradictions(models, card)]
    expected_runs = (header.eval.dataset.samples or 0) * (header.eval.config.epochs or 1)
    if header.status != "success" and len(by_name) < expected_runs:  # Reports state that the evaluation is unfinished.
        return list(trials.values()), tuple(findings)
    detail = "this run is missing from the log of a finished evaluation"
    for task in map(str, header.eval.dataset.sample_ids or entries):
        for epoch in range(1, card.epochs + 1):
            name = sample_name(task, epoch)
            if name in by_name:
                continue
            findings.append(LogFinding(kind="sample-missing", sample=name, detail=detail))
            entry = entries.get(task) or published_task_entry(task)
            if entry is not None:
                entries[task] = entry
                trials[name] = unscored_trial(entry, epoch, detail)
    if card.dataset_digest and digest(entries.values()) != card.dataset_digest:
        detail = "the digest of the tasks is not the one on the run card"
        findings.insert(0, LogFinding(kind="tasks-changed", detail=detail))
        trials = {name: _without_score(trial, entries[trial.task.id], detail) for name, trial in trials.items()}
    return list(trials.values()), tuple(findings)


def _without_score(trial: Trial, entry: Entry, reason: str) -> Trial:
    """Return an unscored copy of a trial."""
    return unscored_trial(entry, trial.epoch, reason, trial.judgements)


def _repetitions(by_name: dict[str, list[TracedTrial]], epochs: int) -> Iterator[tuple[str, str]]:
    """Yield the name of each repeated or copied sample, and the reason why it does not count."""
    for name, copies in by_name.items():
        if len(copies) > 1:
            yield name, f"the log contains {len(copies)} samples of this run"
        elif copies[0].trial.epoch > epochs:
            yield name, f"this is repeat {copies[0].trial.epoch}, but the card states {epochs}"
    uses = Counter(item.trace_digest for copies in by_name.values() for item in copies[:1] if item.trace_digest)
    for name, copies in by_name.items():
        if len(copies) == 1 and copies[0].trial.epoch <= epochs and uses[copies[0].trace_digest] > 1:
            yield name, "its trace is also the trace of another run"
