"""The planners and eyes of this project as models of the engine: ``scope_ptz/grammar``, ``scope_ptz/qwen3-4b``, ..."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import anyio
from inspect_ai.model import (
    ChatCompletionChoice,
    ChatMessage,
    ChatMessageAssistant,
    ContentReasoning,
    ContentText,
    GenerateConfig,
    ModelAPI,
    ModelCall,
    ModelOutput,
    ModelUsage,
    StopReason,
)
from inspect_ai.tool import ToolCall, ToolChoice, ToolInfo

from scope_ptz.bench.engine.context import ModelRequest, equipment
from scope_ptz.bench.engine.recorded_chat import WIRE
from scope_ptz.bench.engine.transcript import call_id, state_of
from scope_ptz.bench.judging.judge import Complete
from scope_ptz.planner.base import CallTools, Decision, Planner
from scope_ptz.planner.chat.messages import callable_name

if TYPE_CHECKING:
    from scope_ptz.bench.engine.logged_perception import Eyes


@dataclass
class Asked:
    """One question to eyes on its way through the engine: how to ask, and what came of it."""

    ask: Callable[[], Awaitable[Any]]
    answer: Any = None


LOOK: ContextVar[Asked | None] = ContextVar("scope_look", default=None)


class ScopeModel(ModelAPI):
    """A model of this project's registry, or a built-in. What it is made for, planning or looking, shows when it is asked."""

    def __init__(
        self,
        model_name: str,
        base_url: str | None = None,
        api_key: str | None = None,
        config: GenerateConfig | None = None,
        **options: Any,
    ) -> None:
        super().__init__(model_name, base_url, api_key, [], config or GenerateConfig())
        self.wish = ModelRequest(model_name, base_url, options)
        self._lock = anyio.Lock()
        self._planner: Planner | None = None
        self._eyes: Eyes | None = None
        self._judges: dict[int, Complete] = {}

    async def planner(self) -> Planner:
        """The planner behind this name, made when it is first wanted."""
        async with self._lock:
            if self._planner is None:
                self._planner = await equipment().make_planner(self.wish)
            return self._planner

    async def eyes(self) -> Eyes:
        """The eyes behind this name, made when they are first wanted."""
        async with self._lock:
            if self._eyes is None:
                self._eyes = await equipment().make_perception(self.wish)
            return self._eyes

    async def judge(self, repeat: int) -> Complete:
        """The judge behind this name, as it judges for the ``repeat``-th time; made when it is first wanted."""
        async with self._lock:
            if repeat not in self._judges:
                self._judges[repeat] = await equipment().make_judge(self.wish, repeat)
            return self._judges[repeat]

    async def generate(
        self,
        input: list[ChatMessage],  # noqa: A002 - the engine's signature
        tools: list[ToolInfo],  # noqa: ARG002
        tool_choice: ToolChoice,  # noqa: ARG002
        config: GenerateConfig,  # noqa: ARG002
    ) -> tuple[ModelOutput, ModelCall]:
        look = LOOK.get()
        if look is not None:
            look.answer = await look.ask()
            return self._told(look.answer), ModelCall.create({"model": self.model_name}, None)
        wire: list[dict[str, Any]] = []
        token = WIRE.set(wire)
        try:
            decision = await (await self.planner()).step(state_of(input))
        finally:
            WIRE.reset(token)
        step = 1 + sum(isinstance(m, ChatMessageAssistant) and bool(m.tool_calls) for m in input)
        request = {"requests": [row["request"] for row in wire]}
        return output_of(decision, self.model_name, step), ModelCall.create(request, {"replies": [row["reply"] for row in wire]})

    def _told(self, answer: Any) -> ModelOutput:
        text = json.dumps(answer.model_dump(mode="json", exclude={"attempts"}, exclude_defaults=True), ensure_ascii=False)
        return ModelOutput.from_content(self.model_name, text)

    def tool_result_images(self) -> bool:
        """Frames stay in the results that they belong to."""
        return True

    def connection_key(self) -> str:
        return f"{self.base_url or ''} {self.model_name}"


def output_of(decision: Decision, model: str, step: int) -> ModelOutput:
    """A decision as the engine logs it; the decision itself goes with it."""
    said = decision.thought if isinstance(decision, CallTools) else decision.text
    content = [ContentReasoning(reasoning=decision.reasoning)] if decision.reasoning else []
    calls: list[ToolCall] | None = None
    stop: StopReason = "stop"
    if isinstance(decision, CallTools):
        stop = "tool_calls"
        calls = [
            ToolCall(id=call_id(step, index), function=callable_name(c.name), arguments=c.arguments, parse_error=c.problem)
            for index, c in enumerate(decision.calls)
        ]
    message = ChatMessageAssistant(
        id=f"step-{step}", content=[*content, ContentText(text=said)] if content else said, tool_calls=calls, source="generate"
    )
    used, served = decision.usage, decision.served
    return ModelOutput(
        model=(served.model if served else "") or model,
        choices=[ChatCompletionChoice(message=message, stop_reason=stop)],
        usage=ModelUsage(
            input_tokens=used.input_tokens - used.cached_tokens,
            output_tokens=used.output_tokens,
            total_tokens=used.input_tokens + used.output_tokens,
            input_tokens_cache_read=used.cached_tokens or None,
        ),
        metadata={"decision": decision.model_dump(mode="json")},
    )
