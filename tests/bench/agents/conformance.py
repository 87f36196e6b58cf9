"""Conformance suite for channels to external agents.

A test module defines a subclass with a fixture ``connection``::

    class TestPipeChannel(ChannelConformance):
        @pytest.fixture
        async def connection(self, tmp_path):
            async with ... as (channel, peer):
                yield Connection(channel, peer)
"""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass
from typing import Any, Protocol

import anyio
import pytest

from scope_ptz.bench.agents.channel import ISOLATIONS, AgentChannel
from scope_ptz.bench.agents.faults import AGENT_FAULTS
from scope_ptz.bench.agents.messages import MAX_MESSAGE_BYTES, CallResult, Calls, Hello, Reply, Results, ViewRequest
from scope_ptz.bench.agents.planner import ChannelPlanner
from scope_ptz.errors import PlannerError
from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.base import Briefing, CallTools, Exchange, Finish, Picture, State, ToolOutcome

HELLO = {"type": "hello", "protocol": 1, "name": "peer", "sees": True}
FRAME = b"\xff\xd8 a frame"
STATE = State(
    instruction="Zähle die Bälle 🎈",
    briefing=Briefing(presets=("gate", "yard"), pose=Pose(1.5, -2.0, 3.0), limits=Limits()),
    tools=({"type": "function", "function": {"name": "count_objects"}},),
    view=Picture(data_url="data:image/jpeg;base64," + base64.b64encode(FRAME).decode(), caption="now"),
)
TIMEOUT_S = 30.0


class Peer(Protocol):
    """The agent's side of a channel."""

    async def send(self, message: bytes) -> None:
        """Send raw bytes, which need not be valid JSON."""

    async def receive(self) -> dict[str, Any]:
        """Wait for a message from the host."""

    async def leave(self) -> None:
        """Disconnect, or end the process."""


@dataclass(frozen=True)
class Connection:
    """Both sides of a channel."""

    channel: AgentChannel
    peer: Peer

    async def send(self, message: dict[str, Any]) -> None:
        await self.peer.send(json.dumps(message).encode())


def state_after(state: State, decision: CallTools, *results: dict[str, Any]) -> State:
    """Return the state after the calls of a decision, with their results."""
    outcomes = tuple(ToolOutcome(call=c, result=r) for c, r in zip(decision.calls, results, strict=True))
    return state.model_copy(update={"history": (*state.history, Exchange(outcomes=outcomes))})


