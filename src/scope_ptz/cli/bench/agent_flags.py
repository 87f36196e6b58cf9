"""Options for external agents."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.bench.agents.launch import AgentOptions

AGENT_PANEL = "External agent"
DEFAULT_MEMORY_MB, DEFAULT_STEP_S, DEFAULT_RUN_S = 4_096, 300.0, 1_800.0
"""Default limits on external agents. They are copied from ``AgentOptions``, so that help pages need not import its module."""


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
