"""The parts of a report: sections with charts and tables."""

from __future__ import annotations

from dataclasses import dataclass

from scope_ptz.bench.reports.tables import ReportTable


@dataclass(frozen=True, slots=True)
class Chart:
    """A chart as SVG. ``alt`` is its text alternative. In a window narrower than ``width_px`` it is scrolled."""

    key: str
    title: str
    alt: str
    svg: str
    width_px: int


@dataclass(frozen=True, slots=True)
class Section:
    """A section. ``text`` holds the paragraphs before charts and tables; ``folded`` names the tables that are collapsed."""

    key: str
    title: str
    text: tuple[str, ...] = ()
    charts: tuple[Chart, ...] = ()
    tables: tuple[ReportTable, ...] = ()
    folded: frozenset[str] = frozenset()
