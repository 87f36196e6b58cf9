"""Convert a planner's state to chat messages and back. The log shows these messages, and any chat model can plan from them.

The wording is the same as in the chat planner. For planners that do not use the text, the metadata contains exact values, such as
poses and results.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import Any

from inspect_ai.model import (
    ChatMessage,
    ChatMessageAssistant,
    ChatMessageSystem,
    ChatMessageTool,
    ChatMessageUser,
    Content,
    ContentImage,
    ContentReasoning,
    ContentText,
)
from inspect_ai.tool import ToolCall as EngineCall
from inspect_ai.tool import ToolCallError, ToolInfo, ToolParams
from pydantic import TypeAdapter

from scope_ptz.agent.records import Called, Decided, Ended, Started
from scope_ptz.errors import PlannerError
from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.base import Briefing, CallTools, Exchange, Picture, State, ToolCall, ToolOutcome
from scope_ptz.planner.chat.chat_messages import valid_tool_name
from scope_ptz.planner.chat.observations import observation
from scope_ptz.planner.chat.prompts import Prompt
from scope_ptz.planner.chat.schemas import simplify_schemas
from scope_ptz.tools.registry import schemas

Record = Started | Decided | Called | Ended
"""A trace record."""

_BRIEFING: TypeAdapter[Briefing] = TypeAdapter(Briefing)


def messages_of(state: State, prompt: Prompt, *, sees: bool = False) -> list[ChatMessage]:
    """Convert a state to messages.

    Each step appends messages to those of the previous step, except that the newest view replaces the previous one.

    Args:
        state: The state.
        prompt: The system prompt.
        sees: Whether the planner accepts images.
    """
    briefing = state.briefing
    system = ChatMessageSystem(
        id="briefing",
        content=prompt.fill(briefing.presets, briefing.limits, briefing.pose, accepts_images=sees),
        metadata={"briefing": _BRIEFING.dump_python(briefing, mode="json")},
    )
    messages: list[ChatMessage] = [system, ChatMessageUser(id="instruction", content=state.instruction)]
    for step, exchange in enumerate(state.history, 1):
        messages += _exchange(exchange, step)
    if state.view is not None:
        messages.append(ChatMessageUser(id=f"view-{len(state.history)}", content=_picture_content(state.view)))
    return messages


def _exchange(exchange: Exchange, step: int) -> list[ChatMessage]:
    calls = [
        EngineCall(id=call_id(step, index), function=valid_tool_name(o.call.name), arguments=o.call.arguments)
        for index, o in enumerate(exchange.outcomes)
    ]
    assistant = ChatMessageAssistant(id=f"step-{step}", content=exchange.thought, tool_calls=calls)
    return [assistant, *(tool_message(outcome, step, index) for index, outcome in enumerate(exchange.outcomes))]


def call_id(step: int, index: int) -> str:
    """Return the id of a call in messages. Ids have nine characters, because some chat templates require this length."""
    return f"s{step:04d}c{index:03d}"


def tool_message(outcome: ToolOutcome, step: int, index: int) -> ChatMessageTool:
    """Convert the outcome of a call to a message for the planner, with the outcome in its metadata."""
    content: list[Content] = [ContentText(text=observation(outcome))]
    if outcome.picture is not None:
        content += _picture_content(outcome.picture)
    return ChatMessageTool(
        id=f"result-{step}-{index}",
        tool_call_id=call_id(step, index),
        function=valid_tool_name(outcome.call.name),
        content=content if outcome.picture is not None else observation(outcome),
        error=ToolCallError("unknown", outcome.error) if outcome.error is not None else None,
        metadata={"outcome": outcome.model_dump(mode="json")},
    )


def _picture_content(picture: Picture) -> list[Content]:
    return [ContentText(text=picture.caption), ContentImage(image=picture.data_url)]


def conversation_of(records: Sequence[Record], pictures: Mapping[str, str]) -> list[ChatMessage]:
    """Convert a run to a conversation for the log viewer.

    Args:
        records: The records of the trace.
        pictures: Data URLs of the pictures by name. A picture is shown in the message of the call that took it.
    """
    messages: list[ChatMessage] = []
    for record in records:
        match record:
            case Started():
                messages.append(
                    ChatMessageUser(content=[ContentText(text=record.instruction), *_images_named([record.frame], pictures)])
                )
            case Decided(decision=CallTools() as decision):
                calls = [
                    EngineCall(id=call_id(record.step, index), function=valid_tool_name(c.name), arguments=c.arguments)
                    for index, c in enumerate(decision.calls)
                ]
                thought = [ContentReasoning(reasoning=decision.reasoning)] if decision.reasoning else []
                messages.append(
                    ChatMessageAssistant(
                        content=[*thought, ContentText(text=decision.thought)], tool_calls=calls, source="generate"
                    )
                )
            case Called():
                message = tool_message(record.outcome, record.step, record.index)
                result = record.outcome.result or {}
                names = [*result.get("frames", ()), result.get("file"), record.frame]
                images = _images_named(names, pictures)
                if images:
                    message = message.model_copy(update={"content": [ContentText(text=message.text), *images]})
                messages.append(message)
            case Ended():
                messages.append(ChatMessageAssistant(content=record.text, source="generate"))
    return messages


def _images_named(names: Iterable[str | None], pictures: Mapping[str, str]) -> list[Content]:
    return [ContentImage(image=pictures[name]) for name in names if name is not None and name in pictures]


@cache
def _schemas() -> tuple[dict[str, Any], ...]:
    """Return the tool schemas, which are the same for every camera."""
    return tuple(schemas())


@cache
def _tool_infos() -> tuple[ToolInfo, ...]:
    functions = (tool["function"] for tool in simplify_schemas(_schemas()))
    return tuple(
        ToolInfo(name=f["name"], description=f["description"], parameters=ToolParams.model_validate(f["parameters"]))
        for f in functions
    )


def tool_infos() -> list[ToolInfo]:
    """Return the tools in Inspect's format."""
    return list(_tool_infos())


