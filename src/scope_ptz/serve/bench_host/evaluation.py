"""The host's view of one participant's evaluation: its phase, and the messages exchanged.

The host knows a run only by an opaque key. The worker, which knows the tasks, offers runs one after another.
"""

from __future__ import annotations

import asyncio
import logging
from collections import deque
from dataclasses import dataclass
from typing import Literal

from scope_ptz.bench.agents.messages import (
    MAX_MESSAGE_BYTES,
    PROTOCOL,
    End,
    Error,
    Hello,
    HostMessage,
    TaskMessage,
    parse_agent_message,
)
from scope_ptz.errors import PlannerError, ScopeError
from scope_ptz.serve.bench_host.journal import Journal
from scope_ptz.serve.bench_host.links import HostSide, OpenLink
from scope_ptz.serve.bench_host.wire import (
    AgentGone,
    Begin,
    Deliver,
    Event,
    Failed,
    Finished,
    MessageToAgent,
    Ready,
    RunEnded,
    RunOffered,
    WorkerSettings,
)

logger = logging.getLogger(__name__)

Phase = Literal["stopped", "preparing", "offered", "turn", "working", "finished", "failed"]
"""The phases of an evaluation.

"stopped": no worker is running. "preparing": the worker has not yet offered the next run. "offered": a run is waiting for
``hello``. "turn": it is the agent's turn. "working": the engine is processing the agent's message. "finished": every run has
ended. "failed": the worker failed repeatedly.
"""
MAX_RESTARTS = 3
"""A worker that has ended this many times without progress is not restarted."""
MAX_WAIT_S = 300.0
"""Maximum time, in seconds, for which ``hello`` waits for the next run."""
CANNOT_CONTINUE = "The host cannot continue this evaluation. Its operator must restart it. No task was lost."
ALL_ATTEMPTED = "All tasks have been attempted. The evaluation is finished."
PARTICIPANT_ABSENT = "The participant did not continue before the host closed the evaluation."


class NotYourTurnError(ScopeError):
    """The message is not allowed in the current phase of the evaluation."""


class NotReadyError(ScopeError):
    """The host cannot serve the participant at the moment."""


@dataclass(frozen=True, slots=True)
class Progress:
    """An evaluation's progress, as shown to its participant.

    Attributes:
        phase: "ready" for the next ``hello``, "your_turn", "wait", or "finished".
        runs: Number of runs; None until the worker has reported it.
        begun: Number of runs that have begun.
        last: The host's last message in the current run, for an agent that lost its connection.
    """

    phase: Literal["ready", "your_turn", "wait", "finished"]
    runs: int | None
    begun: int
    last: HostMessage | None


