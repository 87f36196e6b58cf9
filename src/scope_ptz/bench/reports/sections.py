"""The sections and charts of a report."""

from __future__ import annotations

from dataclasses import dataclass

from scope_ptz.bench.reports.tables import ReportTable


@dataclass(frozen=True, slots=True)
class Chart:
    """A chart as inline SVG. ``alt`` is its text alternative. A window that is narrower than ``width_px`` scrolls the chart."""

    key: str
    title: str
    alt: str
    svg: str
    width_px: int


@dataclass(frozen=True, slots=True)
class Section:
    """A section of a report.

    Attributes:
        key: Key of the section.
        title: Title of the section.
        text: The paragraphs before charts and tables.
        charts: The charts.
        tables: The tables.
        folded: Keys of the tables that the page shows collapsed.
    """

    key: str
    title: str
    text: tuple[str, ...] = ()
    charts: tuple[Chart, ...] = ()
    tables: tuple[ReportTable, ...] = ()
    folded: frozenset[str] = frozenset()
