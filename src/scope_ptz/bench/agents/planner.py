"""A planner whose decisions come from an external agent through a channel."""

from __future__ import annotations

import secrets
import time
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import TypeVar

import anyio

from scope_ptz.bench.agents.channel import AgentChannel
from scope_ptz.bench.agents.faults import agent_failure
from scope_ptz.bench.agents.messages import (
    MAX_NAME_CHARS,
    PROTOCOL,
    AgentMessage,
    CallResult,
    Calls,
    CameraLimits,
    CameraPose,
    Error,
    Hello,
    HostMessage,
    Reply,
    Results,
    TaskMessage,
    View,
    ViewRequest,
    printable,
)
from scope_ptz.errors import PlannerError
from scope_ptz.planner.base import CallTools, Decision, Finish, Planner, State, ToolCall, ToolOutcome

T = TypeVar("T")

ERROR_MESSAGE_S = 1.0
"""Timeout in seconds for sending an agent the error that ended its run."""
MAX_VIEWS_PER_STEP = 100
"""Maximum number of frames that an agent can request in one step."""


@dataclass(frozen=True, slots=True)
class AgentTimeLimits:
    """Limits on the time that an agent takes, not counting the time of tools, perception and the camera.

    Attributes:
        step_s: Maximum seconds per step, from the host's message to the agent's next calls or reply.
        run_s: Maximum seconds for all steps of a run together.
    """

    step_s: float = 300.0
    run_s: float = 1800.0