class HostedEvaluation:
    """One participant's evaluation.

    Args:
        settings: The worker's settings.
        journal: The participant's journal.
        open_link: Function that starts a worker.
        fail_unfinished: Whether to fail all unfinished runs, so that the evaluation can be finished without the participant.
    """

    def __init__(self, settings: WorkerSettings, journal: Journal, open_link: OpenLink, *, fail_unfinished: bool = False) -> None:
        self.settings, self.journal, self._open_link, self._fail_unfinished = settings, journal, open_link, fail_unfinished
        self.phase: Phase = "finished" if journal.submission is not None else "stopped"
        self.runs: int | None = None
        self._run = ""
        self._task: TaskMessage | None = None
        self._last: HostMessage | None = None
        self._replay: deque[str] = deque()
        self._link: HostSide | None = None
        self._supervisor: asyncio.Task[None] | None = None
        self._changed = asyncio.Condition()
        self._pending_reply: asyncio.Future[HostMessage] | None = None

    @property
    def finished(self) -> bool:
        """Whether every run has ended and the submission is signed."""
        return self.phase == "finished"

    @property
    def progress(self) -> Progress:
        """The evaluation's progress, as shown to the participant."""
        phase: Literal["ready", "your_turn", "wait", "finished"] = "wait"
        if self.phase in ("stopped", "offered"):
            phase = "ready"
        elif self.phase == "turn":
            phase = "your_turn"
        elif self.phase == "finished":
            phase = "finished"
        return Progress(phase, self.runs, self.journal.attempted, self._last)

    def start(self) -> None:
        """Start the worker if it is not running."""
        if self.phase == "stopped":
            self.phase = "preparing"
            self._supervisor = asyncio.ensure_future(self._supervise())

    async def close(self) -> None:
        """Stop the worker. The evaluation can be resumed later."""
        if self._supervisor is not None:
            self._supervisor.cancel()
            await asyncio.gather(self._supervisor, return_exceptions=True)
        self.journal.close()

    async def exchange(self, line: bytes) -> HostMessage:
        """Pass a message from the agent to the engine, and return the host's next message.

        ``hello`` begins the next run. While a run is in progress, ``hello`` returns the task again and does not start a new run.

        Args:
            line: The message as the agent sent it. An invalid message ends the run.

        Raises:
            NotYourTurnError: There is no run in progress, or an earlier message is still being processed.
            NotReadyError: The next run was not ready in time, or the worker has failed repeatedly.
        """
        hello = _parse_hello(line)
        if hello is None:
            return await self._continue(line)
        if hello.protocol != PROTOCOL:
            return Error(message=f"This host speaks version {PROTOCOL} of the protocol, not {hello.protocol}.")
        return await self._hello(line)

    async def _hello(self, line: bytes) -> HostMessage:
        self.start()
        async with self._changed:
            try:
                async with asyncio.timeout(MAX_WAIT_S):
                    await self._changed.wait_for(lambda: self.phase not in ("preparing", "working"))
            except TimeoutError:
                raise NotReadyError("The host is still preparing the task. Send hello again.") from None
            if self.phase == "turn" and self._task is not None:
                return self._task
            if self.phase == "finished":
                return End(reason=ALL_ATTEMPTED)
            self._require_not_failed()
            reply = await self._deliver(line)
        return await reply

    async def _continue(self, line: bytes) -> HostMessage:
        async with self._changed:
            if self.phase == "finished":
                raise NotYourTurnError(ALL_ATTEMPTED)
            self._require_not_failed()
            if self.phase == "working":
                raise NotYourTurnError("Your earlier message is still being processed. Wait for its reply.")
            if self.phase != "turn":
                last_error = f" The last one ended: {self._last.message}" if isinstance(self._last, Error) else ""
                raise NotYourTurnError(f"No task is in progress.{last_error} Send hello to begin the next one.")
            reply = await self._deliver(line)
        return await reply

    def _require_not_failed(self) -> None:
        if self.phase == "failed":
            raise NotReadyError(CANNOT_CONTINUE)

    async def _deliver(self, line: bytes) -> asyncio.Future[HostMessage]:
        """Record a message, pass it to the worker, and return a future for the reply. The caller must hold ``_changed``."""
        assert self._link is not None  # noqa: S101 - the worker offered the run
        text = line[: MAX_MESSAGE_BYTES + 1].decode("utf-8", "replace")
        self.journal.record(self._run, text)
        begins_run, self.phase = self.phase == "offered", "working"
        self._pending_reply = reply = asyncio.get_running_loop().create_future()
        if begins_run:
            await self._link.send(Begin(run=self._run))
        await self._link.send(Deliver(run=self._run, line=text))
        return reply

    def _respond(self, message: HostMessage) -> None:
        """Reply to the agent's pending message, if any, and keep the reply in case the agent loses its connection."""
        self._last = message
        if self._pending_reply is not None and not self._pending_reply.done():
            self._pending_reply.set_result(message)

    async def _supervise(self) -> None:
        """Run the worker, and restart it if it ends early."""
        failures = 0
        while not self.finished and failures < MAX_RESTARTS:
            ended_runs = self.journal.ended
            try:
                await self._run_worker()
            except Exception:  # for example, a full disk; other participants' evaluations continue
                logger.exception("The evaluation of %s stopped", self.settings.participant)
            failures = failures + 1 if self.journal.ended == ended_runs else 1
            if not self.finished:
                await self._set_phase("preparing")
        if not self.finished:
            logger.warning("The evaluation of %s cannot continue. Restart the host to try again.", self.settings.participant)
            await self._set_phase("failed")
            if self._pending_reply is not None and not self._pending_reply.done():
                self._pending_reply.set_exception(NotReadyError(CANNOT_CONTINUE))

    async def _run_worker(self) -> None:
        """Start a worker, and handle its events until it ends."""
        self._link = link = await self._open_link(self.settings)
        try:
            while (event := await link.receive()) is not None:
                async with self._changed:
                    await self._handle(event, link)
                    self._changed.notify_all()
        finally:
            self._link = None
            await asyncio.shield(asyncio.ensure_future(link.close()))

    async def _set_phase(self, phase: Phase) -> None:
        async with self._changed:
            self.phase = phase
            self._changed.notify_all()

    async def _handle(self, event: Event, link: HostSide) -> None:
        match event:
            case Ready():
                self.runs = event.runs
            case RunOffered():
                await self._handle_offer(event.run, link)
            case MessageToAgent():
                await self._handle_message(event, link)
            case RunEnded():
                self._handle_end(event)
            case Finished():
                self.journal.record_done(event.submission)
                self.phase = "finished"
            case Failed():
                logger.warning("The evaluation of %s failed: %s", self.settings.participant, event.message)

    async def _handle_offer(self, run: str, link: HostSide) -> None:
        """Offer a run to the agent. A run that began before a restart is resumed from the journal."""
        self._run, self._task, self._last = run, None, None
        self._replay = deque(self.journal.messages(run))
        if self._replay or self._fail_unfinished or self.journal.has_ended(run):
            self.phase = "working"
            await link.send(Begin(run=run))
            await self._send_next_recorded(link)
        else:
            self.phase = "offered"

    async def _send_next_recorded(self, link: HostSide) -> None:
        """Send the next recorded message to the engine, or report that the agent will send no more messages."""
        if self._replay:
            await link.send(Deliver(run=self._run, line=self._replay.popleft()))
        else:
            await link.send(AgentGone(run=self._run, reason=PARTICIPANT_ABSENT))

    async def _handle_message(self, event: MessageToAgent, link: HostSide) -> None:
        if isinstance(event.message, TaskMessage):
            self._task = event.message
        if isinstance(event.message, Error):
            self._respond(event.message)  # the run is about to end
        elif self._replay or self._fail_unfinished or self.journal.has_ended(event.run):
            await self._send_next_recorded(link)
        else:
            self.phase = "turn"
            self._respond(event.message)

    def _handle_end(self, event: RunEnded) -> None:
        self.journal.record_end(event.run)
        self._replay.clear()
        if not isinstance(self._last, Error):
            self._respond(End(reason=event.reason))
        self._task, self.phase = None, "preparing"


def _parse_hello(line: bytes) -> Hello | None:
    """Parse a message as ``hello``. Return None if it is any other message."""
    try:
        message = parse_agent_message(line)
    except PlannerError:
        return None
    return message if isinstance(message, Hello) else None
