"""Charts as SVG. Colour-blind-safe colours, text as text, axes in the colour of the page's ink: they work in light and dark."""

from __future__ import annotations

import io
import re
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from statistics import fmean
from typing import TYPE_CHECKING, Any

from scope_ptz.bench.error_modes import ErrorMode
from scope_ptz.bench.reports.runs import Run
from scope_ptz.bench.reports.sections import Chart
from scope_ptz.bench.reports.tables import Table, bare
from scope_ptz.bench.statistics.clustered import Estimate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from scope_ptz.bench.reports.choosing import Candidate

INK, FAINT = "#010203", "#040506"
"""Stand-ins that become the page's own colours."""
HUES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442")
"""Okabe and Ito (2008)."""
GREY = "#8a8f98"
PX = 96.0
_SETTINGS: Any = {
    "svg.fonttype": "none", "svg.hashsalt": "scope",
    "text.parse_math": False, "font.family": "DejaVu Sans", "font.size": 10.5, "text.color": INK,
    "axes.edgecolor": INK, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK, "axes.spines.top": False,
    "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True, "grid.color": FAINT, "grid.linewidth": 0.7,
    "figure.facecolor": "none", "axes.facecolor": "none", "savefig.facecolor": "none", "legend.frameon": False,
}  # fmt: skip


@contextmanager
def _canvas(width_px: int, height_px: int) -> Iterator[tuple[Figure, Axes]]:
    import matplotlib as mpl
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with mpl.rc_context(_SETTINGS), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph")  # The reader's browser has the glyphs; only their width is guessed here.
        figure = Figure(figsize=(width_px / PX, height_px / PX), dpi=PX, layout="constrained")
        FigureCanvasSVG(figure)
        yield figure, figure.subplots()


def _chart(key: str, title: str, alt: str, figure: Figure) -> Chart:
    """The figure as inline SVG: ids of its own, the page's colours and fonts."""
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    svg = out.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r'\bid="', f'id="{key}-', svg)
    svg = re.sub(r'(href="#|url\(#)', rf"\g<1>{key}-", svg)
    svg = svg.replace(INK, "var(--ink)").replace(FAINT, "var(--line)")
    svg = re.sub(r"font: ([\d.]+px) [^;\"]+", r"font: \1 system-ui, 'DejaVu Sans', sans-serif", svg)
    svg = svg.replace("<svg ", '<svg aria-hidden="true" focusable="false" ', 1)
    return Chart(key, title, alt, svg, round(figure.get_figwidth() * PX))


def colours(runs: Sequence[Run]) -> dict[str, str]:
    """A hue for each pair of eyes, lighter for smaller planners, as in the paper's figure; grey for what is not ranked."""
    eyes = list(dict.fromkeys(run.evaluation.card.perception.name for run in runs if run.ranked))
    found = {}
    for run in runs:
        if not run.ranked:
            found[run.label] = GREY
            continue
        name = run.evaluation.card.perception.name
        same = [r for r in runs if r.ranked and r.evaluation.card.perception.name == name]
        place = (same.index(run) + 1) / len(same)
        found[run.label] = _mixed(HUES[eyes.index(name) % len(HUES)], 0.45 + 0.55 * place)
    return found


def _mixed(colour: str, share: float) -> str:
    """A colour mixed with light grey, so that it shows on white and on black."""
    parts = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return "#" + "".join(f"{round(part * share + 205 * (1 - share)):02x}" for part in parts)


def _short(label: str, most: int = 46) -> str:
    """A label that fits, without characters that no picture can hold."""
    shown = "".join(mark if mark.isprintable() else " " for mark in label)
    return shown if len(shown) <= most else shown[: most - 1] + "…"


def accuracy_chart(runs: Sequence[Run]) -> Chart:
    """Macro accuracy with its interval, the best on top, reference runs below and grey."""
    ordered = sorted(runs, key=lambda r: (r.ranked, r.macro.value if r.macro else 0.0))
    tint = colours(runs)
    with _canvas(880, 110 + 26 * len(ordered)) as (figure, axes):
        for y, run in enumerate(ordered):
            found = run.macro
            if found is None:
                continue
            if found.low is not None and found.high is not None:
                axes.plot([100 * found.low, 100 * found.high], [y, y], color=tint[run.label], lw=2.5, solid_capstyle="round")
            axes.plot(100 * found.value, y, "o" if run.ranked else "D", color=tint[run.label], ms=7)
        axes.set_yticks(range(len(ordered)), [_short(r.label) + ("" if r.ranked else " (not ranked)") for r in ordered])
        axes.set_xlim(0, 101)
        axes.set_ylim(-0.6, len(ordered) - 0.4)
        axes.set_xlabel("Macro accuracy (%), 95% interval")
        values = "; ".join(f"{r.label} {100 * r.macro.value:.1f}%" for r in reversed(ordered) if r.macro)
        return _chart("chart-accuracy", "Macro accuracy", f"Macro accuracy by run, best first: {values}.", figure)


