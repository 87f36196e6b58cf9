"""Parsing completions in the formats of many servers, without characters that break files or terminals."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scope_ptz.endpoints.bodies import load_object, safe_text
from scope_ptz.endpoints.chat_replies import ChatReply, ReplyAssembler
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from tests.support.misbehaving import Say, completion, pieces

AT = Endpoint(url="http://127.0.0.1:1/v1")


def gather(*parts: dict[str, Any]) -> ChatReply:
    gathering = ReplyAssembler(AT)
    for part in parts:
        gathering.add(part)
    return gathering.reply()


def delta(**content: Any) -> dict[str, Any]:
    return {"choices": [{"index": 0, "delta": content}]}


def call(arguments: Any, **more: Any) -> dict[str, Any]:
    return {"function": {"name": "go_home", "arguments": arguments}} | more


SAYINGS = st.builds(
    Say,
    text=st.text(),
    reasoning=st.text(),
    tool_calls=st.lists(st.tuples(st.sampled_from(["go_home", "no_such_tool"]), st.text()), max_size=3).map(tuple),
)


@settings(deadline=None)
@given(SAYINGS)
def test_streamed_and_complete_replies_are_equal(say: Say) -> None:
    if not (say.text.strip() or say.reasoning.strip() or say.tool_calls):
        return
    whole = gather(completion(say))
    assert whole == gather(*pieces(say))
    assert [call.arguments_text for call in whole.tool_calls] == [safe_text(arguments) for _, arguments in say.tool_calls]


ANY_JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(
                ["choices", "message", "delta", "content", "tool_calls", "function", "usage", "model", "index", "id", "name"]
            ),
            inner,
            max_size=4,
        )
    ),
    max_leaves=25,
)


@settings(deadline=None)
@given(st.dictionaries(st.sampled_from(["choices", "usage", "model"]), ANY_JSON))
def test_any_data_is_a_reply_or_a_failure(data: dict[str, Any]) -> None:
    try:
        reply = gather(data)
    except ServerFailure as failure:
        assert failure.kind in (FailureKind.EMPTY, FailureKind.MALFORMED)
    else:
        assert reply.text.strip() or reply.reasoning.strip() or reply.tool_calls


@settings(deadline=None)
@given(st.binary() | ANY_JSON.map(lambda data: json.dumps({"a": data}).encode()))
def test_any_bytes_are_an_object_or_a_failure(body: bytes) -> None:
    try:
        data = load_object(body, AT, 200)
    except ServerFailure:
        return
    json.dumps(data, ensure_ascii=False).encode("utf-8")  # writable


def test_arguments_given_as_an_object_or_not_at_all() -> None:
    reply = gather({"choices": [{"message": {"tool_calls": [call({"a": 1}), call(None), call("{}")]}}]})
    assert [call.arguments_text for call in reply.tool_calls] == ['{"a": 1}', "", "{}"]


def test_calls_that_share_an_index_but_not_an_id() -> None:
    reply = gather(delta(tool_calls=[call("{}", index=0, id="a")]), delta(tool_calls=[call("{}", index=0, id="b")]))
    assert [call.id for call in reply.tool_calls] == ["a", "b"]


def test_pieces_of_a_call_without_an_index() -> None:
    rest = {"function": {"arguments": "}"}}
    reply = gather(delta(tool_calls=[call("{", id="a")]), delta(tool_calls=[rest]), delta(tool_calls=[call("{}", id="b")]))
    assert [call.arguments_text for call in reply.tool_calls] == ["{}", "{}"]


@pytest.mark.parametrize("field", ["reasoning", "reasoning_content"])
def test_reasoning_has_two_names(field: str) -> None:
    assert gather({"choices": [{"message": {"content": "x", field: "because"}}]}).reasoning == "because"


def test_content_in_parts() -> None:
    assert (
        gather({"choices": [{"message": {"content": [{"type": "text", "text": "a"}, {"type": "text", "text": "b"}]}}]}).text == "ab"
    )


@pytest.mark.parametrize(
    "usage", [None, [], "much", {"prompt_tokens": None}, {"prompt_tokens": -1}, {"prompt_tokens": float("nan")}]
)
def test_invalid_token_counts_are_zero(usage: Any) -> None:
    assert gather({"choices": [{"message": {"content": "x"}}], "usage": usage}).input_tokens == 0


def test_characters_that_break_files_or_terminals_are_replaced() -> None:
    body = b'{"choices":[{"message":{"content":"a\\ud800b\\u001b[2Jc\\u0000\\u009b d\\n"}}]}'
    reply = gather(load_object(body, AT, 200))
    assert reply.text == "a\ufffdb\ufffd[2Jc\ufffd\ufffd d\n"
    reply.model_dump_json().encode()


def test_raw_line_ends_in_strings_are_accepted() -> None:
    assert load_object(b'{"a": "x\ny"}', AT, 200) == {"a": "x\ny"}


def test_a_complete_call_is_not_joined_to_another() -> None:
    reply = gather({"choices": [{"message": {"tool_calls": [call("{}", index=0, id="a"), call("{}", index=0, id="a")]}}]})
    assert [call.arguments_text for call in reply.tool_calls] == ["{}", "{}"]


@pytest.mark.parametrize("marks", [{"id": "a"}, {"id": "a", "index": 0}, {}])
def test_pieces_that_repeat_their_name_are_one_call(marks: dict[str, Any]) -> None:
    parts = ("", '{"pan', '_deg": 5}', "")
    reply = gather(*(delta(tool_calls=[call(part, **marks)]) for part in parts))
    assert [call.arguments_text for call in reply.tool_calls] == ['{"pan_deg": 5}']


@pytest.mark.parametrize("marks", [{"id": "a"}, {"id": "a", "index": 0}, {}])
def test_complete_streamed_calls_with_the_same_index_are_separate(marks: dict[str, Any]) -> None:
    reply = gather(*(delta(tool_calls=[call(given, **marks)]) for given in ('{"a":', "1}", "{}")))
    assert [call.arguments_text for call in reply.tool_calls] == ['{"a":1}', "{}"]


@pytest.mark.parametrize("streamed", [False, True])
def test_the_interface_before_tools(streamed: bool) -> None:
    message = {"content": None, "function_call": {"name": "go_home", "arguments": "{}"}}
    reply = gather(delta(**message) if streamed else {"choices": [{"message": message}]})
    assert [(call.name, call.arguments_text) for call in reply.tool_calls] == [("go_home", "{}")]


@pytest.mark.parametrize(
    "body",
    [{"detail": "not loaded"}, {"message": "not loaded", "code": 500}, {"status": "error", "message": "not loaded"}],
)
def test_a_body_with_only_a_message_is_an_error(body: dict[str, Any]) -> None:
    with pytest.raises(ServerFailure) as raised:
        load_object(json.dumps(body).encode(), AT, 200)
    assert raised.value.kind == FailureKind.ERROR_BODY
    assert "not loaded" in str(raised.value)


def test_unreadable_bodies_are_quoted_briefly() -> None:
    with pytest.raises(ServerFailure, match="in 'Internal Server Error'"):
        load_object(b"Internal Server Error", AT, 200)
