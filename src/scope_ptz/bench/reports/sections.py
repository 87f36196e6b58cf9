"""The sections and charts of a report."""

from __future__ import annotations

from dataclasses import dataclass

from scope_ptz.bench.reports.tables import ReportTable


@dataclass(frozen=True, slots=True)
class Chart:
    """A chart as SVG. ``alt`` is its text alternative. It scrolls in windows narrower than ``width_px``."""

    key: str
    title: str
    alt: str
    svg: str
    width_px: int


@dataclass(frozen=True, slots=True)
class Section:
    """A section. ``text`` are the paragraphs before charts and tables; ``folded`` are the keys of collapsed tables."""

    key: str
    title: str
    text: tuple[str, ...] = ()
    charts: tuple[Chart, ...] = ()
    tables: tuple[ReportTable, ...] = ()
    folded: frozenset[str] = frozenset()
