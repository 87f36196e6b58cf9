"""The planner that asks a model behind an OpenAI-compatible server."""

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
from scope_ptz.planner.chat.families import Server, Thinking, family_of, likely_server, switch_for, temperature_for
from scope_ptz.planner.chat.interpret import decide
from scope_ptz.planner.chat.prompts import DEFAULT_PROMPT, Prompt, load_prompt
from scope_ptz.planner.chat.schemas import plain_schemas
from scope_ptz.planner.chat.window import fits, shortenings

_OVERFLOW, _CUT_OFF = FailureKind.CONTEXT_OVERFLOW, FailureKind.CUT_OFF
_MOST_LESSONS = 6
"""How many unsupported features are left out before a server's refusal is final."""


class ChatOptions(BaseModel):
    """Options for planning with a chat model.

    Attributes:
        tools: How tools are offered: through the server's interface ("native"), in the prompt and the text ("text"), or
            natively until the server refuses it ("auto").
        sees: Whether the model takes images.
        summarise: Whether to shorten old observations when the context is full instead of ending the run. Never used in
            evaluations.
        context_tokens: The size of the model's context, where it is known.
        max_tokens: The limit of one reply.
        temperature: None selects what suits the model.
        server: The program that serves the model, guessed from its address when None.
        family: A model name that determines the family, when the server uses another name.
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

    Between steps it keeps a connection and what it learned about the server, but nothing about the run.
    """

    def __init__(
        self,
        endpoint: Endpoint,
        options: ChatOptions | None = None,
        *,
        client: ChatClient | None = None,
        prompt: Prompt | None = None,
    ) -> None:
        """Set up the planner.

        Args:
            endpoint: The server.
            options: How to plan.
            client: A client to use instead of a new one.
            prompt: A prompt to use instead of the named one, for variants without a file.
        """
        self.options = options or ChatOptions()
        self.endpoint, self.client = endpoint, client or ChatClient(endpoint)
        self.prompt = prompt or load_prompt(self.options.prompt)
        self.name, self.sees = endpoint.model or "chat", self.options.sees
        tools, model = self.options.tools, self.options.family or endpoint.model
        server = self.options.server or likely_server(endpoint.url)
        self._dialect = Dialect("text" if tools == "text" else "native", fixed=tools != "auto")
        self._switch = switch_for(model, self.options.thinking, server)
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
        tried: list[Attempt] = []
        for brief_before in self._levels(state):
            try:
                reply = await self._ask(state, brief_before, tried)
                return self._decide(reply, state, tried)
            except PlannerError as error:
                failure = error
                full = error.kind == _OVERFLOW.value or (error.kind == _CUT_OFF.value and self.options.max_tokens is None)
                if not (full and self.options.summarise):
                    raise
        raise failure

    async def close(self) -> None:
        await self.client.close()

    def _levels(self, state: State) -> Iterator[int]:
        """Yield how many of the oldest exchanges to shorten, in the order of the attempts."""
        levels = [0, *shortenings(state)] if self.options.summarise else [0]
        for level in levels:
            window = self.options.context_tokens
            if level == levels[-1] or window is None or fits(self._messages(state, level), state.tools, window):
                yield level

    def _messages(self, state: State, brief_before: int) -> list[Message]:
        messages = build_messages(
            state,
            self.prompt,
            notation=self._dialect.notation,
            sees=self.sees,
            switch=self._switch.words,
            brief_before=brief_before,
        )
        return self._dialect.messages(messages)

    async def _ask(self, state: State, brief_before: int, tried: list[Attempt]) -> ChatReply:
        """Return a reply. What the server refuses and can do without is left out. Every request is added to ``tried``."""
        for lesson in range(_MOST_LESSONS + 1):
            native = self._dialect.notation == "native"
            fields = self._dialect.fields(self._fields)
            tools = plain_schemas(state.tools) if native and state.tools else None
            messages = self._messages(state, brief_before)
            try:
                reply = await self.client.complete(messages, tools=tools, stream=self.options.stream, extra=fields)
            except ServerFailure as failure:
                tried.extend(failure.history)
                if lesson < _MOST_LESSONS and self._dialect.learn(failure, fields, with_tools=tools is not None):
                    continue
                raise PlannerError(str(failure), kind=failure.kind.value, attempts=tried) from None
            tried.extend(reply.attempts)
            return reply
        raise AssertionError("the last attempt returns or raises")

    def _decide(self, reply: ChatReply, state: State, tried: list[Attempt]) -> Decision:
        return decide(reply.model_copy(update={"attempts": tuple(tried)}), state, context_tokens=self.options.context_tokens)
