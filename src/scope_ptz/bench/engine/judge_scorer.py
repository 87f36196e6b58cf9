"""The judge as an Inspect scorer: it reads a whole run and returns a verdict, an error mode and a reason."""

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

from scope_ptz.bench.engine.checks_scorer import METRICS
from scope_ptz.bench.engine.context import EvalContext
from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.judgement_journal import Journal
from scope_ptz.bench.engine.judgement_scores import JUDGE, score_of_judgement
from scope_ptz.bench.engine.recording.scope_model import ScopeModel
from scope_ptz.bench.engine.samples import STORE, Kept, sample_name, trace_of
from scope_ptz.bench.engine.trial_records import broken_by
from scope_ptz.bench.judging.judge import Completion, Judge, JudgeMessage, NoReplyError

FIRST_SEED = 1
"""Seed of the first judgement by a judge of another provider; each further judgement uses the next one."""

_ROLES: dict[str, Callable[..., ChatMessage]] = {
    "system": ChatMessageSystem,
    "user": ChatMessageUser,
    "assistant": ChatMessageAssistant,
}


def judge_scorer(context: EvalContext, repeat: int = 0, journal: Journal | None = None) -> Scorer:
    """Return the scorer whose verdict is that of the model in the role "judge".

    Args:
        context: Provides the connection to the judge.
        repeat: Index of the judgement, from 0, if the judge gives several.
        journal: Contains known judgements and receives new ones; None for a journal in memory.
    """
    known = journal or Journal()

    @scorer(metrics=list(METRICS), name=JUDGE)
    def judge(repeat: int = 0) -> Scorer:
        async def score(state: TaskState, target: Target) -> Score:  # noqa: ARG001 - the engine's signature
            return await _judgement(state, context, repeat, known)

        return score

    return judge(repeat)


async def _judgement(state: TaskState, context: EvalContext, repeat: int, journal: Journal) -> Score:
    """Return the judgement of a run as a score. A run that infrastructure broke has a score without a value."""
    stored = state.store.get(STORE)
    entry = Entry.of_metadata(state.metadata)
    kept = Kept.of_store(stored) if stored else Kept("", {}, "")
    trace = trace_of(kept.trace, Path(entry.facts.scene))
    broken = broken_by(trace.ended) if trace is not None else "the run did not begin"
    if trace is None or broken is not None:
        return Score.unscored(reason="infrastructure", explanation=broken)
    name = sample_name(entry.facts.id, state.epoch)
    model = get_model(role="judge", required=True)
    judgement = journal.find(name, model.name, repeat)
    if judgement is None:
        port = LoggedJudge(model, context, repeat)
        judgement = await Judge(model.name, port).judge(entry.facts, trace, repeat=repeat, preset_viewpoints=kept.places)
        journal.add(name, judgement)
    return score_of_judgement(judgement)


class LoggedJudge:
    """A connection to a judge whose requests go through an Inspect model."""

    def __init__(self, model: Model, context: EvalContext, repeat: int) -> None:
        self._model, self._context, self._repeat = model, context, repeat

    async def __call__(self, messages: list[JudgeMessage], schema: dict[str, Any]) -> Completion:
        chat = [_ROLES[message["role"]](content=message["content"]) for message in messages]
        if not isinstance(self._model.api, ScopeModel):
            return await self._ask_other_provider(chat, schema)
        port = await self._model.api.judge(self._context, self._repeat)
        return await self._model.api.logged_call(self._model, chat, lambda: port(messages, schema))

    async def _ask_other_provider(self, chat: list[ChatMessage], schema: dict[str, Any]) -> Completion:
        """Ask a model of another provider."""
        shape = ResponseSchema(name="verdict", json_schema=JSONSchema.model_validate(schema))
        config = GenerateConfig(response_schema=shape, temperature=0.0, seed=FIRST_SEED + self._repeat)
        try:
            output = await self._model.generate(chat, config=config)
        except Exception as error:  # Each provider raises its own error types.
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
