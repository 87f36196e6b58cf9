"""The planner contract. A planner is a pure function of (U, H_t): it keeps nothing between steps.

U is the instruction and H_t everything that happened so far. Each step it either ends the run (an answer, a clarifying question,
a refusal) or asks for tool calls, whose results are appended before it is asked again.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from scope_ptz.geometry import Limits, Pose


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, arbitrary_types_allowed=True)


class ToolCall(_Model):
    """A call as the planner wants it: not yet validated."""

    id: str
    name: str
    arguments: dict[str, Any] = {}


class ToolOutcome(_Model):
    """What a call brought back: ``error`` is set when it failed. ``result`` is the tool's result as JSON data."""

    call: ToolCall
    result: dict[str, Any] | None = None
    error: str | None = None


class Exchange(_Model):
    """One step of a run: the calls that the planner made together and what came back, in order."""

    outcomes: tuple[ToolOutcome, ...]
    thought: str = ""


class PastTurn(_Model):
    """An earlier turn of a conversation."""

    instruction: str
    exchanges: tuple[Exchange, ...]
    reply: str


class Briefing(_Model):
    """What the planner may know of the camera when a run starts."""

    presets: tuple[str, ...]
    pose: Pose
    limits: Limits


class State(_Model):
    """S_t: the goal U, the history H_t (observations O_t are the results in it), and what came before in a conversation."""

    instruction: str
    briefing: Briefing
    history: tuple[Exchange, ...] = ()
    conversation: tuple[PastTurn, ...] = ()
    tools: tuple[dict[str, Any], ...] = Field(default=(), description="OpenAI function schemas of the tools on offer")


class Usage(_Model):
    """Tokens that a step cost; zero for planners without tokens."""

    input_tokens: int = 0
    output_tokens: int = 0


class CallTools(_Model):
    kind: Literal["call"] = "call"
    calls: tuple[ToolCall, ...] = Field(min_length=1)
    thought: str = ""
    usage: Usage = Usage()


class Finish(_Model):
    """The end of a run. ``text`` is the answer, the clarifying question, or the reason for refusing."""

    kind: Literal["answered", "clarification", "refused"]
    text: str = Field(min_length=1)
    usage: Usage = Usage()


Decision = CallTools | Finish


class Planner(ABC):
    name: str

    @abstractmethod
    async def step(self, state: State) -> Decision:
        """The next decision. Raises ``PlannerError`` when there is none."""

    async def close(self) -> None:
        """Release what the planner holds. The default holds nothing."""
