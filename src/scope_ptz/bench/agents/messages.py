"""The messages of the agent protocol, version 1. A message is a JSON object whose ``type`` determines its model.

An agent and its host take turns:

1. The agent sends ``hello``, and the host replies with ``task``.
2. The agent sends ``calls``, and the host replies with ``results``. The calls in one message form one step.
3. The agent can send ``view`` whenever it is its turn, and the host replies with ``view``.
4. The agent sends ``reply``, and the host replies with ``end``.

The host can send ``error`` or ``end`` at any time to end the run. Agents must ignore fields that they do not know. The host rejects
messages with unknown fields.
"""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from scope_ptz.bench.agents.faults import agent_failure
from scope_ptz.geometry import Limits, Pose

PROTOCOL = 1
"""Version of the protocol."""
MAX_MESSAGE_BYTES = 1_000_000
"""Maximum size of a message from an agent in bytes."""
MAX_CALLS = 64
"""Maximum number of calls per message."""
MAX_REPLY_CHARS = 100_000
"""Maximum length of a reply's text in characters."""
MAX_NAME_CHARS = 200
"""Maximum length of agent names, tool names and call ids, in characters."""
MAX_QUOTED_CHARS = 300
"""Maximum length of text from an agent that an error message quotes, in characters."""
MAX_DEPTH = 32
"""Maximum nesting depth of a call's arguments."""
MAX_INTEGER = 2**63
"""Upper bound (exclusive) on the absolute value of integers in a call's arguments."""

Name = Annotated[str, Field(min_length=1, max_length=MAX_NAME_CHARS)]


def _check_values(arguments: dict[str, Any]) -> dict[str, Any]:
    """Check that all numbers in the arguments are finite and fit into 64 bits, and that the nesting is not too deep."""
    pending: list[tuple[Any, int]] = [(arguments, 1)]
    while pending:
        value, depth = pending.pop()
        if depth > MAX_DEPTH:
            raise ValueError(f"arguments may be nested at most {MAX_DEPTH} levels deep")
        if isinstance(value, dict):
            pending += [(item, depth + 1) for item in value.values()]
        elif isinstance(value, list):
            pending += [(item, depth + 1) for item in value]
        elif isinstance(value, float) and not math.isfinite(value):
            raise ValueError("numbers must be finite")
        elif isinstance(value, int) and abs(value) >= MAX_INTEGER:
            raise ValueError("integers must fit into 64 bits")
    return arguments


