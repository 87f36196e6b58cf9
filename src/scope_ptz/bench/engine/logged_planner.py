"""The agent's planner and its tools, seen by the engine: every decision a model event, every call a tool event in its own span."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable
from typing import Any

from inspect_ai.model import ChatMessageAssistant, Content, ContentImage, ContentText, Model, ModelOutput, execute_tools
from inspect_ai.tool import ToolCall, ToolDef, ToolError, ToolParams
from pydantic import TypeAdapter

from scope_ptz.bench.engine.picture_store import KeptPictures
from scope_ptz.bench.engine.scope_model import ScopeModel
from scope_ptz.bench.engine.transcript import messages_of, tool_infos
from scope_ptz.endpoints.replies import ChatReply, RawToolCall
from scope_ptz.errors import CameraError, PerceptionError, PlannerError, ScopeError, ToolCallError, UnknownNameError
from scope_ptz.planner.base import Decision, Planner, State
from scope_ptz.planner.chat.interpret import decide
from scope_ptz.planner.chat.prompts import DEFAULT_PROMPT, Prompt, load_prompt
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.registry import run_tool
from scope_ptz.tools.results import Result

_DECISION: TypeAdapter[Decision] = TypeAdapter(Decision)
_ANYTHING = ToolParams(additionalProperties=True)
"""What a call may hold is checked where it is made, so that the planner reads the same words whoever runs it."""


class LoggedPlanner(Planner):
    """A planner behind a model of the engine: one of this project's, or any chat model that the engine knows."""

    def __init__(self, model: Model, planner: Planner | None) -> None:
        """``planner``: what stands behind a model of this project."""
        self._model, self._planner = model, planner
        self.name = planner.name if planner is not None else str(model)
        self.sees = planner.sees if planner is not None else False
        prompt = getattr(planner, "prompt", None)
        self._prompt = prompt if isinstance(prompt, Prompt) else load_prompt(DEFAULT_PROMPT)
        self._tools = tool_infos()

    @property
    def details(self) -> dict[str, str]:
        if self._planner is not None:
            return self._planner.details
        return {"model": str(self._model), "prompt": self._prompt.name, "prompt_sha256": self._prompt.digest}

    @classmethod
    async def of(cls, model: Model) -> LoggedPlanner:
        """The planner that plays a role."""
        return cls(model, await model.api.planner() if isinstance(model.api, ScopeModel) else None)

    async def step(self, state: State) -> Decision:
        messages = messages_of(state, self._prompt, sees=self.sees)
        try:
            output = await self._model.generate(messages, self._tools)
        except ScopeError:
            raise
        except Exception as error:  # A foreign provider's own errors: the planner's server failed
            raise PlannerError(f"The model {self._model} failed: {error}", kind="server-error") from error
        if output.metadata and "decision" in output.metadata:
            return _DECISION.validate_python(output.metadata["decision"])
        return decide(_reply(output), state)


def _reply(output: ModelOutput) -> ChatReply:
    """What a model of somebody else's provider said."""
    calls = output.message.tool_calls or []
    usage = output.usage
    return ChatReply(
        text=output.completion,
        tool_calls=tuple(RawToolCall(id=c.id, name=c.function, arguments_text=json.dumps(c.arguments)) for c in calls),
        finish_reason="length" if output.stop_reason in ("max_tokens", "model_length") else output.stop_reason,
        input_tokens=usage.input_tokens + (usage.input_tokens_cache_read or 0) if usage else 0,
        output_tokens=usage.output_tokens if usage else 0,
        seconds=output.time or 0.0,
        model=output.model,
    )


class ToolLog:
    """Makes calls as the loop would, inside a tool event. Pictures that a call took are shown with its result."""

    def __init__(self, pictures: KeptPictures | None) -> None:
        self._pictures = pictures
        self._calls = 0

    async def run(self, context: ToolContext, name: str, arguments: Any) -> Result:
        """As ``tools.registry.run_tool``."""
        self._calls += 1
        call = ToolCall(id=f"call-{self._calls:03d}", function=name, arguments=arguments)
        came: list[Result | ScopeError] = []
        tool = ToolDef(self._body(context, name, came), name=name, description=name, parameters=_ANYTHING)
        await execute_tools([ChatMessageAssistant(content="", tool_calls=[call])], [tool])
        result = came[0] if came else await run_tool(context, name, arguments)
        if isinstance(result, ScopeError):
            raise result
        return result

    def _body(self, context: ToolContext, name: str, came: list[Result | ScopeError]) -> Callable[..., Awaitable[list[Content]]]:
        known = set(self._pictures.kept) if self._pictures else set()

        async def call(**kwargs: Any) -> list[Content]:
            try:
                result = await run_tool(context, name, kwargs)
            except (ToolCallError, UnknownNameError, PerceptionError, CameraError) as error:
                came.append(error)
                raise ToolError(str(error)) from error
            except ScopeError as error:
                came.append(error)
                raise
            came.append(result)
            shown: list[Content] = [ContentText(text=json.dumps(result.model_dump(mode="json"), ensure_ascii=False))]
            if self._pictures is not None:
                await self._pictures.settle()
                files = [*getattr(result, "frames", ()), getattr(result, "file", None)]
                shown += [ContentImage(image=self._pictures.kept[f]) for f in files if f in self._pictures.kept and f not in known]
            return shown

        return call
