"""Judge runs with a language model. The caller provides the function that queries the model."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from time import perf_counter
from typing import Any

from pydantic import BaseModel, ConfigDict

from scope_ptz.agent.trace import Trace
from scope_ptz.bench.judging.case import JudgeCase, case_of
from scope_ptz.bench.judging.judge_replies import REPLY_SCHEMA, JudgeReply, parse_judge_reply
from scope_ptz.bench.judging.quoting import shorten
from scope_ptz.bench.judging.rendering import MIN_CHARS, describe_run
from scope_ptz.bench.judging.rubrics import prompt_version, system_prompt
from scope_ptz.bench.scoring.episode import PresetViewpoints
from scope_ptz.bench.scoring.trials import Judgement
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.errors import ScopeError

DEFAULT_JUDGE = "gpt-oss-120b"
ATTEMPTS = 3
"""Default maximum number of replies per judgement. If all of them are invalid, the judgement is unparseable."""

BUDGET_CHARS = 60_000
"""Default maximum length of a run's description, in characters (about 15,000 tokens)."""

_MAX_QUOTED_CHARS = 2_000
"""Maximum number of characters of an invalid reply that are sent back to the judge. Longer replies are shortened."""
JudgeMessage = dict[str, Any]
"""A chat message to a judge in the OpenAI format."""


class Completion(BaseModel):
    """A reply from a judge's model, without its reasoning. ``cut_off`` is true if the reply reached the token limit."""

    model_config = ConfigDict(frozen=True)

    text: str
    input_tokens: int = 0
    output_tokens: int = 0
    cut_off: bool = False


class NoReplyError(ScopeError):
    """A judge's server gave no usable reply. ``overflow`` is true if the messages exceed the model's context."""

    def __init__(self, message: str, *, overflow: bool = False) -> None:
        self.overflow = overflow
        super().__init__(message)


Complete = Callable[[list[JudgeMessage], dict[str, Any]], Awaitable[Completion]]
"""Function that sends messages to a model and returns its reply, which follows a JSON schema. Raises only ``NoReplyError``."""


class Judge:
    """A language model that judges runs. It keeps no state between judgements, so it can judge several runs concurrently.

    Args:
        name: Name of the model, as recorded in judgements.
        complete: Function that sends messages to the judge's model and returns the reply.
        attempts: Maximum number of replies per judgement.
        budget_chars: Maximum length of a run's description, in characters.
    """

    def __init__(self, name: str, complete: Complete, *, attempts: int = ATTEMPTS, budget_chars: int = BUDGET_CHARS) -> None:
        self.name, self.complete, self.attempts, self.budget_chars = name, complete, attempts, budget_chars

    async def judge(
        self, facts: TaskFacts, trace: Trace, *, repeat: int = 0, preset_viewpoints: PresetViewpoints | None = None
    ) -> Judgement:
        """Judge a recorded run. Model and server errors are recorded in the judgement instead of being raised.

        Args:
            facts: The task's properties and expected answer.
            trace: The recorded run.
            repeat: Index of the judgement, from 0, if the run is judged several times.
            preset_viewpoints: The viewpoints of the presets. With them, the description states the camera's viewpoint after each
                call.
        """
        return await self.judge_case(facts, case_of(trace, preset_viewpoints), repeat=repeat)

    async def judge_case(self, facts: TaskFacts, case: JudgeCase, *, repeat: int = 0) -> Judgement:
        """Judge a run. ``repeat`` is the index of the judgement, from 0."""
        session = _Session(self, repeat)
        start_s = perf_counter()
        judgement = await session.run(facts, case)
        return judgement.model_copy(update={"latency_s": perf_counter() - start_s})


class _Session:
    """All attempts at one judgement."""

    def __init__(self, judge: Judge, repeat: int) -> None:
        self.judge, self.repeat = judge, repeat
        self.requests = self.input_tokens = self.output_tokens = 0

    async def run(self, facts: TaskFacts, case: JudgeCase) -> Judgement:
        """Send requests until a reply is valid, the attempts are exhausted, or the server fails.

        If the messages exceed the model's context, the description of the run is shortened. This does not use up an attempt.
        """
        budget, problem = self.judge.budget_chars, ""
        opening = judge_messages(facts, case, budget)
        messages, replies = opening, 0
        while replies < self.judge.attempts:
            self.requests += 1
            try:
                reply = await self.judge.complete(messages, REPLY_SCHEMA)
            except NoReplyError as failure:
                if failure.overflow and budget > MIN_CHARS:
                    budget = max(budget // 2, MIN_CHARS)
                    messages = opening = judge_messages(facts, case, budget)
                    continue
                return self._judgement("failed", str(failure))
            replies += 1
            self.input_tokens += reply.input_tokens
            self.output_tokens += reply.output_tokens
            parsed = "it was cut off at the limit of tokens" if reply.cut_off else parse_judge_reply(reply.text)
            if isinstance(parsed, JudgeReply):
                judgement = self._judgement(parsed.verdict, parsed.reason)
                return judgement.model_copy(update={"error_mode": parsed.error_mode})
            problem = parsed
            messages = [*opening, *_correction(reply.text, problem)]
        return self._judgement("unparseable", problem)

    def _judgement(self, verdict: str, reason: str) -> Judgement:
        return Judgement.model_validate(
            {
                "judge": self.judge.name,
                "prompt": prompt_version(),
                "repeat": self.repeat,
                "verdict": verdict,
                "reason": reason,
                "attempts": self.requests,
                "input_tokens": self.input_tokens,
                "output_tokens": self.output_tokens,
            }
        )


def judge_messages(facts: TaskFacts, case: JudgeCase, budget_chars: int = BUDGET_CHARS) -> list[JudgeMessage]:
    """Return the messages that ask a judge for a verdict on a run."""
    return [
        {"role": "system", "content": system_prompt(facts.category)},
        {"role": "user", "content": describe_run(facts, case, budget_chars)},
    ]


def _correction(reply: str, problem: str) -> list[JudgeMessage]:
    """Return messages that repeat the invalid reply and ask for a valid one."""
    return [
        {"role": "assistant", "content": shorten(reply, _MAX_QUOTED_CHARS) or "(nothing)"},
        {
            "role": "user",
            "content": f"This is no valid verdict: {problem}. Reply again with one JSON object in the given schema, nothing else.",
        },
    ]
