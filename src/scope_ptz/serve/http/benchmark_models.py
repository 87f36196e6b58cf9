"""Request and response bodies for the evaluation routes."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, Field

from scope_ptz.bench.reports.progress_state import CategoryProgress, RunningTask, Score
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.bench.tasks.task import Category
from scope_ptz.serve.http.models import Body, Identifier, whole_number
from scope_ptz.serve.site.benchmark.evaluation_folder import State
from scope_ptz.serve.site.benchmark.evaluations import EvaluationStatus, ReportState

MAX_LIMIT = 10_000  # maximum value of ``limit`` in a request
Split = Literal["core", "lite", "paraphrase", "reaction", "unseen", "all"]


class SplitModel(BaseModel):
    """A split of the dataset, with its number of tasks in each category."""

    name: str
    tasks: int
    by_category: dict[str, int]


class BenchmarkModel(BaseModel):
    """The pairs and splits that can be evaluated.

    Attributes:
        pairs: The server's pairs, the default first.
        splits: The installed splits.
        missing: A message that names missing packages; empty if evaluations can run on the server.
        running: The id of the evaluation in progress; null if there is none.
    """

    pairs: list[str]
    splits: list[SplitModel]
    missing: str
    running: str | None


class EvaluationStart(Body):
    """The evaluation to start.

    Attributes:
        pair: One of the server's pairs; by default, the default pair.
        split: A dataset split.
        limit: Maximum number of tasks, sampled evenly; by default, all.
        categories: The categories to evaluate; all if empty.
    """

    pair: Identifier | None = None
    split: Split = "lite"
    limit: Annotated[int, Field(ge=1, le=MAX_LIMIT), BeforeValidator(whole_number)] | None = None
    categories: Annotated[list[Category], Field(max_length=8)] = Field(default_factory=list)


class ProgressModel(BaseModel):
    """An evaluation's progress: run counts, scores so far with 95% intervals, and the running tasks.

    ``broken`` counts the runs with an infrastructure failure. ``micro`` is the fraction of correct runs, and ``macro`` is the mean
    of the categories' fractions. ``seconds_left`` is the estimated remaining time.
    """

    runs: int
    done: int
    correct: int
    incorrect: int
    unscored: int
    broken: int
    micro: Score | None
    macro: Score | None
    categories: list[CategoryProgress]
    running: list[RunningTask]
    seconds_left: float | None


class EvaluationModel(BaseModel):
    """An evaluation.

    ``actor`` is the name of the client that started the evaluation, and ``resumed`` is the number of times that it was resumed.
    ``message`` is the error message if the evaluation failed. ``report_message`` is the error message if writing the report failed.
    Otherwise, they are empty.
    """

    id: str
    pair: str
    split: str
    limit: int | None
    categories: list[str]
    started: datetime
    actor: str
    resumed: int
    state: State
    message: str
    can_resume: bool
    report: ReportState
    report_message: str
    progress: ProgressModel | None

    @classmethod
    def of(cls, status: EvaluationStatus) -> EvaluationModel:
        """Create the model of an evaluation."""
        record, progress = status.record, status.progress
        return cls(
            **record.model_dump(include={"id", "pair", "split", "limit", "started", "actor", "resumed"}),
            categories=list(record.categories),
            state=status.state,
            message=status.message,
            can_resume=status.can_resume,
            report=status.report,
            report_message=status.report_message,
            progress=None
            if progress is None
            else ProgressModel(**{name: getattr(progress, name) for name in ProgressModel.model_fields}),
        )


class TrialModel(BaseModel):
    """A finished run of a task. ``sample`` identifies the run within its evaluation. ``headline`` is the verdict."""

    sample: str
    task: str
    instruction: str
    category: str
    difficulty: str
    scene: str
    preset: str
    expected: str
    answer: str
    headline: str
    error_mode: str | None
    reason: str
    outcome: str | None
    seconds: float

    @classmethod
    def of(cls, trial: Trial) -> TrialModel:
        """Create the model of a run."""
        facts = trial.task
        return cls(
            sample=trial.sample,
            task=facts.id,
            answer=trial.answer,
            headline=trial.headline,
            error_mode=trial.error_mode.value if trial.error_mode is not None else None,
            reason=trial.reason,
            outcome=trial.outcome,
            seconds=trial.timings.total_s,
            **facts.model_dump(include={"instruction", "category", "difficulty", "scene", "preset", "expected"}),
        )


class TrialList(BaseModel):
    """A page of runs.

    ``count`` is the number of runs that match the filters. ``error_modes`` counts the runs in the whole evaluation by error mode.
    """

    trials: list[TrialModel]
    count: int
    error_modes: dict[str, int]


class CheckModel(BaseModel):
    """The result of one check on an answer or a run. ``passed`` is null if the check is undecided."""

    name: str
    passed: bool | None
    reason: str


class StepPicture(BaseModel):
    """A picture from a step, and the number of detections in it."""

    name: str
    marks: int


class TrialStep(BaseModel):
    """A tool call in a run. ``message`` is the result's message, or the error if the call failed."""

    tool: str
    arguments: dict[str, Any]
    message: str
    failed: bool
    seconds: float
    pictures: list[StepPicture]


class TrialDetails(BaseModel):
    """A run with its checks and steps.

    ``demands`` lists what the run was required to do besides giving the expected answer. ``start_picture`` is the name of the
    picture taken before the first step. ``missing`` states why the steps cannot be read; it is empty if they can.
    """

    trial: TrialModel
    demands: list[str]
    checks: list[CheckModel]
    start_picture: str | None
    steps: list[TrialStep]
    missing: str
