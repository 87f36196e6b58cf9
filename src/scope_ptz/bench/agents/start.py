"""Start external agents: create a planner for each run from the user's options."""

from __future__ import annotations

import os
import sys
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from scope_ptz.bench.agents import runner
from scope_ptz.bench.agents.channel import AgentChannel, Isolation
from scope_ptz.bench.agents.in_process import InProcessChannel
from scope_ptz.bench.agents.launch import AgentLaunch, AgentOptions, agent_name, find_program, split_command
from scope_ptz.bench.agents.pipe import PipeChannel
from scope_ptz.bench.agents.planner import ChannelPlanner
from scope_ptz.bench.agents.sandbox import RUNNER, SCRATCH, SandboxContents, own_folders, require_sandbox, sandbox_command
from scope_ptz.bench.agents.source import (
    AgentSource,
    Interpreter,
    find_command_source,
    find_module_source,
    interpreter_at,
    own_interpreter,
)
from scope_ptz.errors import ConfigError
from scope_ptz.settings import agent_environment

OpenChannel = Callable[[], Awaitable[AgentChannel]]


@dataclass(frozen=True, slots=True)
class LocalAgent:
    """An external agent on this machine, which can be started for any number of runs.

    Attributes:
        name: Its name in traces and on run cards.
        isolation: How it is separated from the tasks and the ground truth. Its results are labelled with this.
        source: Digest of its source files; empty if they are unknown.
        settings: Other settings that affect its results, as JSON data. They are part of an evaluation's identity.
        options: The user's options.
        open_channel: Starts the agent for one run.
    """

    name: str
    isolation: Isolation
    source: str
    settings: dict[str, Any]
    options: AgentOptions
    open_channel: OpenChannel

    async def open(self) -> ChannelPlanner:
        """Start the agent for one run. If the agent fails to start, the error is raised at the first step of the run."""
        planner = ChannelPlanner(await self.open_channel(), self.name, self.options.times)
        try:
            await planner.connect()
        except BaseException:  # including cancellation, so that no process is left behind
            await planner.close()
            raise
        return planner

    async def check(self) -> None:
        """Check that the agent starts and speaks the protocol, without giving it a task.

        Raises:
            ConfigError: The agent does not start, or does not speak the protocol.
        """
        planner = await self.open()
        await planner.close()
        if planner.failure is not None:
            hint = " In a sandbox, import AgentReply from scope_agent instead of scope_ptz." if self.options.sandbox else ""
            problem = str(planner.failure)
            raise ConfigError(problem + (hint if "scope_ptz" in problem else "")) from planner.failure


def local_agent(agent: str, options: AgentOptions, hidden: tuple[Path, ...] = ()) -> LocalAgent:
    """Return an agent that is ready to start, without running any of its code.

    Args:
        agent: ``module:Class``; ignored if the options contain a command.
        options: The user's options.
        hidden: Folders and files that a sandbox hides in addition to SCOPE itself.

    Raises:
        ConfigError: The options contradict each other or name a program that does not exist.
    """
    name, folder = agent_name(agent, options), Path.cwd()
    if sys.platform == "win32" and not options.in_process:
        raise ConfigError(
            "External agents need Linux or macOS. On Windows, use --agent-in-process or the Windows Subsystem for Linux."
        )
    if options.command:
        return _command_agent(name, options, folder, hidden)
    if options.in_process:
        source = find_module_source(agent, folder, own_interpreter().search_path)
        return LocalAgent(name, "in-process", source.digest() if source else "", {}, options, lambda: _in_process_channel(agent))
    return _class_agent(name, options, folder, hidden)


def _class_agent(name: str, options: AgentOptions, folder: Path, hidden: tuple[Path, ...]) -> LocalAgent:
    environment = agent_environment(options.variables, python_path=options.python is None)
    interpreter = own_interpreter() if options.python is None else interpreter_at(_absolute_path(options.python))
    source = find_module_source(name, folder, interpreter.search_path)
    installed = source is not None and any(source.folder.is_relative_to(prefix) for prefix in interpreter.prefixes)
    if options.python is None and source is not None and source.folder != folder and not installed:
        # The folder may have been added to this process's search path, which a new process does not inherit.
        environment["PYTHONPATH"] = os.pathsep.join(
            [str(source.folder), *environment.get("PYTHONPATH", "").split(os.pathsep)]
        ).rstrip(":")
    program = RUNNER if options.sandbox else Path(runner.__file__)
    launch = AgentLaunch(
        name, (str(interpreter.program), str(program), name), folder, environment, options.isolation, options.memory_mb
    )
    settings = _settings(options) | ({"python": str(options.python)} if options.python is not None else {})
    if options.sandbox:
        return _sandboxed_agent(launch, source, settings, options, interpreter, hidden)
    return _process_agent(launch, source, settings, options)


