"""The sections and charts of a report."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

from scope_ptz.bench.reports.tables import ReportTable


@dataclass(frozen=True)
class Chart:
    """A chart, which is drawn on first use.

    Attributes:
        key: Key of the chart.
        title: Title of the chart.
        alt: The text alternative.
        width_px: Width of the chart in pixels. The chart scrolls in narrower windows.
        draw: Function that draws the chart as inline SVG.
    """

    key: str
    title: str
    alt: str
    width_px: int
    draw: Callable[[], str] = field(repr=False, compare=False)

    @cached_property
    def svg(self) -> str:
        """The chart as inline SVG."""
        return self.draw()


@dataclass(frozen=True, slots=True)
class Section:
    """A section of a report.

    Attributes:
        key: Key of the section.
        title: Title of the section.
        text: The paragraphs above the charts and tables.
        charts: The charts.
        tables: The tables.
        folded: Keys of the tables that are collapsed on the page.
    """

    key: str
    title: str
    text: tuple[str, ...] = ()
    charts: tuple[Chart, ...] = ()
    tables: tuple[ReportTable, ...] = ()
    folded: frozenset[str] = frozenset()
