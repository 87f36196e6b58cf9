"""Feedback on runs and on individual calls."""

from __future__ import annotations

import time
from typing import Any

from sqlalchemy import RowMapping, delete, insert, select

from scope_ptz.errors import InputError, UnknownNameError
from scope_ptz.store.database import Database
from scope_ptz.store.queries import run_number, utc_time
from scope_ptz.store.rows import FeedbackRow
from scope_ptz.store.schema import FEEDBACK, STEPS

MAX_COMMENT_CHARS = 4_000


def add_feedback(
    database: Database, run_id: str, rating: int, comment: str = "", *, actor: str = "", position: int | None = None
) -> FeedbackRow:
    """Store a rating and a comment. It replaces earlier feedback by the same person on the same run or call.

    Args:
        database: The database.
        run_id: The run.
        rating: 1 for good, -1 for bad, 0 for a comment without a rating.
        comment: The comment; may be empty.
        actor: The person who gave the feedback.
        position: Index of the call that the feedback is about, from 0; None for the whole run.

    Raises:
        UnknownNameError: There is no such run, or no such call.
        InputError: There is neither a rating nor a comment, or the comment is too long.
    """
    if rating not in (-1, 0, 1):
        raise InputError(f"A rating must be 1 (good), -1 (bad) or 0 (a comment alone); got {rating}.")
    if rating == 0 and not comment.strip():
        raise InputError("Feedback must have a rating or a comment.")
    if len(comment) > MAX_COMMENT_CHARS:
        raise InputError(f"A comment must have at most {MAX_COMMENT_CHARS} characters; got {len(comment)}.")
    values: dict[str, Any] = {"rating": rating, "comment": comment.strip(), "actor": actor, "created": time.time()}
    with database.write_transaction() as connection:
        number = run_number(connection, run_id)
        if position is not None:
            positions = connection.execute(select(STEPS.c.position).where(STEPS.c.run == number)).scalars().all()
            if position not in positions:
                raise UnknownNameError("call", str(position), [str(known_position) for known_position in positions])
        same_subject = FEEDBACK.c.position.is_(None) if position is None else FEEDBACK.c.position == position
        connection.execute(delete(FEEDBACK).where(FEEDBACK.c.run == number, same_subject, FEEDBACK.c.actor == actor))
        key = connection.execute(
            insert(FEEDBACK).values(run=number, position=position, **values).returning(FEEDBACK.c.id)
        ).scalar_one()
    return FeedbackRow(id=key, run=run_id, position=position, **{**values, "created": utc_time(values["created"])})


def feedback_on(database: Database, run_id: str) -> list[FeedbackRow]:
    """Return all feedback on a run, oldest first.

    Raises:
        UnknownNameError: There is no such run.
    """
    with database.read_transaction() as connection:
        number = run_number(connection, run_id)
        rows = connection.execute(select(FEEDBACK).where(FEEDBACK.c.run == number).order_by(FEEDBACK.c.id)).mappings().all()
    return [_feedback(row, run_id) for row in rows]


def remove_feedback(database: Database, feedback_id: int, *, actor: str | None = None) -> None:
    """Remove one feedback entry.

    Args:
        database: The database.
        feedback_id: The id of the entry.
        actor: The person who must have given the feedback; None permits any person.

    Raises:
        UnknownNameError: There is no such entry, or another person gave it.
    """
    conditions = [FEEDBACK.c.id == feedback_id]
    if actor is not None:
        conditions.append(FEEDBACK.c.actor == actor)
    with database.write_transaction() as connection:
        if not connection.execute(delete(FEEDBACK).where(*conditions)).rowcount:
            raise UnknownNameError("feedback", str(feedback_id), ())


def _feedback(row: RowMapping, run_id: str) -> FeedbackRow:
    fields = {name: row[name] for name in FeedbackRow.model_fields}
    return FeedbackRow(**{**fields, "run": run_id, "created": utc_time(row["created"])})
