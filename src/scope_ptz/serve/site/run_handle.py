"""Runs in progress, which any number of clients can follow."""

from __future__ import annotations

from collections.abc import AsyncGenerator
from dataclasses import dataclass

import anyio

from scope_ptz.agent.records import Called, Decided, Ended, Started
from scope_ptz.store.request_file import RunRequest

Record = Started | Decided | Called | Ended


@dataclass(frozen=True, slots=True)
class RunEvent:
    """A run's record with its number, counted from 0. A stored run's records have the same numbers."""

    number: int
    record: Record


class RunHandle:
    """A run in progress.

    Attributes:
        id: Name of the run folder.
        instruction: The instruction.
        request: The client that started the run, the camera, and the conversation.
        preview: The commands that a dry run would send, one sentence each.
        records: The records so far.
        cancel_scope: The cancel scope in which the run is executed.
        failure: The error that kept the run from starting or finishing; None if there is none.
        call_error: The error from the last tool call that failed; None if none failed.
        done: Set when the run has ended and there will be no more records.
    """

    def __init__(self, run_id: str, instruction: str, request: RunRequest) -> None:
        self.id, self.instruction, self.request = run_id, instruction, request
        self.preview: list[str] = []
        self.records: list[Record] = []
        self.cancel_scope = anyio.CancelScope()
        self.failure: Exception | None = None
        self.call_error: Exception | None = None
        self._changed = anyio.Event()
        self.done = anyio.Event()

    def add(self, record: Record) -> None:
        """Add a record and notify all followers."""
        self.records.append(record)
        self._wake()

    def finish(self, failure: Exception | None = None) -> None:
        """Record that the run has ended, and notify all followers that there will be no more records."""
        self.failure = failure
        self.done.set()
        self._wake()

    def cancel(self) -> None:
        """Cancel the run, which then ends with the outcome "cancelled"."""
        self.cancel_scope.cancel()

    @property
    def ended(self) -> Ended | None:
        """The record of the run's end; None while the run is in progress."""
        last = self.records[-1] if self.records else None
        return last if isinstance(last, Ended) else None

    async def wait_until_started(self) -> None:
        """Wait for the first record.

        Raises:
            ScopeError: The run failed or was cancelled before its first record.
        """
        while not self.records and not self.done.is_set():
            await self._changed.wait()
        if not self.records and self.failure is not None:
            raise self.failure

    async def events(self, after: int = -1) -> AsyncGenerator[RunEvent]:
        """Yield the records after record number ``after`` as they arrive, until the run ends."""
        number = after + 1
        while True:
            changed, done = self._changed, self.done.is_set()
            while number < len(self.records):
                yield RunEvent(number, self.records[number])
                number += 1
            if done:
                return
            await changed.wait()

    def _wake(self) -> None:
        changed, self._changed = self._changed, anyio.Event()
        changed.set()