def state_of(messages: Sequence[ChatMessage]) -> State:
    """Convert messages to a state. If there is no briefing, the camera points straight ahead and has no presets.

    Raises:
        PlannerError: The messages contain no instruction.
    """
    system = next((m for m in messages if isinstance(m, ChatMessageSystem) and m.metadata and "briefing" in m.metadata), None)
    stored = system.metadata["briefing"] if system is not None and system.metadata else None
    briefing = _BRIEFING.validate_python(stored) if stored else Briefing(presets=(), pose=Pose(), limits=Limits())
    instruction = next((m for m in messages if isinstance(m, ChatMessageUser)), None)
    if instruction is None or not instruction.text.strip():
        raise PlannerError("The messages contain no instruction.")
    newest = messages[-1]
    view = _view(newest) if isinstance(newest, ChatMessageUser) and newest is not instruction else None
    return State(instruction=instruction.text, briefing=briefing, history=tuple(_history(messages)), tools=_schemas(), view=view)


def _history(messages: Sequence[ChatMessage]) -> list[Exchange]:
    results = {m.tool_call_id: m for m in messages if isinstance(m, ChatMessageTool)}
    history = []
    for message in messages:
        if isinstance(message, ChatMessageAssistant) and message.tool_calls:
            outcomes = tuple(_outcome(call, results.get(call.id)) for call in message.tool_calls)
            history.append(Exchange(outcomes=outcomes, thought=message.text))
    return history


def _outcome(call: EngineCall, message: ChatMessageTool | None) -> ToolOutcome:
    if message is not None and message.metadata and "outcome" in message.metadata:
        return ToolOutcome.model_validate(message.metadata["outcome"])
    tool_call = ToolCall(id=call.id, name=call.function, arguments=call.arguments)
    if message is None:
        return ToolOutcome(call=tool_call, error="Nothing came back.")
    if message.error is not None:
        return ToolOutcome(call=tool_call, error=message.error.message)
    return ToolOutcome(call=tool_call, result=_result_object(message.text))


def _result_object(text: str) -> dict[str, Any]:
    try:
        content = json.loads(text)
    except ValueError:
        content = None
    return content if isinstance(content, dict) else {"message": text}


def _view(message: ChatMessageUser) -> Picture | None:
    if isinstance(message.content, str):
        return None
    image = next((part for part in message.content if isinstance(part, ContentImage)), None)
    return Picture(data_url=image.image, caption=message.text) if image is not None else None
