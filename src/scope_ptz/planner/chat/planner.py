"""The planner that asks a chat model behind an OpenAI-compatible server."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from scope_ptz.endpoints.chat import ChatClient
from scope_ptz.endpoints.chat_replies import ChatReply
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import Attempt, FailureKind, ServerFailure
from scope_ptz.errors import PlannerError
from scope_ptz.planner.base import Decision, Planner, State
from scope_ptz.planner.chat.chat_messages import Message, build_messages
from scope_ptz.planner.chat.dialect import Dialect
from scope_ptz.planner.chat.families import Server, Thinking, family_of, reasoning_switch, temperature_for, usual_server
from scope_ptz.planner.chat.interpret import decide
from scope_ptz.planner.chat.prompts import DEFAULT_PROMPT, Prompt, load_prompt
from scope_ptz.planner.chat.schemas import simplify_schemas
from scope_ptz.planner.chat.window import fits, shortenings

_OVERFLOW, _CUT_OFF = FailureKind.CONTEXT_OVERFLOW, FailureKind.CUT_OFF
_MAX_ADAPTATIONS = 6
"""Maximum number of retries for a request, each without one more rejected feature. Any further rejection is an error."""


class ChatOptions(BaseModel):
    """Options for planning with a chat model.

    Attributes:
        prompt: Name of the packaged system prompt.
        thinking: Whether to switch the model's reasoning on or off; "default" leaves it unchanged.
        tools: How tool calls are exchanged: in the API's native fields ("native"), in the text of messages ("text"), or
            natively until the server rejects tools ("auto").
        sees: Whether the model accepts images.
        summarise: Whether to shorten old observations instead of ending the run when the context is full. Never used in
            evaluations.
        context_tokens: The size of the model's context; None if it is unknown.
        max_tokens: The maximum length of a reply; None selects the server's default.
        temperature: The sampling temperature; None selects the model family's default.
        seed: The seed for the server's sampling; None sends no seed.
        stream: Whether to request streamed replies.
        server: The server program; None to infer it from the address.
        family: The model name that determines the family, if the server uses a different name for the model.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    prompt: str = DEFAULT_PROMPT
    thinking: Thinking = "default"
    tools: Literal["auto", "native", "text"] = "auto"
    sees: bool = False
    summarise: bool = False
    context_tokens: int | None = Field(default=None, ge=512)
    max_tokens: int | None = Field(default=None, ge=1)
    temperature: float | None = Field(default=None, ge=0, le=2, allow_inf_nan=False)
    seed: int | None = None
    stream: bool = True
    server: Server | None = None
    family: str | None = None


class ChatPlanner(Planner):
    """A planner that asks a chat model at each step.

    Between steps, it keeps the connection and the features that the server rejected, but no run state.
    """

    def __init__(
        self,
        endpoint: Endpoint,
        options: ChatOptions | None = None,
        *,
        client: ChatClient | None = None,
        prompt: Prompt | None = None,
    ) -> None:
        """Create the planner.

        Args:
            endpoint: The server.
            options: Options for planning; None selects the defaults.
            client: A client to use instead of a new one.
            prompt: A prompt to use instead of the named one, for prompt variants without a file.
        """
        self.options = options or ChatOptions()
        self.endpoint, self.client = endpoint, client or ChatClient(endpoint)
        self.prompt = prompt or load_prompt(self.options.prompt)
        self.name, self.sees = endpoint.model or "chat", self.options.sees
        tools, model = self.options.tools, self.options.family or endpoint.model
        server = self.options.server or usual_server(endpoint.url)
        self._dialect = Dialect("text" if tools == "text" else "native", fixed=tools != "auto")
        self._switch = reasoning_switch(model, self.options.thinking, server)
        temperature = self.options.temperature
        self._fields: dict[str, Any] = {
            "temperature": temperature_for(model, self.options.thinking) if temperature is None else temperature,
            "seed": self.options.seed,
            "max_tokens": self.options.max_tokens,
            **self._switch.fields,
        }

    @property
    def details(self) -> dict[str, str]:
        return {
            "url": self.endpoint.url,
            "family": family_of(self.options.family or self.endpoint.model).name,
            "prompt": self.prompt.name,
            "prompt_sha256": self.prompt.digest,
            "thinking": self.options.thinking,
            "tools": self._dialect.notation,
            "sees": str(self.sees).lower(),
            "summarise": str(self.options.summarise).lower(),
            "temperature": str(self._fields["temperature"]),
        }

    async def step(self, state: State) -> Decision:
        attempts: list[Attempt] = []
        for shorten_oldest in self._levels(state):
            try:
                reply = await self._ask(state, shorten_oldest, attempts)
                return self._decide(reply, state, attempts)
            except PlannerError as error:
                failure = error
                full = error.kind == _OVERFLOW.value or (error.kind == _CUT_OFF.value and self.options.max_tokens is None)
                if not (full and self.options.summarise):
                    raise
        raise failure

    async def close(self) -> None:
        await self.client.close()

    def _levels(self, state: State) -> Iterator[int]:
        """Yield the numbers of oldest exchanges to shorten, in the order in which to try them."""
        levels = [0, *shortenings(state)] if self.options.summarise else [0]
        for level in levels:
            window = self.options.context_tokens
            if level == levels[-1] or window is None or fits(self._messages(state, level), state.tools, window):
                yield level

    def _messages(self, state: State, shorten_oldest: int) -> list[Message]:
        messages = build_messages(
            state,
            self.prompt,
            notation=self._dialect.notation,
            accepts_images=self.sees,
            switch=self._switch.words,
            shorten_oldest=shorten_oldest,
        )
        return self._dialect.messages(messages)

    async def _ask(self, state: State, shorten_oldest: int, attempts: list[Attempt]) -> ChatReply:
        """Send the messages and return the reply. If the server rejects optional features, retry without them.

        Every request is appended to ``attempts``.
        """
        for adaptations in range(_MAX_ADAPTATIONS + 1):
            native = self._dialect.notation == "native"
            fields = self._dialect.fields(self._fields)
            tools = simplify_schemas(state.tools) if native and state.tools else None
            messages = self._messages(state, shorten_oldest)
            try:
                reply = await self.client.complete(messages, tools=tools, stream=self.options.stream, extra=fields)
            except ServerFailure as failure:
                attempts.extend(failure.history)
                if adaptations < _MAX_ADAPTATIONS and self._dialect.adapt(failure, fields, with_tools=tools is not None):
                    continue
                raise PlannerError(str(failure), kind=failure.kind.value, attempts=attempts) from None
            attempts.extend(reply.attempts)
            return reply
        raise AssertionError("the last attempt returns or raises")

    def _decide(self, reply: ChatReply, state: State, attempts: list[Attempt]) -> Decision:
        return decide(reply.model_copy(update={"attempts": tuple(attempts)}), state, context_tokens=self.options.context_tokens)
