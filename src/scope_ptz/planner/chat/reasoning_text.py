"""Separate a reply's reasoning from its answer. Traces keep the reasoning, but it is never part of the answer.

Servers that support the model return its reasoning in a separate field. Other servers leave it in the text, between tags that
differ by model family.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from scope_ptz.planner.chat.harmony import read_harmony

_TAG_PAIRS = (
    ("<think>", "</think>"),  # Qwen, DeepSeek, GLM, SmolLM, Nemotron
    ("<thinking>", "</thinking>"),
    ("<thought>", "</thought>"),
    ("<reasoning>", "</reasoning>"),
    ("<seed:think>", "</seed:think>"),
    ("[THINK]", "[/THINK]"),  # Magistral
    ("◁think▷", "◁/think▷"),  # Kimi-VL
    ("<|channel>thought", "<channel|>"),  # Gemma 4
    ("<|START_THINKING|>", "<|END_THINKING|>"),  # Command A
)
_GRANITE = re.compile(
    r"\A\s*here(?:'s| is) my thought process:(?P<thought>.*?)here(?:'s| is) my response:", re.IGNORECASE | re.DOTALL
)
_CALL_START = re.compile(r"<tool_call>|<function=|<\|tool_call|\[TOOL_CALLS\]|<｜tool▁calls▁begin｜>")
"""The start of a tool call, which also ends reasoning that has no closing tag."""


@dataclass(frozen=True, slots=True)
class SeparatedReply:
    """A reply's answer and reasoning, stripped of whitespace; either may be empty."""

    text: str
    reasoning: str


def separate_reasoning(text: str, field: str = "") -> SeparatedReply:
    """Separate a reply into its answer and its reasoning.

    Args:
        text: The reply's content, as returned by the server.
        field: The reasoning that the server returned in a separate field.
    """
    rest, reasoning_parts = read_harmony(text)
    if granite := _GRANITE.match(rest):
        reasoning_parts.append(granite["thought"])
        rest = rest[granite.end() :]
    for opening, closing in _TAG_PAIRS:
        rest = _extract(rest, opening, closing, reasoning_parts)
    reasoning = "\n\n".join(t.strip() for t in (field, *reasoning_parts) if t.strip())
    return SeparatedReply(rest.strip(), reasoning)


def _extract(text: str, opening: str, closing: str, reasoning_parts: list[str]) -> str:
    """Append the text between opening and closing tags to ``reasoning_parts``, and return the other text."""
    visible: list[str] = []
    position, inside, tag_seen = 0, False, False
    for tag in re.finditer(f"{re.escape(opening)}|{re.escape(closing)}", text):
        opens = tag[0] == opening
        if inside and opens:
            continue
        # A closing tag without an opening tag: the chat template put the opening tag into the prompt.
        (reasoning_parts if inside or not (opens or tag_seen) else visible).append(text[position : tag.start()])
        position, inside, tag_seen = tag.end(), opens, True
    rest = text[position:]
    if not inside:
        return "".join((*visible, rest))
    call = _CALL_START.search(rest)
    cut = call.start() if call else len(rest)
    reasoning_parts.append(rest[:cut])
    return "".join((*visible, rest[cut:]))
