"""Provide SCOPE's planners, perception backends and judges as Inspect models, such as ``scope_ptz/grammar``."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

import anyio
from inspect_ai.model import (
    ChatCompletionChoice,
    ChatMessage,
    ChatMessageAssistant,
    ContentReasoning,
    ContentText,
    GenerateConfig,
    Model,
    ModelAPI,
    ModelCall,
    ModelOutput,
    ModelUsage,
    StopReason,
    get_model,
    modelapi,
)
from inspect_ai.tool import ToolCall, ToolChoice, ToolInfo
from pydantic import BaseModel

from scope_ptz.bench.engine.context import EvalContext, ModelRequest
from scope_ptz.bench.engine.recording.recorded_chat import Exchanges, recording_planner
from scope_ptz.bench.engine.recording.transcript import call_id, state_of
from scope_ptz.bench.judging.judge import Complete
from scope_ptz.errors import ConfigError
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import CallTools, Decision, Planner
from scope_ptz.planner.chat.chat_messages import valid_tool_name

__all__ = ["PROVIDER", "Model", "ScopeModel", "inspect_model", "output_of", "scope_ptz"]

PROVIDER = "scope_ptz"
"""Name of the Inspect provider, as in ``scope_ptz/grammar``."""

_Reply = TypeVar("_Reply", bound=BaseModel)


class ScopeModel(ModelAPI):
    """An Inspect model that runs one of SCOPE's planners, perception backends or judges.

    The model name is the name of a registered model, or of a built-in planner or perception backend.
    """

    def __init__(
        self,
        model_name: str,
        base_url: str | None = None,
        api_key: str | None = None,
        config: GenerateConfig | None = None,
        **options: Any,
    ) -> None:
        super().__init__(model_name, base_url, api_key, [], config or GenerateConfig())
        self.request = ModelRequest(model_name, base_url, options)
        self._lock = anyio.Lock()
        self._planner: Planner | None = None
        self._perception: Perception | None = None
        self._judges: dict[int, Complete] = {}
        self._pending: dict[str, _PendingCall] = {}

    async def planner(self, context: EvalContext) -> Planner:
        """Return the planner with this model name. It is created on the first call."""
        async with self._lock:
            if self._planner is None:
                self._planner = await context.make_planner(self.request)
            return self._planner

    async def perception(self, context: EvalContext) -> Perception:
        """Return the perception backend with this model name. It is created on the first call."""
        async with self._lock:
            if self._perception is None:
                self._perception = await context.make_perception(self.request)
            return self._perception

    async def judge(self, context: EvalContext, repeat: int) -> Complete:
        """Return the connection to the judge with this model name, opened on the first call. ``repeat`` is the judgement index."""
        async with self._lock:
            if repeat not in self._judges:
                self._judges[repeat] = await context.make_judge(self.request, repeat)
            return self._judges[repeat]

    async def logged_call(self, model: Model, messages: list[ChatMessage], call: Callable[[], Awaitable[_Reply]]) -> _Reply:
        """Make a call within an Inspect model event, so that Inspect counts, limits and logs it.

        Args:
            model: The Inspect model that wraps this object.
            messages: The input to show in the log.
            call: Function that makes the call.

        Returns:
            The result of ``call``.
        """
        pending = _PendingCall(call)
        key = messages[-1].id or ""
        self._pending[key] = pending
        try:
            await model.generate(messages)
        finally:
            del self._pending[key]
        reply: _Reply = pending.reply
        return reply

    async def generate(
        self,
        input: list[ChatMessage],  # noqa: A002 - Inspect's signature
        tools: list[ToolInfo],  # noqa: ARG002
        tool_choice: ToolChoice,  # noqa: ARG002
        config: GenerateConfig,  # noqa: ARG002
    ) -> tuple[ModelOutput, ModelCall]:
        pending = self._pending.get(input[-1].id or "")
        if pending is not None:
            pending.reply = await pending.call()
            return self._output_of_reply(pending.reply), ModelCall.create({"model": self.model_name}, None)
        if self._planner is None:
            raise ConfigError(
                "scope_ptz models run only in SCOPE's benchmark. Use `scope bench run` or `inspect eval scope_ptz/bench`."
            )
        exchanges = Exchanges()
        decision = await recording_planner(self._planner, exchanges).step(state_of(input))
        step = 1 + sum(isinstance(m, ChatMessageAssistant) and bool(m.tool_calls) for m in input)
        call = ModelCall.create({"requests": exchanges.requests}, {"replies": exchanges.replies})
        return output_of(decision, self.model_name, step), call

    def _output_of_reply(self, reply: BaseModel) -> ModelOutput:
        text = json.dumps(reply.model_dump(mode="json", exclude={"attempts"}, exclude_defaults=True), ensure_ascii=False)
        return ModelOutput.from_content(self.model_name, text)

    def tool_result_images(self) -> bool:
        """Return True, so that Inspect does not move frames out of tool results."""
        return True

    def connection_key(self) -> str:
        return f"{self.base_url or ''} {self.model_name}"


class _PendingCall:
    """A call that ``generate`` makes, and its reply."""

    def __init__(self, call: Callable[[], Awaitable[Any]]) -> None:
        self.call = call
        self.reply: Any = None


@modelapi(name=PROVIDER)
def scope_ptz() -> type[ModelAPI]:
    """Return the Inspect provider for registered models and the built-in planners and perception backends."""
    return ScopeModel


def inspect_model(name: str, max_connections: int, *, url: str | None = None, **model_args: Any) -> Model:
    """Return the Inspect model for one of SCOPE's planners, perception backends or judges.

    Args:
        name: Name of a registered or built-in model, or the model's name on its server.
        max_connections: Maximum number of concurrent calls.
        url: Base URL of the server.
        model_args: Model options, which are recorded in the log.
    """
    config = GenerateConfig(max_connections=max_connections)
    return get_model(f"{PROVIDER}/{name}", base_url=url, config=config, memoize=False, **model_args)


def output_of(decision: Decision, model: str, step: int) -> ModelOutput:
    """Convert a decision to an Inspect model output whose metadata contains the decision."""
    text = decision.thought if isinstance(decision, CallTools) else decision.text
    content = [ContentReasoning(reasoning=decision.reasoning)] if decision.reasoning else []
    calls: list[ToolCall] | None = None
    stop: StopReason = "stop"
    if isinstance(decision, CallTools):
        stop = "tool_calls"
        calls = [
            ToolCall(id=call_id(step, index), function=valid_tool_name(c.name), arguments=c.arguments, parse_error=c.problem)
            for index, c in enumerate(decision.calls)
        ]
    message = ChatMessageAssistant(
        id=f"step-{step}", content=[*content, ContentText(text=text)] if content else text, tool_calls=calls, source="generate"
    )
    usage, served = decision.usage, decision.served
    return ModelOutput(
        model=(served.model if served else "") or model,
        choices=[ChatCompletionChoice(message=message, stop_reason=stop)],
        usage=ModelUsage(
            input_tokens=usage.input_tokens - usage.cached_tokens,
            output_tokens=usage.output_tokens,
            total_tokens=usage.input_tokens + usage.output_tokens,
            input_tokens_cache_read=usage.cached_tokens or None,
        ),
        metadata={"decision": decision.model_dump(mode="json")},
    )
