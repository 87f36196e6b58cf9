"""The first section of a report: a chart and a table with the accuracy, latency and memory of each pair."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from scope_ptz.bench.reports.choice.candidates import REAL_TIME_S, Candidate, create_candidate, rank_candidates
from scope_ptz.bench.reports.choice.front_chart import front_chart
from scope_ptz.bench.reports.choice.ties import ROUNDING, Leaders, join_names
from scope_ptz.bench.reports.report_runs import ReportRun
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, MarkedCell, ReportTable, cell_text
from scope_ptz.bench.statistics.clustered import IntervalEstimate

CorrectedAccuracy = Callable[[ReportRun], IntervalEstimate | float | None]
"""Function that returns the chance-corrected accuracy of a run, or None if it is unknown."""
COLUMNS = (
    Column("run", "Pair"),
    Column("number", "No.", "count"),
    Column("choose", "Choose it for"),
    Column("standing", "Against the highest"),
    Column("macro", "Accuracy (%)", "share"),
    Column("corrected", "Chance-corrected (%)", "share"),
    Column("latency_s", "Seconds per turn, median", "seconds"),
    Column("p95_s", "p95", "seconds"),
    Column("inference_s", "Seconds per inference", "seconds"),
    Column("memory_gb", "Memory (GB)", "gb"),
    Column("isolation", "Agent"),
)
NOTES = (
    "Accuracy: macro average with its 95% interval. Against the highest: “not distinguishable” means that the paired comparisons "
    "do not show a difference from the highest accuracy. The order of these pairs has no meaning. A turn is one instruction, from "
    "start to answer, without the camera; “contended” means that other runs used the machine or the servers at the same time. "
    "Seconds per inference: the median of a planner step or of a perception call, whichever is slower; a control loop of 2 Hz "
    f"needs at most {REAL_TIME_S} s. Memory: computed from the registry for both models, not measured. "
    "Choose it for: a pair is on the Pareto front if no other pair is at least as good in accuracy, latency and memory, and better "
    "in one of them.",
    "Agent: “built in” is SCOPE's own loop. External agents run in-process (they can read the answers), isolated (in a separate "
    "process), sandboxed (without the network and the dataset's files) or hosted (the answers are on another machine). "
    "Baselines are not ranked.",
)


def choice_section(
    ranked: Sequence[ReportRun],
    others: Sequence[ReportRun],
    baselines: Sequence[ReportRun],
    all_runs: Sequence[ReportRun],
    best: Leaders | None,
    corrected: CorrectedAccuracy | None = None,
) -> Section:
    """Return the first section, which shows the best pairs by accuracy, latency and memory.

    Args:
        ranked: The runs of model pairs on the same tasks.
        others: The runs of model pairs on other tasks in the same task set.
        baselines: The unranked runs in the same task set.
        all_runs: All runs in the report. Latencies are taken from a run without contention, if there is one.
        best: The pairs with the highest accuracy, and the pairs that are not distinguishable from them.
        corrected: Returns the chance-corrected accuracy of a run.
    """
    pairs = sorted(rank_candidates(ranked, all_runs), key=lambda c: (-round(c.accuracy or 0.0, 9), c.latency_s or 0.0))
    reasons = _reasons(pairs, best)
    rows = [
        _row(c, number, _choice(c, reasons), best.standing(c.run) if best else None, corrected) for number, c in enumerate(pairs, 1)
    ]
    groups = {}
    for title, choose, runs in (("On other tasks, not comparable", "other tasks", others), ("Not ranked", "baseline", baselines)):
        if rows and runs:
            groups[len(rows)] = title
        rows += [_row(create_candidate(run, all_runs), None, choose, None, corrected) for run in runs]
    charts = (front_chart(pairs, [run for run in baselines if run.built_in]),) if any(c.is_complete for c in pairs) else ()
    table = ReportTable("choice", "Accuracy, latency and memory of each pair", COLUMNS, tuple(rows), NOTES, groups)
    return Section("choice", "Which pair to choose", _recommendations(pairs, best), charts, (table,))


def _choice(candidate: Candidate, reasons: Mapping[str, Sequence[str]]) -> str:
    """Return the criteria by which a pair is a good choice."""
    return "; ".join(reasons.get(candidate.run.label, ())) or ("Pareto front" if candidate.on_front else "–")


def _row(
    candidate: Candidate, number: int | None, choose: str, standing: str | None, corrected: CorrectedAccuracy | None
) -> tuple[CellValue, ...]:
    run = candidate.run
    return (
        run.label,
        "" if number is None else number,
        choose,
        "" if standing is None else standing,
        run.macro,
        corrected(run) if corrected is not None else None,
        _latency(candidate),
        candidate.p95_s,
        _inference(candidate),
        candidate.memory_gb,
        isolation_title(run),
    )


def _latency(candidate: Candidate) -> CellValue:
    value = candidate.latency_s
    return MarkedCell(value, note="contended") if value is not None and candidate.contended else value


def _inference(candidate: Candidate) -> CellValue:
    value = candidate.inference_s
    return MarkedCell(value, note="2 Hz") if value is not None and value <= REAL_TIME_S else value


def isolation_title(run: ReportRun) -> str:
    """Describe how a run's agent was isolated from the answers."""
    if run.kind == "person":
        return "a person"
    return run.evaluation.card.isolation or "built in"