class ChannelConformance:
    """The conformance suite. Each test gets a new channel from the fixture ``connection``."""

    async def test_messages_arrive_complete_and_in_order(self, connection: Connection) -> None:
        with anyio.fail_after(TIMEOUT_S):
            await connection.send(HELLO)
            assert await connection.channel.receive() == Hello(protocol=1, name="peer", sees=True)
            calls = {
                "type": "calls",
                "calls": [{"id": "ä\n", "name": "query_answer", "arguments": {"question": "🎈\n\u2028" * 9000}}],
            }
            await connection.send(calls)
            received = await connection.channel.receive()
            assert isinstance(received, Calls) and received.model_dump(mode="json") == calls
            await connection.channel.send(Results(results=(CallResult(id="ä\n", result={"answer": "\n🎈" * 50_000}),)))
            results = await connection.peer.receive()
            assert results["type"] == "results" and results["results"][0]["result"] == {"answer": "\n🎈" * 50_000}
            await connection.send({"type": "reply", "text": "done"})
            assert await connection.channel.receive() == Reply(text="done")

    @pytest.mark.parametrize(
        ("message", "problem"),
        [
            (b"hello", "JSON"),
            (b"[1, 2]", "object"),
            (b'{"type": "task"}', "task"),
            (b'{"type": "hello", "protocol": 1}', "name"),
            (b'{"type": "calls", "calls": []}', "calls"),
            (b'{"type": "calls", "calls": [{"id": "1", "name": "a", "arguments": {"x": NaN}}]}', "finite"),
            (b'{"type": "reply", "text": "x", "kind": "correct"}', "kind"),
            (b'{"type": "reply", "text": "x", "score": 1}', "score"),
            (b"\xff\xfe\x00", "JSON"),
        ],
    )
    async def test_an_invalid_message_is_a_failure_of_the_agent(self, connection: Connection, message: bytes, problem: str) -> None:
        with anyio.fail_after(TIMEOUT_S):
            await connection.peer.send(message)
            with pytest.raises(PlannerError, match=problem) as excinfo:
                await connection.channel.receive()
            assert excinfo.value.kind == "agent-protocol"

    async def test_a_message_that_is_too_long_is_a_failure_of_the_agent(self, connection: Connection) -> None:
        with anyio.fail_after(TIMEOUT_S):
            async with anyio.create_task_group() as group:
                # The host stops reading at the limit, and the agent's write then blocks.
                group.start_soon(
                    connection.peer.send, b'{"type": "reply", "text": "' + b"x" * (MAX_MESSAGE_BYTES + 100_000) + b'"}'
                )
                with pytest.raises(PlannerError, match="bytes") as excinfo:
                    await connection.channel.receive()
                assert excinfo.value.kind == "agent-output"
                group.cancel_scope.cancel()

    async def test_an_agent_that_leaves_has_failed(self, connection: Connection) -> None:
        with anyio.fail_after(TIMEOUT_S):
            await connection.send(HELLO)
            await connection.channel.receive()
            await connection.peer.leave()
            for _ in range(2):
                with pytest.raises(PlannerError) as excinfo:
                    await connection.channel.receive()
                assert excinfo.value.kind in AGENT_FAULTS

    async def test_a_cancelled_receive_loses_nothing(self, connection: Connection) -> None:
        with anyio.fail_after(TIMEOUT_S):
            with anyio.move_on_after(0.05) as waiting:
                await connection.channel.receive()
            assert waiting.cancelled_caught
            await connection.send({"type": "view"})
            assert await connection.channel.receive() == ViewRequest()

    async def test_closing_tells_the_agent_why_and_can_be_repeated(self, connection: Connection) -> None:
        with anyio.fail_after(TIMEOUT_S):
            await connection.send(HELLO)
            await connection.channel.receive()
            async with anyio.create_task_group() as group:
                group.start_soon(connection.channel.close, "That is all.")
                assert await connection.peer.receive() == {"type": "end", "reason": "That is all."}
                await connection.peer.leave()
            await connection.channel.close("Again.")

    async def test_a_complete_run(self, connection: Connection) -> None:
        planner = ChannelPlanner(connection.channel)
        peer = connection.peer
        with anyio.fail_after(TIMEOUT_S):
            await connection.send(HELLO)
            await planner.connect()
            assert (planner.name, planner.sees) == ("peer", True)
            await connection.send({"type": "view"})
            calls = [{"id": "b", "name": "count_objects", "arguments": {"description": "x"}}, {"id": "a", "name": "take_image"}]
            await connection.send({"type": "calls", "calls": calls})
            decision = await planner.step(STATE)
            task = await peer.receive()
            assert task["type"] == "task" and task["instruction"] == STATE.instruction and task["presets"] == ["gate", "yard"]
            assert task["pose"] == {"pan_deg": 1.5, "tilt_deg": -2.0, "zoom": 3.0} and task["limits"]["max_zoom"] == 5.0
            assert task["tools"] == list(STATE.tools)
            view = await peer.receive()
            assert view["media_type"] == "image/jpeg" and base64.b64decode(view["data"]) == FRAME
            assert isinstance(decision, CallTools) and decision.opened
            assert [call.name for call in decision.calls] == ["count_objects", "take_image"]
            assert len({call.id for call in decision.calls}) == 2
            await connection.send({"type": "reply", "text": "Which balls?", "kind": "clarification"})
            end = await planner.step(state_after(STATE, decision, {"count": 2}, {"file": "x.jpg"}))
            results = await peer.receive()
            assert [(r["id"], r["result"]) for r in results["results"]] == [("b", {"count": 2}), ("a", {"file": "x.jpg"})]
            assert isinstance(end, Finish)
            assert (end.kind, end.text, end.opened) == ("clarification", "Which balls?", False)
            await peer.leave()
            await planner.close()

    async def test_the_isolation_label_is_valid(self, connection: Connection) -> None:
        assert connection.channel.isolation in ISOLATIONS
