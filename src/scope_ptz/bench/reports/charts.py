"""Draw the charts of a report as SVG, with text alternatives."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from statistics import fmean
from typing import TYPE_CHECKING, Any

from scope_ptz.bench.reports.chart_style import (
    FAINT,
    GREY,
    HUES,
    PAPER,
    bar_styles,
    canvas,
    create_chart,
    draw_legend_below,
    legend_height_px,
    panels,
    row_height_px,
    run_colours,
    shorten_label,
    wrap_label,
)
from scope_ptz.bench.reports.report_runs import ReportRun
from scope_ptz.bench.reports.sections import Chart
from scope_ptz.bench.reports.tables import MarkedCell, ReportTable, cell_value
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.statistics.clustered import IntervalEstimate

if TYPE_CHECKING:
    from matplotlib.artist import Artist


def accuracy_chart(runs: Sequence[ReportRun]) -> Chart:
    """Draw macro accuracies with their intervals, best first.

    Runs on other tasks have hollow markers and are drawn below the rest. Unranked runs are grey and come last.
    """
    ordered = sorted(runs, key=lambda r: (r.ranked, not r.task_difference, r.macro.value if r.macro else 0.0))
    colour_of_run = run_colours(runs)
    labels = [wrap_label(r.label + ("" if r.ranked else " (not ranked)")) for r in ordered]
    with canvas(880, 110 + row_height_px(labels) * len(ordered)) as (figure, axes):
        for y, run in enumerate(ordered):
            macro, colour = run.macro, colour_of_run[run.label]
            if macro is None:
                continue
            if macro.low is not None and macro.high is not None:
                axes.plot([100 * macro.low, 100 * macro.high], [y, y], color=colour, lw=2.5, solid_capstyle="round")
            face = PAPER if run.task_difference else colour
            axes.plot(100 * macro.value, y, "o" if run.ranked else "D", mec=colour, mfc=face, mew=2, ms=7, clip_on=False)
        axes.set_yticks(range(len(ordered)), labels)
        axes.set_xlim(0, 101)
        axes.set_ylim(-0.6, len(ordered) - 0.4)
        axes.set_xlabel("Macro accuracy (%), 95% interval")
        values = "; ".join(f"{r.label} {100 * r.macro.value:.1f}%" for r in reversed(ordered) if r.macro)
        title = "Macro accuracy" + (". Hollow: runs on other tasks" if any(r.task_difference for r in runs) else "")
        return create_chart("chart-accuracy", title, f"Macro accuracy by run, best first: {values}.", figure)


MAX_GROUPED_RUNS = 8
"""Maximum number of runs in a chart with grouped bars. More bars would be hard to distinguish."""


def mode_chart(
    key: str,
    title: str,
    runs: Sequence[ReportRun],
    counts: Mapping[str, Counter[ErrorMode]],
    trials: Mapping[str, int],
    titles: Mapping[ErrorMode, str],
    all_runs: Sequence[ReportRun],
) -> Chart:
    """Draw grouped bars, with one group per error mode. If there are many runs, draw panels with one row per run instead.

    Args:
        key: Key of the chart.
        title: Title of the chart.
        runs: The runs in the chart.
        counts: For each run label, the number of trials with each error mode.
        trials: For each run label, the number of trials.
        titles: The titles of the error modes.
        all_runs: The runs in all charts of this kind in the report, so that a run has the same fill in every chart.
    """
    from matplotlib.patches import Patch

    if len(runs) > MAX_GROUPED_RUNS:
        return _mode_panels(key, title, runs, counts, trials, titles, all_runs)
    handles: list[Artist] = []
    fills = dict(zip((run.label for run in all_runs), bar_styles(all_runs), strict=True))
    labels = [shorten_label(run.label + ("" if run.ranked else " (not ranked)"), 120) for run in runs]
    with canvas(980, 370 + legend_height_px(labels)) as (figure, axes):
        width = 0.84 / max(1, len(runs))
        for number, (run, words) in enumerate(zip(runs, labels, strict=True)):
            heights = [100 * counts[run.label][mode] / max(1, trials[run.label]) for mode in titles]
            positions = [group - 0.42 + (number + 0.5) * width for group in range(len(titles))]
            (fill, hatch), edge = fills[run.label], "none" if run.ranked else "#22262b"
            # Bars of zero height are omitted, because their edges would appear as dashes on the axis.
            bars = [(x, height) for x, height in zip(positions, heights, strict=True) if height]
            axes.bar([x for x, _ in bars], [y for _, y in bars], width * 0.92, color=fill, hatch=hatch, edgecolor=edge, lw=0.6)
            handles.append(Patch(facecolor=fill, hatch=hatch, edgecolor=edge, lw=0.6, label=words))
        for group in range(1, len(titles)):
            axes.axvline(group - 0.5, color=FAINT, lw=1)
        axes.grid(axis="x", visible=False)
        axes.set_xticks(range(len(titles)), [words.replace(" ", "\n", 1) for words in titles.values()])
        axes.set_xlim(-0.5, len(titles) - 0.5)
        axes.set_ylim(bottom=0)
        axes.set_ylabel("Incorrect trials per 100")
        draw_legend_below(figure, labels, handles)
        return create_chart(f"chart-{key.replace('_', '-')}", title, _mode_alt(runs, counts, titles), figure)


def _mode_alt(runs: Sequence[ReportRun], counts: Mapping[str, Counter[ErrorMode]], titles: Mapping[ErrorMode, str]) -> str:
    totals = ", ".join(f"{words} {sum(counts[r.label][mode] for r in runs)}" for mode, words in titles.items())
    return f"Bars: incorrect trials by error mode and run. Trials over all runs: {totals}. The table below has all values."


def _mode_panels(
    key: str,
    title: str,
    runs: Sequence[ReportRun],
    counts: Mapping[str, Counter[ErrorMode]],
    trials: Mapping[str, int],
    titles: Mapping[ErrorMode, str],
    all_runs: Sequence[ReportRun],
) -> Chart:
    """Draw a panel per error mode with a row per run. All panels have the same scale."""
    ordered = [*(r for r in reversed(runs) if not r.ranked), *(r for r in reversed(runs) if r.ranked)]
    colour_of_run = run_colours(all_runs)
    labels = [wrap_label(run.label + ("" if run.ranked else " (not ranked)")) for run in ordered]
    rates = {mode: [100 * counts[r.label][mode] / max(1, trials[r.label]) for r in ordered] for mode in titles}
    with panels(1180, 110 + row_height_px(labels, 24) * len(ordered), len(titles)) as (figure, grid):
        for axes, (mode, words) in zip(grid, titles.items(), strict=True):
            axes.barh(range(len(ordered)), rates[mode], color=[colour_of_run[run.label] for run in ordered], height=0.72)
            axes.set_title(words.replace(" ", "\n", 1), fontsize=9.5)
            axes.grid(axis="y", visible=False)
            axes.set_xlim(0, 1.05 * max(1.0, *(rate for values in rates.values() for rate in values)))
            axes.tick_params(axis="y", length=0)
        grid[0].set_yticks(range(len(ordered)), labels)
        grid[0].set_ylim(-0.6, len(ordered) - 0.4)
        figure.supxlabel("Incorrect trials per 100", fontsize=10.5)
        return create_chart(f"chart-{key.replace('_', '-')}", title, _mode_alt(runs, counts, titles), figure)


MEASURED, CORRECTED, RERUN = ("o", HUES[0]), ("s", HUES[1]), ("D", HUES[2])
ORACLE_PANELS = (
    ("by the checks", (
        ("macro_checks", "measured", MEASURED), ("oracle_rules", "VLM errors counted as correct", CORRECTED),
        ("macro_rerun", "rerun with ground-truth perception", RERUN),
    )),
    ("by the judge", (("macro_judge", "measured", MEASURED), ("oracle_judge", "VLM errors counted as correct", CORRECTED))),
)  # fmt: skip
"""The panels of the oracle chart: the panel title and, for each series, the column, title, marker and colour.

