"""The messages of the agent protocol, version 1. A message is one JSON object, and its ``type`` names its model.

An agent and its host take turns:

1. The agent sends ``hello``, and the host replies with ``task``.
2. The agent sends ``calls``, and the host replies with ``results``. The calls of one message form one step.
3. The agent can send ``view`` at any time when it is its turn, and the host replies with ``view``.
4. The agent sends ``reply``, and the host replies with ``end``.

The host sends ``error`` or ``end`` at any time to end the run. Agents must ignore fields that they do not know. The host rejects
messages with unknown fields.
"""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from scope_ptz.bench.agents.faults import agent_failed
from scope_ptz.geometry import Limits, Pose

PROTOCOL = 1
"""Version of the protocol."""
MAX_MESSAGE_BYTES = 1_000_000
"""Maximum size of a message from an agent."""
MAX_CALLS = 64
"""Maximum number of calls in a message."""
MAX_REPLY_CHARS = 100_000
"""Maximum length of the text of a reply."""
MAX_NAME_CHARS = 200
"""Maximum length of the names of agents and tools, and of the ids of calls."""
MAX_QUOTED_CHARS = 300
"""Maximum length of a description of an invalid message."""
MAX_DEPTH = 32
"""Maximum nesting of a call's arguments."""
MAX_INTEGER = 2**63
"""Integers in a call's arguments must be smaller than this."""

Name = Annotated[str, Field(min_length=1, max_length=MAX_NAME_CHARS)]


def _plain_values(arguments: dict[str, Any]) -> dict[str, Any]:
    """Check that arguments contain only finite numbers of an ordinary size, and are not nested too deeply."""
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
    """The first message of an agent.

    Attributes:
        protocol: Version of the protocol that the agent speaks.
        name: The agent's name.
        sees: Whether the agent requests frames with ``view``.
    """

    type: Literal["hello"] = "hello"
    protocol: int
    name: Name
    sees: bool = False


class RequestedCall(_Message):
    """A tool call. ``id`` is chosen by the agent and must be unique within its message."""

    id: Name
    name: Name
    arguments: Annotated[dict[str, Any], AfterValidator(_plain_values)] = {}


def _unique_ids(calls: tuple[RequestedCall, ...]) -> tuple[RequestedCall, ...]:
    if len({call.id for call in calls}) < len(calls):
        raise ValueError("the ids of the calls must differ from each other")
    return calls


class Calls(_Message):
    """Tool calls that form one step. Perception calls of a step run concurrently, and other calls in order."""

    type: Literal["calls"] = "calls"
    calls: Annotated[tuple[RequestedCall, ...], Field(min_length=1, max_length=MAX_CALLS), AfterValidator(_unique_ids)]


class ViewRequest(_Message):
    """A request for the newest frame. Only frames that an agent requested count as observations."""

    type: Literal["view"] = "view"


class Reply(_Message):
    """The final reply: an answer, a clarifying question or a refusal."""

    type: Literal["reply"] = "reply"
    kind: Literal["answered", "clarification", "refused"] = "answered"
    text: Annotated[str, Field(max_length=MAX_REPLY_CHARS)]


class CameraPose(_Message):
    """A pose: pan and tilt in degrees, positive to the right and up, and zoom as magnification."""

    pan_deg: float
    tilt_deg: float
    zoom: float

    @classmethod
    def of(cls, pose: Pose) -> CameraPose:
        """Return the pose as part of a message."""
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
        """Return the limits as part of a message."""
        return cls(**asdict(limits))


class TaskMessage(_Message):
    """What an agent learns about its task.

    Attributes:
        protocol: Version of the protocol that the host speaks.
        task: An opaque handle, different in every run. It says nothing about the task.
        instruction: The instruction to the agent.
        tools: The JSON schemas of the tools in the OpenAI function format.
        presets: The names of the presets.
        limits: The limits of the camera.
        pose: The pose of the camera at the start.
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
    """The results of the calls of one step, in the order of the calls."""

    type: Literal["results"] = "results"
    results: tuple[CallResult, ...]


class View(_Message):
    """The newest frame. ``media_type`` and ``data`` (base64) are null if the agent said in ``hello`` that it does not see."""

    type: Literal["view"] = "view"
    media_type: str | None = None
    data: str | None = Field(default=None, repr=False)


class End(_Message):
    """The run has ended. The agent should exit or disconnect."""

    type: Literal["end"] = "end"
    reason: str


class Error(_Message):
    """The agent made a mistake that ends the run."""

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
        line: One JSON object, in UTF-8 if it is bytes.

    Returns:
        The message.

    Raises:
        PlannerError: The message is too long or not valid. Its kind is "agent-output" or "agent-protocol".
    """
    size = len(line) if isinstance(line, bytes) else len(line.encode("utf-8", "replace"))
    if size > MAX_MESSAGE_BYTES:
        raise agent_failed("agent-output", f"The agent sent a message of more than {MAX_MESSAGE_BYTES} bytes.")
    try:
        return _FROM_AGENT.validate_json(line)
    except ValidationError as error:
        raise agent_failed("agent-protocol", f"The agent sent an invalid message: {_first_problem(error)}.") from error


def parse_host_message(line: bytes | str) -> HostMessage:
    """Parse a message from the host. Raises ``pydantic.ValidationError`` if it is not valid."""
    return _FROM_HOST.validate_json(line)


def line_of(message: AgentMessage | HostMessage) -> bytes:
    """Return a message as a line of JSON that ends with a line feed."""
    return message.model_dump_json().encode() + b"\n"


def _first_problem(error: ValidationError) -> str:
    """Return the first problem of an invalid message. It quotes little of the message, which may be long or unprintable."""
    first = error.errors(include_url=False, include_context=False, include_input=False)[0]
    place = ".".join(str(part) for part in first["loc"])
    problem = f"{place}: {first['msg']}" if place else first["msg"]
    return printable(problem.replace("Value error, ", ""), MAX_QUOTED_CHARS)


def printable(text: str, length: int) -> str:
    """Return the beginning of a text that an agent wrote, with "?" in place of characters that cannot be printed."""
    return "".join(character if character.isprintable() else "?" for character in text[:length])