class ChannelPlanner(Planner):
    """A planner whose decisions are the tool calls and the final reply of an external agent.

    An instance can be used for only one run, because the agent keeps its own state. Call ``connect`` before the run, because the
    agent's first message states whether it needs frames.

    Attributes:
        channel: The channel to the agent. Closing the planner closes it.
        times: The limits on the agent's time.
        spent_s: Seconds that the agent has taken so far.
        failure: The error with which the agent failed; None if it has not failed.
    """

    def __init__(self, channel: AgentChannel, name: str = "", times: AgentTimeLimits | None = None) -> None:
        """Create a planner.

        Args:
            channel: The channel to the agent.
            name: The agent's name in traces. The default is the name in the agent's first message.
            times: The limits on the agent's time.
        """
        self.channel, self.name, self.times = channel, name or "external agent", times or AgentTimeLimits()
        self.spent_s = 0.0
        self._step_spent_s = 0.0
        self._named = bool(name)
        self._connected = False
        self.failure: PlannerError | None = None
        self._pending_ids: tuple[str, ...] = ()
        self._started = False
        self._calls_made = 0
        self._view: View = View()

    async def connect(self) -> None:
        """Wait for the agent's first message. If the agent fails, the first step raises the failure."""
        try:
            hello = await self._receive()
            if not isinstance(hello, Hello):
                raise agent_failure("agent-protocol", f"The agent's first message must be hello; it sent {hello.type}.")
            if hello.protocol != PROTOCOL:
                raise agent_failure(
                    "agent-protocol", f"The agent speaks version {hello.protocol} of the protocol; this host speaks {PROTOCOL}."
                )
            self.sees, self._connected = hello.sees, True
            self.name = self.name if self._named else printable(hello.name, MAX_NAME_CHARS)
        except PlannerError as error:
            await self._report(error)

    async def step(self, state: State) -> Decision:
        """Return the agent's next calls or its reply.

        Raises:
            PlannerError: The agent failed. The error's kind is one from ``bench.agents.faults``, or "empty" for an empty reply.
        """
        if self.failure is None and not self._connected:
            await self.connect()
        if self.failure is not None:
            raise self.failure
        try:
            return await self._decide(state)
        except PlannerError as error:
            await self._report(error)
            raise

    async def close(self) -> None:
        """Close the channel."""
        await self.channel.close("The run has ended.")

    async def _decide(self, state: State) -> Decision:
        self._step_spent_s = 0.0
        if state.view is not None:
            header, _, data = state.view.data_url.partition(",")
            self._view = View(media_type=header.removeprefix("data:").partition(";")[0], data=data)
        await self._send(self._next_message(state))
        opened = False
        for _ in range(MAX_VIEWS_PER_STEP + 1):
            message = await self._receive()
            if isinstance(message, ViewRequest):
                view = self._view if self.sees else View()
                opened = opened or view.data is not None
                await self._send(view)
            elif isinstance(message, Calls):
                return CallTools(calls=self._numbered_calls(message), opened=opened)
            elif isinstance(message, Reply):
                return self._finish(message, opened=opened)
            else:
                raise agent_failure("agent-protocol", "The agent sent hello twice.")
        raise agent_failure("agent-protocol", f"The agent requested more than {MAX_VIEWS_PER_STEP} frames in one step.")

    def _next_message(self, state: State) -> HostMessage:
        """Return the task at the first step and the results of the last calls at later steps."""
        if not self._started:
            self._started = True
            return TaskMessage(
                task=secrets.token_hex(8),
                instruction=state.instruction,
                tools=state.tools,
                presets=state.briefing.presets,
                limits=CameraLimits.of(state.briefing.limits),
                pose=CameraPose.of(state.briefing.pose),
            )
        outcomes = state.history[-1].outcomes
        # The loop limits the calls per step. The last outcome reports the dropped calls, so it is repeated for each of them.
        padded = (*outcomes, *outcomes[-1:] * (len(self._pending_ids) - len(outcomes)))
        return Results(
            results=tuple(_result_of(call_id, outcome) for call_id, outcome in zip(self._pending_ids, padded, strict=True))
        )

    def _numbered_calls(self, message: Calls) -> tuple[ToolCall, ...]:
        """Return the calls with ids that are unique in the run. The agent's ids are unique only within a message."""
        first = self._calls_made + 1
        self._calls_made += len(message.calls)
        self._pending_ids = tuple(call.id for call in message.calls)
        return tuple(
            ToolCall(id=f"call-{number}", name=call.name, arguments=call.arguments)
            for number, call in enumerate(message.calls, start=first)
        )

    def _finish(self, reply: Reply, *, opened: bool) -> Finish:
        if not reply.text.strip():
            raise PlannerError("The agent ended without an answer.", kind="empty")
        return Finish(kind=reply.kind, text=reply.text, opened=opened)

    async def _send(self, message: HostMessage) -> None:
        """Send a message. The time that an agent takes to read it counts towards the limits."""
        await self._with_time_limit(lambda: self.channel.send(message))

    async def _receive(self) -> AgentMessage:
        return await self._with_time_limit(self.channel.receive)

    async def _with_time_limit(self, work: Callable[[], Awaitable[T]]) -> T:
        """Await ``work``, and raise ``PlannerError`` if the agent takes too long for the step or for the whole run."""
        step_left_s, run_left_s = self.times.step_s - self._step_spent_s, self.times.run_s - self.spent_s
        started = time.monotonic()
        try:
            with anyio.move_on_after(max(0.0, min(step_left_s, run_left_s))):
                return await work()
        finally:
            seconds = time.monotonic() - started
            self._step_spent_s += seconds
            self.spent_s += seconds
        if step_left_s <= run_left_s:
            raise agent_failure("agent-timeout", f"The agent took longer than {self.times.step_s:g} s for one step.")
        raise agent_failure("agent-timeout", f"The agent took longer than {self.times.run_s:g} s for the whole run.")

    async def _report(self, error: PlannerError) -> None:
        """Store the failure, and send it to the agent if the agent is still reading its messages."""
        self.failure = error
        with suppress(PlannerError), anyio.move_on_after(ERROR_MESSAGE_S):
            await self.channel.send(Error(message=str(error)))


def _result_of(call_id: str, outcome: ToolOutcome) -> CallResult:
    if outcome.error is None and outcome.result is not None:
        return CallResult(id=call_id, result=outcome.result)
    return CallResult(id=call_id, error=outcome.error or "The call has no result.")
