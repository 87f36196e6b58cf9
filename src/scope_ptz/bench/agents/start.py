"""Start external agents: turn the user's options into a planner for each run."""

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
from scope_ptz.bench.agents.sandbox import RUNNER, SCRATCH, SandboxContents, own_files, require_sandbox, sandboxed
from scope_ptz.bench.agents.source import AgentSource, Interpreter, find_command, find_module, interpreter_at, own_interpreter
from scope_ptz.errors import ConfigError
from scope_ptz.settings import agent_environment

OpenChannel = Callable[[], Awaitable[AgentChannel]]


@dataclass(frozen=True, slots=True)
class LocalAgent:
    """An external agent on this machine, ready to be started for any number of runs.

    Attributes:
        name: Its name in traces and on run cards.
        isolation: How it is separated from the tasks and the ground truth; its results carry this label.
        source: Digest of its source; empty if the source is unknown.
        settings: Other settings that affect its results, as JSON data. They are part of an evaluation's identity.
        options: The options.
        open_channel: Starts it for one run.
    """

    name: str
    isolation: Isolation
    source: str
    settings: dict[str, Any]
    options: AgentOptions
    open_channel: OpenChannel

    async def open(self) -> ChannelPlanner:
        """Start the agent for one run. If it fails to start, the first step of the run reports that."""
        planner = ChannelPlanner(await self.open_channel(), self.name, self.options.times)
        try:
            await planner.connect()
        except BaseException:  # including cancellation, which must leave no process behind
            await planner.close()
            raise
        return planner

    async def check(self) -> None:
        """Start the agent once, without a task.

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
    """Return an agent that can be started. Its code is not run yet.

    Args:
        agent: ``module:Class``; not used if the options name a command.
        options: The options.
        hidden: Folders and files that a sandbox hides besides SCOPE itself.

    Raises:
        ConfigError: The options contradict each other, or name something that does not exist.
    """
    name, folder = agent_name(agent, options), Path.cwd()
    if sys.platform == "win32" and not options.in_process:
        raise ConfigError(
            "External agents need Linux or macOS. On Windows, use --agent-in-process or the Windows Subsystem for Linux."
        )
    if options.command:
        return _program(name, options, folder, hidden)
    if options.in_process:
        source = find_module(agent, folder, own_interpreter().search_path)
        return LocalAgent(name, "in-process", source.digest() if source else "", {}, options, lambda: _in_process(agent))
    return _class(name, options, folder, hidden)


def _class(name: str, options: AgentOptions, folder: Path, hidden: tuple[Path, ...]) -> LocalAgent:
    environment = agent_environment(options.variables, python_path=options.python is None)
    interpreter = own_interpreter() if options.python is None else interpreter_at(_absolute(options.python))
    source = find_module(name, folder, interpreter.search_path)
    installed = source is not None and any(source.folder.is_relative_to(prefix) for prefix in interpreter.prefixes)
    if options.python is None and source is not None and source.folder != folder and not installed:
        # This program may have added the folder to its own search path, which a new process does not inherit.
        environment["PYTHONPATH"] = os.pathsep.join(
            [str(source.folder), *environment.get("PYTHONPATH", "").split(os.pathsep)]
        ).rstrip(":")
    program = RUNNER if options.sandbox else Path(runner.__file__)
    launch = AgentLaunch(
        name, (str(interpreter.program), str(program), name), folder, environment, options.isolation, options.memory_mb
    )
    settings = _settings(options) | ({"python": str(options.python)} if options.python is not None else {})
    if options.sandbox:
        return _in_sandbox(launch, source, settings, options, interpreter, hidden)
    return _local(launch, source, settings, options)


def _program(name: str, options: AgentOptions, folder: Path, hidden: tuple[Path, ...]) -> LocalAgent:
    words = split_command(options.command)
    program = find_program(words[0], folder)
    source = find_command(words, program, folder)
    command = (str(program), *words[1:])
    launch = AgentLaunch(
        name, command, folder, agent_environment(options.variables, python_path=False), options.isolation, options.memory_mb
    )
    settings = _settings(options) | {"command": words}
    if options.sandbox:
        return _in_sandbox(launch, source, settings, options, None, hidden)
    return _local(launch, source, settings, options)


def _in_sandbox(
    launch: AgentLaunch,
    source: AgentSource | None,
    settings: dict[str, Any],
    options: AgentOptions,
    interpreter: Interpreter | None,
    hidden: tuple[Path, ...],
) -> LocalAgent:
    """Return an agent in the sandbox. Its working folder is the folder that contains its module."""
    require_sandbox()
    visible: tuple[Path, ...] = () if interpreter is None else (*_folders_of(interpreter), *_links_to(interpreter.program))
    installed = source is None or any(source.folder.is_relative_to(path) for path in visible)
    contents = SandboxContents(
        folder=None if source is None or installed else source.folder,
        shown=visible,
        runner=Path(runner.__file__) if interpreter is not None else None,
        hidden=(*own_files(), *hidden, *(path / "scope_ptz" for path in (interpreter.search_path if interpreter else ()))),
    )
    kept = {name: value for name, value in launch.environment.items() if name not in ("PYTHONPATH", "TMPDIR")}
    sandbox_launch = replace(launch, folder=Path("/"), environment=kept | {"HOME": SCRATCH})
    return _local(sandbox_launch, source, settings, options, contents)


def _folders_of(interpreter: Interpreter) -> tuple[Path, ...]:
    return tuple(dict.fromkeys(path for path in interpreter.prefixes if path != Path("/")))


def _links_to(program: Path) -> tuple[Path, ...]:
    """Return the program and each target of its chain of symbolic links, down to the real file."""
    links = [program]
    while links[-1].is_symlink():
        links.append(Path(os.path.normpath(links[-1].parent / links[-1].readlink())))
    return tuple(links)


def _local(
    launch: AgentLaunch,
    source: AgentSource | None,
    settings: dict[str, Any],
    options: AgentOptions,
    contents: SandboxContents | None = None,
) -> LocalAgent:
    if contents is not None:
        sandboxed(launch.command, contents)  # raises ConfigError now, and not at the first run

    async def open_channel() -> AgentChannel:
        # Files that must be hidden may appear later, such as the folder of the logs.
        current = launch if contents is None else replace(launch, command=sandboxed(launch.command, contents))
        return await PipeChannel.start(current)

    return LocalAgent(launch.name, launch.isolation, source.digest() if source else "", settings, options, open_channel)


async def _in_process(agent: str) -> AgentChannel:
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


def _absolute(program: Path) -> Path:
    """Return the absolute path of an interpreter. Links are kept, because Python finds a virtual environment by its link."""
    return find_program(str(program), Path.cwd()).absolute()