def mode_chart(
    key: str,
    title: str,
    runs: Sequence[Run],
    counted: Mapping[str, Counter[ErrorMode]],
    of: Mapping[str, int],
    titles: Mapping[ErrorMode, str],
) -> Chart:
    """Grouped bars, a group for each error mode; ``of``: how many trials a run's counts are out of."""
    tint = colours(runs)
    with _canvas(980, 380 + 16 * ((len(runs) + 1) // 2)) as (figure, axes):
        width = 0.84 / max(1, len(runs))
        for number, run in enumerate(runs):
            heights = [100 * counted[run.label][mode] / max(1, of[run.label]) for mode in titles]
            at = [group - 0.42 + (number + 0.5) * width for group in range(len(titles))]
            axes.bar(at, heights, width * 0.92, color=tint[run.label], label=_short(run.label), hatch=None if run.ranked else "//")
        for group in range(1, len(titles)):
            axes.axvline(group - 0.5, color=FAINT, lw=1)
        axes.grid(axis="x", visible=False)
        axes.set_xticks(range(len(titles)), [words.replace(" ", "\n", 1) for words in titles.values()])
        axes.set_xlim(-0.5, len(titles) - 0.5)
        axes.set_ylabel("Failed trials of 100")
        figure.legend(loc="outside lower center", ncols=2, fontsize=9.5)
        totals = ", ".join(f"{words} {sum(counted[r.label][mode] for r in runs)}" for mode, words in titles.items())
        alt = f"Bars: failed trials by error mode and run. Trials over all runs: {totals}. The table below has every figure."
        return _chart(f"chart-{key.replace('_', '-')}", title, alt, figure)


def oracle_chart(table: Table) -> Chart:
    """Accuracy as it is, with perception's failures as right, and run again with ground-truth eyes."""
    names = [column.name for column in table.columns]
    series = (
        ("macro_checks", "as it is, by checks", "o", HUES[0]), ("oracle_rules", "rules' VLM failures as right", "s", HUES[1]),
        ("oracle_judge", "judge's VLM failures as right", "^", HUES[3]),
        ("macro_rerun", "run again with ground-truth eyes", "D", HUES[2]),
    )  # fmt: skip
    rows = list(reversed(table.rows))
    with _canvas(880, 150 + 30 * len(rows)) as (figure, axes):
        told = []
        for name, words, marker, colour in series:
            found = [(_value(row[names.index(name)]), y) for y, row in enumerate(rows)]
            points = [(100 * value, y) for value, y in found if value is not None]
            if points:
                axes.plot(*zip(*points, strict=True), marker, color=colour, ms=8, label=words, alpha=0.95)
                told.append(f"{words} {fmean(x for x, _ in points):.1f}% on average")
        axes.set_yticks(range(len(rows)), [_short(str(row[0])) for row in rows])
        axes.set_ylim(-0.6, len(rows) - 0.4)
        axes.set_xlim(0, 102)
        axes.set_xlabel("Macro accuracy (%)")
        figure.legend(loc="outside lower center", ncols=2, fontsize=9.5)
        return _chart("chart-oracle", "The oracle setting", f"Macro accuracy by pair: {'; '.join(told)}.", figure)


def _value(cell: Any) -> float | None:
    found = bare(cell)
    if isinstance(found, Estimate):
        return found.value
    return float(found) if isinstance(found, int | float) else None


def time_chart(runs: Sequence[Run], titles: Mapping[str, str]) -> Chart:
    """Mean seconds by stage, stacked."""
    stages = [stage for stage in titles if stage != "total_s"]
    timed = [(run, [t.timings for t in run.scored if t.timings.total_s > 0]) for run in runs]
    rows = [(run, {s: fmean(getattr(t, s) for t in own) for s in titles}) for run, own in timed if own]
    rows.reverse()
    with _canvas(880, 150 + 30 * len(rows)) as (figure, axes):
        left = [0.0] * len(rows)
        for stage, colour in zip(stages, (HUES[0], HUES[1], HUES[2], HUES[4]), strict=True):
            wide = [mean[stage] for _, mean in rows]
            axes.barh(range(len(rows)), wide, left=left, color=colour, height=0.62, label=titles[stage])
            left = [a + b for a, b in zip(left, wide, strict=True)]
        rest = [max(0.0, mean["total_s"] - sum(mean[s] for s in stages)) for _, mean in rows]
        axes.barh(range(len(rows)), rest, left=left, color=GREY, height=0.62, label="The rest")
        notes = ["" if not run.evaluation.card.contended else " (contended)" for run, _ in rows]
        axes.set_yticks(range(len(rows)), [_short(r.label, 40) + note for (r, _), note in zip(rows, notes, strict=True)])
        axes.grid(axis="y", visible=False)
        axes.set_xlabel("Mean wall seconds a trial, by stage")
        figure.legend(loc="outside lower center", ncols=5, fontsize=9.5)
        told = "; ".join(f"{r.label} {mean['total_s']:.2f} s" for r, mean in reversed(rows))
        return _chart("chart-time", "Where the time goes", f"Mean wall seconds of a trial, by stage. In all: {told}.", figure)


def front_chart(found: Sequence[Candidate]) -> Chart:
    """Accuracy against latency; the area of a point is its memory; those on the Pareto front are filled. Numbers lead to names."""
    from matplotlib.collections import PathCollection
    from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

    complete = [c for c in found if c.accuracy is not None and c.latency_s is not None and c.memory_gb is not None]
    complete.sort(key=lambda c: -(c.accuracy or 0.0))
    tint = colours([c.run for c in found])
    with _canvas(980, max(460, 150 + 26 * len(complete))) as (figure, axes):
        for number, c in enumerate(complete, 1):
            shade, at = tint[c.run.label], (c.latency_s or 0.0, 100 * (c.accuracy or 0.0))
            axes.scatter(
                *at,
                s=max(150.0, 10.0 * (c.memory_gb or 0.0)),
                facecolor=shade if c.on_front else "none",
                edgecolor=shade,
                lw=2,
                alpha=0.85,
                linestyle="--" if c.contended else "-",
                label=f"{number}  {_short(c.run.label, 40)}, {c.memory_gb:.0f} GB",
            )
            axes.annotate(
                str(number), at, ha="center", va="center", fontsize=9.5, fontweight="bold", color="#000" if c.on_front else INK
            )
        axes.set_xscale("log")
        axes.margins(x=0.12, y=0.14)
        axes.xaxis.set_major_locator(LogLocator(base=10, subs=(1.0, 2.0, 3.0, 5.0, 7.0)))
        axes.xaxis.set_major_formatter(ScalarFormatter())
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlabel("Median wall seconds of a trial (logarithmic)")
        axes.set_ylabel("Macro accuracy (%)")
        keys = figure.legend(loc="outside right upper", fontsize=9.5, labelspacing=0.9)
        for handle in keys.legend_handles:
            if isinstance(handle, PathCollection):
                handle.set_sizes([70.0])
        on = "; ".join(
            f"{c.run.label} {100 * (c.accuracy or 0):.1f}%, {c.latency_s:.2f} s, {c.memory_gb:.0f} GB"
            for c in complete
            if c.on_front
        )
        alt = f"Scatter: accuracy against latency, area by memory. On the Pareto front: {on}."
        title = "Accuracy, latency and memory. Filled: on the Pareto front; area: memory; broken outline: timed under contention"
        return _chart("chart-front", title, alt, figure)


def repeats_chart(table: Table, most: int) -> Chart:
    """pass^k by k."""
    with _canvas(760, 330 + 16 * ((len(table.rows) + 1) // 2)) as (figure, axes):
        told = []
        for number, row in enumerate(table.rows):
            points = [(k, 100 * value) for k, cell in enumerate(row[2:], 1) if (value := _value(cell)) is not None]
            if points:
                hue, marker = HUES[number % len(HUES)], "os^Dvp*"[number % 7]
                axes.plot(*zip(*points, strict=True), marker=marker, color=hue, label=_short(str(row[0])), lw=2, ms=7)
                told.append(f"{row[0]} from {points[0][1]:.1f}% to {points[-1][1]:.1f}%")
        axes.set_xticks(range(1, most + 1))
        axes.set_ylim(0, 102)
        axes.set_xlabel("k")
        axes.set_ylabel("pass^k (%)")
        figure.legend(loc="outside lower center", ncols=2, fontsize=9.5)
        return _chart("chart-repeats", "pass^k", f"pass^k falls with k: {'; '.join(told)}.", figure)
