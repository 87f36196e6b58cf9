"""The sections that help to choose a pair: Pareto front, memory, spreads, scopes, mixtures of experts and quantisation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import fmean

from scope_ptz.bench.reports import charts as drawing
from scope_ptz.bench.reports.candidates import Candidate, candidates
from scope_ptz.bench.reports.paired_comparison import compare, comparison_table
from scope_ptz.bench.reports.report_runs import FULL_PRECISION, ReportRun, is_mixture, scores_of
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, ReportTable
from scope_ptz.bench.statistics.clustered import share, share_difference
from scope_ptz.registry import Model

LATENCY = "trial without the camera, median (s)"
SIZES_GB = (8, 16, 24, 48, 80, 160)
"""Common sizes of accelerator memory. The last one is two accelerators of 80 GB."""


def design_section(ranked: Sequence[ReportRun], every: Sequence[ReportRun]) -> Section:
    """Return the section on accuracy, latency and memory of each pair, with the best pair for each memory size."""
    found = candidates(ranked, every)
    columns = (
        Column("run", "Run"),
        Column("macro", "Macro (%)", "share"),
        Column("latency_s", LATENCY.capitalize(), "seconds"),
        Column("contended", "Measured"),
        Column("memory_gb", "Memory (GB, computed)", "gb"),
        Column("front", "On the Pareto front"),
    )
    rows = tuple(
        (
            c.run.label,
            c.accuracy,
            c.latency_s,
            "contended" if c.contended else "alone",
            c.memory_gb,
            ("yes" if c.on_front else "no") if c.complete else None,
        )
        for c in sorted(found, key=lambda c: -(c.accuracy or 0.0))
    )
    notes = (
        "Memory is computed from the registry (parameters at their precision, cache for 16,384 tokens, 1.5 GB for each server), "
        "not measured. A pair is on the front if no other pair is at least as accurate, as fast and as small, and better in one "
        "of these.",
    )
    text = (
        "Choose a pair that no other pair beats in accuracy, latency and memory at once. A difference in accuracy that was not "
        "shown (see the comparisons) is no reason to prefer the larger pair. Latencies are comparable only if all of them were "
        "measured alone on the same machine.",
        "Latency is the time of planner, perception and tools without the camera. The time for rendering frames belongs to the "
        "simulator and would rank pairs by the views that they asked for.",
    )
    charts = (drawing.front_chart(found),) if any(c.complete for c in found) else ()
    tables = (ReportTable("design_points", "Accuracy, latency and memory", columns, rows, notes), _fitting(found))
    return Section("design", "Accuracy, latency, memory", text, charts, tables)


def _fitting(found: Sequence[Candidate]) -> ReportTable:
    columns = (
        Column("memory", "Memory"),
        Column("run", "Most accurate pair that fits"),
        Column("macro", "Macro (%)", "share"),
        Column("latency_s", LATENCY.capitalize(), "seconds"),
        Column("memory_gb", "Memory (GB, computed)", "gb"),
    )
    rows: list[tuple[CellValue, ...]] = []
    for size in SIZES_GB:
        fitting = [c for c in found if c.memory_gb is not None and c.memory_gb <= size and c.accuracy is not None]
        if fitting:
            best = max(fitting, key=lambda c: (round(c.accuracy or 0.0, 9), -(c.latency_s or 0.0)))
            rows.append((f"{size} GB", best.run.label, best.accuracy, best.latency_s, best.memory_gb))
    notes = (f"Sizes: {', '.join(map(str, SIZES_GB))} GB. Sizes into which no pair fits are left out.",)
    return ReportTable("memory_fits", "Best pair by memory size", columns, tuple(rows), notes)


def spread_section(ranked: Sequence[ReportRun]) -> Section:
    """Return the section on how much accuracy depends on the planner and on the perception model."""
    tables = (
        _spread(
            "spread_planner",
            "Changing only the planner",
            "Fixed perception model",
            ranked,
            lambda r: r.system[1],
            lambda r: r.system[0],
        ),
        _spread(
            "spread_eyes",
            "Changing only the perception model",
            "Fixed planner",
            ranked,
            lambda r: r.system[0],
            lambda r: r.system[1],
        ),
    )
    text = (
        "The spread is the highest macro accuracy minus the lowest while one model of the pair is fixed. It grows with the number "
        "of pairs and with noise; the comparisons say which differences were shown.",
    )
    return Section("spread", "Spread by planner and by perception model", text, (), tables)


def _spread(
    key: str,
    title: str,
    held_title: str,
    runs: Sequence[ReportRun],
    held: Callable[[ReportRun], str],
    changed: Callable[[ReportRun], str],
) -> ReportTable:
    columns = (
        Column("held", held_title),
        Column("pairs", "Pairs", "count"),
        Column("lowest", "Lowest"),
        Column("low", "Macro (%)", "share"),
        Column("highest", "Highest"),
        Column("high", "Macro (%)", "share"),
        Column("spread", "Spread (points)", "points"),
    )
    rows: list[tuple[CellValue, ...]] = []
    for name in dict.fromkeys(held(run) for run in runs):
        own = [
            (run.macro.value, changed(run)) for run in runs if held(run) == name and run.macro and run.system[2:] == ("scope", "")
        ]
        if len({model for _, model in own}) > 1:
            (low, worst), (high, best) = min(own), max(own)
            rows.append((name, len(own), worst, low, best, high, high - low))
        else:
            rows.append((name, len(own), None, None, None, None, None))
    return ReportTable(key, title, columns, tuple(rows), ("Only runs of SCOPE's own agent loop with its standard prompt.",))


def scope_section(runs: Sequence[ReportRun]) -> Section:
    """Return the section that compares tasks about the current view with tasks about the full scene."""
    columns = (
        Column("run", "Run"),
        Column("current_trials", "Trials, current", "count"),
        Column("current", "Current view (%)", "share"),
        Column("full_trials", "Trials, full", "count"),
        Column("full", "Full scene (%)", "share"),
        Column("difference", "Current minus full (points)", "points"),
    )
    rows = [_scope_row(run) for run in runs]
    ranked = [row for row, run in zip(rows, runs, strict=True) if run.ranked and not run.other_tasks]
    if len(ranked) > 1:
        counts = [sum(int(str(row[index])) for row in ranked) for index in (1, 3)]
        rows.append(("Mean of the model pairs", counts[0], _mean(ranked, 2), counts[1], _mean(ranked, 4), _mean(ranked, 5)))
    text = (
        "Micro accuracy by the scope of the task. Tasks of the two scopes also differ in category, so the panorama is not the only "
        "cause of the difference. The interval of the difference combines the intervals of both sides (Newcombe 1998). It is "
        "unknown if one of them is unknown.",
    )
    return Section("scope", "Current view against full scene", text, (), (ReportTable("scope", "By scope", columns, tuple(rows)),))


def _scope_row(run: ReportRun) -> tuple[CellValue, ...]:
    parts = {scope: [t for t in run.scored_trials if t.task.scope == scope] for scope in ("current", "full")}
    current, full = (scores_of(parts[scope]) for scope in ("current", "full"))
    return run.label, len(parts["current"]), share(current), len(parts["full"]), share(full), share_difference(current, full)


def _mean(rows: Sequence[tuple[CellValue, ...]], index: int) -> float | None:
    known = [v for row in rows if (v := getattr(row[index], "value", None)) is not None]
    return fmean(known) if known else None


def architecture_section(ranked: Sequence[ReportRun], every: Sequence[ReportRun]) -> Section:
    """Return the section that compares mixtures of experts with dense models, and quantised models with full precision."""
    pairs = [(q, f) for q in ranked for f in ranked if _is_quantised_of(q, f)]
    found = [c for quantised, full in pairs if (c := compare(quantised, full)) is not None]
    notes = (
        "Models of one family, size and number of active parameters in the registry, with the rest of the pair unchanged. Latency "
        "and memory of these pairs are in the table of accuracy, latency and memory.",
    )
    precision = comparison_table("quantised", "Quantised minus full precision", found, notes)
    text = ["The registry says which models are mixtures of experts or quantised. Models that it does not contain are left out."]
    if not found:
        text.append("No two pairs differ only in precision, so quantisation is not measured.")
    tables = (_mixtures(ranked, every), *((precision,) if found else ()))
    return Section("architecture", "Mixtures of experts and quantisation", tuple(text), (), tables)


def _is_quantised_of(one: ReportRun, other: ReportRun) -> bool:
    """Return whether a pair equals another one except that one of its models is quantised."""
    if one.task_set != other.task_set or one.system[2:] != other.system[2:]:
        return False
    if one.system[1] == other.system[1]:
        return _quantised_of(one.planner, other.planner)
    return one.system[0] == other.system[0] and _quantised_of(one.perception, other.perception)


def _quantised_of(one: Model | None, other: Model | None) -> bool:
    if one is None or other is None or (one.family, one.size_b, one.active_b) != (other.family, other.size_b, other.active_b):
        return False
    return bool(one.family) and one.precision not in FULL_PRECISION and other.precision in FULL_PRECISION


def _mixtures(ranked: Sequence[ReportRun], every: Sequence[ReportRun]) -> ReportTable:
    """Return a table with a row for each model that is paired with both mixtures of experts and dense models."""
    columns = [Column("held", "Fixed model"), Column("changed", "Changed model")]
    for key, words in (("moe", "Mixtures"), ("dense", "Dense")):
        columns += [
            Column(f"{key}_pairs", f"{words}: pairs", "count"),
            Column(f"{key}_macro", f"{words}: macro, mean (%)", "share"),
            Column(f"{key}_latency_s", f"{words}: {LATENCY}", "seconds"),
            Column(f"{key}_memory_gb", f"{words}: memory (GB, computed)", "gb"),
        ]
    columns.append(Column("difference", "Mixtures minus dense (points)", "points"))
    found = candidates(ranked, every)
    rows: list[tuple[CellValue, ...]] = []
    for side, other in (("planner", 1), ("perception", 0)):
        for name in dict.fromkeys(c.run.system[other] for c in found):
            own = [c for c in found if c.run.system[other] == name and getattr(c.run, side)]
            kinds = [[c for c in own if is_mixture(getattr(c.run, side)) is mixture] for mixture in (True, False)]
            if all(kinds):
                cells = [v for k in kinds for v in (len(k), *(_average(k, w) for w in ("accuracy", "latency_s", "memory_gb")))]
                moe, dense = (_average(kind, "accuracy") for kind in kinds)
                apart = None if moe is None or dense is None else moe - dense
                rows.append((name, "planners" if side == "planner" else "perception models", *cells, apart))
    notes = ("Means over the pairs of each kind. A fixed model that was paired with only one kind is left out.",)
    return ReportTable("mixtures", "Mixtures of experts against dense models", tuple(columns), tuple(rows), notes)


def _average(found: Sequence[Candidate], what: str) -> float | None:
    known = [value for c in found if (value := getattr(c, what)) is not None]
    return fmean(known) if known else None
