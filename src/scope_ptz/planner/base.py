"""The planner contract.

A planner is a pure function of the instruction U and the history H_t; it keeps no state between steps. At each step it either ends
the run (with an answer, a clarifying question or a refusal) or requests tool calls. The results of the calls are appended to the
history before the next step.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from scope_ptz.endpoints.failures import Attempt
from scope_ptz.geometry import Limits, Pose


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, arbitrary_types_allowed=True)


class ToolCall(_Model):
    """A tool call as the planner requests it, before validation.

    Attributes:
        problem: Why the call is malformed, for example invalid JSON arguments. Such a call is not executed and returns this text as
            its error. None for a well-formed call.
    """

    id: str
    name: str
    arguments: dict[str, Any] = {}
    problem: str | None = None


class Picture(_Model):
    """A frame for planners that accept images: a JPEG as a data URL. Traces store the name of the image file instead."""

    data_url: str = Field(repr=False)
    caption: str


class ToolOutcome(_Model):
    """The outcome of a tool call: its result as JSON data, or ``error`` when it failed."""

    call: ToolCall
    result: dict[str, Any] | None = None
    error: str | None = None
    picture: Picture | None = Field(
        default=None, exclude=True, description="The picture of take_image, for planners that accept images"
    )


class Exchange(_Model):
    """One step of a run: the calls that the planner requested together, with their outcomes in the same order.

    Attributes:
        thought: The text that accompanied the calls.
    """

    outcomes: tuple[ToolOutcome, ...]
    thought: str = ""


class PastTurn(_Model):
    """An earlier turn of a conversation.

    Attributes:
        reply: The text that ended the turn: the answer, the clarifying question, or the reason why there is no answer.
        start: The camera's pose at the beginning of the turn; None if it is unknown.
        viewpoint: The viewpoint of a simulated camera at the beginning of the turn; None if it is unknown, or for other cameras.
    """

    instruction: str
    exchanges: tuple[Exchange, ...]
    reply: str
    start: Pose | None = None
    viewpoint: str | None = None


class Viewpoints(_Model):
    """The viewpoints between which a simulated camera switches. Poses of different viewpoints must not be compared.

    Attributes:
        current: The camera's viewpoint when the run starts.
        of_presets: The viewpoint of each preset.
        home: The viewpoint of the home view; None if it is unknown.
    """

    current: str
    of_presets: dict[str, str] = {}
    home: str | None = None


class Briefing(_Model):
    """The facts about the camera that the planner receives when a run starts.

    Attributes:
        simulated: Whether the camera is simulated. A planner asks before it moves a real camera for a reason that the user did not
            give.
        viewpoints: The viewpoints of a camera in a simulated scene; None for other cameras, which have a single one.
    """

    presets: tuple[str, ...]
    pose: Pose
    limits: Limits
    simulated: bool = False
    viewpoints: Viewpoints | None = None


class State(_Model):
    """The state S_t: the instruction U, the history H_t (whose results are the observations), and the earlier conversation.

    Attributes:
        view: The newest frame, for planners that accept images; older frames are not included.
    """

    instruction: str
    briefing: Briefing
    history: tuple[Exchange, ...] = ()
    conversation: tuple[PastTurn, ...] = ()
    tools: tuple[dict[str, Any], ...] = Field(default=(), description="OpenAI function schemas of the available tools")
    view: Picture | None = None


class Usage(_Model):
    """The tokens that a step used; zero for planners without a language model.

    Attributes:
        cached_tokens: The input tokens that the server read from its prefix cache.
    """

    input_tokens: int = 0
    output_tokens: int = 0
    cached_tokens: int = 0

    def __add__(self, other: Usage) -> Usage:
        return Usage(**{name: getattr(self, name) + getattr(other, name) for name in Usage.model_fields})


class Served(_Model):
    """Metadata of a model server's reply.

    Attributes:
        model: The model's name as the server reports it.
        first_token_s: Seconds to the first token of a streamed reply.
        calls_from: Where the calls were found: "native" for the ``tool_calls`` field of the reply, otherwise the name of a text
            notation.
        attempts: All requests that were sent to get the reply, including failed ones.
    """

    model: str = ""
    finish_reason: str | None = None
    first_token_s: float | None = None
    seconds: float = 0.0
    calls_from: str = ""
    attempts: tuple[Attempt, ...] = ()


class CallTools(_Model):
    """The decision to call tools.

    Attributes:
        thought: Text that accompanies the calls.
        reasoning: The planner's reasoning, kept in traces only.
        opened: Whether an external agent fetched the picture that it was offered; None for planners that receive the pictures
            with each request.
        planned_by: The part of a hybrid planner that made the decision: "grammar", "model", or "confirmed" for calls that the user
            confirmed. None for other planners.
    """

    kind: Literal["call"] = "call"
    calls: tuple[ToolCall, ...] = Field(min_length=1)
    thought: str = ""
    usage: Usage = Usage()
    reasoning: str = ""
    served: Served | None = None
    opened: bool | None = None
    planned_by: str | None = None


class Finish(_Model):
    """The decision to end the run. ``text`` is the answer, the clarifying question or the reason for the refusal.

    Attributes:
        opened: See ``CallTools``.
        planned_by: See ``CallTools``.
    """

    kind: Literal["answered", "clarification", "refused"]
    text: str = Field(min_length=1)
    usage: Usage = Usage()
    reasoning: str = ""
    served: Served | None = None
    opened: bool | None = None
    planned_by: str | None = None


Decision = CallTools | Finish


class Planner(ABC):
    """Base class of planners.

    Attributes:
        name: The planner's name in traces and results.
        sees: Whether the planner accepts images: ``State.view`` and the pictures of ``take_image``.
    """

    name: str
    sees: bool = False

    @property
    def details(self) -> dict[str, str]:
        """Facts about the planner for traces. They must not contain secrets."""
        return {}

    @abstractmethod
    async def step(self, state: State) -> Decision:
        """Return the next decision.

        Raises:
            PlannerError: The planner cannot make a decision.
        """

    async def close(self) -> None:
        """Release the planner's resources. The default implementation does nothing."""
