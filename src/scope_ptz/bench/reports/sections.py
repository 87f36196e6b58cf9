"""What a report is made of."""

from __future__ import annotations

from dataclasses import dataclass

from scope_ptz.bench.reports.tables import ReportTable


@dataclass(frozen=True, slots=True)
class Chart:
    """An SVG picture. ``alt`` says what it shows to whoever cannot see it; ``width_px``: below it, it is scrolled, not shrunk."""

    key: str
    title: str
    alt: str
    svg: str
    width_px: int


@dataclass(frozen=True, slots=True)
class Section:
    """``text``: paragraphs before charts and tables; ``folded``: tables that are closed at first."""

    key: str
    title: str
    text: tuple[str, ...] = ()
    charts: tuple[Chart, ...] = ()
    tables: tuple[ReportTable, ...] = ()
    folded: frozenset[str] = frozenset()
