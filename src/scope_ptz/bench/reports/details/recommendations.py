"""The sections that help to choose a pair: Pareto front, memory, spreads, scopes, mixture-of-experts models, quantisation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import fmean

from scope_ptz.bench.reports.choice.candidates import Candidate, rank_candidates
from scope_ptz.bench.reports.choice.ties import ROUNDING, Distinctions, extreme_names, join_names
from scope_ptz.bench.reports.paired_comparison import compare, comparison_table
from scope_ptz.bench.reports.report_runs import FULL_PRECISION, ReportRun, is_mixture, scores_of
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, ReportTable
from scope_ptz.bench.statistics.clustered import proportion, proportion_difference
from scope_ptz.registry import Model

LATENCY_TITLE = "trial without the camera, median (s)"
"""Title of the latency columns."""
SIZES_GB = (8, 16, 24, 48, 80, 160)
"""Common accelerator memory sizes in GB. The last size corresponds to two accelerators with 80 GB each."""


def design_section(ranked: Sequence[ReportRun], all_runs: Sequence[ReportRun], distinctions: Distinctions) -> Section:
    """Return the section on the accuracy, latency and memory of each pair, with the best pair for each memory size.

    Args:
        ranked: The runs of model pairs on the same tasks.
        all_runs: All runs in the report.
        distinctions: The pairs that the paired comparisons distinguish.
    """
    pairs = rank_candidates(ranked, all_runs)
    columns = (
        Column("run", "Run"),
        Column("macro", "Macro (%)", "share"),
        Column("latency_s", LATENCY_TITLE.capitalize(), "seconds"),
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
            ("yes" if c.on_front else "no") if c.is_complete else None,
        )
        for c in sorted(pairs, key=lambda c: -(c.accuracy or 0.0))
    )
    notes = (
        "Memory is computed from the registry (parameters at their precision, KV cache for 16,384 tokens, 1.5 GB for each server), "
        "not measured. A pair is on the Pareto front if no other pair is at least as good in accuracy, latency and memory, and "
        "better in one of them.",
    )
    text = (
        "Choose a pair on the Pareto front. If the comparisons do not show a difference in accuracy between two pairs, there is no "
        "reason to prefer the larger one. Latencies are comparable only if all of them were measured alone on the same machine.",
        "Latency is the time of planner, perception and tools, without the camera. It excludes the time for rendering, because "
        "that depends on the simulator and on the views that a pair requests.",
    )
    tables = (
        ReportTable("design_points", "Accuracy, latency and memory", columns, rows, notes),
        _memory_table(pairs, distinctions),
    )
    return Section("design", "Accuracy, latency, memory", text, (), tables)


def _memory_table(pairs: Sequence[Candidate], distinctions: Distinctions) -> ReportTable:
    columns = (
        Column("memory", "Memory"),
        Column("run", "Highest accuracy that fits"),
        Column("macro", "Macro (%)", "share"),
        Column("latency_s", LATENCY_TITLE.capitalize(), "seconds"),
        Column("memory_gb", "Memory (GB, computed)", "gb"),
        Column("tied", "Not distinguishable from it", "prose"),
    )
    rows: list[tuple[CellValue, ...]] = []
    for size in SIZES_GB:
        fitting = [c for c in pairs if c.memory_gb is not None and c.memory_gb <= size and c.accuracy is not None]
        if fitting:
            best = max(fitting, key=lambda c: (round(c.accuracy or 0.0, 9), -(c.latency_s or 0.0), -(c.memory_gb or 0.0)))
            tied = _tied_names(best, fitting, distinctions) or "none"
            rows.append((f"{size} GB", best.run.label, best.accuracy, best.latency_s, best.memory_gb, tied))
    notes = (
        f"Memory sizes of {', '.join(map(str, SIZES_GB))} GB. Sizes in which no pair fits are left out. Of pairs with equal "
        "accuracy, the fastest is shown and the others are marked as equal. The last column lists the pairs that fit, and whose "
        "difference from this pair the paired comparisons do not show.",
    )
    return ReportTable("memory_fits", "Highest accuracy by memory size", columns, tuple(rows), notes)


def _tied_names(best: Candidate, pairs: Sequence[Candidate], distinctions: Distinctions) -> str:
    """Return the names of the pairs that are not distinguishable from the best pair, sorted by accuracy."""
    tied = [c for c in pairs if c is not best and not distinctions.are_distinct(c.run, best.run)]
    tied.sort(key=lambda c: -(c.accuracy or 0.0))
    names = [
        c.run.label + (" (equal)" if abs((c.accuracy or 0.0) - (best.accuracy or 0.0)) < ROUNDING else "") for c in tied
    ]  # fmt: skip
    return join_names(names)


def spread_section(ranked: Sequence[ReportRun], distinctions: Distinctions) -> Section:
    """Return the section on how strongly accuracy depends on the planner and on the perception model.

    Args:
        ranked: The runs of model pairs on the same tasks.
        distinctions: The pairs that the paired comparisons distinguish.
    """
    tables = (
        _spread(
            "spread_planner",
            "Changing only the planner",
            "Fixed perception model",
            ranked,
            lambda r: r.system[1],
            lambda r: r.system[0],
            distinctions,
        ),
        _spread(
            "spread_eyes",
            "Changing only the perception model",
            "Fixed planner",
            ranked,
            lambda r: r.system[0],
            lambda r: r.system[1],
            distinctions,
        ),
    )
    text = (
        "The spread is the highest macro accuracy minus the lowest while one model of the pair is fixed. It increases with the "
        "number of pairs and with noise. The last column states whether the paired comparisons show a difference between the "
        "lowest and the highest pair. Models with equal values share a cell.",
    )
    return Section("spread", "Spread by planner and by perception model", text, (), tables)


def _spread(
    key: str,
    title: str,
    fixed_title: str,
    runs: Sequence[ReportRun],
    fixed_model: Callable[[ReportRun], str],
    changed_model: Callable[[ReportRun], str],
    distinctions: Distinctions,
) -> ReportTable:
    columns = (
        Column("held", fixed_title),
        Column("pairs", "Pairs", "count"),
        Column("lowest", "Lowest"),
        Column("low", "Macro (%)", "share"),
        Column("highest", "Highest"),
        Column("high", "Macro (%)", "share"),
        Column("spread", "Spread (points)", "points"),
        Column("differ", "Differ"),
    )
    rows: list[tuple[CellValue, ...]] = []
    for name in dict.fromkeys(fixed_model(run) for run in runs):
        fixed_runs = [run for run in runs if fixed_model(run) == name and run.macro and run.system[2:] == ("scope", "")]
        values = [(run.macro.value, changed_model(run)) for run in fixed_runs if run.macro]
        if len({model for _, model in values}) < 2:
            rows.append((name, len(values), *(None,) * 6))
            continue
        low, high = min(values)[0], max(values)[0]
        if high - low < ROUNDING:
            rows.append((name, len(values), "all equal", low, "all equal", high, 0.0, "not shown"))
            continue
        worst, best = extreme_names(values)
        ends = [[run for run in fixed_runs if run.macro and abs(run.macro.value - end) < ROUNDING] for end in (low, high)]
        differs = any(distinctions.are_distinct(lowest, highest) for lowest in ends[0] for highest in ends[1])
        rows.append((name, len(values), worst, low, best, high, high - low, "yes" if differs else "not shown"))
    notes = ("This table covers only runs of SCOPE's own agent loop with its standard prompt.",)
    return ReportTable(key, title, columns, tuple(rows), notes)


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
    ranked = [row for row, run in zip(rows, runs, strict=True) if run.ranked and not run.task_difference]
    if len(ranked) > 1:
        counts = [sum(int(str(row[index])) for row in ranked) for index in (1, 3)]
        rows.append(("Mean of the model pairs", counts[0], _mean(ranked, 2), counts[1], _mean(ranked, 4), _mean(ranked, 5)))
    text = (
        "This section compares the micro accuracy of tasks about the current view and about the full scene. These tasks also "
        "differ in category, so the panorama is not the only cause of the difference. The interval of the difference combines the "
        "intervals of the two proportions (Newcombe 1998). It is missing if either of these is missing.",
    )
    return Section("scope", "Current view against full scene", text, (), (ReportTable("scope", "By scope", columns, tuple(rows)),))


def _scope_row(run: ReportRun) -> tuple[CellValue, ...]:
    parts = {scope: [t for t in run.scored_trials if t.task.scope == scope] for scope in ("current", "full")}
    current, full = (scores_of(parts[scope]) for scope in ("current", "full"))
    return (
        run.label,
        len(parts["current"]),
        proportion(current),
        len(parts["full"]),
        proportion(full),
        proportion_difference(current, full),
    )


def _mean(rows: Sequence[tuple[CellValue, ...]], index: int) -> float | None:
    values = [v for row in rows if (v := getattr(row[index], "value", None)) is not None]
    return fmean(values) if values else None


def architecture_section(ranked: Sequence[ReportRun], all_runs: Sequence[ReportRun]) -> Section:
    """Return the section that compares mixture-of-experts models with dense models, and quantised models with full precision."""
    pairs = [(q, f) for q in ranked for f in ranked if _is_quantised_pair(q, f)]
    comparisons = [c for quantised, full in pairs if (c := compare(quantised, full)) is not None]
    notes = (
        "The models have the same family, size and number of active parameters in the registry, and the rest of the pair is the "
        "same. The latency and memory of these pairs are in the table of accuracy, latency and memory.",
    )
    precision = comparison_table("quantised", "Quantised minus full precision", comparisons, notes)
    text = [
        "The registry states which models are mixture-of-experts models or quantised. Models that are not in the registry are "
        "left out."
    ]
    if not comparisons:
        text.append("No two pairs differ only in precision, so quantisation is not measured.")
    tables = (_mixture_table(ranked, all_runs), *((precision,) if comparisons else ()))
    return Section("architecture", "Mixture-of-experts models and quantisation", tuple(text), (), tables)


def _is_quantised_pair(quantised: ReportRun, full: ReportRun) -> bool:
    """Return whether two runs use the same pair except that one model in ``quantised`` is quantised."""
    if quantised.task_set != full.task_set or quantised.system[2:] != full.system[2:]:
        return False
    if quantised.system[1] == full.system[1]:
        return _is_quantised_model(quantised.planner, full.planner)
    return quantised.system[0] == full.system[0] and _is_quantised_model(quantised.perception, full.perception)


def _is_quantised_model(quantised: Model | None, full: Model | None) -> bool:
    """Return whether ``quantised`` is the quantised version of the full-precision model ``full``."""
    if quantised is None or full is None:
        return False
    if (quantised.family, quantised.size_b, quantised.active_b) != (full.family, full.size_b, full.active_b):
        return False
    return bool(quantised.family) and quantised.precision not in FULL_PRECISION and full.precision in FULL_PRECISION


def _mixture_table(ranked: Sequence[ReportRun], all_runs: Sequence[ReportRun]) -> ReportTable:
    """Return a table with a row for each model that was paired with both mixture-of-experts and dense models."""
    columns = [Column("held", "Fixed model"), Column("changed", "Changed model")]
    for key, title in (("moe", "Mixtures"), ("dense", "Dense")):
        columns += [
            Column(f"{key}_pairs", f"{title}: pairs", "count"),
            Column(f"{key}_macro", f"{title}: macro, mean (%)", "share"),
            Column(f"{key}_latency_s", f"{title}: {LATENCY_TITLE}", "seconds"),
            Column(f"{key}_memory_gb", f"{title}: memory (GB, computed)", "gb"),
        ]
    columns.append(Column("difference", "Mixtures minus dense (points)", "points"))
    pairs = rank_candidates(ranked, all_runs)
    rows: list[tuple[CellValue, ...]] = []
    for role, other_role in (("planner", 1), ("perception", 0)):
        for name in dict.fromkeys(c.run.system[other_role] for c in pairs):
            same_model = [c for c in pairs if c.run.system[other_role] == name and getattr(c.run, role)]
            kinds = [[c for c in same_model if is_mixture(getattr(c.run, role)) is mixture] for mixture in (True, False)]
            if all(kinds):
                cells = [v for k in kinds for v in (len(k), *(_average(k, f) for f in ("accuracy", "latency_s", "memory_gb")))]
                moe, dense = (_average(kind, "accuracy") for kind in kinds)
                gain = None if moe is None or dense is None else moe - dense
                rows.append((name, "planners" if role == "planner" else "perception models", *cells, gain))
    notes = (
        "Values are means over the pairs with mixtures and over the pairs with dense models. Fixed models that were paired with "
        "only one kind are left out.",
    )
    return ReportTable("mixtures", "Mixture-of-experts models against dense models", tuple(columns), tuple(rows), notes)


def _average(pairs: Sequence[Candidate], field: str) -> float | None:
    values = [value for c in pairs if (value := getattr(c, field)) is not None]
    return fmean(values) if values else None
