"""Options of the benchmark commands: tasks, evaluations, external agents and judges."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.options import JUDGE_PANEL, RUN_PANEL, JudgeFlags, RunSeedOption
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.bench.agents.launch import AgentOptions
    from scope_ptz.bench.engine.estimate import Price
    from scope_ptz.bench.tasks.task import Task
    from scope_ptz.factory.evaluation_options import EvaluationOptions, JudgeSettings
    from scope_ptz.factory.models import ModelOptions

TASKS_PANEL, AGENT_PANEL = "Tasks", "External agent"
DEFAULT_LOG_FOLDER = Path("evaluations")
DEFAULT_MEMORY_MB, DEFAULT_STEP_S, DEFAULT_RUN_S = 4_096, 300.0, 1_800.0
"""Default limits on external agents. They are copied from ``AgentOptions``, so that help pages need not import its module."""

SPLITS = "core, lite, paraphrase, reaction, unseen, all"

TasksOption = Annotated[str, typer.Option("--tasks", help=f"Split ({SPLITS}) or task file (JSONL or YAML).")]
ScenesOption = Annotated[
    list[str] | None, typer.Option("--scene", help="Scene to make tasks for (repeatable; default: every scene).")
]
GoldOption = Annotated[Path | None, typer.Option("--gold", help="File of gold runs (default: the published file).")]
HostKeysOption = Annotated[
    list[Path] | None,
    typer.Option("--host-key", help="Public key of a trusted host, or folder of such keys (*.pub; repeatable)."),
]
JudgeRepeatsOption = Annotated[
    int, typer.Option("--judge-repeats", min=1, help="Number of judgements of each run.", rich_help_panel=JUDGE_PANEL)
]


@dataclass(frozen=True, kw_only=True)
class SelectionFlags:
    """Options that select the tasks."""

    split: Annotated[
        str, typer.Option("--split", "--tasks", help=f"Split ({SPLITS}) or task file.", rich_help_panel=TASKS_PANEL)
    ] = "core"
    category: Annotated[
        list[str] | None,
        typer.Option("--category", help="Run only tasks of this category (repeatable).", rich_help_panel=TASKS_PANEL),
    ] = None
    scene: Annotated[
        list[str] | None,
        typer.Option("--scene", help="Run only tasks of this scene (repeatable).", rich_help_panel=TASKS_PANEL),
    ] = None
    limit: Annotated[
        int | None,
        typer.Option(
            "--limit",
            min=1,
            help="Run at most N tasks, sampled evenly across the selected categories, scenes and answers.",
            rich_help_panel=TASKS_PANEL,
        ),
    ] = None
    epochs: Annotated[int, typer.Option("--epochs", min=1, help="Number of runs of each task.", rich_help_panel=TASKS_PANEL)] = 1


@dataclass(frozen=True, kw_only=True)
class EvaluationFlags:
    """Options for running tasks and writing the log."""

    concurrency: Annotated[
        int | None,
        typer.Option(
            "--concurrency",
            min=1,
            max=256,
            help="Number of runs at a time (default: 8 with model servers, otherwise 1).",
            rich_help_panel=RUN_PANEL,
        ),
    ] = None
    latency: Annotated[
        bool, typer.Option("--latency", help="Run one task at a time, to measure latencies.", rich_help_panel=RUN_PANEL)
    ] = False
    seed: RunSeedOption = 1
    max_steps: Annotated[
        int, typer.Option("--max-steps", min=1, help="Maximum number of planner steps in a run.", rich_help_panel=RUN_PANEL)
    ] = 60
    time_budget: Annotated[
        float | None,
        typer.Option(
            "--time-budget", min=1, help="Maximum duration of a run in seconds (default: no limit).", rich_help_panel=RUN_PANEL
        ),
    ] = None
    out: Annotated[Path, typer.Option("--out", help="Folder for logs.", rich_help_panel=RUN_PANEL)] = DEFAULT_LOG_FOLDER


@dataclass(frozen=True, kw_only=True)
class SingleEvaluationFlags(EvaluationFlags):
    """Options for a single evaluation, including those that are not available for sweeps over several pairs."""

    pictures: Annotated[
        bool,
        typer.Option(
            "--pictures/--no-pictures",
            help="Render frames and log them. Ground-truth perception needs no frames.",
            rich_help_panel=RUN_PANEL,
        ),
    ] = True
    resume: Annotated[
        Path | None,
        typer.Option(
            "--resume",
            metavar="LOG",
            help="Log to resume (default: the log of the same evaluation in --out).",
            rich_help_panel=RUN_PANEL,
        ),
    ] = None
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Start again instead of resuming an earlier log.", rich_help_panel=RUN_PANEL)
    ] = False
    variant: Annotated[
        str,
        typer.Option(
            "--variant", help="Label for an evaluation that differs from another in one setting.", rich_help_panel=RUN_PANEL
        ),
    ] = ""
    price: Annotated[
        str | None,
        typer.Option(
            "--price",
            metavar="IN,OUT",
            help="US dollars per million input and output tokens of the planner.",
            rich_help_panel=RUN_PANEL,
        ),
    ] = None
    progress: Annotated[
        Path | None,
        typer.Option(
            "--progress",
            metavar="FOLDER",
            help="Folder for progress files, for programs that follow the evaluation.",
            rich_help_panel=RUN_PANEL,
        ),
    ] = None


@dataclass(frozen=True, kw_only=True)
class AgentFlags:
    """Options for an external agent."""

    agent: Annotated[
        str,
        typer.Option(
            "--agent",
            metavar="MODULE:CLASS",
            help="External agent to run instead of the built-in loop; see docs/external-agents.md.",
            rich_help_panel=AGENT_PANEL,
        ),
    ] = "scope"
    agent_command: Annotated[
        str | None,
        typer.Option(
            "--agent-command",
            metavar="COMMAND",
            help="Command line of a program that speaks the agent protocol on stdin and stdout. It is run without a shell.",
            rich_help_panel=AGENT_PANEL,
        ),
    ] = None
    agent_python: Annotated[
        Path | None,
        typer.Option(
            "--agent-python",
            metavar="PATH",
            help="Python interpreter of the agent's own environment (default: the one that runs SCOPE).",
            rich_help_panel=AGENT_PANEL,
        ),
    ] = None
    agent_env: Annotated[
        list[str] | None,
        typer.Option(
            "--agent-env",
            metavar="NAME",
            help="Environment variable to pass on to the agent (repeatable).",
            rich_help_panel=AGENT_PANEL,
        ),
    ] = None
    sandbox: Annotated[
        bool,
        typer.Option(
            "--sandbox",
            help="Run the agent without access to the network and the dataset's files (bubblewrap, Linux only).",
            rich_help_panel=AGENT_PANEL,
        ),
    ] = False
    agent_memory_mb: Annotated[
        int,
        typer.Option(
            "--agent-memory-mb",
            min=64,
            help="Maximum total memory of the agent's processes, in MB.",
            rich_help_panel=AGENT_PANEL,
        ),
    ] = DEFAULT_MEMORY_MB
    agent_step_s: Annotated[
        float,
        typer.Option(
            "--agent-step-s",
            min=0.1,
            help="Maximum time in seconds that the agent may take per step.",
            rich_help_panel=AGENT_PANEL,
        ),
    ] = DEFAULT_STEP_S
    agent_run_s: Annotated[
        float,
        typer.Option(
            "--agent-run-s",
            min=0.1,
            help="Maximum time in seconds that the agent may take per run, not counting tools and perception.",
            rich_help_panel=AGENT_PANEL,
        ),
    ] = DEFAULT_RUN_S
    agent_in_process: Annotated[
        bool,
        typer.Option(
            "--agent-in-process",
            help="Run the agent inside SCOPE, for debugging. It can access the answers, and its results are labelled accordingly.",
            rich_help_panel=AGENT_PANEL,
        ),
    ] = False


def evaluation_options(selection: SelectionFlags, evaluation: EvaluationFlags, models: ModelOptions) -> EvaluationOptions:
    """Convert the flags that all evaluation commands share to evaluation options."""
    from scope_ptz.factory.evaluation_options import EvaluationOptions

    return EvaluationOptions(
        models=models,
        out=evaluation.out,
        tasks=selection.split,
        categories=tuple(selection.category or ()),
        scenes=tuple(selection.scene or ()),
        limit=selection.limit,
        epochs=selection.epochs,
        seed=evaluation.seed,
        max_steps=evaluation.max_steps,
        time_s=evaluation.time_budget,
        concurrency=evaluation.concurrency,
        latency=evaluation.latency,
    )


def agent_options(flags: AgentFlags) -> AgentOptions:
    """Return the options for starting an external agent."""
    from scope_ptz.bench.agents.launch import AgentOptions
    from scope_ptz.bench.agents.planner import AgentTimeLimits

    if flags.agent_command is not None and not flags.agent_command.strip():
        raise InputError("--agent-command is empty. Give the command line of a program that speaks the agent protocol.")
    return AgentOptions(
        command=flags.agent_command or "",
        python=flags.agent_python,
        in_process=flags.agent_in_process,
        sandbox=flags.sandbox,
        variables=tuple(flags.agent_env or ()),
        memory_mb=flags.agent_memory_mb,
        times=AgentTimeLimits(flags.agent_step_s, flags.agent_run_s),
    )


def judge_settings(flags: JudgeFlags, repeats: int = 1) -> JudgeSettings:
    """Convert the judge flags to judge settings."""
    from scope_ptz.factory.evaluation_options import JudgeSettings

    return JudgeSettings(
        flags.judge_url,
        flags.judge_model,
        flags.judge_key_file,
        flags.judge_timeout,
        tuple(flags.judge_option or ()),
        repeats,
    )


def parse_price(text: str | None) -> Price | None:
    """Parse ``IN,OUT`` as a price. Raises ``InputError``."""
    if text is None:
        return None
    from scope_ptz.bench.engine.estimate import Price

    try:
        amounts = [float(part) for part in text.split(",")]
    except ValueError:
        amounts = []
    if len(amounts) != 2 or min(amounts) < 0:
        raise InputError(
            f"--price must be two prices in US dollars per million input and output tokens, such as 0.15,0.60; got '{text}'."
        )
    return Price(*amounts)


def published_tasks() -> list[Task]:
    """Return the tasks of every published split that is installed."""
    from scope_ptz.bench.tasks.published import published_tasks as published

    return list(published().values())


def check_category(name: str) -> str:
    """Return the name of a category, or an empty name for all categories. Raises ``InputError`` for unknown categories."""
    from scope_ptz.bench.engine.run_totals import CATEGORIES

    if name and name not in CATEGORIES:
        raise InputError(f"There is no category '{name}'. The categories are: {', '.join(CATEGORIES)}.")
    return name