class _Message(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Hello(_Message):
    """An agent's first message.

    Attributes:
        protocol: Version of the protocol that the agent speaks.
        name: The agent's name.
        sees: Whether the agent will request frames with ``view``.
    """

    type: Literal["hello"] = "hello"
    protocol: int
    name: Name
    sees: bool = False


class RequestedCall(_Message):
    """A tool call. The agent chooses ``id``, which must be unique within the message."""

    id: Name
    name: Name
    arguments: Annotated[dict[str, Any], AfterValidator(_check_values)] = {}


def _check_unique_ids(calls: tuple[RequestedCall, ...]) -> tuple[RequestedCall, ...]:
    if len({call.id for call in calls}) < len(calls):
        raise ValueError("the ids of the calls must differ from each other")
    return calls


class Calls(_Message):
    """Tool calls that form one step. Within a step, perception calls run concurrently and other calls in order."""

    type: Literal["calls"] = "calls"
    calls: Annotated[tuple[RequestedCall, ...], Field(min_length=1, max_length=MAX_CALLS), AfterValidator(_check_unique_ids)]


class ViewRequest(_Message):
    """A request for the newest frame. Only requested frames count as observations."""

    type: Literal["view"] = "view"


class Reply(_Message):
    """The final reply: an answer, a clarifying question or a refusal."""

    type: Literal["reply"] = "reply"
    kind: Literal["answered", "clarification", "refused"] = "answered"
    text: Annotated[str, Field(max_length=MAX_REPLY_CHARS)]


class CameraPose(_Message):
    """A camera pose: pan (positive to the right) and tilt (positive up) in degrees, and zoom as magnification."""

    pan_deg: float
    tilt_deg: float
    zoom: float

    @classmethod
    def of(cls, pose: Pose) -> CameraPose:
        """Convert a pose to its form in messages."""
        return cls(pan_deg=pose.pan_deg, tilt_deg=pose.tilt_deg, zoom=pose.zoom)


class CameraLimits(_Message):
    """The limits of a camera. With ``pan_endless``, pan is unlimited and wraps at 180 degrees."""

    min_pan_deg: float
    max_pan_deg: float
    min_tilt_deg: float
    max_tilt_deg: float
    min_zoom: float
    max_zoom: float
    pan_endless: bool

    @classmethod
    def of(cls, limits: Limits) -> CameraLimits:
        """Convert limits to their form in messages."""
        return cls(**asdict(limits))


class TaskMessage(_Message):
    """The task as the agent receives it.

    Attributes:
        protocol: Version of the protocol that the host speaks.
        task: An opaque handle that differs in every run and reveals nothing about the task.
        instruction: The instruction to the agent.
        tools: The JSON schemas of the tools in the OpenAI function format.
        presets: The names of the presets.
        limits: The limits of the camera.
        pose: The initial pose of the camera.
    """

    type: Literal["task"] = "task"
    protocol: int = PROTOCOL
    task: str
    instruction: str
    tools: tuple[dict[str, Any], ...]
    presets: tuple[str, ...]
    limits: CameraLimits
    pose: CameraPose


class CallResult(_Message):
    """The result of one call. Exactly one of ``result`` and ``error`` is not null."""

    id: str
    result: dict[str, Any] | None = None
    error: str | None = None


class Results(_Message):
    """The results of the calls in one step, in the order of the calls."""

    type: Literal["results"] = "results"
    results: tuple[CallResult, ...]


class View(_Message):
    """The newest frame. ``media_type`` and ``data`` (base64) are null if ``sees`` is false in the agent's ``hello``."""

    type: Literal["view"] = "view"
    media_type: str | None = None
    data: str | None = Field(default=None, repr=False)


class End(_Message):
    """The run has ended. The agent should exit or disconnect."""

    type: Literal["end"] = "end"
    reason: str


class Error(_Message):
    """The run has ended because of an error by the agent."""

    type: Literal["error"] = "error"
    message: str


AgentMessage = Hello | Calls | ViewRequest | Reply
"""A message from an agent."""
HostMessage = TaskMessage | Results | View | End | Error
"""A message from the host."""

_FROM_AGENT: TypeAdapter[AgentMessage] = TypeAdapter(Annotated[AgentMessage, Field(discriminator="type")])
_FROM_HOST: TypeAdapter[HostMessage] = TypeAdapter(Annotated[HostMessage, Field(discriminator="type")])


def parse_agent_message(line: bytes | str) -> AgentMessage:
    """Parse a message from an agent.

    Args:
        line: A JSON object as a string or UTF-8 bytes.

    Returns:
        The message.

    Raises:
        PlannerError: The message is too long or invalid. The error's kind is "agent-output" or "agent-protocol".
    """
    size = len(line) if isinstance(line, bytes) else len(line.encode("utf-8", "replace"))
    if size > MAX_MESSAGE_BYTES:
        raise agent_failure("agent-output", f"The agent sent a message of more than {MAX_MESSAGE_BYTES} bytes.")
    try:
        return _FROM_AGENT.validate_json(line)
    except ValidationError as error:
        raise agent_failure("agent-protocol", f"The agent sent an invalid message: {_first_problem(error)}.") from error


def parse_host_message(line: bytes | str) -> HostMessage:
    """Parse a message from the host. Raises ``pydantic.ValidationError`` if the message is invalid."""
    return _FROM_HOST.validate_json(line)


def encode_message(message: AgentMessage | HostMessage) -> bytes:
    """Encode a message as a line of JSON, including the line feed."""
    return message.model_dump_json().encode() + b"\n"


def _first_problem(error: ValidationError) -> str:
    """Return the first problem in an invalid message, truncated and without unprintable characters."""
    first = error.errors(include_url=False, include_context=False, include_input=False)[0]
    place = ".".join(str(part) for part in first["loc"])
    problem = f"{place}: {first['msg']}" if place else first["msg"]
    return printable(problem.replace("Value error, ", ""), MAX_QUOTED_CHARS)


def printable(text: str, length: int) -> str:
    """Truncate text from an agent to ``length`` characters, and replace unprintable characters with "?"."""
    return "".join(character if character.isprintable() else "?" for character in text[:length])
