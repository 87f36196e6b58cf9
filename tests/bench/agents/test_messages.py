"""Messages: the documented examples are valid and complete, and arbitrary bytes are rejected."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.bench.agents.messages import (
    MAX_QUOTED_CHARS,
    Calls,
    RequestedCall,
    encode_message,
    parse_agent_message,
    parse_host_message,
    printable,
)
from scope_ptz.errors import PlannerError

PAGE = (Path(__file__).parents[3] / "docs" / "external-agents.md").read_text("utf-8")
FROM_AGENT, FROM_HOST = (
    [json.loads(text) for text in re.findall(r"```json\n(.*?)```", part, re.DOTALL)]
    for part in PAGE.split("### From the agent")[1].split("### From the host")
)
JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**62), 2**62) | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda children: st.lists(children, max_size=3) | st.dictionaries(st.text(), children, max_size=3),
    max_leaves=10,
)


@pytest.mark.parametrize("example", FROM_AGENT, ids=lambda example: example["type"])
def test_documented_messages_of_agents(example: dict[str, Any]) -> None:
    message = parse_agent_message(json.dumps(example))
    assert {name: value for name, value in message.model_dump(mode="json").items() if name in example} == example


@pytest.mark.parametrize("example", FROM_HOST, ids=lambda example: example["type"])
def test_documented_messages_of_the_host(example: dict[str, Any]) -> None:
    assert parse_host_message(json.dumps(example)).model_dump(mode="json") == example


def test_every_message_is_documented() -> None:
    assert {example["type"] for example in FROM_AGENT} == {"hello", "calls", "view", "reply"}
    assert {example["type"] for example in FROM_HOST} == {"task", "results", "view", "error", "end"}


@given(st.dictionaries(st.text(), JSON_VALUES, max_size=4))
def test_arguments_survive_a_round_trip(arguments: dict[str, Any]) -> None:
    message = Calls(calls=(RequestedCall(id="1", name="x", arguments=arguments),))
    line = encode_message(message)
    assert line.count(b"\n") == 1 and parse_agent_message(line) == message


@given(st.binary(max_size=200) | JSON_VALUES.map(lambda value: json.dumps(value).encode()))
def test_arbitrary_bytes_are_rejected(data: bytes) -> None:
    with pytest.raises(PlannerError) as excinfo:
        parse_agent_message(data)
    assert excinfo.value.kind == "agent-protocol" and len(str(excinfo.value)) < MAX_QUOTED_CHARS + 100


@given(st.text(min_size=1), st.integers(1, 50))
def test_quoted_text_can_be_printed(text: str, length: int) -> None:
    assert printable(text, length).isprintable() and len(printable(text, length)) == min(length, len(text))


@pytest.mark.parametrize(
    "arguments",
    [
        '{"x": 1e999}',
        '{"x": -Infinity}',
        '{"x": 9223372036854775808}',
        '{"x": ' + "[" * 40 + "]" * 40 + "}",
        '{"x": "\\ud800"}',
        "[]",
    ],
)
def test_invalid_arguments_are_rejected(arguments: str) -> None:
    with pytest.raises(PlannerError) as excinfo:
        parse_agent_message(f'{{"type": "calls", "calls": [{{"id": "1", "name": "x", "arguments": {arguments}}}]}}')
    assert excinfo.value.kind == "agent-protocol"


def test_ids_must_differ() -> None:
    call = '{"id": "1", "name": "x"}'
    with pytest.raises(PlannerError, match="differ"):
        parse_agent_message(f'{{"type": "calls", "calls": [{call}, {call}]}}')
