"""The chart of accuracy against latency, with memory as marker area, the Pareto front and the 2 Hz bar."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import TYPE_CHECKING, Any

from scope_ptz.bench.reports.chart_style import GREY, INK, canvas, create_chart, run_colours, wrap_label
from scope_ptz.bench.reports.choice.candidates import REAL_TIME_S, Candidate
from scope_ptz.bench.reports.choice.label_placement import place_labels
from scope_ptz.bench.reports.report_runs import ReportRun
from scope_ptz.bench.reports.sections import Chart

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PathCollection

MARKERS = "os^Dvph"
"""Marker shapes for perception models, so that they do not differ only in colour."""
MIN_AREA, AREA_PER_GB = 60.0, 2.6
"""Marker area in square points: ``MIN_AREA`` plus ``AREA_PER_GB`` for each GB of memory."""
SIZE_EXAMPLES_GB = (10, 40, 160)
"""Memory sizes shown in the legend."""
COARSE_TICKS, FINE_TICKS = (1.0, 2.0, 5.0), (1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0)
"""Ticks on the latency axis within each decade."""
NARROW_RATIO = 5.0
"""The fine ticks are used if the range of the latency axis spans less than this factor."""
NEAR_REAL_TIME_S = 2 * REAL_TIME_S
"""The 2 Hz bar is drawn if the fastest turn takes at most this many seconds."""


def front_chart(candidates: Sequence[Candidate], baselines: Sequence[ReportRun] = ()) -> Chart:
    """Draw accuracy against latency. Marker areas show memory, and filled markers are on the Pareto front.

    The number next to a marker refers to the legend and the table. Vertical lines are confidence intervals of the accuracy. The
    stepped line connects the pairs for which no other pair is both faster and more accurate.

    Args:
        candidates: The pairs in the order of their numbers.
        baselines: Runs of the built-in planner with ground truth, whose accuracies are drawn as horizontal lines.
    """
    complete = [(number, c) for number, c in enumerate(candidates, 1) if c.is_complete]
    colour_of_run = run_colours([c.run for c in candidates])
    perception = list(dict.fromkeys(c.run.perception_name for c in candidates))
    labels = [wrap_label(f"{number}  {c.run.label}, {c.memory_gb:.0f} GB", 52) for number, c in complete]
    lines = sum(1 + label.count("\n") for label in labels)
    with canvas(1040, max(500, 200 + 18 * lines)) as (figure, axes):
        _draw_baselines(axes, baselines)
        _draw_steps(axes, [c for _, c in complete])
        handles = []
        for _, c in complete:
            colour, marker = colour_of_run[c.run.label], MARKERS[perception.index(c.run.perception_name) % len(MARKERS)]
            _draw_interval(axes, c, colour)
            _draw_marker(axes, [_position(c)], _area(c.memory_gb or 0.0), colour, marker, c)
            handles.append(_draw_marker(axes, [], 90.0, colour, marker, c))
        has_bar = min(c.latency_s or 0.0 for _, c in complete) <= NEAR_REAL_TIME_S
        if has_bar:
            axes.axvline(REAL_TIME_S, color=INK, lw=1.3, ls=(0, (6, 3)))
            axes.annotate(
                "2 Hz (0.5 s)", (REAL_TIME_S, 0.01), (4, 0), xycoords=("data", "axes fraction"), textcoords="offset points"
            )
        _style(axes)
        _legends(figure, handles, labels)

        def place() -> None:
            figure.canvas.draw()  # Finalises the layout, on which the label positions depend.
            place_labels(axes, [(str(number), _position(c), sqrt(_area(c.memory_gb or 0.0)) / 2) for number, c in complete])

        return create_chart("chart-front", _title(complete, has_bar), _alt(complete, baselines), figure, place)


def _position(candidate: Candidate) -> tuple[float, float]:
    return candidate.latency_s or 0.0, 100 * (candidate.accuracy or 0.0)


def _area(memory_gb: float) -> float:
    return MIN_AREA + AREA_PER_GB * memory_gb


def _draw_baselines(axes: Axes, baselines: Sequence[ReportRun]) -> None:
    """Draw the accuracies of the baselines as horizontal lines, because markers at their latencies would stretch the axis."""
    for run in baselines:
        if run.macro is not None:
            level = 100 * run.macro.value
            axes.axhline(level, color=GREY, lw=1.2, ls=":")
            axes.annotate(
                f"{run.label} (baseline, {level:.1f}%)", (0.01, level), (0, 3), xycoords=("axes fraction", "data"),
                textcoords="offset points", fontsize=9.5,
            )  # fmt: skip


def _draw_steps(axes: Axes, candidates: Sequence[Candidate]) -> None:
    """Draw the Pareto front of accuracy and latency as a stepped line."""
    points = sorted(_position(c) for c in candidates)
    front = [
        (x, y)
        for x, y in points
        if not any(other != (x, y) and other[0] <= x and other[1] >= y for other in points)
    ]  # fmt: skip
    if len(front) > 1:
        axes.step(*zip(*front, strict=True), where="post", color=INK, lw=1.1, alpha=0.55, zorder=1)


def _draw_interval(axes: Axes, candidate: Candidate, colour: str) -> None:
    macro = candidate.run.macro
    if macro is not None and macro.low is not None and macro.high is not None:
        x = candidate.latency_s or 0.0
        axes.plot([x, x], [100 * macro.low, 100 * macro.high], color=colour, lw=1, alpha=0.45, zorder=1.5)


def _draw_marker(
    axes: Axes, points: Sequence[tuple[float, float]], area: float, colour: str, marker: str, candidate: Candidate
) -> PathCollection:
    """Draw a marker. It is filled if the pair is on the Pareto front, and has a dashed edge if it was timed under contention."""
    x, y = [point[0] for point in points], [point[1] for point in points]
    line_style: Any = (0, (2.2, 1.4)) if candidate.contended else "-"
    fill = colour if candidate.on_front else "none"
    edge = INK if candidate.on_front else colour
    return axes.scatter(
        x, y, s=area, marker=marker, facecolor=fill, edgecolor=edge, lw=1.3 if candidate.on_front else 1.8, linestyle=line_style,
        zorder=3,
    )  # fmt: skip


def _style(axes: Axes) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.set_xscale("log")
    axes.margins(x=0.1, y=0.08)
    left, right = axes.get_xlim()
    subs = FINE_TICKS if right / left < NARROW_RATIO else COARSE_TICKS
    axes.xaxis.set_major_locator(LogLocator(base=10, subs=subs))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("Median seconds per turn without the camera (logarithmic)")
    axes.set_ylabel("Macro accuracy (%), 95% interval")


def _legends(figure: Any, handles: Sequence[Any], labels: Sequence[str]) -> None:
    from matplotlib.lines import Line2D

    figure.legend(handles, labels, loc="outside right upper", fontsize=9.5, labelspacing=0.55, handletextpad=0.4)
    sizes = [
        Line2D([], [], ls="", marker="o", mfc="none", mec=INK, ms=sqrt(_area(size))) for size in SIZE_EXAMPLES_GB
    ]  # fmt: skip
    words = [f"{size} GB" + (" of memory" if size == SIZE_EXAMPLES_GB[-1] else "") for size in SIZE_EXAMPLES_GB]
    figure.legend(sizes, words, loc="outside lower left", ncols=len(words), fontsize=9.5, handletextpad=0.6, borderpad=1.0)


def _title(complete: Sequence[tuple[int, Candidate]], has_bar: bool) -> str:
    parts = ["Accuracy, latency and memory of each pair. Filled: no other pair is at least as good in all three"]
    if any(c.contended for _, c in complete):
        parts.append("Dashed edge: timed under contention")
    if not has_bar:
        fastest = min(c.latency_s or 0.0 for _, c in complete)
        parts.append(f"The 2 Hz bar (0.5 s) is off the left edge of the chart: the fastest turn takes {fastest:.1f} s")
    return ". ".join(parts)


def _alt(complete: Sequence[tuple[int, Candidate]], baselines: Sequence[ReportRun]) -> str:
    on_front = "; ".join(
        f"{c.run.label} {100 * (c.accuracy or 0):.1f}%, {c.latency_s:.2f} s, {c.memory_gb:.0f} GB"
        for _, c in complete
        if c.on_front
    )
    lines = "; ".join(f"{run.label} {100 * run.macro.value:.1f}%" for run in baselines if run.macro)
    return (
        f"Scatter: accuracy against latency without the camera, area by memory. On the Pareto front: {on_front}."
        + (f" Baselines: {lines}." if lines else "")
    )  # fmt: skip