Each panel uses either only verdicts of the checks or only verdicts of the judge.
"""


def oracle_chart(table: ReportTable) -> Chart:
    """Draw measured accuracy and accuracy with perfect perception, in a panel for the checks and a panel for the judge.

    Args:
        table: The oracle table, without the rows of means.
    """
    names = [column.name for column in table.columns]
    rows = [
        (str(row[0]), {name: _complete_value(cell) for name, cell in zip(names, row, strict=True)}) for row in reversed(table.rows)
    ]
    used_panels = [
        (words, series) for words, series in ORACLE_PANELS if any(v[name] is not None for _, v in rows for name, *_ in series)
    ]
    labels, parts, handles = [wrap_label(label) for label, _ in rows], [], dict[str, Any]()
    with panels(1080, 150 + row_height_px(labels, 34) * len(rows), max(1, len(used_panels))) as (figure, grid):
        for axes, (words, series) in zip(grid, used_panels, strict=False):
            for y, (label, values) in enumerate(rows):
                shares = [(title, 100 * value) for name, title, _ in series if (value := values[name]) is not None]
                if shares:
                    parts.append(f"{label} {words}: {', '.join(f'{title} {value:.1f}%' for title, value in shares)}")
                    axes.plot([min(v for _, v in shares), max(v for _, v in shares)], [y, y], color=GREY, lw=1.5, zorder=1)
            for name, title, (marker, colour) in series:
                points = [(100 * value, y) for y, (_, values) in enumerate(rows) if (value := values[name]) is not None]
                if points:
                    handles[title] = axes.plot(*zip(*points, strict=True), marker, color=colour, ms=9, alpha=0.9)[0]
            axes.set_title(f"Macro accuracy {words} (%)", fontsize=10.5, loc="left")
            axes.set_xlim(0, 102)
            axes.set_ylim(-0.6, len(rows) - 0.4)
        grid[0].set_yticks(range(len(rows)), labels)
        figure.set_layout_engine("constrained", wspace=0.05)
        figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=3, fontsize=9.5)
        return create_chart("chart-oracle", "The oracle setting", f"Macro accuracy by pair. {'; '.join(parts)}.", figure)


def _complete_value(cell: Any) -> float | None:
    """Return the value of a cell; None if a note states that it does not cover all tasks of the run."""
    return None if isinstance(cell, MarkedCell) and cell.note else _value(cell)


def _value(cell: Any) -> float | None:
    value = cell_value(cell)
    if isinstance(value, IntervalEstimate):
        return value.value
    return float(value) if isinstance(value, int | float) else None


def time_chart(runs: Sequence[ReportRun], titles: Mapping[str, str]) -> Chart:
    """Draw stacked bars with the mean seconds per stage, without the camera.

    The camera time is written next to each bar.
    """
    stages = ("planner_s", "perception_s", "tools_s")
    timed = [(run, [t.timings for t in run.scored_trials if t.timings.total_s > 0]) for run in runs]
    rows = [(run, {s: fmean(getattr(t, s) for t in timings) for s in titles}) for run, timings in reversed(timed) if timings]
    notes = [("" if r.ranked else " (not ranked)") + (" (contended)" if r.evaluation.card.contended else "") for r, _ in rows]
    labels = [wrap_label(run.label + note) for (run, _), note in zip(rows, notes, strict=True)]
    with canvas(980, 150 + row_height_px(labels, 30) * len(rows)) as (figure, axes):
        left = [0.0] * len(rows)
        for stage, colour in zip(stages, (HUES[0], HUES[1], HUES[2]), strict=True):
            widths = [mean[stage] for _, mean in rows]
            axes.barh(range(len(rows)), widths, left=left, color=colour, height=0.62, label=titles[stage])
            left = [a + b for a, b in zip(left, widths, strict=True)]
        for y, (_, mean) in enumerate(rows):
            words = f"{left[y]:.2f} s + camera {mean['capture_s']:.2f} s"
            axes.annotate(words, (left[y], y), (5, 0), textcoords="offset points", va="center", fontsize=9.5)
        axes.set_xlim(0, max(left) * 1.45)
        axes.set_ylim(-0.6, len(rows) - 0.4)
        axes.set_yticks(range(len(rows)), labels)
        axes.grid(axis="y", visible=False)
        axes.set_xlabel("Mean wall-clock seconds per trial without the camera, by stage")
        figure.legend(loc="outside lower center", ncols=3, fontsize=9.5)
        totals = "; ".join(f"{r.label} {m['own_s']:.2f} s and the camera {m['capture_s']:.2f} s" for r, m in reversed(rows))
        alt = f"Mean wall-clock seconds of a trial by stage, without the camera. Totals: {totals}."
        return create_chart("chart-time", "Time of each pair by stage", alt, figure)


def repeats_chart(table: ReportTable, max_trials: int) -> Chart:
    """Draw pass^k for k from 1 to ``max_trials``."""
    labels = [shorten_label(str(row[0]), 100) for row in table.rows]
    with canvas(880, 330 + legend_height_px(labels)) as (figure, axes):
        parts = []
        for number, (row, words) in enumerate(zip(table.rows, labels, strict=True)):
            points = [(k, 100 * value) for k, cell in enumerate(row[2:], 1) if (value := _value(cell)) is not None]
            if points:
                hue, marker = HUES[number % len(HUES)], "os^Dvp*"[number % 7]
                axes.plot(*zip(*points, strict=True), marker=marker, color=hue, label=words, lw=2, ms=7)
                parts.append(f"{row[0]} from {points[0][1]:.1f}% to {points[-1][1]:.1f}%")
        axes.set_xticks(range(1, max_trials + 1))
        axes.set_ylim(0, 102)
        axes.set_xlabel("k")
        axes.set_ylabel("pass^k (%)")
        draw_legend_below(figure, labels)
        return create_chart("chart-repeats", "pass^k", f"pass^k falls with k: {'; '.join(parts)}.", figure)
