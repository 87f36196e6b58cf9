"""Conversations: sequences of related instructions, each with a camera and an owner."""

from __future__ import annotations

import secrets
import time

from sqlalchemy import RowMapping, delete, insert, select, update

from scope_ptz.errors import UnknownNameError
from scope_ptz.store.database import Database
from scope_ptz.store.queries import utc_time
from scope_ptz.store.rows import ConversationRow
from scope_ptz.store.schema import CONVERSATIONS, RUNS

MAX_TITLE_CHARS = 120


def add_conversation(database: Database, *, camera: str, pair: str, owner: str, title: str = "") -> ConversationRow:
    """Add a conversation with a random id that cannot be guessed."""
    now = time.time()
    values = {"camera": camera, "pair": pair, "owner": owner, "title": title[:MAX_TITLE_CHARS], "created": now, "updated": now}
    key = secrets.token_urlsafe(12)
    with database.write_transaction() as connection:
        connection.execute(insert(CONVERSATIONS).values(id=key, **values))
    return ConversationRow(id=key, **{**values, "created": utc_time(now), "updated": utc_time(now)})  # type: ignore[arg-type]


def load_conversation(database: Database, key: str, *, owner: str) -> ConversationRow:
    """Return a conversation.

    Raises:
        UnknownNameError: The owner has no such conversation.
    """
    query = select(CONVERSATIONS).where(CONVERSATIONS.c.id == key, CONVERSATIONS.c.owner == owner)
    with database.read_transaction() as connection:
        row = connection.execute(query).mappings().first()
    if row is None:
        raise UnknownNameError("conversation", key[:60], ())
    return _conversation(row)


def list_conversations(database: Database, *, owner: str, camera: str | None = None, limit: int = 50) -> list[ConversationRow]:
    """Return the conversations of an owner, most recently used first."""
    query = select(CONVERSATIONS).where(CONVERSATIONS.c.owner == owner)
    if camera is not None:
        query = query.where(CONVERSATIONS.c.camera == camera)
    with database.read_transaction() as connection:
        rows = connection.execute(query.order_by(CONVERSATIONS.c.updated.desc()).limit(limit)).mappings().all()
    return [_conversation(row) for row in rows]


def touch_conversation(database: Database, key: str, *, title: str | None = None, pair: str | None = None) -> None:
    """Record that a conversation was used, and optionally change its title or its pair of models."""
    values: dict[str, object] = {"updated": time.time()}
    if title is not None:
        values["title"] = title[:MAX_TITLE_CHARS]
    if pair is not None:
        values["pair"] = pair
    with database.write_transaction() as connection:
        connection.execute(update(CONVERSATIONS).where(CONVERSATIONS.c.id == key).values(**values))


def remove_conversation(database: Database, key: str, *, owner: str) -> None:
    """Remove a conversation. Its runs are kept, but no longer belong to a conversation.

    Raises:
        UnknownNameError: The owner has no such conversation.
    """
    with database.write_transaction() as connection:
        removed = connection.execute(delete(CONVERSATIONS).where(CONVERSATIONS.c.id == key, CONVERSATIONS.c.owner == owner))
        if not removed.rowcount:
            raise UnknownNameError("conversation", key[:60], ())
        connection.execute(update(RUNS).where(RUNS.c.conversation == key).values(conversation=None))


def runs_of_conversation(database: Database, key: str, *, limit: int = 20) -> list[str]:
    """Return the ids of the most recent finished runs of a conversation, oldest first."""
    query = select(RUNS.c.id).where(RUNS.c.conversation == key, RUNS.c.kind == "instruction", RUNS.c.ended.is_not(None))
    with database.read_transaction() as connection:
        ids = connection.execute(query.order_by(RUNS.c.started.desc(), RUNS.c.number.desc()).limit(limit)).scalars().all()
    return list(reversed(ids))


def _conversation(row: RowMapping) -> ConversationRow:
    fields = {name: row[name] for name in ConversationRow.model_fields}
    return ConversationRow(**{**fields, "created": utc_time(row["created"]), "updated": utc_time(row["updated"])})
