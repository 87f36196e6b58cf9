"""Check the samples of a log as a whole: none is missing, repeated or copied, and the tasks are those of the run card.

A sample that is missing from a finished log, and every sample that occurs twice, gives an unscored trial, which counts as not
correct. If the tasks of a finished log are not those that its card was made for, no score of the log is used.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence

from inspect_ai.log import EvalLog

from scope_ptz.bench.engine.entries import Entry, digest
from scope_ptz.bench.engine.stored_run import sample_name
from scope_ptz.bench.engine.traces.named_models import card_contradictions
from scope_ptz.bench.engine.traces.scored_trials import entry_of_published, unscored
from scope_ptz.bench.engine.traces.traced_trials import TracedTrial
from scope_ptz.bench.scoring.trials import LogFinding, RunCard, Trial


def completed(traced: Sequence[TracedTrial], header: EvalLog, card: RunCard) -> tuple[list[Trial], tuple[LogFinding, ...]]:
    """Return the trials of a log without repeated samples and with missing ones, and all findings about the log.

    Args:
        traced: The trials of the samples in the log.
        header: The header of the log.
        card: The run card of the log.
    """
    findings = [finding for one in traced for finding in one.findings]
    by_name: dict[str, list[TracedTrial]] = defaultdict(list)
    for one in traced:
        by_name[one.trial.sample].append(one)
    trials = {name: same[0].trial for name, same in by_name.items()}
    entries = {one.entry.facts.id: one.entry for one in traced}
    for name, detail in _repeated(by_name, card.epochs):
        first = by_name[name][0]
        trials[name] = unscored(first.entry, first.trial.epoch, detail, first.trial.judgements)
        findings.append(LogFinding(kind="sample-repeated", sample=name, detail=detail))
    models = [one.models for one in traced]
    findings += [LogFinding(kind="card-differs", detail=detail) for detail in card_contradictions(models, card)]
    wanted = (header.eval.dataset.samples or 0) * (header.eval.config.epochs or 1)
    if header.status != "success" and len(by_name) < wanted:  # an unfinished evaluation, which reports name
        return list(trials.values()), tuple(findings)
    detail = "the log of a finished evaluation lacks this run"
    for task in map(str, header.eval.dataset.sample_ids or entries):
        for epoch in range(1, card.epochs + 1):
            name = sample_name(task, epoch)
            if name in by_name:
                continue
            findings.append(LogFinding(kind="sample-missing", sample=name, detail=detail))
            entry = entries.get(task) or entry_of_published(task)
            if entry is not None:
                entries[task] = entry
                trials[name] = unscored(entry, epoch, detail)
    if card.dataset_digest and digest(entries.values()) != card.dataset_digest:
        detail = "the digest of the tasks is not the one on the run card"
        findings.insert(0, LogFinding(kind="tasks-changed", detail=detail))
        trials = {name: _without_score(trial, entries[trial.task.id], detail) for name, trial in trials.items()}
    return list(trials.values()), tuple(findings)


def _without_score(trial: Trial, entry: Entry, reason: str) -> Trial:
    """Return a trial without its verdict."""
    return unscored(entry, trial.epoch, reason, trial.judgements)


def _repeated(by_name: dict[str, list[TracedTrial]], epochs: int) -> Iterator[tuple[str, str]]:
    """Yield the names of samples that occur several times or too often, and of those whose trace is a copy of another trace."""
    for name, same in by_name.items():
        if len(same) > 1:
            yield name, f"the log contains {len(same)} samples of this run"
        elif same[0].trial.epoch > epochs:
            yield name, f"this is repeat {same[0].trial.epoch}, but the card states {epochs}"
    uses = Counter(one.trace_digest for same in by_name.values() for one in same[:1] if one.trace_digest)
    for name, same in by_name.items():
        if len(same) == 1 and same[0].trial.epoch <= epochs and uses[same[0].trace_digest] > 1:
            yield name, "its trace is also the trace of another run"
