"""Query lists of runs, and the data for one run."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any, cast

from sqlalchemy import ColumnElement, Connection, RowMapping, Select, and_, case, exists, false, func, or_, select, text

from scope_ptz.errors import InputError, UnknownNameError
from scope_ptz.store.database import Database
from scope_ptz.store.matching import words_of
from scope_ptz.store.rows import FrameRow, RunFilter, RunRow, StepRow
from scope_ptz.store.schema import FEEDBACK, FRAMES, RUNS, STEPS

MAX_PAGE = 500
"""Maximum number of runs on a page."""

MAX_COUNT = 500
"""Matching runs are counted only up to this number, because an exact count of many runs is slow."""

_COMMON_WORD_RUNS = 1_000
"""Words that occur in at least this many runs are matched without the full-text index, because scanning from the newest
run finds a page of matches sooner."""


@dataclass(frozen=True, slots=True)
class RunPage:
    """A page of runs, newest first. ``next`` is the cursor for the next page; None on the last page."""

    runs: list[RunRow]
    next: str | None


@dataclass(frozen=True, slots=True)
class StoredRun:
    """A run with its calls and its pictures."""

    run: RunRow
    steps: list[StepRow]
    frames: list[FrameRow]


def list_runs(database: Database, run_filter: RunFilter, *, limit: int = 50, after: str | None = None) -> RunPage:
    """Return a page of runs, newest first.

    Args:
        database: The database.
        run_filter: The filter.
        limit: Maximum number of runs on the page, at most ``MAX_PAGE``.
        after: The cursor ``next`` from the previous page.

    Raises:
        InputError: The cursor or the limit is invalid.
    """
    if not 1 <= limit <= MAX_PAGE:
        raise InputError(f"A page must have 1 to {MAX_PAGE} runs; got {limit}.")
    query = select(*_COLUMNS).order_by(RUNS.c.started.desc(), RUNS.c.number.desc()).limit(limit + 1)
    if after is not None:
        started, number = _cursor(after)
        query = query.where(or_(RUNS.c.started < started, and_(RUNS.c.started == started, RUNS.c.number < number)))
        query = query.where(RUNS.c.started <= started)  # lets the database start in the middle of its index
    with database.read_transaction() as connection:
        found = connection.execute(query.where(*_conditions(connection, run_filter))).mappings().all()
        ratings = _ratings(connection, [row["number"] for row in found])
    runs = [_run(row, ratings) for row in found[:limit]]
    last = found[limit - 1] if len(found) > limit else None
    return RunPage(runs, None if last is None else f"{last['started']!r}:{last['number']}")


def count_matching(database: Database, run_filter: RunFilter, *, limit: int = MAX_COUNT) -> int:
    """Return the number of runs that match a filter, counted up to ``limit``."""
    with database.read_transaction() as connection:
        matching = select(RUNS.c.number).where(*_conditions(connection, run_filter)).limit(limit).subquery()
        return int(connection.execute(select(func.count()).select_from(matching)).scalar_one())


def load_run(database: Database, run_id: str) -> StoredRun:
    """Return the stored data for a run.

    Raises:
        UnknownNameError: There is no such run.
    """
    with database.read_transaction() as connection:
        row = connection.execute(select(*_COLUMNS).where(RUNS.c.id == run_id)).mappings().first()
        if row is None:
            raise UnknownNameError("run", run_id[:120], ())
        number = row["number"]
        steps = connection.execute(select(STEPS).where(STEPS.c.run == number).order_by(STEPS.c.position)).mappings().all()
        frames = connection.execute(select(FRAMES).where(FRAMES.c.run == number).order_by(FRAMES.c.name)).mappings().all()
        ratings = _ratings(connection, [number])
    return StoredRun(_run(row, ratings), [_step(step) for step in steps], [_frame(frame) for frame in frames])


def run_number(connection: Connection, run_id: str) -> int:
    """Return the primary key of a run in the database.

    Raises:
        UnknownNameError: There is no such run.
    """
    number = connection.execute(select(RUNS.c.number).where(RUNS.c.id == run_id)).scalar()
    if number is None:
        raise UnknownNameError("run", run_id[:120], ())
    return int(number)


def distinct_values(database: Database) -> dict[str, list[str]]:
    """Return the distinct values of the columns ``camera``, ``planner``, ``perception`` and ``outcome``, for menus."""
    values: dict[str, list[str]] = {}
    with database.read_transaction() as connection:
        for name in ("camera", "planner", "perception", "outcome"):
            # Each step jumps to the next value in the index; DISTINCT would read the whole index.
            query = text(
                f"WITH RECURSIVE v(x) AS (SELECT min({name}) FROM runs UNION ALL "  # noqa: S608 - one of four names
                f"SELECT (SELECT min({name}) FROM runs WHERE {name} > v.x) FROM v WHERE v.x IS NOT NULL) "
                "SELECT x FROM v WHERE x IS NOT NULL"
            )
            values[name] = [str(row[0]) for row in connection.execute(query)]
    return values


def utc_time(seconds: float) -> datetime:
    """Convert a stored time, in seconds since 1970, to a UTC datetime."""
    return datetime.fromtimestamp(seconds, UTC)


_COLUMNS = [column for column in RUNS.c if column.name != "trace_bytes"]


def _conditions(connection: Connection, run_filter: RunFilter) -> list[ColumnElement[bool]]:
    conditions: list[ColumnElement[bool]] = []
    for name in ("kind", "camera", "planner", "perception", "outcome", "conversation", "actor"):
        if (value := getattr(run_filter, name)) is not None:
            conditions.append(RUNS.c[name] == value)
    if run_filter.since is not None:
        conditions.append(RUNS.c.started >= run_filter.since.timestamp())
    if run_filter.until is not None:
        conditions.append(RUNS.c.started < run_filter.until.timestamp())
    if run_filter.tool is not None:
        conditions.append(exists().where(STEPS.c.tool == run_filter.tool, STEPS.c.run == RUNS.c.number))
    if run_filter.rating is not None:
        conditions.append(RUNS.c.number.in_(select(FEEDBACK.c.run).where(FEEDBACK.c.rating == run_filter.rating)))
    if run_filter.text.strip():
        conditions.append(_contains(connection, run_filter.text))
    return conditions


def _contains(connection: Connection, query: str) -> ColumnElement[bool]:
    """Return the condition that a run contains all words in ``query``. The last word may be incomplete."""
    words = words_of(query)
    if not words:
        return false()
    phrase = " ".join(f'"{word}"' for word in words[:-1]) + f' "{words[-1]}"*'
    limited_count = text(f"SELECT count(*) FROM (SELECT 1 FROM runs_text WHERE runs_text MATCH :words LIMIT {_COMMON_WORD_RUNS})")  # noqa: S608
    if connection.execute(limited_count, {"words": phrase}).scalar_one() < _COMMON_WORD_RUNS:
        condition = "runs.number IN (SELECT rowid FROM runs_text WHERE runs_text MATCH :words)"
        return cast("ColumnElement[bool]", text(condition).bindparams(words=phrase))
    return func.has_words(RUNS.c.instruction, RUNS.c.answer, " ".join(words)) == 1


def _cursor(after: str) -> tuple[float, int]:
    started, _, number = after.partition(":")
    try:
        return float(started), int(number)
    except ValueError:
        raise InputError(f"'{after[:60]}' is not a cursor. Use the value of `next` in the previous page.") from None


def _ratings(connection: Connection, numbers: Sequence[int]) -> dict[int, tuple[int, int]]:
    """Return the numbers of good and bad ratings for each run, by run number."""
    good = func.sum(case((FEEDBACK.c.rating > 0, 1), else_=0))
    bad = func.sum(case((FEEDBACK.c.rating < 0, 1), else_=0))
    query: Select[Any] = select(FEEDBACK.c.run, good, bad).where(FEEDBACK.c.run.in_(numbers)).group_by(FEEDBACK.c.run)
    return {int(run): (int(up), int(down)) for run, up, down in connection.execute(query)}


def _run(row: RowMapping, ratings: dict[int, tuple[int, int]]) -> RunRow:
    up, down = ratings.get(row["number"], (0, 0))
    fields = {name: row[name] for name in RunRow.model_fields if name in row}
    fields |= {"started": utc_time(row["started"]), "ended": None if row["ended"] is None else utc_time(row["ended"])}
    return RunRow(**fields, thumbs_up=up, thumbs_down=down)


def _step(row: RowMapping) -> StepRow:
    return StepRow(**{**{name: row[name] for name in StepRow.model_fields}, "arguments": json.loads(row["arguments"])})


def _frame(row: RowMapping) -> FrameRow:
    return FrameRow(name=row["name"], position=row["position"])
