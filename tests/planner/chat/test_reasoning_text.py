"""Reasoning is separated from answers in all formats of servers."""

from __future__ import annotations

import pytest

from scope_ptz.planner.chat.reasoning_text import separate_reasoning

CALL = '<tool_call>{"name": "go_home", "arguments": {}}</tool_call>'


@pytest.mark.parametrize(
    ("text", "answer", "reasoning"),
    [
        ("Four cones.", "Four cones.", ""),
        ("<think>\nI count.\n</think>\n\nFour cones.", "Four cones.", "I count."),
        ("<think>\n\n</think>\n\nFour cones.", "Four cones.", ""),
        ("I count.\n</think>\n\nFour cones.", "Four cones.", "I count."),
        ("<think>I count, and never end", "", "I count, and never end"),
        (f"<think>I go home. {CALL}", CALL, "I go home."),
        ("<think>a</think>One.<think>b</think> Two.", "One. Two.", "a\n\nb"),
        ("[THINK]hm[/THINK]Yes.", "Yes.", "hm"),
        ("◁think▷hm◁/think▷Yes.", "Yes.", "hm"),
        ("<|channel>thought\nhm<channel|>Yes.", "Yes.", "hm"),
        ("Here is my thought process: hm Here is my response: Yes.", "Yes.", "hm"),
        ("<|channel|>analysis<|message|>hm<|end|><|start|>assistant<|channel|>final<|message|>Yes.<|return|>", "Yes.", "hm"),
        (
            "<|channel|>analysis<|message|>hm<|end|><|start|>assistant<|channel|>commentary to=functions.go_to_preset "
            '<|constrain|>json<|message|>{"name": "gate"}<|call|>',
            '<tool_call><function=go_to_preset>{"name": "gate"}</function></tool_call>',
            "hm",
        ),
    ],
)
def test_reasoning_is_separated_from_text(text: str, answer: str, reasoning: str) -> None:
    parted = separate_reasoning(text)
    assert (parted.text, parted.reasoning) == (answer, reasoning)


def test_the_reasoning_field_of_the_server_takes_precedence() -> None:
    parted = separate_reasoning("<think>b</think>Yes.", "a")
    assert (parted.text, parted.reasoning) == ("Yes.", "a\n\nb")
