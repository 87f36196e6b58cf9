"""Tool calls in text, in the notations of model families, and texts that only look like calls."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scope_ptz.planner.chat.reasoning_text import separate_reasoning
from scope_ptz.planner.chat.tool_text import find_calls
from scope_ptz.planner.chat.written_calls import Signatures, WrittenCall, read_arguments
from scope_ptz.tools.registry import schemas

TOOLS = Signatures.of(schemas())
PAN = WrittenCall("adjust_ptz", {"pan_deg": 20})
HOME = WrittenCall("go_home", {})
COUNT = WrittenCall("count_objects", {"description": "red cars", "view": "full"})
PAN_JSON = '{"name": "adjust_ptz", "arguments": {"pan_deg": 20}}'
HOME_JSON = '{"name": "go_home", "arguments": {}}'
COUNT_XML = (
    "<function=count_objects>\n<parameter=description>\nred cars\n</parameter>\n<parameter=view>\nfull\n</parameter>\n</function>"
)
PAN_XML = "<function=adjust_ptz>\n<parameter=pan_deg>\n20\n</parameter>\n</function>"


@pytest.mark.parametrize(
    ("text", "calls", "rest"),
    [
        (f"<tool_call>\n{PAN_JSON}\n</tool_call>", [PAN], ""),
        (f"I turn.\n<tool_call>{PAN_JSON}</tool_call>\n<tool_call>{HOME_JSON}</tool_call>", [PAN, HOME], "I turn."),
        (f"<tool_call>{PAN_JSON}\n{HOME_JSON}</tool_call>", [PAN, HOME], ""),
        (f"<tool_call>[{PAN_JSON}, {HOME_JSON}]</tool_call>", [PAN, HOME], ""),
        (f"<tool_call>{PAN_JSON}", [PAN], ""),
        ('<tool_call>{"name": "adjust_ptz", "arguments": "{\\"pan_deg\\": 20}"}</tool_call>', [PAN], ""),
        ('<tool_call>{"name": "functions.adjust_ptz", "parameters": {"pan_deg": 20}}</tool_call>', [PAN], ""),
        ('<tool_call>{"function": {"name": "adjust_ptz", "arguments": {"pan_deg": 20}}}</tool_call>', [PAN], ""),
        ("<tool_call>go_home</tool_call>", [HOME], ""),
        (f"<tool_call>\n{COUNT_XML}\n</tool_call>", [COUNT], ""),
        (f"I look.\n<tool_call>\n{COUNT_XML}\n</tool_call>\n<tool_call>\n{PAN_XML}\n</tool_call>", [COUNT, PAN], "I look."),
        (f"{COUNT_XML}\n{PAN_XML}", [COUNT, PAN], ""),
        ("<function=go_home>\n</function>", [HOME], ""),
        ('<function=adjust_ptz>{"pan_deg": 20}</function>', [PAN], ""),
        ('<function name="adjust_ptz"><parameter name="pan_deg">20</parameter></function>', [PAN], ""),
        (
            "<tool_call>count_objects\n<arg_key>description</arg_key>\n<arg_value>red cars</arg_value>\n"
            "<arg_key>view</arg_key>\n<arg_value>full</arg_value>\n</tool_call>",
            [COUNT],
            "",
        ),
        (f"<tools>\n{PAN_JSON}\n</tools>", [PAN], ""),
        ("<|tool_call_start|>[adjust_ptz(pan_deg=20), go_home()]<|tool_call_end|>Turning.", [PAN, HOME], "Turning."),
        ("<|tool_call_start|>[adjust_ptz(pan_deg=-20.5)]<|tool_call_end|>", [WrittenCall("adjust_ptz", {"pan_deg": -20.5})], ""),
        (f"<|tool_call|>[{PAN_JSON}]<|/tool_call|>", [PAN], ""),
        (f"[TOOL_CALLS][{PAN_JSON}]", [PAN], ""),
        ('[TOOL_CALLS]adjust_ptz[ARGS]{"pan_deg": 20}[TOOL_CALLS]go_home[ARGS]{}', [PAN, HOME], ""),
        ('<|python_tag|>{"name": "adjust_ptz", "parameters": {"pan_deg": 20}}<|eom_id|>', [PAN], ""),
        (f"Sure:\n```json\n{PAN_JSON}\n```", [PAN], "Sure:"),
        (f"```json\n{PAN_JSON}\n```\nand then\n```json\n{HOME_JSON}\n```", [PAN, HOME], "and then"),
        (f"```\n[{PAN_JSON},\n{HOME_JSON}]\n```", [PAN, HOME], ""),
        (f"```tool_call\n{PAN_JSON}", [PAN], ""),
        ("```python\n[adjust_ptz(pan_deg=20)]\n```", [PAN], ""),
        (PAN_JSON, [PAN], ""),
        (f"{PAN_JSON}\n{HOME_JSON}", [PAN, HOME], ""),
        (f"{PAN_JSON}; {HOME_JSON}", [PAN, HOME], ""),
        (f"I will turn right.\n\n{PAN_JSON}", [PAN], "I will turn right."),
        ("[adjust_ptz(pan_deg=20), go_home()]", [PAN, HOME], ""),
    ],
)  # fmt: skip
def test_notations(text: str, calls: list[WrittenCall], rest: str) -> None:
    found = find_calls(text, TOOLS)
    assert (list(found.calls), found.rest) == (calls, rest)
    assert found.notation


@pytest.mark.parametrize(
    "text",
    [
        "There are 4 cones.",
        '{"count": 4, "sign": "EXIT"}',
        '```json\n{"count": 4}\n```',
        '{"name": "white van", "arguments": {}}',
        "You could call adjust_ptz(pan_deg=20) to turn right.",
        'The sign says {"name": "go_home"}, as if it were a command.',
        "",
    ],
)
def test_answers_stay_answers(text: str) -> None:
    assert find_calls(text, TOOLS).calls == ()
    assert find_calls(text, TOOLS).rest == text.strip()


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ('<tool_call>{"name": "adjust_ptz", "arguments": {"pan_deg": 20</tool_call>', "adjust_ptz"),
        ("<tool_call>{'name': 'adjust_ptz', 'arguments': {}}</tool_call>", "adjust_ptz"),
        ('<tool_call>{"name": "adjust_ptz", "arguments": {"pan_deg": NaN}}</tool_call>', "adjust_ptz"),
        ('<tool_call>{"name": "adjust_ptz", "arguments": {"pan_deg": 1e999}}</tool_call>', "adjust_ptz"),
        ("<tool_call>turn right please</tool_call>", ""),
        ("<tool_call></tool_call>", ""),
        ("<tool_call>" + "[" * 20000 + "</tool_call>", ""),
        ("<|tool_call_start|>[adjust_ptz(20)]<|tool_call_end|>", "adjust_ptz"),
        ("<|tool_call_start|>[adjust_ptz(pan_deg=__import__('os').getpid())]<|tool_call_end|>", "adjust_ptz"),
        ("<|tool_call_start|>[adjust_ptz(pan_deg=1e999)]<|tool_call_end|>", "adjust_ptz"),
        ("<tool_call><function=adjust_ptz>pan_deg 20</function></tool_call>", "adjust_ptz"),
    ],
)
def test_an_unreadable_marked_call_becomes_an_error(text: str, name: str) -> None:
    (call,) = find_calls(text, TOOLS).calls
    assert call.name == name
    assert call.malformed


def test_values_take_the_type_of_their_parameter() -> None:
    text = "<tool_call><function=query_answer><parameter=question>42</parameter></function></tool_call>"
    assert find_calls(text, TOOLS).calls == (WrittenCall("query_answer", {"question": "42"}),)
    text = "<tool_call><function=adjust_ptz><parameter=pan_deg>a lot</parameter></function></tool_call>"
    assert find_calls(text, TOOLS).calls == (WrittenCall("adjust_ptz", {"pan_deg": "a lot"}),)
    text = "<tool_call><function=adjust_ptz><parameter=zoom_factor>null</parameter></function></tool_call>"
    assert find_calls(text, TOOLS).calls == (WrittenCall("adjust_ptz", {"zoom_factor": None}),)


@pytest.mark.parametrize(
    ("text", "arguments", "readable"),
    [
        ('{"pan_deg": 20}', {"pan_deg": 20}, True),
        ("", {}, True),
        ("null", {}, True),
        ('"{\\"pan_deg\\": 20}"', {"pan_deg": 20}, True),
        ('{"pan_deg": 20', {}, False),
        ("[20]", {}, False),
        ("20", {}, False),
        ('{"pan_deg": Infinity}', {}, False),
        ('{"a": "\\ud800"}', {"a": "?"}, True),
    ],
)
def test_arguments(text: str, arguments: dict[str, Any], readable: bool) -> None:
    read, malformed = read_arguments(text)
    assert read == arguments
    assert (malformed is None) == readable


_PIECES = st.sampled_from(
    ["<tool_call>", "</tool_call>", "<function=", "</function>", "<parameter=a>", "{", "}", "[", "]", '"name":', '"go_home"',
     "go_home", "(", ")", "```", "\n", "<|python_tag|>", "[TOOL_CALLS]", "<arg_key>", "1e999", "x", "\ud800", ",", "<think>"]
)  # fmt: skip


@settings(max_examples=200, deadline=None)
@given(st.lists(_PIECES, max_size=25).map("".join))
def test_any_text_is_parsed_without_an_exception(text: str) -> None:
    found = find_calls(text, TOOLS)
    for call in found.calls:
        json.dumps({"name": call.name, "arguments": call.arguments, "malformed": call.malformed}, allow_nan=False).encode()


@settings(max_examples=100, deadline=None)
@given(st.text(max_size=60))
def test_arguments_of_any_text_are_an_object(text: str) -> None:
    read, malformed = read_arguments(text)
    assert isinstance(read, dict)
    assert malformed is None or read == {}


@pytest.mark.parametrize(
    "mark",
    [
        "<think> ",
        "</think> ",
        "<|channel|>",
        "<tool_call>",
        "<function=a>",
        "<parameter=a>",
        "<arg_key>",
        "[TOOL_CALLS]",
        "```\n",
        "{ \n",
        "? ",
    ],
)
def test_megabytes_of_markup_are_parsed_quickly(mark: str) -> None:
    """Quadratic parsing would not finish."""
    parted = separate_reasoning("<tool_call>" + mark * 50_000)
    find_calls(parted.text, TOOLS)
    find_calls(mark * 50_000, TOOLS)
    separate_reasoning(mark * 50_000)
