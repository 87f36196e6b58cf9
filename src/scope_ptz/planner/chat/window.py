"""Estimate a conversation's tokens, and shorten conversations that exceed the model's context.

By default, the run ends with a context overflow. With ``ChatOptions.summarise``, old observations are shortened instead: all calls
are kept, and their results keep only counts, answers, poses and other short fields.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from scope_ptz.planner.base import State

CHARS_PER_TOKEN = 3.2
"""A conservative value; tokenizers average 3.5 to 4.5 characters per token for English and JSON."""

PICTURE_TOKENS = 1300
"""The approximate number of tokens that current vision models need for a 1280x720 frame."""

NEVER_SHORTENED = 2
"""Number of newest exchanges that are never shortened, because the planner is about to act on them."""

_USABLE_FRACTION = 0.9  # usable fraction of the context; the rest is a margin, because the token count is an estimate
_REPLY_TOKENS = 512  # tokens reserved for the reply


def estimated_tokens(messages: Sequence[Mapping[str, Any]], tools: Sequence[Mapping[str, Any]]) -> int:
    """Estimate the number of tokens in messages and tools, without the model's tokenizer."""
    chars, pictures = len(json.dumps(tools)), 0
    for message in messages:
        content = message.get("content") or ""
        parts = content if isinstance(content, list) else [{"type": "text", "text": content}]
        pictures += sum(part["type"] == "image_url" for part in parts)
        chars += sum(len(part["text"]) for part in parts if part["type"] == "text")
        chars += len(json.dumps(message.get("tool_calls", ())))
    return round(chars / CHARS_PER_TOKEN) + pictures * PICTURE_TOKENS


def fits(messages: Sequence[Mapping[str, Any]], tools: Sequence[Mapping[str, Any]], context_tokens: int) -> bool:
    """Return whether messages and tools probably leave room for a reply in the context."""
    return estimated_tokens(messages, tools) + min(_REPLY_TOKENS, context_tokens // 4) <= context_tokens * _USABLE_FRACTION


def shortenings(state: State) -> Iterator[int]:
    """Yield how many of the oldest exchanges to shorten: first about half of all exchanges, then all but ``NEVER_SHORTENED``.

    Half is rounded down to an even number, so that the beginning of the messages rarely changes and prefix caches keep working.
    """
    exchanges = sum(len(turn.exchanges) for turn in state.conversation) + len(state.history)
    maximum = exchanges - NEVER_SHORTENED
    half = (exchanges // 2) // 2 * 2
    if 0 < half < maximum:
        yield half
    if maximum > 0:
        yield maximum
