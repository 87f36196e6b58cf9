"""Judged runs as plain data: what an evaluation leaves behind, and all that reports, agreement and gates are made from.

Nothing here knows the evaluation engine; logs are turned into these records in one place.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from scope_ptz.agent.timing import Timings
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.verdict import Headline
from scope_ptz.bench.tasks.task_facts import TaskFacts

Count = Annotated[int, Field(ge=0)]
Seconds = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class CheckRecord(_Record):
    """One executable check: passed, failed, or (None) it cannot be told."""

    name: str
    passed: bool | None
    reason: str


class Judgement(_Record):
    """What a judge said about a run. ``verdict`` "unparseable": it never gave a valid verdict, "failed": its server never answered.

    ``error_mode`` and ``reason`` are the judge's own; ``prompt``: version of the prompt; ``repeat``: 0 for its first judgement.
    """

    judge: str
    prompt: str
    repeat: Count = 0
    verdict: Literal["correct", "incorrect", "unparseable", "failed"]
    error_mode: ErrorMode | None = None
    reason: str = ""
    attempts: Count = 1
    input_tokens: Count = 0
    output_tokens: Count = 0
    latency_s: Seconds = 0.0


class Label(_Record):
    """A person's own judgement of a run."""

    by: str
    verdict: Literal["correct", "incorrect", "unclear"]
    error_mode: ErrorMode | None = None
    note: str = ""


class ObservationTime(_Record):
    """Where the wall seconds of one look went. ``eyes_s``: what perception took; ``capture_s``: camera moves and frames,
    simulated ones included; ``call_s``: the whole call, with the tool's own work. Looks made at the same time share a frame, and
    with it its capture."""

    view: Literal["current", "full"]
    eyes_s: Seconds
    capture_s: Seconds
    call_s: Seconds


class Trial(_Record):
    """One run of one task, judged. ``epoch``: 1 for its first run; ``sample``: where the log keeps it, with trace and pictures.

    ``scored_by`` says whose verdict ``headline`` is: the checks', or the judge's where a task has no check of its answer.
    ``error_mode`` is None unless the headline is "incorrect". ``tool_calls``: calls made, by tool, failed ones included.
    ``looks``: the calls that looked.
    """

    task: TaskFacts
    epoch: Annotated[int, Field(ge=1)] = 1
    sample: str
    headline: Headline
    scored_by: Literal["checks", "judge"] = "checks"
    reason: str
    error_mode: ErrorMode | None = None
    checks: tuple[CheckRecord, ...] = ()
    collateral: bool = False
    outcome: str | None
    answer: str
    steps: Count = 0
    tool_calls: dict[str, Count] = {}
    bad_calls: Count = 0
    perception_failures: Count = 0
    server_events: dict[str, Count] = {}
    input_tokens: Count = 0
    output_tokens: Count = 0
    cost_usd: Annotated[float, Field(ge=0, allow_inf_nan=False)] | None = None
    timings: Timings = Timings()
    looks: tuple[ObservationTime, ...] = ()
    judgements: tuple[Judgement, ...] = ()
    labels: tuple[Label, ...] = ()


class ModelCard(_Record):
    """A model of a pair. ``registry``: its name there, if it has one; ``reported``: what its server says of itself."""

    name: str
    registry: str | None = None
    provider: str = ""
    reported: dict[str, str] = {}
    deterministic: bool = False
    """Not a model at all: the grammar planner, or ground truth for eyes. Kept off model rankings."""


class RunCard(_Record):
    """Under what conditions an evaluation ran. ``contended``: runs shared the machine or servers, so that latency is not its own.

    ``split``: "core", "lite", "paraphrase", "reaction", "unseen" or a file's name; ``dataset_digest``: of the tasks that were run;
    ``agent``: "scope" for our own loop, else module and class of another; ``variant``: which prompt or setting was varied, if any.
    """

    run_id: str
    started: str
    package_version: str
    engine_version: str
    dataset: str
    dataset_digest: str
    split: str
    planner: ModelCard
    perception: ModelCard
    agent: str = "scope"
    variant: str = ""
    sampling: dict[str, Any] = {}
    seed: int | None = None
    prompt_digest: str = ""
    max_steps: int
    epochs: Annotated[int, Field(ge=1)] = 1
    concurrency: Annotated[int, Field(ge=1)] = 1
    contended: bool = True
    host: str = ""

    @property
    def pair(self) -> str:
        """How tables call the pair."""
        return f"{self.planner.name} + {self.perception.name}"

    @property
    def ranked(self) -> bool:
        """Whether the pair belongs in rankings of models."""
        return not (self.planner.deterministic or self.perception.deterministic)


class Evaluation(_Record):
    """A log as data. ``wanted``: how many runs it should hold (tasks times epochs); fewer trials mean that it is unfinished."""

    card: RunCard
    trials: tuple[Trial, ...]
    wanted: Count
    log: str = ""

    @property
    def finished(self) -> bool:
        return len(self.trials) >= self.wanted
