"""Evaluations in Python: load tasks, run a planner and a perception backend on them, and read the results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from scope_ptz.bench.scoring.trials import Evaluation, Trial
from scope_ptz.bench.tasks.task import Category, Task
from scope_ptz.errors import ConfigError, InputError
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import Planner

if TYPE_CHECKING:
    import pandas as pd

CATEGORIES: tuple[str, ...] = get_args(Category)


class EvaluationResults:
    """The results of an evaluation: scores by category, and every trial. In a notebook, they are shown as a table.

    ``evaluate`` and ``load_results`` return this class. A score is the fraction of correct trials among those that were scored.
    Trials with an infrastructure failure and trials that still need a judge are excluded.

    Example:
        >>> import scope_ptz, tempfile
        >>> tasks = scope_ptz.load_tasks("core", categories=["single_call"], limit=2)
        >>> results = scope_ptz.evaluate(tasks=tasks, out=tempfile.mkdtemp(), pictures=False)
        >>> results.scores
        {'single_call': 1.0}
        >>> [trial.headline for trial in results.trials]
        ['correct', 'correct']
    """

    def __init__(self, evaluation: Evaluation) -> None:
        self._evaluation = evaluation

    @property
    def trials(self) -> tuple[Trial, ...]:
        """All trials. A trial is a run of a task, with its verdict, answer, error mode and timings."""
        return self._evaluation.trials

    @property
    def pair(self) -> str:
        """Names of the planner and the perception backend that were evaluated, as "PLANNER + PERCEPTION"."""
        return self._evaluation.card.pair

    @property
    def log(self) -> Path:
        """Path of the log file, which ``load_results`` and ``scope bench report`` read."""
        return Path(self._evaluation.log)

    @property
    def finished(self) -> bool:
        """Whether all trials are complete. Running the same evaluation again resumes an unfinished one."""
        return self._evaluation.finished

    @cached_property
    def scores(self) -> dict[str, float]:
        """Score in each category, from 0 to 1. Categories without scored trials are omitted."""
        scored = {category: score(self._trials_of(category)) for category in CATEGORIES}
        return {category: value for category, value in scored.items() if value is not None}

    @property
    def macro(self) -> float | None:
        """Unweighted mean of the category scores; None if no trial was scored."""
        return sum(self.scores.values()) / len(self.scores) if self.scores else None

    @property
    def micro(self) -> float | None:
        """Fraction of correct trials among all scored trials; None if no trial was scored."""
        return score(self.trials)

    def to_pandas(self) -> pd.DataFrame:
        """Return the trials as a data frame.

        Returns:
            The data frame, with one row for each trial.

        Raises:
            ConfigError: pandas is not installed.
        """
        try:
            import pandas as pd
        except ImportError:
            raise ConfigError("to_pandas() needs pandas. Install it with: pip install pandas") from None
        return pd.DataFrame([_row(trial) for trial in self.trials], columns=list(_COLUMNS))

    def __len__(self) -> int:
        return len(self.trials)

    def __iter__(self) -> Iterator[Trial]:
        return iter(self.trials)

    def __repr__(self) -> str:
        macro = f"{self.macro:.1%}" if self.macro is not None else "not scored"
        return f"<EvaluationResults {self.pair}: {len(self)} trials, macro {macro}>"

    def _repr_html_(self) -> str:
        from scope_ptz.api.notebook import table_html

        rows = [self._table_row(name.replace("_", " "), self._trials_of(name), value) for name, value in self.scores.items()]
        rows.append(self._table_row("macro (mean of categories)", (), self.macro))
        rows.append(self._table_row("micro (all trials)", self.trials, self.micro))
        return table_html(self.pair, ("category", "trials", "correct", "score"), rows, f"log: {self.log}")

    def _trials_of(self, category: str) -> tuple[Trial, ...]:
        return tuple(trial for trial in self.trials if trial.task.category == category)

    @staticmethod
    def _table_row(name: str, trials: Sequence[Trial], value: float | None) -> tuple[str, str, str, str]:
        correct = sum(trial.headline == "correct" for trial in trials)
        numbers = (str(len(trials)), str(correct)) if trials else ("", "")
        return name, *numbers, "-" if value is None else f"{value:.1%}"


def load_tasks(
    tasks: str | PathLike[str] = "core",
    *,
    categories: Sequence[str] = (),
    scenes: Sequence[str] = (),
    limit: int | None = None,
) -> tuple[Task, ...]:
    """Load benchmark tasks.

    Args:
        tasks: A split ("core", "lite", "paraphrase", "reaction", "unseen" or "all"), or a task file (JSONL or YAML).
        categories: Only tasks of these categories; all by default.
        scenes: Only tasks of these scenes; all by default.
        limit: At most this many tasks, sampled evenly across the selected categories, scenes and answers.

    Returns:
        The tasks. The same arguments always select the same tasks.

    Raises:
        InputError: A name is unknown, a file is missing or damaged, or no task matches the selection.

    Example:
        >>> import scope_ptz
        >>> tasks = scope_ptz.load_tasks("core", limit=16)
        >>> len(tasks), len({task.category for task in tasks})
        (16, 8)
    """
    from scope_ptz.bench.engine.entries import select_entries
    from scope_ptz.factory.evaluation import load_entries
    from scope_ptz.factory.scenes import scene_search
    from scope_ptz.settings import load_settings
    from scope_ptz.simulator.library import Library

    entries = load_entries(str(tasks), Library(scene_search(load_settings())))
    selected = select_entries(entries, _names("categories", categories), _names("scenes", scenes), limit)
    loaded = tuple(entry.task for entry in selected if entry.task is not None)
    if len(loaded) < len(selected):
        raise InputError(f"{tasks} contains imported tasks, which only a judge can score. Pass its path to evaluate(tasks=...).")
    return loaded


def evaluate(
    planner: Planner | str | None = None,
    perception: Perception | str | None = None,
    *,
    tasks: str | PathLike[str] | Sequence[Task] = "core",
    out: str | PathLike[str] = "evaluations",
    pair: str | None = None,
    agent: str | None = None,
    agent_command: str | None = None,
    agent_python: str | PathLike[str] | None = None,
    agent_env: Sequence[str] = (),
    sandbox: bool = False,
    agent_memory_mb: int = 4_096,
    agent_step_s: float = 300.0,
    agent_run_s: float = 1_800.0,
    agent_in_process: bool = False,
    categories: Sequence[str] = (),
    scenes: Sequence[str] = (),
    limit: int | None = None,
    epochs: int = 1,
    seed: int = 1,
    max_steps: int = 60,
    time_budget_s: float | None = None,
    concurrency: int | None = None,
    pictures: bool = True,
    fresh: bool = False,
    planner_url: str | None = None,
    planner_model: str | None = None,
    perception_url: str | None = None,
    perception_model: str | None = None,
    timeout_s: float | None = None,
) -> EvaluationResults:
    """Run a planner and a perception backend on benchmark tasks, and score every run.

    The log in ``out`` grows as runs end. Calling this again with the same arguments resumes an interrupted evaluation, and reads
    the results of a complete one.

    Args:
        planner: Name of a planner or model, or a ``Planner`` object; the built-in rule-based planner by default.
        perception: Name of a backend or model, or a ``Perception`` object; the simulator's ground truth by default.
        tasks: A split, a task file, or tasks returned by ``load_tasks``.
        out: Folder for the logs.
        pair: A pair as "PLANNER+PERCEPTION", or the name of one model that does both.
        agent: "module:Class" of an external agent, which replaces the planner and the agent loop. It runs in a separate process.
        agent_command: Command line of a program that speaks the agent protocol on stdin and stdout, instead of ``agent``.
        agent_python: Python interpreter of the agent's own environment; the current one by default.
        agent_env: Names of environment variables to pass on to the agent.
        sandbox: Run the agent without access to the network and the dataset's files (bubblewrap, Linux only).
        agent_memory_mb: Maximum total memory of the agent's processes, in MB.
        agent_step_s: Maximum time in seconds that the agent may take per step.
        agent_run_s: Maximum time in seconds that the agent may take per run, not counting tools and perception.
        agent_in_process: Run the agent inside this program, for debugging. It can then read the expected answers, and its
            results are labelled accordingly.
        categories: Only tasks of these categories; all by default.
        scenes: Only tasks of these scenes; all by default.
        limit: At most this many tasks, sampled evenly across the selected categories, scenes and answers.
        epochs: Number of runs of each task.
        seed: Seed for every random choice.
        max_steps: Number of planner steps after which a run ends.
        time_budget_s: Seconds of wall-clock time after which a run ends; no limit by default.
        concurrency: Number of concurrent runs; the default depends on the models.
        pictures: Whether to render and log frames. Ground truth does not need frames and is faster without them.
        fresh: Start a new evaluation even if ``out`` has a log of the same evaluation.
        planner_url: Address of the planner's model server.
        planner_model: Name of the planner's model on its server.
        perception_url: Address of the vision model's server.
        perception_model: Name of the vision model on its server.
        timeout_s: Seconds after which a request to a model server fails, including its retries.

    Returns:
        The results.

    Raises:
        ConfigError: The evaluation engine is not installed, or a model is not configured.
        InputError: An option is invalid, or a name is unknown.
        ScopeError: Too many consecutive runs failed because of infrastructure.

    Example:
        >>> import scope_ptz, tempfile
        >>> tasks = scope_ptz.load_tasks("core", categories=["single_call"], limit=2)
        >>> results = scope_ptz.evaluate("grammar", "ground-truth", tasks=tasks, out=tempfile.mkdtemp(), pictures=False)
        >>> results.macro
        1.0
    """
    from scope_ptz.api.evaluating import EvaluationRequest, run_evaluation
    from scope_ptz.bench.agents.launch import AgentOptions
    from scope_ptz.bench.agents.planner import AgentTimeLimits

    options = AgentOptions(
        command=agent_command or "", python=None if agent_python is None else Path(agent_python), in_process=agent_in_process,
        sandbox=sandbox, variables=_names("agent_env", agent_env), memory_mb=agent_memory_mb,
        times=AgentTimeLimits(agent_step_s, agent_run_s),
    )  # fmt: skip
    request = EvaluationRequest(
        planner=planner, perception=perception, pair=pair, tasks=tasks if isinstance(tasks, str | PathLike) else tuple(tasks),
        out=Path(out), agent=agent, agent_options=options,
        categories=_names("categories", categories), scenes=_names("scenes", scenes), limit=limit,
        epochs=epochs, seed=seed, max_steps=max_steps, time_budget_s=time_budget_s, concurrency=concurrency, pictures=pictures,
        fresh=fresh, planner_url=planner_url, planner_model=planner_model, perception_url=perception_url,
        perception_model=perception_model, timeout_s=timeout_s,
    )  # fmt: skip
    return EvaluationResults(run_evaluation(request))


def load_results(path: str | PathLike[str]) -> EvaluationResults:
    """Read the results of an evaluation.

    Args:
        path: A log file, or a folder. The newest log in the folder is read.

    Returns:
        The results. ``finished`` is False if the evaluation is incomplete.

    Raises:
        TraceError: There is no log, or it is damaged.
        ConfigError: The evaluation engine is not installed.

    Example:
        >>> import scope_ptz, tempfile
        >>> out = tempfile.mkdtemp()
        >>> tasks = scope_ptz.load_tasks("core", categories=["single_call"], limit=1)
        >>> ran = scope_ptz.evaluate(tasks=tasks, out=out, pictures=False)
        >>> scope_ptz.load_results(out).scores == ran.scores
        True
    """
    from scope_ptz.api.evaluating import read_results

    return EvaluationResults(read_results(Path(path)))


def score(trials: Sequence[Trial]) -> float | None:
    """Return the fraction of correct trials among the scored trials; None if no trial is scored."""
    from scope_ptz.bench.judging.judgement_tally import lacks_verdict

    scored = [trial for trial in trials if trial.headline != "infrastructure" and not lacks_verdict(trial)]
    return sum(trial.headline == "correct" for trial in scored) / len(scored) if scored else None


_COLUMNS = (
    "task", "category", "scope", "scene", "viewpoint", "difficulty", "epoch", "instruction", "expected", "answer", "outcome",
    "headline", "correct", "error_mode", "steps", "calls", "bad_calls", "planner_s", "perception_s", "total_s", "input_tokens",
    "output_tokens",
)  # fmt: skip


def _row(trial: Trial) -> dict[str, Any]:
    task, timings = trial.task, trial.timings
    values: tuple[Any, ...] = (
        task.id, task.category, task.scope, task.scene, task.viewpoint, task.difficulty, trial.epoch, task.instruction,
        task.expected, trial.answer, trial.outcome, trial.headline, trial.headline == "correct", trial.error_mode, trial.steps,
        sum(trial.tool_calls.values()), trial.bad_calls, timings.planner_s, timings.perception_s, timings.total_s,
        trial.input_tokens, trial.output_tokens,
    )  # fmt: skip
    return dict(zip(_COLUMNS, values, strict=True))


def _names(option: str, names: Sequence[str]) -> tuple[str, ...]:
    if isinstance(names, str):
        raise InputError(f"{option}= must be a list of names: write {option}=[{names!r}].")
    return tuple(names)
