"""The settings for starting a local agent: its class or program, its environment and its limits."""

from __future__ import annotations

import os
import shlex
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from scope_ptz.bench.agents.channel import Isolation
from scope_ptz.bench.agents.planner import AgentTimeLimits
from scope_ptz.errors import ConfigError

DEFAULT_MEMORY_MB = 4_096
"""Default limit on the total memory of an agent's processes, in MB."""


@dataclass(frozen=True, slots=True)
class AgentOptions:
    """The user's options for a local agent, other than the name of its class.

    Attributes:
        command: Command line of a program that speaks the protocol on stdin and stdout; empty for a class.
        python: Interpreter of the agent's own environment; None for the interpreter that runs SCOPE.
        in_process: Whether to run the agent in the scorer's process.
        sandbox: Whether to run the agent in a sandbox.
        variables: Names of additional environment variables to pass to the agent.
        memory_mb: Maximum total memory of the agent's processes in MB; None for no limit.
        times: Limits on the agent's time.
    """

    command: str = ""
    python: Path | None = None
    in_process: bool = False
    sandbox: bool = False
    variables: tuple[str, ...] = ()
    memory_mb: int | None = DEFAULT_MEMORY_MB
    times: AgentTimeLimits = field(default_factory=AgentTimeLimits)

    @property
    def isolation(self) -> Isolation:
        """The isolation label of the agent's results."""
        return "in-process" if self.in_process else "sandboxed" if self.sandbox else "isolated"


@dataclass(frozen=True, slots=True)
class AgentLaunch:
    """The settings for starting an agent's process.

    Attributes:
        name: The agent's name in traces and on run cards.
        command: The program and its arguments, including the command line of the sandbox.
        folder: The working folder.
        environment: The complete environment of the process.
        isolation: The isolation label of the agent's results.
        memory_mb: Maximum total memory of the agent's processes in MB; None for no limit.
    """

    name: str
    command: tuple[str, ...]
    folder: Path
    environment: Mapping[str, str] = field(repr=False)
    isolation: Isolation = "isolated"
    memory_mb: int | None = DEFAULT_MEMORY_MB


def agent_name(agent: str, options: AgentOptions) -> str:
    """Return the name of an agent: ``module:Class``, or ``command:FILE``.

    FILE is the first argument that names an existing file, or else the program. Other arguments are not shown, because they may be
    private.

    Raises:
        ConfigError: The name is invalid, or the options contradict each other.
    """
    if options.command:
        if options.python is not None or options.in_process:
            raise ConfigError(
                "--agent-python and --agent-in-process require --agent MODULE:CLASS and cannot be used with --agent-command."
            )
        program, *arguments = split_command(options.command)
        return f"command:{Path(next(filter(os.path.isfile, arguments), program)).name}"
    module, colon, attribute = agent.partition(":")
    if not colon or not module or not attribute:
        raise ConfigError(f"--agent must have the form module:Class; got '{agent}'.")
    if options.in_process and (options.sandbox or options.python is not None):
        raise ConfigError("--agent-in-process runs the agent inside SCOPE; remove it to use --sandbox or --agent-python.")
    return agent


def split_command(command: str) -> list[str]:
    """Split a command into the program and its arguments, without using a shell.

    Raises:
        ConfigError: The command is empty, or a quotation mark is missing.
    """
    try:
        parts = shlex.split(command)
    except ValueError as error:
        raise ConfigError(f"--agent-command is not a valid command line: {error}.") from error
    if not parts:
        raise ConfigError("--agent-command is empty. Give the command line of a program that speaks the agent protocol.")
    return parts


def find_program(name: str, folder: Path) -> Path:
    """Return the path of a program.

    Args:
        name: A program name to look up on the search path, or a path. Relative paths are resolved against ``folder``.
        folder: The working folder.

    Raises:
        ConfigError: The program does not exist or is not executable.
    """
    found = shutil.which(str(folder / name) if "/" in name else name)
    if found is None:
        raise ConfigError(f"The program '{name}' does not exist or is not executable. Check the path.")
    return Path(found)
