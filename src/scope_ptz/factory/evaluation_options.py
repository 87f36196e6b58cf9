"""Options, progress and result of an evaluation."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.bench.engine.context import Watcher
from scope_ptz.factory.models import ModelOptions

if TYPE_CHECKING:
    from scope_ptz.bench.engine.estimate import Estimate, Price
    from scope_ptz.bench.judging.judgement_tally import JudgementTally
    from scope_ptz.bench.scoring.trials import Evaluation, Trial

OWN_AGENT = "scope"
DEFAULT_LOG_FOLDER = Path("evaluations")
JUDGE_TIMEOUT_S = 300.0


@dataclass(frozen=True, slots=True)
class JudgeSettings:
    """A judge's server as requested. ``options`` are ``NAME=VALUE`` strings; ``repeats`` is the number of judgements of each run.

    ``url``, ``model`` and ``key_file`` fall back to SCOPE_JUDGE_URL, SCOPE_JUDGE_MODEL and SCOPE_JUDGE_KEY.
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
class EvaluationOptions:
    """What to evaluate and how. The defaults run the built-in planner on the published tasks.

    Attributes:
        models: Planner and perception, by name or address.
        out: Folder of the logs.
        tasks: Split (core, lite, paraphrase, reaction, unseen, all) or task file.
        categories: Run only tasks of these categories; all when empty.
        scenes: Run only tasks of these scenes; all when empty.
        limit: Run at most this many tasks, sampled evenly across the selected categories and scenes.
        epochs: Number of runs of each task.
        seed: Seed for every random choice.
        agent: "scope", or ``module:Class`` of an external agent.
        max_steps: Planner steps after which a run ends.
        time_s: Seconds after which a run ends; None for no limit.
        concurrency: Runs at a time; None for a number that suits the models.
        latency: Run one task at a time, to measure latencies.
        pictures: Render frames and log them.
        variant: Label that distinguishes evaluations which differ by one setting.
        fresh: Start again even if there is a log of the same evaluation.
        resume: Log to resume; None for the most complete one in ``out``.
        price: Price of the planner's tokens, for the estimate and the log.
        judge: Judge that scores each run, or None.
    """

    models: ModelOptions = field(default_factory=ModelOptions)
    out: Path = DEFAULT_LOG_FOLDER
    tasks: str = "core"
    categories: tuple[str, ...] = ()
    scenes: tuple[str, ...] = ()
    limit: int | None = None
    epochs: int = 1
    seed: int = 1
    agent: str = OWN_AGENT
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


@dataclass(frozen=True, slots=True)
class EvaluationPlan:
    """The plan of an evaluation that is about to start.

    ``agent`` is None for the built-in loop; ``finished`` are runs taken over from an earlier log. ``asks_planner_server``
    is False if planning costs nothing. ``origin`` names the log that is resumed, or the reason why none is; it may be empty.
    """

    runs: int
    planner: str
    perception: str
    agent: str | None
    concurrency: int
    finished: tuple[Trial, ...]
    estimate: Estimate
    asks_planner_server: bool
    origin: str = ""

    @property
    def pair(self) -> str:
        """Planner (or external agent) and perception, as tables name them."""
        return f"{self.agent or self.planner} + {self.perception}"


class EvaluationProgress(Watcher):
    """Receives the progress of an evaluation. Every method may be overridden; by default none does anything."""

    def note(self, text: str) -> None:
        """Receive a sentence for the user, such as that judgements are missing."""

    def planned(self, plan: EvaluationPlan) -> None:
        """Receive the plan with its estimate, once, before the first run."""

    def closed(self) -> None:
        """The last run has ended, or the evaluation was interrupted. Called once for each call of ``planned``."""


@dataclass(frozen=True, slots=True)
class EvaluationResult:
    """An evaluation as its log holds it. ``judge`` and ``judgements`` are empty without a judge."""

    evaluation: Evaluation
    judge: str = ""
    judgements: JudgementTally | None = None
