"""Describe evaluations with incomplete results: those that ended in an error, were interrupted, or had many failures."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.bench.judging.judgement_tally import lacks_verdict
from scope_ptz.bench.reports.report_runs import ReportRun, macro, scores_of
from scope_ptz.bench.reports.tables import cell_text
from scope_ptz.bench.scoring.trials import Trial

MAX_UNREPORTED_LOSS_FRACTION = 0.02
"""Fraction of trials lost to infrastructure failures above which the report states the loss at the top."""
MAX_MESSAGE_CHARS = 160
"""Maximum length of an error message in characters. Longer messages are truncated."""


def describe_problems(runs: Sequence[ReportRun]) -> tuple[str, ...]:
    """Return a description of each evaluation that ended in an error, is unfinished, or lost more than 2% of its trials.

    Each description states bounds: the accuracy if all lost trials were incorrect, and if all of them were correct.
    """
    return tuple(text for run in runs if (text := _problem(run)))


def _problem(run: ReportRun) -> str:
    evaluation = run.evaluation
    missing = max(0, evaluation.wanted - len(evaluation.trials))
    # It is not known which of the missing trials would have been included in accuracy.
    included = evaluation.trials if missing else run.main_trials or evaluation.trials
    trials = [t for t in included if not lacks_verdict(t)]
    lost = [t for t in trials if t.headline == "infrastructure"]
    causes = []
    if evaluation.failure:
        causes.append(f"the log ended in an error ({_shorten(evaluation.failure)})")
    if missing:
        causes.append(f"it is unfinished: {len(evaluation.trials)} of {evaluation.wanted} trials were run")
    if trials and len(lost) / len(trials) > MAX_UNREPORTED_LOSS_FRACTION:
        share = cell_text(len(lost) / len(trials), "share")
        causes.append(f"{len(lost)} of {len(trials)} trials ({share}%) were lost to infrastructure failures")
    return f"{run.label}: {'; '.join(causes)}. {_bounds_text(trials, lost, missing)}" if causes else ""


def _bounds_text(trials: Sequence[Trial], lost: Sequence[Trial], missing: int) -> str:
    """State the accuracy without the lost trials, and its bounds.

    If trials are missing, the bounds apply to micro accuracy, because the categories of missing trials are unknown.
    """
    scored = [t for t in trials if t.headline != "infrastructure"]
    if not lost and not missing:
        return "No trials were lost."
    if not scored:
        return "No trial can be scored, so the accuracy is unknown (0.0% to 100.0%)."
    if missing:
        correct, total = sum(t.headline == "correct" for t in scored), len(trials) + missing
        name, values = "Micro", (correct / len(scored), correct / total, (correct + len(lost) + missing) / total)
    else:
        measured = macro(scores_of(scored))
        lowest, highest = (
            macro(scores_of(trials, [t.headline == "correct" or (t.headline == "infrastructure" and right) for t in trials]))
            for right in (False, True)
        )
        estimates = [estimate.value if estimate else 0.0 for estimate in (measured, lowest, highest)]
        name, values = "Macro", (estimates[0], estimates[1], estimates[2])
    value, low, high = (cell_text(v, "share") for v in values)
    return (
        f"{name} accuracy is {value}% without the lost and missing trials, {low}% if all of them were incorrect, and {high}% if "
        "all of them were correct."
    )


def _shorten(message: str) -> str:
    line = " ".join(message.split())
    return line if len(line) <= MAX_MESSAGE_CHARS else line[: MAX_MESSAGE_CHARS - 1] + "…"
