"""The planner contract. A planner is a pure function of (U, H_t): it keeps nothing between steps.

U is the instruction and H_t everything that happened so far. Each step it either ends the run (an answer, a clarifying question,
a refusal) or asks for tool calls, whose results are appended before it is asked again.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from scope_ptz.endpoints.failures import Attempt
from scope_ptz.geometry import Limits, Pose

MAX_INSTRUCTION_CHARS = 4000  # longer instructions raise InputError


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, arbitrary_types_allowed=True)


class ToolCall(_Model):
    """A call as the planner wants it: not yet validated. ``problem``: why it cannot be made as it was written, which is an
    error."""

    id: str
    name: str
    arguments: dict[str, Any] = {}
    problem: str | None = None


class Picture(_Model):
    """A frame as planners that see get it, a JPEG as a data URL. It is kept out of traces, which name the file instead."""

    data_url: str = Field(repr=False)
    caption: str


class ToolOutcome(_Model):
    """What a call brought back: ``error`` is set when it failed. ``result`` is the tool's result as JSON data."""

    call: ToolCall
    result: dict[str, Any] | None = None
    error: str | None = None
    picture: Picture | None = Field(default=None, exclude=True, description="of take_image, for planners that see")


class Exchange(_Model):
    """One step of a run: the calls that the planner made together and what came back, in order."""

    outcomes: tuple[ToolOutcome, ...]
    thought: str = ""


class PastTurn(_Model):
    """An earlier turn of a conversation. ``start``: where the camera looked when it began."""

    instruction: str
    exchanges: tuple[Exchange, ...]
    reply: str
    start: Pose | None = None


class Briefing(_Model):
    """What the planner may know of the camera when a run starts."""

    presets: tuple[str, ...]
    pose: Pose
    limits: Limits


class State(_Model):
    """S_t: the goal U, the history H_t (observations O_t are the results in it), and what came before in a conversation.

    ``view``: the newest frame, for planners that see; older ones are not kept.
    """

    instruction: str
    briefing: Briefing
    history: tuple[Exchange, ...] = ()
    conversation: tuple[PastTurn, ...] = ()
    tools: tuple[dict[str, Any], ...] = Field(default=(), description="OpenAI function schemas of the tools on offer")
    view: Picture | None = None


class Usage(_Model):
    """Tokens that a step cost; zero for planners without tokens. ``cached_tokens``: those of the input that the server had kept."""

    input_tokens: int = 0
    output_tokens: int = 0
    cached_tokens: int = 0

    def __add__(self, other: Usage) -> Usage:
        return Usage(**{name: getattr(self, name) + getattr(other, name) for name in Usage.model_fields})


class Served(_Model):
    """How a model server answered: ``model`` as it names itself, ``first_token_s`` where it streams, ``calls_from`` the notation in
    which calls were found ("native", or one written into the text), ``attempts`` with those that failed."""

    model: str = ""
    finish_reason: str | None = None
    first_token_s: float | None = None
    seconds: float = 0.0
    calls_from: str = ""
    attempts: tuple[Attempt, ...] = ()


class CallTools(_Model):
    """``thought``: what the planner says beside its calls; ``reasoning``: what it thought, for traces only.

    ``opened``: whether it took the picture that it was offered (None: whoever sees is given it).
    """

    kind: Literal["call"] = "call"
    calls: tuple[ToolCall, ...] = Field(min_length=1)
    thought: str = ""
    usage: Usage = Usage()
    reasoning: str = ""
    served: Served | None = None
    opened: bool | None = None


class Finish(_Model):
    """The end of a run. ``text`` is the answer, the clarifying question, or the reason for refusing. ``opened`` as above."""

    kind: Literal["answered", "clarification", "refused"]
    text: str = Field(min_length=1)
    usage: Usage = Usage()
    reasoning: str = ""
    served: Served | None = None
    opened: bool | None = None


Decision = CallTools | Finish


class Planner(ABC):
    """``sees``: it wants frames (``State.view``, pictures of take_image); ``details``: what a trace should say about it, no
    secrets."""

    name: str
    sees: bool = False

    @property
    def details(self) -> dict[str, str]:
        return {}

    @abstractmethod
    async def step(self, state: State) -> Decision:
        """The next decision. Raises ``PlannerError`` when there is none."""

    async def close(self) -> None:
        """Release what the planner holds. The default holds nothing."""
