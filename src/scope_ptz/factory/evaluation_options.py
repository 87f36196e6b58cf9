"""The options, progress and result of an evaluation."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scope_ptz.bench.engine.context import OpenAgent, Order, Watcher
from scope_ptz.factory.models import ModelOptions

if TYPE_CHECKING:
    from scope_ptz.bench.agents.channel import Isolation
    from scope_ptz.bench.agents.launch import AgentOptions
    from scope_ptz.bench.engine.estimate import Estimate, Price
    from scope_ptz.bench.judging.judgement_tally import JudgementTally
    from scope_ptz.bench.scoring.trials import Evaluation, Trial

BUILT_IN_AGENT = "scope"
DEFAULT_LOG_FOLDER = Path("evaluations")
JUDGE_TIMEOUT_S = 300.0


@dataclass(frozen=True, slots=True)
class JudgeSettings:
    """Settings for the judge and its server.

    Attributes:
        url: URL of the server; None to use SCOPE_JUDGE_URL.
        model: The judge's served name; None to use SCOPE_JUDGE_MODEL.
        key_file: File that contains the server's API key; None to use the key in SCOPE_JUDGE_KEY.
        timeout_s: Timeout in seconds for a judgement, including retries.
        options: Additional options for the judge, as ``NAME=VALUE`` strings.
        repeats: Number of judgements per run.
    """

    url: str | None = None
    model: str | None = None
    key_file: Path | None = None
    timeout_s: float = JUDGE_TIMEOUT_S
    options: tuple[str, ...] = ()
    repeats: int = 1

    @property
    def requested(self) -> bool:
        """Whether a judge is specified by options or by the environment."""
        from scope_ptz.settings import load_settings

        return bool(self.url or self.model or load_settings().judge_url)


@dataclass(frozen=True, slots=True)
class HostedAgent:
    """An external agent that runs elsewhere and connects for each run.

    Attributes:
        name: The agent's name in traces and on run cards.
        open: A function that waits until the agent starts the next run, and connects it.
        order: A function that orders the tasks so that the agent cannot predict them.
        settings: Other settings that determine the agent's results, as JSON data. They are part of an evaluation's identity.
        isolation: The isolation label for its results.
        source: Digest of its source code; empty because the code is unknown.
    """

    name: str
    open: OpenAgent
    order: Order
    settings: dict[str, Any]
    isolation: Isolation = "hosted"
    source: str = ""

    async def check(self) -> None:
        """Do nothing, because the agent connects only when its first run starts."""


@dataclass(frozen=True, slots=True)
class EvaluationOptions:
    """The options of an evaluation. The defaults run the built-in planner on the published tasks.

    Attributes:
        models: The planner and perception backend, by name or URL.
        out: The log folder.
        tasks: A split (core, lite, paraphrase, reaction, unseen, all) or a task file.
        categories: Run only tasks in these categories; all if empty.
        scenes: Run only tasks in these scenes; all if empty.
        limit: Run at most this many tasks, sampled evenly across the selected categories, scenes and answers.
        epochs: Number of runs per task.
        seed: Seed for every random choice.
        agent: "scope" for the built-in agent, or ``module:Class`` for an external agent.
        agent_options: How an external agent is started and limited; None for the defaults. A command in it replaces ``agent``.
        max_steps: Maximum number of planner steps per run.
        time_s: Maximum wall-clock seconds per run; None for no limit.
        concurrency: Number of concurrent runs; None for a default that depends on the models.
        latency: Run one task at a time in order to measure latencies.
        pictures: Render and log frames.
        variant: Label that distinguishes evaluations with different settings.
        fresh: Start a new evaluation even if the folder contains a log of the same evaluation.
        resume: The log to resume; None for the most complete one in ``out``.
        price: Price of the planner's tokens, for the estimate and the log.
        judge: Settings for the judge that scores each run; None for no judge.
        hosted_agent: An external agent that runs elsewhere. It replaces ``agent``.
    """

    models: ModelOptions = field(default_factory=ModelOptions)
    out: Path = DEFAULT_LOG_FOLDER
    tasks: str = "core"
    categories: tuple[str, ...] = ()
    scenes: tuple[str, ...] = ()
    limit: int | None = None
    epochs: int = 1
    seed: int = 1
    agent: str = BUILT_IN_AGENT
    agent_options: AgentOptions | None = None
    max_steps: int = 60
    time_s: float | None = None
    concurrency: int | None = None
    latency: bool = False
    pictures: bool = True
    variant: str = ""
    fresh: bool = False
    resume: Path | None = None
    price: Price | None = None
    judge: JudgeSettings | None = None
    hosted_agent: HostedAgent | None = None


@dataclass(frozen=True, slots=True)
class EvaluationPlan:
    """The plan of an evaluation that is about to start.

    Attributes:
        runs: Number of runs, including finished ones.
        planner: Name of the planner.
        perception: Name of the perception backend.
        agent: Name of the external agent; None for the built-in agent loop.
        concurrency: Number of concurrent runs.
        finished: Trials from the log that is being resumed.
        estimate: Estimated duration and cost.
        uses_planner_server: Whether the planner calls a model server. If not, planning is free.
        isolation: How an external agent is isolated from tasks, ground truth and checks; None for the built-in agent loop.
        origin: A sentence that names the log that is being resumed, or the reason for starting a new evaluation; may be empty.
    """

    runs: int
    planner: str
    perception: str
    agent: str | None
    concurrency: int
    finished: tuple[Trial, ...]
    estimate: Estimate
    uses_planner_server: bool
    isolation: Isolation | None = None
    origin: str = ""

    @property
    def pair(self) -> str:
        """The names of the planner (or external agent) and the perception backend, as shown in tables."""
        return f"{self.agent or self.planner} + {self.perception}"


class EvaluationProgress(Watcher):
    """Receives the progress of an evaluation. Override the methods of interest; the default implementations do nothing."""

    def note(self, text: str) -> None:
        """Receive a message for the user, for example that judgements are missing."""

    def planned(self, plan: EvaluationPlan) -> None:
        """Receive the plan with its estimate. Called once before the first run."""

    def closed(self) -> None:
        """Called once for each call to ``planned``, when the evaluation has ended or was interrupted."""


@dataclass(frozen=True, slots=True)
class EvaluationResult:
    """An evaluation as stored in its log.

    Attributes:
        evaluation: The evaluation with its trials.
        judge: Name of the judge; empty without a judge.
        judgements: Tally of the judgements; None without a judge.
    """

    evaluation: Evaluation
    judge: str = ""
    judgements: JudgementTally | None = None
