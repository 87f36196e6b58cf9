"""A server's stored runs: their folders, their index, and the earlier turns of conversations."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TypeVar

import anyio
from anyio import to_thread

from scope_ptz.agent.trace import read_trace
from scope_ptz.errors import ScopeError, TraceError
from scope_ptz.planner.base import PastTurn
from scope_ptz.store.conversations import runs_of_conversation, touch_conversation
from scope_ptz.store.export import exchanges_of
from scope_ptz.store.run_store import RunStore

MAX_TURNS = 20
"""Maximum number of conversation turns that the planner receives."""

MAX_INDEX_WAIT_S = 2.0
"""Maximum time, in seconds, that a request to list runs waits for recently ended runs to be indexed."""

_T = TypeVar("_T")

logger = logging.getLogger(__name__)


class RunLibrary:
    """A server's runs folder, with its index. An index failure never stops a run.

    Args:
        root: The runs folder.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self.store = RunStore(root)
        self._turns: dict[str, tuple[PastTurn, ...]] = {}
        self._queue: asyncio.Queue[str] = asyncio.Queue()

    async def in_thread(self, work: Callable[[], _T]) -> _T:
        """Call a blocking function, such as one that reads the store, in a worker thread, and return its result."""
        return await to_thread.run_sync(work)

    def index_soon(self, run_id: str) -> None:
        """Queue a run for indexing."""
        self._queue.put_nowait(run_id)

    async def run(self) -> None:
        """Index all runs, including those left by a killed server; then index queued runs until cancelled."""
        await self._run_or_log(self.store.index)
        while True:
            run_id = await self._queue.get()
            # If indexing the run fails, index all runs.
            if not await self._run_or_log(partial(self.store.index_run, run_id)):
                await asyncio.sleep(1.0)
                await self._run_or_log(self.store.index)
            self._queue.task_done()

    async def wait_for_indexing(self, limit_s: float = MAX_INDEX_WAIT_S) -> None:
        """Wait up to ``limit_s`` seconds for all queued runs to be indexed, so that lists include recently ended runs."""
        with anyio.move_on_after(limit_s):
            await self._queue.join()

    async def turns(self, conversation: str) -> tuple[PastTurn, ...]:
        """Return a conversation's earlier turns, oldest first. After a restart, they are read from the run folders."""
        if conversation not in self._turns:
            self._turns[conversation] = await self.in_thread(lambda: self._stored_turns(conversation))
        return self._turns[conversation]

    async def add_turn(self, conversation: str, turn: PastTurn) -> None:
        """Add a turn to a conversation."""
        self._turns[conversation] = (*await self.turns(conversation), turn)[-MAX_TURNS:]
        await self._run_or_log(partial(touch_conversation, self.store.database, conversation))

    def forget(self, conversation: str) -> None:
        """Remove a conversation's cached turns."""
        self._turns.pop(conversation, None)

    def close(self) -> None:
        """Close the store."""
        self.store.close()

    def _stored_turns(self, conversation: str) -> tuple[PastTurn, ...]:
        turns = []
        for run_id in runs_of_conversation(self.store.database, conversation, limit=MAX_TURNS):
            try:
                trace = read_trace(self.store.folder(run_id))
            except TraceError:
                continue
            if trace.ended is not None and trace.ended.outcome != "cancelled":
                started = trace.started
                turn = PastTurn(
                    instruction=started.instruction,
                    exchanges=exchanges_of(trace),
                    reply=trace.ended.text,
                    start=started.pose.pose(),
                    viewpoint=started.viewpoint,
                )
                turns.append(turn)
        return tuple(turns)

    async def _run_or_log(self, work: Callable[[], object]) -> bool:
        try:
            await to_thread.run_sync(work)
        except (ScopeError, OSError) as error:
            logger.warning("The index of runs is not up to date: %s", error)
            return False
        return True
