"""A planner that gets its decisions from an Inspect model, so that the log contains each decision as a model event."""

from __future__ import annotations

import json

from inspect_ai.model import Model, ModelOutput
from pydantic import TypeAdapter

from scope_ptz.bench.engine.context import EvalContext
from scope_ptz.bench.engine.recording.scope_model import ScopeModel
from scope_ptz.bench.engine.recording.transcript import messages_of, tool_infos
from scope_ptz.endpoints.chat_replies import ChatReply, RawToolCall
from scope_ptz.errors import PlannerError, ScopeError
from scope_ptz.planner.base import Decision, Planner, State
from scope_ptz.planner.chat.interpret import decide
from scope_ptz.planner.chat.prompts import DEFAULT_PROMPT, Prompt, load_prompt

_DECISION: TypeAdapter[Decision] = TypeAdapter(Decision)


class LoggedPlanner(Planner):
    """A planner that gets its decisions from an Inspect model.

    The model is either a ``ScopeModel``, which runs one of SCOPE's planners, or a chat model from another Inspect provider.
    """

    def __init__(self, model: Model, planner: Planner | None) -> None:
        """Initialize the planner. Use ``of`` to create a planner for a model.

        Args:
            model: The Inspect model.
            planner: The planner that the model runs if it is a ``ScopeModel``, otherwise None.
        """
        self._model, self._planner = model, planner
        self.name = planner.name if planner is not None else str(model)
        self.sees = planner.sees if planner is not None else False
        prompt = getattr(planner, "prompt", None)
        self._prompt = prompt if isinstance(prompt, Prompt) else load_prompt(DEFAULT_PROMPT)
        # A planner without a prompt sends no tools to a model. Inspect would copy and log their schemas at every step.
        self._tools = tool_infos() if planner is None or isinstance(prompt, Prompt) else []

    @property
    def details(self) -> dict[str, str]:
        if self._planner is not None:
            return self._planner.details
        return {"model": str(self._model), "prompt": self._prompt.name, "prompt_sha256": self._prompt.digest}

    @classmethod
    async def of(cls, model: Model, context: EvalContext) -> LoggedPlanner:
        """Create a planner for an Inspect model."""
        return cls(model, await model.api.planner(context) if isinstance(model.api, ScopeModel) else None)

    async def step(self, state: State) -> Decision:
        messages = messages_of(state, self._prompt, sees=self.sees)
        try:
            output = await self._model.generate(messages, self._tools)
        except ScopeError:
            raise
        except Exception as error:  # Each provider raises its own error types.
            raise PlannerError(f"The model {self._model} failed: {error}", kind="server-error") from error
        if output.metadata and "decision" in output.metadata:  # A ``ScopeModel`` returns the decision itself.
            return _DECISION.validate_python(output.metadata["decision"])
        return decide(_reply(output), state)


def _reply(output: ModelOutput) -> ChatReply:
    """Convert the output of a chat model to the reply that the chat planner interprets."""
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
