"""From replies to decisions: several calls, invalid calls, final answers, truncated replies, model families, and refused fields."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from scope_ptz.endpoints.chat_replies import ChatReply, RawToolCall
from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from scope_ptz.errors import PlannerError
from scope_ptz.planner.base import CallTools, Finish
from scope_ptz.planner.chat import ChatOptions, prompt_names
from scope_ptz.planner.chat.dialect import Dialect
from scope_ptz.planner.chat.families import family_of, reasoning_switch, temperature_for, usual_server
from scope_ptz.planner.chat.interpret import MAX_CALLS, decide
from scope_ptz.planner.chat.schemas import simplify_schemas
from scope_ptz.tools.registry import schemas
from tests.planner.chat.test_chat_messages import exchanges, state


def reply(text: str = "", *calls: tuple[str, str, str], **fields: Any) -> ChatReply:
    raw = tuple(RawToolCall(id=i, name=name, arguments_text=arguments) for i, name, arguments in calls)
    return ChatReply(text=text, tool_calls=raw, **fields)


def finish(text: str, steps: int = 0, **fields: Any) -> tuple[str, str]:
    decision = decide(reply(text, **fields), state(*exchanges(steps)))
    assert isinstance(decision, Finish)
    return decision.kind, decision.text


def test_several_native_calls_with_text() -> None:
    given = reply(
        "I turn.", ("a", "adjust_ptz", '{"pan_deg": 20}'), ("b", "go_home", ""), input_tokens=9, cached_tokens=4, reasoning="hm"
    )
    decision = decide(given, state())
    assert isinstance(decision, CallTools)
    assert [(c.id, c.name, c.arguments, c.problem) for c in decision.calls] == [
        ("a", "adjust_ptz", {"pan_deg": 20}, None),
        ("b", "go_home", {}, None),
    ]
    assert (decision.thought, decision.reasoning, decision.usage.cached_tokens) == ("I turn.", "hm", 4)
    assert decision.served is not None
    assert decision.served.calls_from == "native"


@pytest.mark.parametrize("arguments", ['{"pan_deg": 20', "[1]", "right", '{"pan_deg": NaN}', '{"pan_deg": 1e999}', "{" * 5000])
def test_arguments_that_are_not_an_object_give_a_call_with_an_error(arguments: str) -> None:
    decision = decide(reply("", ("a", "adjust_ptz", arguments)), state())
    assert isinstance(decision, CallTools)
    (call,) = decision.calls
    assert call.arguments == {}
    assert call.problem is not None
    assert "adjust_ptz" in call.problem
    assert len(call.problem) < 500


def test_calls_that_the_server_left_in_the_text_are_removed() -> None:
    twice = 'I go. <tool_call>{"name": "go_home", "arguments": {}}</tool_call>'
    decision = decide(reply(twice, ("a", "go_home", "{}")), state())
    assert isinstance(decision, CallTools)
    assert (len(decision.calls), decision.thought) == (1, "I go.")


def test_simplified_schemas_keep_their_meaning() -> None:
    for plain, full in zip(simplify_schemas(schemas()), schemas(), strict=True):
        assert plain["function"]["name"] == full["function"]["name"]
        theirs, ours = plain["function"]["parameters"], full["function"]["parameters"]
        assert (theirs.get("required"), theirs["additionalProperties"]) == (ours.get("required"), False)
        assert theirs["properties"].keys() == ours["properties"].keys()
        for name, prop in theirs["properties"].items():
            assert set(prop) <= {"type", "description", "enum"}
            assert isinstance(prop["type"], str)
            assert prop["description"] == ours["properties"][name]["description"]


def test_calls_without_an_id_from_the_server_get_one() -> None:
    decision = decide(reply("", ("", "go_home", "{}"), ("", "go_home", "{}")), state(*exchanges(2)))
    assert isinstance(decision, CallTools)
    assert [c.id for c in decision.calls] == ["s0003c001", "s0003c002"]


def test_the_number_of_calls_is_limited() -> None:
    many = [(f"c{n}", "go_home", "{}") for n in range(500)]
    decision = decide(reply("", *many), state())
    assert isinstance(decision, CallTools)
    assert len(decision.calls) == MAX_CALLS + 1
    assert [c.problem is None for c in decision.calls[-2:]] == [True, False]


def test_calls_in_reasoning_count_only_without_other_text() -> None:
    thought = 'I go. <tool_call>{"name": "go_home", "arguments": {}}</tool_call>'
    decision = decide(reply("", reasoning=thought), state())
    assert isinstance(decision, CallTools)
    assert finish("I stay.", reasoning=thought) == ("answered", "I stay.")


@pytest.mark.parametrize(
    ("text", "steps", "ending"),
    [
        ("Four cones.", 1, ("answered", "Four cones.")),
        ("Four cones.<|im_end|>", 1, ("answered", "Four cones.")),
        ("<think>hm</think>Four cones.", 1, ("answered", "Four cones.")),
        ("Which car do you mean?", 0, ("clarification", "Which car do you mean?")),
        ("I see four. Do you want more?", 2, ("answered", "I see four. Do you want more?")),
        ("CLARIFY: Which car?", 3, ("clarification", "Which car?")),
        ("**Clarify:** Which car?", 0, ("clarification", "Which car?")),
        ("REFUSE: I cannot move the house.", 0, ("refused", "I cannot move the house.")),
        ("REFUSE:", 0, ("answered", "REFUSE:")),
        ("The sign says: REFUSE: no entry", 1, ("answered", "The sign says: REFUSE: no entry")),
    ],
)
def test_the_end_of_a_run(text: str, steps: int, ending: tuple[str, str]) -> None:
    assert finish(text, steps) == ending


@pytest.mark.parametrize(
    ("given", "window", "kind"),
    [
        (reply("The answer is", finish_reason="length", input_tokens=4000, output_tokens=96), 4096, "context-overflow"),
        (reply("The answer is", finish_reason="length", input_tokens=4000, output_tokens=96), 8192, "cut-off"),
        (reply("The answer is", finish_reason="length"), None, "cut-off"),
        (reply("", reasoning="I think and think", finish_reason="length"), None, "cut-off"),
        (reply("<think>I only think</think>"), None, "empty"),
        (reply("<|im_end|>"), None, "empty"),
    ],
)
def test_replies_without_a_decision_are_errors(given: ChatReply, window: int | None, kind: str) -> None:
    with pytest.raises(PlannerError) as caught:
        decide(given, state(), context_tokens=window)
    assert caught.value.kind == kind


def test_an_endless_answer_is_truncated_and_marked() -> None:
    _, text = finish("ha " * 100_000, 1)
    assert len(text) < 21_000
    assert text.endswith("more characters)")


def test_complete_calls_of_a_truncated_reply_are_carried_out() -> None:
    cut = reply("", ("a", "go_home", "{}"), ("b", "adjust_ptz", '{"pan_'), finish_reason="length")
    decision = decide(cut, state())
    assert isinstance(decision, CallTools)
    assert [c.problem is None for c in decision.calls] == [True, False]


@pytest.mark.parametrize(
    ("model", "family"),
    [
        ("Qwen/Qwen3-4B-Instruct-2507-FP8", "qwen3-instruct"),
        ("Qwen/Qwen3-Next-80B-A3B-Instruct", "qwen3-instruct"),
        ("qwen3:4b-instruct", "qwen3-instruct"),
        ("Qwen/Qwen3-32B", "qwen3"),
        ("Qwen3-32B-Instruct", "qwen3"),
        ("Qwen/Qwen3-4B-Thinking-2507", "qwen3-thinking"),
        ("Qwen/Qwen3.5-9B", "qwen3.5"),
        ("openai/gpt-oss-120b", "gpt-oss"),
        ("google/gemma-4-E4B-it", "gemma-4"),
        ("HuggingFaceTB/SmolLM3-3B", "smollm3"),
        ("my-own-model", "unknown"),
    ],
)
def test_families(model: str, family: str) -> None:
    assert family_of(model).name == family


def test_reasoning_is_switched_on_and_off_as_each_family_requires() -> None:
    off = reasoning_switch("Qwen/Qwen3-32B", "off", "vllm")
    assert (off.fields, off.words) == ({"chat_template_kwargs": {"enable_thinking": False}}, "/no_think")
    assert reasoning_switch("Qwen/Qwen3.5-9B", "on", None).fields == {"chat_template_kwargs": {"enable_thinking": True}}
    assert reasoning_switch("qwen3.5:9b", "off", usual_server("http://localhost:11434/v1")).fields == {"reasoning_effort": "none"}
    assert reasoning_switch("openai/gpt-oss-20b", "off", "vllm").fields == {"reasoning_effort": "low"}
    assert reasoning_switch("ibm-granite/granite-3.3-8b-instruct", "on", "vllm").fields == {
        "chat_template_kwargs": {"thinking": True}
    }
    for model in ("Qwen/Qwen3-4B-Instruct-2507", "my-own-model"):
        assert reasoning_switch(model, "off", None) == reasoning_switch(model, "default", None)
    assert not reasoning_switch("Qwen/Qwen3-32B", "default", None).fields
    assert temperature_for("Qwen/Qwen3-32B", "off") == 0.0
    assert temperature_for("Qwen/Qwen3-32B", "default") == 0.6


def refusal(words: str, kind: FailureKind = FailureKind.BAD_REQUEST) -> ServerFailure:
    return ServerFailure(kind, where="http://x/v1", status=400, detail=words)


def test_refused_fields_are_not_sent_again() -> None:
    dialect = Dialect("native", fixed=False)
    wanted = {"temperature": 0.0, "seed": None, "max_tokens": 9, "chat_template_kwargs": {"enable_thinking": False}}
    sent = dialect.fields(wanted)
    assert "seed" not in sent
    assert dialect.adapt(refusal("Unexpected keys in the request: {'chat_template_kwargs'}"), sent, with_tools=True)
    assert dialect.adapt(refusal("'max_tokens' is not supported; use 'max_completion_tokens'"), sent, with_tools=True)
    assert dialect.fields(wanted) == {"temperature": 0.0, "max_completion_tokens": 9}
    assert dialect.adapt(refusal("Unsupported value: 'temperature'"), sent, with_tools=True)
    assert dialect.adapt(refusal('"auto" tool choice requires --enable-auto-tool-choice'), sent, with_tools=True)
    assert dialect.notation == "text"
    assert Dialect("native", fixed=False).adapt(refusal("Conversation roles must alternate user/assistant"), {}, with_tools=True)
    assert dialect.adapt(refusal("System role not supported"), sent, with_tools=False)
    assert [m["role"] for m in dialect.messages([{"role": "system", "content": "a"}, {"role": "user", "content": "b"}])] == ["user"]
    assert not dialect.adapt(refusal("something else"), {}, with_tools=False)
    assert not dialect.adapt(refusal("tools", FailureKind.REFUSED), {}, with_tools=True)


def test_a_chosen_notation_is_kept() -> None:
    assert not Dialect("native", fixed=True).adapt(refusal("tools are not supported"), {}, with_tools=True)


def test_every_option_is_documented() -> None:
    docs = (Path(__file__).parents[3] / "docs" / "planner.md").read_text(encoding="utf-8")
    assert [name for name in ChatOptions.model_fields if f"`{name}`" not in docs] == []
    assert [name for name in prompt_names() if f"`{name}`" not in docs] == []
