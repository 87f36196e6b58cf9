"""Write the leaderboard page: a self-contained HTML file. All text from submissions is escaped."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

from scope_ptz.bench.leaderboard.entries import LeaderboardEntry, RefusedSubmission, categories_of
from scope_ptz.bench.reports.tables import CellValue, Column, MarkedCell, cell_value
from scope_ptz.bench.reports.writer import cell
from scope_ptz.bench.statistics.clustered import IntervalEstimate
from scope_ptz.errors import OutputError
from scope_ptz.version import __version__

ROUNDING = 1e-9
"""Accuracies that differ by less than this are considered equal and have the same rank."""
MAX_REASON_CHARS = 300  # longer reasons for a refusal are truncated
BASELINE = "baseline"


@dataclass(frozen=True, slots=True)
class LeaderboardTable:
    """The table for one set of tasks.

    Attributes:
        title: Title with the name of the split or task file and the kind of perception.
        subtitle: Dataset version, number of tasks and digest.
        columns: The columns. The first one contains the rank.
        rows: The cells of each row.
    """

    title: str
    subtitle: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[CellValue, ...], ...]


def write_leaderboard(
    entries: Sequence[LeaderboardEntry], refused: Sequence[RefusedSubmission], out: Path, *, title: str = "SCOPE leaderboard"
) -> list[LeaderboardTable]:
    """Write the leaderboard page, and return its tables.

    Args:
        entries: The entries.
        refused: The submissions that are not listed.
        out: The HTML file.
        title: Title of the page.

    Raises:
        OutputError: The file cannot be written.
    """
    tables = leaderboard_tables(entries)
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(leaderboard_html(tables, refused, title), "utf-8")
    except OSError as error:
        raise OutputError(f"The leaderboard {out} cannot be written: {error.strerror}.") from error
    return tables


def leaderboard_tables(entries: Iterable[LeaderboardEntry]) -> list[LeaderboardTable]:
    """Return a table for each dataset, task set, number of repeats and kind of perception. The largest task set comes first."""

    def key(entry: LeaderboardEntry) -> tuple[int, str, str, int, bool]:
        header = entry.header
        return -header.tasks, header.card.dataset, header.tasks_digest, header.card.epochs, entry.uses_ground_truth

    return [_table(list(group)) for _, group in groupby(sorted(entries, key=key), key)]


def leaderboard_html(tables: Sequence[LeaderboardTable], refused: Sequence[RefusedSubmission], title: str) -> str:
    """Return the HTML of the page. Its only script sorts the tables, and the page also works without it."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("scope_ptz", "data/report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["cell"], environment.filters["order"] = cell, _sort_value
    script = environment.get_template("leaderboard.js.j2").render()
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    shown = [RefusedSubmission(r.file, r.reason[:MAX_REASON_CHARS]) for r in refused]
    return environment.get_template("leaderboard.html.j2").render(
        title=title,
        tables=tables,
        refused=shown,
        version=__version__,
        script_digest=digest,
    )


def rank_entries(entries: Sequence[LeaderboardEntry]) -> list[tuple[int | None, LeaderboardEntry]]:
    """Return entries with their ranks, best first.

    Entries with equal accuracies share a rank. Unranked entries are also sorted by accuracy.
    """

    def value(entry: LeaderboardEntry) -> float:
        return entry.accuracy.value if entry.accuracy is not None else -1.0

    ranked_entries: list[tuple[int | None, LeaderboardEntry]] = []
    for entry in sorted(entries, key=lambda e: (-value(e), e.name, e.file)):
        better = sum(other.ranked and value(other) > value(entry) + ROUNDING for other in entries)
        ranked_entries.append((better + 1 if entry.ranked else None, entry))
    return ranked_entries


def _table(entries: Sequence[LeaderboardEntry]) -> LeaderboardTable:
    header, task_set = entries[0].header, entries[0].task_set
    categories = categories_of(entries)
    columns = (
        Column("rank", "Rank", "count"), Column("name", "Team or agent"), Column("accuracy", "Accuracy (%)", "share"),
        Column("label", "Evaluated"), Column("perception", "Perception"),
        *(Column(name, f"{title} (%)", "share") for name, title in categories.items()),
        Column("latency", "Median run (s)", "seconds"), Column("date", "Date"), Column("dataset", "Dataset"),
    )  # fmt: skip
    rows = tuple(_row(rank, entry, categories) for rank, entry in rank_entries(entries))
    perception = "ground-truth perception" if entries[0].uses_ground_truth else "perception models"
    repeats = f", {header.card.epochs} runs of each" if header.card.epochs > 1 else ""
    subtitle = f"Dataset {header.card.dataset}, {header.tasks} tasks{repeats}, digest {header.tasks_digest[:12]}"
    return LeaderboardTable(f"{task_set.name}, {perception}", subtitle, columns, rows)


def _row(rank: int | None, entry: LeaderboardEntry, categories: Iterable[str]) -> tuple[CellValue, ...]:
    card = entry.header.card
    rank_cell: CellValue = rank if rank is not None else BASELINE if entry.is_baseline else "not ranked"
    broken = f"{entry.broken} of {len(entry.lines)} runs broken" if entry.broken else ""
    contended = "contended" if card.contended else ""
    return (
        rank_cell, MarkedCell(entry.name, note=card.variant), MarkedCell(entry.accuracy, note=broken), ", ".join(entry.labels),
        card.perception.name, *(entry.accuracy_in_category(name) for name in categories),
        MarkedCell(entry.latency_s, note=contended), card.started[:10], card.dataset,
    )  # fmt: skip


def _sort_value(value: CellValue) -> Any:
    """Return the value by which the page sorts a cell, or an empty string if the cell has no value."""
    plain = cell_value(value)
    if isinstance(plain, IntervalEstimate):
        return plain.value
    return "" if plain is None else plain
