"""The records of an evaluation: its trials with their verdicts, and its conditions.

Reports, agreement measurements and regression gates use these records. ``bench.engine.logs`` reads them from logs.
The docstrings of ``ModelCard`` and ``RunCard`` are part of the published schema of submissions.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from scope_ptz.agent.timing import Timings
from scope_ptz.bench.agents.channel import Isolation
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.verdict import Headline
from scope_ptz.bench.tasks.task_facts import TaskFacts

Count = Annotated[int, Field(ge=0)]
Seconds = Annotated[float, Field(ge=0, allow_inf_nan=False)]

OWN_AGENT = "scope"
"""Name of SCOPE's own agent loop."""


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class CheckRecord(_Record):
    """The result of an executable check in a trial. ``passed`` is None if the check could not decide."""

    name: str
    passed: bool | None
    reason: str


class Judgement(_Record):
    """A judge's verdict on a run.

    Attributes:
        judge: Name of the judge's model.
        prompt: Version of the judge's prompt.
        repeat: Index of the judgement, from 0, if the judge judged the run several times.
        verdict: The verdict; "unparseable" if the judge gave no valid reply, "failed" if its server gave no usable reply.
        error_mode: The error mode that the judge assigned.
        reason: The judge's reason.
        attempts: Number of requests.
        input_tokens: Number of tokens in all requests.
        output_tokens: Number of tokens in all replies.
        latency_s: Wall-clock seconds of the whole judgement.
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
    """A human label: a person's verdict on a run."""

    by: str
    verdict: Literal["correct", "incorrect", "unclear"]
    error_mode: ErrorMode | None = None
    note: str = ""


class ObservationTime(_Record):
    """The wall-clock times of a perception call. Concurrent calls share a frame and its capture.

    Attributes:
        view: Whether the current view or a panorama of the full scene was observed.
        eyes_s: Seconds for perception (the model role "eyes").
        capture_s: Seconds for camera moves and captures, including rendering.
        call_s: Seconds for the whole tool call.
    """

    view: Literal["current", "full"]
    eyes_s: Seconds
    capture_s: Seconds
    call_s: Seconds


class Trial(_Record):
    """A run of a task, with its verdict.

    Attributes:
        task: The task's properties.
        epoch: Number of the run among the runs of the same task, from 1.
        sample: Name of the sample in the log, which contains the trace and pictures of the run.
        headline: The verdict: correct, incorrect, unscored, or infrastructure failure.
        scored_by: The source of the verdict: the checks, or a judge if the task has no answer check.
        reason: The reason for the verdict.
        error_mode: The error mode; None unless the headline is "incorrect".
        checks: The results of the checks.
        collateral: Whether the final pose differs from the start although the task required no move.
        outcome: How the run ended; None if it was interrupted.
        answer: The agent's final answer.
        steps: Number of decisions that the planner made.
        planned_by: Number of decisions by each part of a hybrid planner ("grammar", "model"); empty for other planners.
        tool_calls: Number of calls to each tool, including failed calls.
        bad_calls: Number of calls with invalid arguments or to unknown tools.
        perception_failures: Number of calls that failed because perception failed.
        server_events: Number of model server failures, by kind.
        input_tokens: Number of tokens in the planner's requests.
        output_tokens: Number of tokens in the planner's replies.
        cost_usd: Cost of the planner's tokens; None if unknown.
        timings: Wall-clock seconds by stage.
        looks: The wall-clock times of each perception call.
        judgements: The verdicts of judges.
        labels: The human labels.
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
    planned_by: dict[str, Count] = {}
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

    @model_serializer(mode="wrap")
    def _omit_empty_planned_by(self, serialize: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Omit an empty ``planned_by``, so that older versions can also read the trial."""
        fields: dict[str, Any] = serialize(self)
        return {name: value for name, value in fields.items() if name != "planned_by" or value}