def _reasons(pairs: Sequence[Candidate], best: Leaders | None) -> dict[str, list[str]]:
    """Return the criteria by which each pair is best, by run label. Pairs with equal values share a criterion."""
    reasons: dict[str, list[str]] = {}

    def add(reason: str, among: Sequence[Candidate], value: Callable[[Candidate], float | None]) -> None:
        values = [(v, c) for c in among if (v := value(c)) is not None]
        lowest = min((v for v, _ in values), default=0.0)
        first = [c for v, c in values if v < lowest + ROUNDING]
        if len(values) > len(first):  # If all values are equal, the criterion does not help to choose.
            for c in first:
                reasons.setdefault(c.run.label, []).append(reason + (" (equal)" if len(first) > 1 else ""))

    add("highest accuracy", pairs, lambda c: None if c.accuracy is None else -c.accuracy)
    if best is not None and best.close:
        top = [c for c in pairs if c.run in (*best.highest, *best.close)]
        add("fastest of those not distinguishable from the highest", top, lambda c: c.latency_s)
        add("least memory of those not distinguishable from the highest", top, lambda c: c.memory_gb)
    add("lowest latency", pairs, lambda c: c.latency_s)
    add("least memory", pairs, lambda c: c.memory_gb)
    return {label: _omit_implied(criteria) for label, criteria in reasons.items()}


def _omit_implied(reasons: Sequence[str]) -> list[str]:
    """Omit criteria that other criteria imply: the fastest of all pairs is also the fastest of the most accurate pairs."""
    implied = {"lowest latency": "fastest of", "least memory": "least memory of"}
    weaker = tuple(start for reason, start in implied.items() if reason in reasons)
    return [reason for reason in reasons if not weaker or not reason.startswith(weaker)]


def _recommendations(pairs: Sequence[Candidate], best: Leaders | None) -> tuple[str, ...]:
    """Return sentences that recommend pairs."""
    if best is None:
        return ("These runs include no pair of models, so nothing is ranked.",)
    lines = [accuracy_sentence(best)]
    top = [c for c in pairs if c.run in (*best.highest, *best.close)]
    if len(top) > 1:
        choices = [
            _lowest_sentence(
                "the fastest is", top, lambda c: c.latency_s, lambda c: f"{cell_text(c.latency_s, 'seconds')} s per turn"
            ),
            _lowest_sentence(
                "the least memory is needed by", top, lambda c: c.memory_gb, lambda c: f"{cell_text(c.memory_gb, 'gb')} GB"
            ),
        ]
        if text := "; ".join(filter(None, choices)):
            lines.append(f"Among these {len(top)} pairs, {text}.")
    real_time = [c for c in pairs if c.inference_s is not None and c.inference_s <= REAL_TIME_S]
    if any(c.inference_s is not None for c in pairs):
        number = f"{len(real_time)} of {len(pairs)} pairs" if real_time else "None of the pairs"
        lines.append(
            f"{number} {'meets' if len(real_time) == 1 else 'meet'} the 2 Hz bar: at most {REAL_TIME_S} s per inference (median)."
        )
    if any(c.contended for c in pairs):
        lines.append("Some latencies were measured under contention, so they are too high and not comparable with the others.")
    return tuple(lines)


def _lowest_sentence(
    words: str, pairs: Sequence[Candidate], value: Callable[[Candidate], float | None], format_value: Callable[[Candidate], str]
) -> str:
    """Name the pairs with the lowest value. Return an empty string if the value is unknown, or equal for all pairs."""
    values = [(v, c) for c in pairs if (v := value(c)) is not None]
    if not values:
        return ""
    lowest = min(v for v, _ in values)
    first = [c for v, c in values if v < lowest + ROUNDING]
    if len(first) == len(values) > 1:
        return ""
    return f"{words} {join_names([c.run.label for c in first])} ({format_value(first[0])})"


def accuracy_sentence(best: Leaders) -> str:
    """Return sentences that name the pairs with the highest accuracy and those that are not distinguishable from them."""
    highest, number = best.highest, len(best.highest) + len(best.close) + len(best.others)
    value = _accuracy(highest[0])
    if number == 1:
        return f"Macro accuracy of the only model pair, {highest[0].label}: {value}."
    if len(highest) == number:
        return f"All {number} model pairs have the same macro accuracy, {value}, so none is ahead."
    names = join_names([run.label for run in highest])
    lead = f"Highest macro accuracy: {names}, {value}" + (" each." if len(highest) > 1 else ".")
    if not best.close:
        return f"{lead} The paired comparisons show that every other pair is less accurate."
    close = join_names([f"{run.label} ({cell_text(run.macro.value, 'share')}%)" for run in best.close if run.macro])
    rest = {0: "", 1: " The remaining pair is shown to be less accurate."}.get(
        len(best.others), f" The remaining {len(best.others)} are shown to be less accurate."
    )
    return f"{lead} Not distinguishable from this in the paired comparisons: {close}.{rest}"


def _accuracy(run: ReportRun) -> str:
    if run.macro is None:
        return "not measured"
    _, _, certainty = cell_text(run.macro, "share").partition(" ")
    inside = certainty.strip("()")
    return f"{cell_text(run.macro.value, 'share')}% ({'' if inside.startswith('interval') else '95% interval '}{inside})"
