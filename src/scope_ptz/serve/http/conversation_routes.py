"""Routes for conversations.

A conversation is visible only to its owner: clients whose token has the same name as the token that started it.
"""

from __future__ import annotations

from functools import partial
from typing import Annotated

from fastapi import APIRouter, Path, Query, Response

from scope_ptz.serve.http.dependencies import Operator, SiteDep, Viewer
from scope_ptz.serve.http.errors import responses
from scope_ptz.serve.http.models import ConversationChange, ConversationStart
from scope_ptz.store.conversations import (
    add_conversation,
    list_conversations,
    load_conversation,
    touch_conversation,
)
from scope_ptz.store.conversations import remove_conversation as remove_stored_conversation
from scope_ptz.store.rows import ConversationRow

router = APIRouter(prefix="/conversations", tags=["conversations"])
ConversationId = Annotated[str, Path(min_length=1, max_length=60)]


@router.get("", responses=responses(503))
async def conversations(
    site: SiteDep, client: Viewer, camera: Annotated[str | None, Query(max_length=120)] = None
) -> list[ConversationRow]:
    """List the client's conversations, most recently used first."""
    return await site.library.in_thread(partial(list_conversations, site.library.store.database, owner=client.name, camera=camera))


@router.post("", status_code=201, responses=responses(404, 503))
async def start_conversation(site: SiteDep, client: Operator, body: ConversationStart) -> ConversationRow:
    """Start a conversation about a camera. Instructions in it may refer to earlier ones."""
    camera, pair = site.station(body.camera).name, site.pairs.check(body.pair)
    title = body.title.encode("utf-8", "replace").decode()
    return await site.library.in_thread(
        partial(add_conversation, site.library.store.database, camera=camera, pair=pair, owner=client.name, title=title)
    )


@router.get("/{conversation}", responses=responses(404, 503))
async def conversation_state(site: SiteDep, client: Viewer, conversation: ConversationId) -> ConversationRow:
    """Return a conversation. `GET /runs?conversation=...` lists its runs."""
    return await site.library.in_thread(partial(load_conversation, site.library.store.database, conversation, owner=client.name))


@router.patch("/{conversation}", responses=responses(404, 503))
async def change_conversation(
    site: SiteDep, client: Operator, conversation: ConversationId, body: ConversationChange
) -> ConversationRow:
    """Change the title or the pair of a conversation."""
    database = site.library.store.database
    await site.library.in_thread(partial(load_conversation, database, conversation, owner=client.name))
    pair = None if body.pair is None else site.pairs.check(body.pair)
    title = None if body.title is None else body.title.encode("utf-8", "replace").decode()
    await site.library.in_thread(partial(touch_conversation, database, conversation, title=title, pair=pair))
    return await site.library.in_thread(partial(load_conversation, database, conversation, owner=client.name))


@router.delete("/{conversation}", status_code=204, responses=responses(404, 503))
async def remove_conversation(site: SiteDep, client: Operator, conversation: ConversationId) -> Response:
    """Remove a conversation. Its runs are kept."""
    await site.library.in_thread(partial(remove_stored_conversation, site.library.store.database, conversation, owner=client.name))
    site.library.forget(conversation)
    return Response(status_code=204)
