"""How a local agent is started: as a class or a program, in which environment, and with which limits."""

from __future__ import annotations

import os
import shlex
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from scope_ptz.bench.agents.channel import Isolation
from scope_ptz.bench.agents.planner import AgentTimes
from scope_ptz.errors import ConfigError

DEFAULT_MEMORY_MB = 4_096
"""Default limit on the memory of an agent's processes together."""


@dataclass(frozen=True, slots=True)
class AgentOptions:
    """What the user states about a local agent, besides the name of its class.

    Attributes:
        command: Program with arguments that speaks the protocol on stdin and stdout; empty for a class.
        python: Interpreter of the agent's own environment; None for the interpreter that runs SCOPE.
        in_process: Run the agent in the scorer's process.
        sandbox: Run the agent in a sandbox.
        variables: Names of further environment variables that the agent receives.
        memory_mb: Maximum memory of the agent's processes together in MB; None for no limit.
        times: Limits on the agent's time.
    """

    command: str = ""
    python: Path | None = None
    in_process: bool = False
    sandbox: bool = False
    variables: tuple[str, ...] = ()
    memory_mb: int | None = DEFAULT_MEMORY_MB
    times: AgentTimes = field(default_factory=AgentTimes)

    @property
    def isolation(self) -> Isolation:
        """The label of the agent's results."""
        return "in-process" if self.in_process else "sandboxed" if self.sandbox else "isolated"


@dataclass(frozen=True, slots=True)
class AgentLaunch:
    """How an agent's process is started.

    Attributes:
        name: The agent's name in traces and on run cards.
        command: The program and its arguments, with everything that the sandbox needs.
        folder: The working folder.
        environment: All environment variables of the process.
        isolation: The label of the agent's results.
        memory_mb: Maximum memory of the agent's processes together in MB; None for no limit.
    """

    name: str
    command: tuple[str, ...]
    folder: Path
    environment: Mapping[str, str] = field(repr=False)
    isolation: Isolation = "isolated"
    memory_mb: int | None = DEFAULT_MEMORY_MB


def agent_name(agent: str, options: AgentOptions) -> str:
    """Return the name of an agent: ``module:Class``, or ``command:FILE``.

    The file is the first that the command's arguments name, or else its program. Other arguments may be private.

    Raises:
        ConfigError: The name or the options contradict each other.
    """
    if options.command:
        if options.python is not None or options.in_process:
            raise ConfigError("--agent-python and --agent-in-process need --agent MODULE:CLASS; they do not fit --agent-command.")
        program, *arguments = split_command(options.command)
        return f"command:{Path(next(filter(os.path.isfile, arguments), program)).name}"
    module, colon, attribute = agent.partition(":")
    if not colon or not module or not attribute:
        raise ConfigError(f"--agent must have the form module:Class; got '{agent}'.")
    if options.in_process and (options.sandbox or options.python is not None):
        raise ConfigError("--agent-in-process runs the agent inside SCOPE; remove it to use --sandbox or --agent-python.")
    return agent


def split_command(command: str) -> list[str]:
    """Split a command into the program and its arguments. No shell is involved.

    Raises:
        ConfigError: The command is empty, or its quotes do not match.
    """
    try:
        parts = shlex.split(command)
    except ValueError as error:
        raise ConfigError(f"--agent-command cannot be split into words: {error}.") from error
    if not parts:
        raise ConfigError("--agent-command is empty. Name a program that speaks the agent protocol.")
    return parts


def find_program(name: str, folder: Path) -> Path:
    """Return the path of a program.

    Args:
        name: A name on the search path, or a path. Relative paths are below ``folder``.
        folder: The working folder.

    Raises:
        ConfigError: There is no such program.
    """
    found = shutil.which(str(folder / name) if "/" in name else name)
    if found is None:
        raise ConfigError(f"The program '{name}' does not exist or cannot be executed. Correct the path.")
    return Path(found)
