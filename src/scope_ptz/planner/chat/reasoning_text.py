"""Separating reasoning from the answer. Reasoning is kept in traces, and never shown or used as an answer.

Servers that know the model return its reasoning in a field of its own. Others leave it in the text, between marks that differ by
family.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from scope_ptz.planner.chat.harmony import read_harmony

_PAIRS = (
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
_CALL_BEGINS = re.compile(r"<tool_call>|<function=|<\|tool_call|\[TOOL_CALLS\]|<｜tool▁calls▁begin｜>")
"""The beginning of a call, which also ends reasoning that was not closed."""


@dataclass(frozen=True, slots=True)
class Parted:
    """The two parts of a reply, stripped; either may be empty."""

    text: str
    reasoning: str


def part(text: str, field: str = "") -> Parted:
    """Separate a reply into text and reasoning.

    Args:
        text: The content as the server returned it.
        field: Reasoning that the server already separated.
    """
    rest, thoughts = read_harmony(text)
    if granite := _GRANITE.match(rest):
        thoughts.append(granite["thought"])
        rest = rest[granite.end() :]
    for opening, closing in _PAIRS:
        rest = _take(rest, opening, closing, thoughts)
    reasoning = "\n\n".join(t.strip() for t in (field, *thoughts) if t.strip())
    return Parted(rest.strip(), reasoning)


def _take(text: str, opening: str, closing: str, thoughts: list[str]) -> str:
    """Move the text between two marks from ``text`` to ``thoughts``, in one pass."""
    kept: list[str] = []
    at, inside, seen = 0, False, False
    for mark in re.finditer(f"{re.escape(opening)}|{re.escape(closing)}", text):
        opens = mark[0] == opening
        if inside and opens:
            continue
        # Closed without being opened: the chat template put the opening mark into the prompt.
        (thoughts if inside or not (opens or seen) else kept).append(text[at : mark.start()])
        at, inside, seen = mark.end(), opens, True
    rest = text[at:]
    if not inside:
        return "".join((*kept, rest))
    call = _CALL_BEGINS.search(rest)
    cut = call.start() if call else len(rest)
    thoughts.append(rest[:cut])
    return "".join((*kept, rest[cut:]))
