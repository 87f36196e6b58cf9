"""Create external agents from evaluation options."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from platformdirs import user_config_path, user_data_path

from scope_ptz.errors import ConfigError
from scope_ptz.factory.evaluation_options import BUILT_IN_AGENT, EvaluationOptions
from scope_ptz.settings import ScopeSettings, load_settings

if TYPE_CHECKING:
    from scope_ptz.bench.agents.start import LocalAgent


def external_agent(options: EvaluationOptions) -> LocalAgent | None:
    """Create the external agent that the options specify; None for the built-in agent loop.

    Raises:
        ConfigError: The options contradict each other, or the agent does not exist.
    """
    from scope_ptz.bench.agents.launch import AgentOptions
    from scope_ptz.bench.agents.start import local_agent

    settings = options.agent_options or AgentOptions()
    if options.agent == BUILT_IN_AGENT and not settings.command:
        if settings != AgentOptions():
            raise ConfigError("Options for external agents require an agent. Add --agent MODULE:CLASS or --agent-command.")
        return None
    if options.agent != BUILT_IN_AGENT and settings.command:
        raise ConfigError("--agent and --agent-command cannot be combined. Remove one of them.")
    return local_agent(options.agent, settings, hidden_files(options, load_settings()))


def hidden_files(options: EvaluationOptions, settings: ScopeSettings) -> tuple[Path, ...]:
    """Return the files and folders to hide from a sandboxed agent: tasks, logs, runs, scenes and settings."""
    paths = (
        options.out, Path(options.tasks), options.resume, settings.scenes_dir, settings.runs_dir, settings.user_runs_folder(),
        settings.cache_dir, settings.pictures_folder(), settings.camera_profiles_dir, settings.tokens, settings.models_file(),
        settings.config, user_config_path("scope-ptz"), user_data_path("scope-ptz"),
    )  # fmt: skip
    return tuple(path.absolute() for path in paths if path is not None)
