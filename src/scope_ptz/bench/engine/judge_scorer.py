"""The Inspect scorer that asks a judge for a verdict on a run, with an error mode and a reason."""

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
from scope_ptz.bench.engine.stored_run import STORE, StoredRun, sample_name, trace_of
from scope_ptz.bench.engine.traces.scored_trials import published_entry
from scope_ptz.bench.engine.trial_records import failure_at_end
from scope_ptz.bench.judging.judge import Completion, Judge, JudgeMessage, NoReplyError
from scope_ptz.errors import TraceError

FIRST_SEED = 1
"""Seed for the first judgement by a judge from another Inspect provider. Each further judgement uses the next integer."""

_ROLES: dict[str, Callable[..., ChatMessage]] = {
    "system": ChatMessageSystem,
    "user": ChatMessageUser,
    "assistant": ChatMessageAssistant,
}


def judge_scorer(context: EvalContext, repeat: int = 0, journal: Journal | None = None) -> Scorer:
    """Return the scorer that asks the model in the role "judge" for a verdict.

    Args:
        context: The resources of the evaluation, including the connection to the judge.
        repeat: Index of the judgement, from 0, if each run is judged several times.
        journal: Journal with earlier judgements, to which new ones are added; None for a journal in memory.
    """
    used_journal = journal or Journal()

    @scorer(metrics=list(METRICS), name=JUDGE)
    def judge(repeat: int = 0) -> Scorer:
        async def score(state: TaskState, target: Target) -> Score:  # noqa: ARG001 - Inspect's signature
            return await _judgement(state, context, repeat, used_journal)

        return score

    return judge(repeat)


async def _judgement(state: TaskState, context: EvalContext, repeat: int, journal: Journal) -> Score:
    """Return the judgement of a run as a score. For a run with an infrastructure failure, the score has no value."""
    stored = state.store.get(STORE)
    entry, _ = published_entry(Entry.of_metadata(state.metadata))
    stored_run = StoredRun.from_store(stored) if stored else StoredRun("", {}, "")
    try:
        trace = trace_of(stored_run.trace, Path(entry.facts.scene))
    except TraceError as error:
        return Score.unscored(reason="damaged trace", explanation=str(error))
    failure = failure_at_end(trace.ended) if trace is not None else "the run did not begin"
    if trace is None or failure is not None:
        return Score.unscored(reason="infrastructure", explanation=failure)
    name = sample_name(entry.facts.id, state.epoch)
    model = get_model(role="judge", required=True)
    judgement = journal.find(name, model.name, repeat)
    if judgement is None:
        judge = Judge(model.name, LoggedJudge(model, context, repeat))
        judgement = await judge.judge(entry.facts, trace, repeat=repeat, preset_viewpoints=stored_run.places)
        journal.add(name, judgement)
    return score_of_judgement(judgement)


class LoggedJudge:
    """A connection to a judge that sends its requests through an Inspect model, so that they are logged."""

    def __init__(self, model: Model, context: EvalContext, repeat: int) -> None:
        self._model, self._context, self._repeat = model, context, repeat

    async def __call__(self, messages: list[JudgeMessage], schema: dict[str, Any]) -> Completion:
        chat = [_ROLES[message["role"]](content=message["content"]) for message in messages]
        if not isinstance(self._model.api, ScopeModel):
            return await self._ask_other_provider(chat, schema)
        complete = await self._model.api.judge(self._context, self._repeat)
        return await self._model.api.logged_call(self._model, chat, lambda: complete(messages, schema))

    async def _ask_other_provider(self, chat: list[ChatMessage], schema: dict[str, Any]) -> Completion:
        """Send the messages to a model from another Inspect provider."""
        response_schema = ResponseSchema(name="verdict", json_schema=JSONSchema.model_validate(schema))
        config = GenerateConfig(response_schema=response_schema, temperature=0.0, seed=FIRST_SEED + self._repeat)
        try:
            output = await self._model.generate(chat, config=config)
        except Exception as error:  # Each provider raises its own error types.
            raise NoReplyError(f"The judge {self._model} failed: {error}") from error
        if output.stop_reason == "model_length":
            raise NoReplyError(f"The run is too long for the judge {self._model}.", overflow=True)
        usage = output.usage
        return Completion(
            text=output.completion,
            input_tokens=usage.input_tokens + (usage.input_tokens_cache_read or 0) if usage else 0,
            output_tokens=usage.output_tokens if usage else 0,
            cut_off=output.stop_reason == "max_tokens",
        )
