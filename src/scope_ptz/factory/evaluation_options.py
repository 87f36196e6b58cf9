"""Options, progress and result of an evaluation."""

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
    """Settings of the judge and its server.

    Attributes:
        url: Address of the server; SCOPE_JUDGE_URL if None.
        model: The judge's served name; SCOPE_JUDGE_MODEL if None.
        key_file: File that contains the server's key; the key in SCOPE_JUDGE_KEY if None.
        timeout_s: Seconds for one judgement, including retries.
        options: Further options of the judge as ``NAME=VALUE`` strings.
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
        """Whether options or the environment name a judge."""
        from scope_ptz.settings import load_settings

        return bool(self.url or self.model or load_settings().judge_url)


@dataclass(frozen=True, slots=True)
class HostedAgent:
    """An external agent that runs elsewhere and connects for each run.

    Attributes:
        name: Its name in traces and on run cards.
        open: Waits until the agent begins the next run, and connects it.
        order: Orders the tasks, so that the agent cannot foresee them.
        settings: What else determines its results, as JSON data: a part of the identity of evaluations.
        isolation: The label of its results.
        source: Digest of its source, which is unknown.
    """

    name: str
    open: OpenAgent
    order: Order
    settings: dict[str, Any]
    isolation: Isolation = "hosted"
    source: str = ""

    async def check(self) -> None:
        """Do nothing: whether the agent works turns out in its first run."""


@dataclass(frozen=True, slots=True)
class EvaluationOptions:
    """What to evaluate and how. The defaults run the built-in planner on the published tasks.

    Attributes:
        models: Planner and perception, by name or address.
        out: Folder of the logs.
        tasks: Split (core, lite, paraphrase, reaction, unseen, all) or task file.
        categories: Run only tasks of these categories; all when empty.
        scenes: Run only tasks of these scenes; all when empty.
        limit: Run at most this many tasks, sampled evenly across the selected categories, scenes and answers.
        epochs: Number of runs of each task.
        seed: Seed for every random choice.
        agent: "scope", or ``module:Class`` of an external agent.
        agent_options: How an external agent is started and limited; None for the defaults. Its command replaces ``agent``.
        max_steps: Number of planner steps after which a run ends.
        time_s: Number of wall-clock seconds after which a run ends; None for no limit.
        concurrency: Number of concurrent runs; None for a default that depends on the models.
        latency: Run one task at a time, to measure latencies.
        pictures: Render and log frames.
        variant: Label that distinguishes evaluations with different settings.
        fresh: Start a new evaluation even if the folder has a log of the same evaluation.
        resume: Log to resume; None for the most complete one in ``out``.
        price: Price of the planner's tokens, for the estimate and the log.
        judge: Settings of the judge that scores each run; None for no judge.
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
        finished: Trials from the log that is resumed.
        estimate: Estimate of duration and cost.
        asks_planner_server: Whether the planner calls a model server. Otherwise planning costs nothing.
        isolation: How an external agent is separated from tasks, ground truth and checks; None for the built-in agent loop.
        origin: A sentence that names the log that is resumed, or the reason for a new evaluation; may be empty.
    """

    runs: int
    planner: str
    perception: str
    agent: str | None
    concurrency: int
    finished: tuple[Trial, ...]
    estimate: Estimate
    asks_planner_server: bool
    isolation: Isolation | None = None
    origin: str = ""

    @property
    def pair(self) -> str:
        """Names of the planner (or external agent) and the perception backend, as shown in tables."""
        return f"{self.agent or self.planner} + {self.perception}"


class EvaluationProgress(Watcher):
    """Receives the progress of an evaluation. Subclasses override the methods that they need; the defaults do nothing."""

    def note(self, text: str) -> None:
        """Receive a message for the user, for example that judgements are missing."""

    def planned(self, plan: EvaluationPlan) -> None:
        """Receive the plan with its estimate, once, before the first run."""

    def closed(self) -> None:
        """Called when the evaluation has ended or was interrupted, once for each call of ``planned``."""


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
