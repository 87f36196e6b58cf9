"""Chart styling: a colour-blind-safe palette, and inline SVG with the colours and fonts of the page."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from scope_ptz.bench.reports.report_runs import ReportRun
from scope_ptz.bench.reports.sections import Chart

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK, FAINT, PAPER = "#010203", "#040506", "#070809"
"""Placeholder colours, which ``_draw_inline_svg`` replaces with the CSS colours of the page."""
HUES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442")
"""The colour-blind-safe palette of Okabe and Ito (2008)."""
GREY = "#8a8f98"
GREYS, HATCHES = ("#c9ccd1", "#9a9fa8", "#757b85", "#b3b7bd"), ("////", "....", "xxxx", "----", "\\\\\\\\")
"""Fills and hatches for unranked runs. Four greys and five hatches give twenty combinations."""
PX = 96.0
"""Pixels per inch."""
_SETTINGS: Any = {
    "svg.fonttype": "none", "svg.hashsalt": "scope",
    "text.parse_math": False, "font.family": "DejaVu Sans", "font.size": 10.5, "text.color": INK,
    "axes.edgecolor": INK, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK, "axes.spines.top": False,
    "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True, "grid.color": FAINT, "grid.linewidth": 0.7,
    "figure.facecolor": "none", "axes.facecolor": "none", "savefig.facecolor": "none", "legend.frameon": False,
}  # fmt: skip


@contextmanager
def canvas(width_px: int, height_px: int) -> Iterator[tuple[Figure, Axes]]:
    """Create a figure with one set of axes."""
    with panels(width_px, height_px, 1) as (figure, (axes,)):
        yield figure, axes


@contextmanager
def panels(width_px: int, height_px: int, number: int) -> Iterator[tuple[Figure, Sequence[Axes]]]:
    """Create a figure with several sets of axes side by side, which share the y axis."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with _style():
        figure = Figure(figsize=(width_px / PX, height_px / PX), dpi=PX, layout="constrained")
        FigureCanvasSVG(figure)
        yield figure, list(figure.subplots(1, number, sharey=True, squeeze=False)[0])


@contextmanager
def _style() -> Iterator[None]:
    """Apply the chart style while a figure is created or drawn."""
    import matplotlib as mpl

    with mpl.rc_context(_SETTINGS), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph")  # Missing glyphs affect only estimated widths; the browser draws them.
        yield


def create_chart(key: str, title: str, alt: str, figure: Figure, prepare: Callable[[], None] | None = None) -> Chart:
    """Create a chart from a figure. The figure is drawn on first use, after ``prepare`` has completed it."""
    return Chart(key, title, alt, round(figure.get_figwidth() * PX), partial(_draw_inline_svg, key, figure, prepare))


def _draw_inline_svg(key: str, figure: Figure, prepare: Callable[[], None] | None) -> str:
    """Draw a figure as inline SVG, with unique ids and the page's colours and fonts."""
    out = io.StringIO()
    with _style():
        if prepare is not None:
            prepare()
        figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    svg = out.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r'\bid="', f'id="{key}-', svg)
    svg = re.sub(r'(href="#|url\(#)', rf"\g<1>{key}-", svg)
    svg = svg.replace(INK, "var(--ink)").replace(FAINT, "var(--line)").replace(PAPER, "var(--paper)")
    svg = re.sub(r"font: ([\d.]+px) [^;\"]+", r"font: \1 system-ui, 'DejaVu Sans', sans-serif", svg)
    return svg.replace("<svg ", '<svg aria-hidden="true" focusable="false" ', 1)


_FILE_STYLE = (
    "<style>:root{--ink:#1b1f24;--line:#d8dee4;--paper:#ffffff}"
    "@media(prefers-color-scheme:dark){:root{--ink:#e6e9ed;--line:#363c44;--paper:#14171b}svg>g{filter:brightness(1.3)}}"
    "svg{background:var(--paper)}</style>"
)
"""Style sheet for charts in separate files, with the colours of the page."""


def standalone_svg(chart: Chart) -> str:
    """Return the content of an SVG file with a chart, including colours for light and dark themes."""
    start = chart.svg.index(">") + 1
    return chart.svg[:start] + _FILE_STYLE + chart.svg[start:]


def run_colours(runs: Sequence[ReportRun]) -> dict[str, str]:
    """Return the colour of each run, by label.

    Runs with the same perception model share a hue, and later runs have stronger shades. Unranked runs are grey.
    """
    ordered = sorted(runs, key=lambda run: run.number)  # This gives a run the same colour in every chart.
    perception = list(dict.fromkeys(run.perception_name for run in ordered if run.ranked))
    colour_of_run = {}
    for run in ordered:
        if not run.ranked:
            colour_of_run[run.label] = GREY
            continue
        name = run.perception_name
        same_perception = [r for r in ordered if r.ranked and r.perception_name == name]
        rank = (same_perception.index(run) + 1) / len(same_perception)
        colour_of_run[run.label] = _mix_with_grey(HUES[perception.index(name) % len(HUES)], 0.45 + 0.55 * rank)
    return colour_of_run


def _mix_with_grey(colour: str, strength: float) -> str:
    """Mix a colour with light grey, so that it is visible on both white and black. ``strength`` is the fraction of the colour."""
    parts = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return "#" + "".join(f"{round(part * strength + 205 * (1 - strength)):02x}" for part in parts)


def bar_styles(runs: Sequence[ReportRun]) -> list[tuple[str, str | None]]:
    """Return the fill and hatch for each run's bars. Unranked runs have a grey fill and a hatch instead of a hue."""
    colour_of_run, others = run_colours(runs), [run for run in runs if not run.ranked]
    styles: list[tuple[str, str | None]] = []
    for run in runs:
        if run.ranked:
            styles.append((colour_of_run[run.label], None))
        else:
            index = others.index(run)
            styles.append((GREYS[index % len(GREYS)], HATCHES[index % len(HATCHES)]))
    return styles


def shorten_label(label: str, max_chars: int = 46) -> str:
    """Shorten a label to ``max_chars`` characters, and replace unprintable characters with spaces."""
    printable = "".join(character if character.isprintable() else " " for character in label)
    return printable if len(printable) <= max_chars else printable[: max_chars - 1] + "…"


def wrap_label(label: str, max_chars: int = 46) -> str:
    """Wrap a label to at most three lines."""
    return "\n".join(wrap(shorten_label(label, 3 * max_chars - 8), max_chars, break_on_hyphens=False) or [""])


def legend_columns(labels: Sequence[str], max_chars: int = 58) -> int:
    """Return the number of legend columns: two if every label fits into half the width, otherwise one."""
    return 2 if len(labels) > 1 and max(map(len, labels)) <= max_chars else 1


def draw_legend_below(figure: Figure, labels: Sequence[str], handles: Sequence[Artist] = ()) -> None:
    """Draw a legend below the axes. ``handles`` are the legend's handles. Without them, the labelled artists are used."""
    columns = legend_columns(labels)
    loc: Any = "outside lower center" if columns == 2 else "outside lower left"
    figure.legend(**({"handles": handles} if handles else {}), loc=loc, ncols=columns, fontsize=9.5)


def legend_height_px(labels: Sequence[str]) -> int:
    """Return the height of the legend in pixels."""
    return 20 * -(-len(labels) // legend_columns(labels))


def row_height_px(labels: Sequence[str], min_px: int = 26) -> int:
    """Return the row height in pixels at which every label fits."""
    return max([min_px, *(8 + 16 * (1 + words.count("\n")) for words in labels)])