def _command_agent(name: str, options: AgentOptions, folder: Path, hidden: tuple[Path, ...]) -> LocalAgent:
    words = split_command(options.command)
    program = find_program(words[0], folder)
    source = find_command_source(words, program, folder)
    command = (str(program), *words[1:])
    launch = AgentLaunch(
        name, command, folder, agent_environment(options.variables, python_path=False), options.isolation, options.memory_mb
    )
    settings = _settings(options) | {"command": words}
    if options.sandbox:
        return _sandboxed_agent(launch, source, settings, options, None, hidden)
    return _process_agent(launch, source, settings, options)


def _sandboxed_agent(
    launch: AgentLaunch,
    source: AgentSource | None,
    settings: dict[str, Any],
    options: AgentOptions,
    interpreter: Interpreter | None,
    hidden: tuple[Path, ...],
) -> LocalAgent:
    """Return an agent that runs in the sandbox. Its working folder is the folder that contains its module."""
    require_sandbox()
    visible: tuple[Path, ...] = () if interpreter is None else (*_folders_of(interpreter), *_link_chain(interpreter.program))
    installed = source is None or any(source.folder.is_relative_to(path) for path in visible)
    contents = SandboxContents(
        folder=None if source is None or installed else source.folder,
        shown=visible,
        runner=Path(runner.__file__) if interpreter is not None else None,
        hidden=(*own_folders(), *hidden, *(path / "scope_ptz" for path in (interpreter.search_path if interpreter else ()))),
    )
    environment = {name: value for name, value in launch.environment.items() if name not in ("PYTHONPATH", "TMPDIR")}
    sandbox_launch = replace(launch, folder=Path("/"), environment=environment | {"HOME": SCRATCH})
    return _process_agent(sandbox_launch, source, settings, options, contents)


def _folders_of(interpreter: Interpreter) -> tuple[Path, ...]:
    return tuple(dict.fromkeys(path for path in interpreter.prefixes if path != Path("/")))


def _link_chain(program: Path) -> tuple[Path, ...]:
    """Return a program and every target of its chain of symbolic links, down to the real file."""
    links = [program]
    while links[-1].is_symlink():
        links.append(Path(os.path.normpath(links[-1].parent / links[-1].readlink())))
    return tuple(links)


def _process_agent(
    launch: AgentLaunch,
    source: AgentSource | None,
    settings: dict[str, Any],
    options: AgentOptions,
    contents: SandboxContents | None = None,
) -> LocalAgent:
    if contents is not None:
        sandbox_command(launch.command, contents)  # raises ConfigError here rather than in the first run

    async def open_channel() -> AgentChannel:
        # Paths that must be hidden, such as the log folder, may not have existed when the agent was created.
        current = launch if contents is None else replace(launch, command=sandbox_command(launch.command, contents))
        return await PipeChannel.start(current)

    return LocalAgent(launch.name, launch.isolation, source.digest() if source else "", settings, options, open_channel)


async def _in_process_channel(agent: str) -> AgentChannel:
    current_folder = str(Path.cwd())
    if current_folder not in sys.path:
        sys.path.insert(0, current_folder)
    runner.provide_module()
    try:
        return InProcessChannel(runner.load(agent), agent)
    except runner.AgentLoadError as error:
        raise ConfigError(str(error)) from error


def _settings(options: AgentOptions) -> dict[str, Any]:
    """Return the settings that affect the agent's results."""
    return {
        "isolation": options.isolation,
        "memory_mb": options.memory_mb,
        "step_s": options.times.step_s,
        "run_s": options.times.run_s,
        "variables": sorted(options.variables),
    }


def _absolute_path(program: Path) -> Path:
    """Return the absolute path of an interpreter. Links are not resolved, because they identify the virtual environment."""
    return find_program(str(program), Path.cwd()).absolute()
