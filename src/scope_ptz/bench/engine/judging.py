"""The judge as a scorer of the engine: full run in, verdict, error mode and reason out, each judgement a score of its own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from inspect_ai.model import (
    ChatMessage,
    ChatMessageAssistant,
    ChatMessageSystem,
    ChatMessageUser,
    GenerateConfig,
    Model,
    ResponseSchema,
    get_model,
)
from inspect_ai.scorer import Score, Scorer, Target, scorer
from inspect_ai.solver import TaskState
from inspect_ai.util import JSONSchema

from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.journal import JOURNAL, Journal
from scope_ptz.bench.engine.judgements import JUDGE, score_of_judgement
from scope_ptz.bench.engine.models import LOOK, Asked, ScopeModel
from scope_ptz.bench.engine.sampling import STORE, Kept, sample_name, trace_of
from scope_ptz.bench.engine.scorers import METRICS
from scope_ptz.bench.engine.scoring import broken_by
from scope_ptz.bench.judging.judge import Completion, Judge, JudgeMessage, NoReplyError

FIRST_SEED = 1
"""Of a judge of another provider; each further judgement has the next one."""

_ROLES: dict[str, Callable[..., ChatMessage]] = {
    "system": ChatMessageSystem,
    "user": ChatMessageUser,
    "assistant": ChatMessageAssistant,
}


@scorer(metrics=list(METRICS), name=JUDGE)
def judge(repeat: int = 0) -> Scorer:
    """The verdict of the model that plays the role "judge". ``repeat``: number of the judgement, where one judge gives several."""

    async def score(state: TaskState, target: Target) -> Score:  # noqa: ARG001 - the engine's signature
        left = state.store.get(STORE)
        entry = Entry.of_metadata(state.metadata)
        kept = Kept.of_store(left) if left else Kept("", {}, "")
        trace = trace_of(kept.trace, Path(entry.facts.scene))
        broken = broken_by(trace.ended) if trace is not None else "the run did not begin"
        if trace is None or broken is not None:
            return Score.unscored(reason="infrastructure", explanation=broken)
        name = sample_name(entry.facts.id, state.epoch)
        model = get_model(role="judge", required=True)
        journal = JOURNAL.get() or Journal()
        made = journal.find(name, model.name, repeat)
        if made is None:
            made = await Judge(model.name, LoggedJudge(model, repeat)).judge(entry.facts, trace, repeat=repeat, places=kept.places)
            journal.add(name, made)
        return score_of_judgement(made)

    return score


class LoggedJudge:
    """The judge's port through a model of the engine."""

    def __init__(self, model: Model, repeat: int) -> None:
        self._model, self._repeat = model, repeat

    async def __call__(self, messages: list[JudgeMessage], schema: dict[str, Any]) -> Completion:
        told = [_ROLES[message["role"]](content=message["content"]) for message in messages]
        if isinstance(self._model.api, ScopeModel):
            port = await self._model.api.judge(self._repeat)
            asked = Asked(lambda: port(messages, schema))
            token = LOOK.set(asked)
            try:
                await self._model.generate(told)
            finally:
                LOOK.reset(token)
            reply: Completion = asked.answer
            return reply
        return await self._foreign(told, schema)

    async def _foreign(self, told: list[ChatMessage], schema: dict[str, Any]) -> Completion:
        """A model of somebody else's provider."""
        shape = ResponseSchema(name="verdict", json_schema=JSONSchema.model_validate(schema))
        config = GenerateConfig(response_schema=shape, temperature=0.0, seed=FIRST_SEED + self._repeat)
        try:
            output = await self._model.generate(told, config=config)
        except Exception as error:  # whatever a provider raises: the judge's server gave no reply
            raise NoReplyError(f"The judge {self._model} failed: {error}") from error
        if output.stop_reason == "model_length":
            raise NoReplyError(f"The run is too long for the judge {self._model}.", overflow=True)
        used = output.usage
        return Completion(
            text=output.completion,
            input_tokens=used.input_tokens + (used.input_tokens_cache_read or 0) if used else 0,
            output_tokens=used.output_tokens if used else 0,
            cut_off=output.stop_reason == "max_tokens",
        )
