"""A context that outgrows the model's window.

By default that is the end of a run, with an outcome of its own kind. When the user allows it, old observations are told in
brief instead: the calls stay, of their results only what was counted, read or found, and where the camera was.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from scope_ptz.planner.base import State

CHARS_PER_TOKEN = 3.2
"""On the safe side of what tokenizers make of English and JSON (3.5 to 4.5)."""

PICTURE_TOKENS = 1300
"""About what a frame of 1280x720 costs the vision models of today."""

KEPT_WHOLE = 2
"""The newest exchanges are never shortened: the planner is about to act on them."""

_FILL = 0.9
_REPLY_TOKENS = 512


def estimated_tokens(messages: Sequence[Mapping[str, Any]], tools: Sequence[Mapping[str, Any]]) -> int:
    """A rough count, without the model's tokenizer."""
    chars, pictures = len(json.dumps(tools)), 0
    for message in messages:
        content = message.get("content") or ""
        parts = content if isinstance(content, list) else [{"type": "text", "text": content}]
        pictures += sum(part["type"] == "image_url" for part in parts)
        chars += sum(len(part["text"]) for part in parts if part["type"] == "text")
        chars += len(json.dumps(message.get("tool_calls", ())))
    return round(chars / CHARS_PER_TOKEN) + pictures * PICTURE_TOKENS


def fits(messages: Sequence[Mapping[str, Any]], tools: Sequence[Mapping[str, Any]], context_tokens: int) -> bool:
    """Whether messages are likely to leave room for a reply in a window."""
    return estimated_tokens(messages, tools) + min(_REPLY_TOKENS, context_tokens // 4) <= context_tokens * _FILL


def shortenings(state: State) -> Iterator[int]:
    """How many of the oldest exchanges to tell in brief: half of them (an even number, so that the beginning of the messages
    changes only now and then and caches keep hitting), then all but the newest."""
    exchanges = sum(len(turn.exchanges) for turn in state.conversation) + len(state.history)
    most = exchanges - KEPT_WHOLE
    half = (exchanges // 2) // 2 * 2
    if 0 < half < most:
        yield half
    if most > 0:
        yield most
