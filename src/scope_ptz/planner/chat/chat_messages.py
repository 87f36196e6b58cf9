"""Convert the state S_t to chat messages.

The messages are append-only: the messages of each step begin with exactly those of the previous step, so that the server's prefix
cache works. There are two exceptions: for planners that accept images, the current view replaces the previous view; and with
``ChatOptions.summarise``, old exchanges are shortened when the context is full.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import Any, Literal

from scope_ptz.geometry import Pose
from scope_ptz.planner.base import Exchange, Picture, State, ToolCall, ToolOutcome
from scope_ptz.planner.chat.observations import observation
from scope_ptz.planner.chat.prompts import Prompt
from scope_ptz.planner.chat.schemas import simplify_schemas

Message = dict[str, Any]
Notation = Literal["native", "text"]
"""How tool calls are exchanged: in the API's native fields, or written into the text of messages."""

_TEXT_TOOLS = """

# Tools
You call a tool by writing, for each call:
<tool_call>
{"name": <name of the tool>, "arguments": <JSON object>}
</tool_call>
The results come back in <tool_response> elements. These are the tools, as JSON schemas:
"""


def build_messages(
    state: State,
    prompt: Prompt,
    *,
    notation: Notation = "native",
    accepts_images: bool = False,
    switch: str = "",
    shorten_oldest: int = 0,
) -> list[Message]:
    """Return the chat messages for a state.

    Args:
        state: The state of the run.
        prompt: The system prompt.
        notation: How tool calls are exchanged.
        accepts_images: Whether the model accepts images.
        switch: Text to append to the user messages to switch the model's reasoning on or off.
        shorten_oldest: How many of the oldest exchanges to shorten.
    """
    builder = _MessageListBuilder(notation, shorten_oldest, in_parts=accepts_images)
    briefing = state.briefing
    start_poses = [turn.start for turn in state.conversation] + [briefing.pose]
    first = start_poses[0] or briefing.pose
    system = prompt.fill(briefing.presets, briefing.limits, first, accepts_images=accepts_images)
    if notation == "text":
        system += _TEXT_TOOLS + "\n".join(
            json.dumps(tool["function"], ensure_ascii=False) for tool in simplify_schemas(state.tools)
        )
    builder.add({"role": "system", "content": system})
    for turn, start in zip(state.conversation, start_poses[:-1], strict=True):
        builder.add_user(_instruction(turn.instruction, None if start == first else start, switch))
        for exchange in turn.exchanges:
            builder.add_exchange(exchange)
        builder.add({"role": "assistant", "content": turn.reply})
    builder.add_user(_instruction(state.instruction, start_poses[-1] if state.conversation else None, switch))
    for exchange in state.history:
        builder.add_exchange(exchange)
    if accepts_images and state.view is not None:
        builder.add_pictures([state.view])
    return builder.messages


def _instruction(text: str, start: Pose | None, switch: str) -> str:
    where = ""
    if start is not None:
        pose = start.as_dict()
        where = f"(The camera is now at pan {pose['pan_deg']:g}, tilt {pose['tilt_deg']:g}, zoom {pose['zoom']:g}.)\n"
    return f"{where}{text}{' ' + switch if switch else ''}"


class _MessageListBuilder:
    """Builds the list of messages. Consecutive user messages are merged, because chat templates require alternating roles."""

    def __init__(self, notation: Notation, shorten_oldest: int, *, in_parts: bool) -> None:
        """Create the builder.

        Args:
            notation: How tool calls are exchanged.
            shorten_oldest: How many of the oldest exchanges to shorten.
            in_parts: Whether user messages are lists of parts, so that pictures can be appended.
        """
        self.messages: list[Message] = []
        self._in_parts = in_parts
        self._notation, self._shorten_oldest, self._exchanges = notation, shorten_oldest, 0
        self._used: set[str] = set()

    def add(self, message: Message) -> None:
        self.messages.append(message)

    def add_user(self, content: str | list[Message]) -> None:
        last = self.messages[-1]
        if last["role"] == "user":
            # The old message is not changed in place, because a caller may still refer to it.
            self.messages[-1] = {"role": "user", "content": [*_parts(last["content"]), *_parts(content)]}
        else:
            self.add({"role": "user", "content": _parts(content) if self._in_parts else content})

    def add_pictures(self, pictures: Sequence[Picture]) -> None:
        self.add_user([part for picture in pictures for part in _picture_parts(picture)])

    def add_exchange(self, exchange: Exchange) -> None:
        is_shortened = self._exchanges < self._shorten_oldest
        self._exchanges += 1
        if self._notation == "native":
            self._add_native_calls(exchange, is_shortened)
        else:
            self._add_text_calls(exchange, is_shortened)
        pictures = [o.picture for o in exchange.outcomes if o.picture is not None]
        if pictures and self._in_parts and not is_shortened:
            self.add_pictures(pictures)

    def _add_native_calls(self, exchange: Exchange, is_shortened: bool) -> None:
        ids = [self._unique_id(outcome.call.id) for outcome in exchange.outcomes]
        calls = [
            {"id": i, "type": "function", "function": {"name": valid_tool_name(o.call.name), "arguments": _arguments(o.call)}}
            for i, o in zip(ids, exchange.outcomes, strict=True)
        ]
        self.add({"role": "assistant", "content": exchange.thought, "tool_calls": calls})
        for call_id, outcome in zip(ids, exchange.outcomes, strict=True):
            self.add({"role": "tool", "tool_call_id": call_id, "content": observation(outcome, is_shortened=is_shortened)})

    def _add_text_calls(self, exchange: Exchange, is_shortened: bool) -> None:
        calls = "\n".join(_call_element(outcome) for outcome in exchange.outcomes)
        self.add({"role": "assistant", "content": f"{exchange.thought}\n{calls}".strip()})
        results = (f"<tool_response>\n{observation(o, is_shortened=is_shortened)}\n</tool_response>" for o in exchange.outcomes)
        self.add_user("\n".join(results))

    def _unique_id(self, call_id: str) -> str:
        """Return a call's id, or a new one if the id is empty or already used. Some servers give every call the same id."""
        if not call_id or call_id in self._used:
            call_id = f"call{len(self._used) + 1:05d}"  # nine letters and digits, as Mistral's templates require
        self._used.add(call_id)
        return call_id


def valid_tool_name(name: str) -> str:
    """Replace with underscores the characters that the OpenAI API does not allow in tool names. Models can invent any name."""
    return re.sub(r"[^\w-]", "_", name, flags=re.ASCII)[:64] or "unreadable"


def _arguments(call: ToolCall) -> str:
    """Return a call's arguments as a JSON object.

    Servers render the arguments with chat templates, which fail on anything but an object. A malformed call has no arguments; its
    error message quotes the original text.
    """
    return json.dumps(call.arguments, ensure_ascii=False)


def _call_element(outcome: ToolOutcome) -> str:
    data = {"name": outcome.call.name, "arguments": outcome.call.arguments}
    return f"<tool_call>\n{json.dumps(data, ensure_ascii=False)}\n</tool_call>"


def _parts(content: str | list[Message]) -> list[Message]:
    return [{"type": "text", "text": content}] if isinstance(content, str) else content


def _picture_parts(picture: Picture) -> list[Message]:
    return [{"type": "text", "text": picture.caption}, {"type": "image_url", "image_url": {"url": picture.data_url}}]