class ModelCard(_Record):
    """A model of a pair. ``registry``: its name there, if it has one; ``reported``: what its server says of itself."""

    name: str
    registry: str | None = None
    provider: str = ""
    reported: dict[str, str] = {}
    deterministic: bool = False
    """Whether this is the rule-based grammar planner or ground-truth perception, not a model. Such pairs are not ranked."""


class RunCard(_Record):
    """Under what conditions an evaluation ran. ``contended``: runs shared the machine or servers, so that latency is not its own.

    ``split``: "core", "lite", "paraphrase", "reaction", "unseen" or a file's name; ``dataset_digest``: of the tasks that were run;
    ``agent``: "scope" for our own loop, else module and class of another; ``variant``: which prompt or setting was varied, if any;
    ``isolation``: how an external agent was separated from tasks, ground truth and checks; null for our own loop.
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
    agent: str = OWN_AGENT
    isolation: Isolation | None = None
    variant: str = ""
    sampling: dict[str, Any] = {}
    seed: int | None = None
    prompt_digest: str = ""
    max_steps: int
    epochs: Annotated[int, Field(ge=1)] = 1
    concurrency: Annotated[int, Field(ge=1)] = 1
    contended: bool = True
    host: str = ""

    @model_validator(mode="before")
    @classmethod
    def _add_missing_isolation(cls, fields: Any) -> Any:
        """Set the missing ``isolation`` of an external agent to "in-process", because older versions ran all agents in this way."""
        if isinstance(fields, dict) and "isolation" not in fields and fields.get("agent", OWN_AGENT) != OWN_AGENT:
            return fields | {"isolation": "in-process"}
        return fields

    @model_serializer(mode="wrap")
    def _omit_empty_isolation(self, serialize: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Omit an empty ``isolation``, so that older versions can also read the cards of SCOPE's own loop."""
        fields: dict[str, Any] = serialize(self)
        return {name: value for name, value in fields.items() if name != "isolation" or value is not None}

    @property
    def pair(self) -> str:
        """Name of the pair in tables."""
        return f"{self.planner.name} + {self.perception.name}"

    @property
    def agent_label(self) -> str:
        """Name of the agent in tables, with the isolation label of an external agent."""
        return f"{self.agent} ({self.isolation})" if self.isolation is not None else self.agent

    @property
    def ranked(self) -> bool:
        """Whether the pair is included in rankings."""
        return not (self.planner.deterministic or self.perception.deterministic)


LogFault = Literal[
    "score-differs", "trace-missing", "trace-damaged", "task-differs", "task-unknown", "tasks-changed", "card-differs",
    "sample-missing", "sample-repeated",
]  # fmt: skip
"""Kinds of contradictions between a log and its traces, or between a log and the published tasks."""


class LogFinding(_Record):
    """A contradiction between a log and its traces, or between a log and the published tasks.

    Attributes:
        kind: The kind of contradiction.
        sample: Name of the sample; empty if the finding concerns the whole log.
        detail: A description of the contradiction, without a final full stop.
    """

    kind: LogFault
    sample: str = ""
    detail: str


class Evaluation(_Record):
    """An evaluation: its conditions and its trials.

    Attributes:
        card: The conditions of the evaluation.
        trials: The finished runs. Verdicts are recomputed from the traces; only judgements and labels are read from storage.
        wanted: Number of trials in the complete evaluation (tasks times epochs).
        log: Path of the log.
        findings: Contradictions between the log and its traces. They are not stored with the evaluation.
        failure: The error that ended the evaluation; empty if it did not end in an error.
    """

    card: RunCard
    trials: tuple[Trial, ...]
    wanted: Count
    log: str = ""
    findings: tuple[LogFinding, ...] = Field(default=(), exclude=True, repr=False)
    failure: str = ""

    @model_serializer(mode="wrap")
    def _omit_empty_failure(self, serialize: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Omit an empty ``failure``, so that older versions can also read the result."""
        fields: dict[str, Any] = serialize(self)
        return {name: value for name, value in fields.items() if name != "failure" or value}

    @property
    def finished(self) -> bool:
        """Whether every trial has finished."""
        return len(self.trials) >= self.wanted
