"""Settings from environment variables named ``SCOPE_...``. No other module reads these variables."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Literal

from platformdirs import user_cache_path, user_config_path, user_data_path
from pydantic import BaseModel, Field, SecretStr, ValidationError

from scope_ptz.errors import ConfigError

_PREFIX = "scope_"


class ScopeSettings(BaseModel):
    """Defaults for every command. Command-line options take precedence."""

    runs_dir: Path = Field(default=Path("runs"), description="Folder in which run folders are created.")
    scenes_dir: Path | None = Field(default=None, description="Folder with additional scene packs.")
    tile_cache_mb: int | None = Field(
        default=None, ge=1, description="Memory limit in MB for a viewpoint's tiles. By default, all loaded tiles stay in memory."
    )
    cache_dir: Path = Field(
        default_factory=lambda: user_cache_path("scope-ptz"), description="Folder for the Blender environment and unfinished bakes."
    )
    pictures_dir: Path | None = Field(
        default=None, description="Folder for decoded pictures of scenes (default: in the cache folder)."
    )
    blender_python: Path | None = Field(default=None, description="A Python interpreter that can import bpy.")
    blender: Path | None = Field(default=None, description="A blender program to use instead of the bpy wheel.")
    planner_key: SecretStr | None = Field(default=None, description="API key for the planner's server.")
    perception_key: SecretStr | None = Field(default=None, description="API key for the perception server.")
    models: Path | None = Field(default=None, description="YAML file with additional models.")
    camera_password: SecretStr | None = Field(default=None, description="Password for the account of a network camera.")
    planner_url: str = Field(default="", description="Address of the planner's server.")
    perception_url: str = Field(default="", description="Address of the perception server.")
    judge_url: str = Field(default="", description="Address of the judge's server.")
    judge_model: str = Field(default="", description="Name of the judge model on its server.")
    judge_key: SecretStr | None = Field(default=None, description="API key for the judge's server.")
    virtual_camera_password: SecretStr | None = Field(default=None, description="Password of the accounts of virtual cameras.")
    camera_profiles_dir: Path = Field(
        default_factory=lambda: user_config_path("scope-ptz") / "cameras",
        description="Folder for the measured properties of cameras.",
    )
    tokens: Path = Field(
        default_factory=lambda: user_config_path("scope-ptz") / "tokens.json", description="File with the tokens of `scope serve`."
    )
    token: SecretStr | None = Field(default=None, description="Token for cameras on another `scope serve` server.")
    config: Path | None = Field(default=None, description="File with the cameras of a site (default: scope.yaml).")

    def tile_bytes(self) -> int | None:
        """Return the memory limit for a viewpoint's tiles in bytes; None if there is no limit."""
        return None if self.tile_cache_mb is None else self.tile_cache_mb * 1_000_000

    def user_runs_folder(self) -> Path:
        """Return the runs folder for a program that does not start in a folder of the user's choice.

        It is the setting or, without one, a folder in the user's data folder.
        """
        return self.runs_dir if "runs_dir" in self.model_fields_set else user_data_path("scope-ptz") / "runs"

    def pictures_folder(self) -> Path:
        """Return the folder for decoded pictures of scenes."""
        return self.pictures_dir or self.cache_dir / "pictures"

    def models_file(self) -> Path | None:
        """Return the user's models file: the configured one, or ``models.yaml`` in the configuration folder if it exists."""
        if self.models is not None:
            return self.models
        default = user_config_path("scope-ptz") / "models.yaml"
        return default if default.is_file() else None


def load_settings() -> ScopeSettings:
    """Read the settings.

    Raises:
        ConfigError: A variable has an invalid value. The message names the variable.
    """
    values = {name.lower().removeprefix(_PREFIX): text for name, text in os.environ.items() if name.lower().startswith(_PREFIX)}
    try:
        return ScopeSettings.model_validate({name: values[name] for name in ScopeSettings.model_fields if name in values})
    except ValidationError as error:
        first = error.errors()[0]
        name = "SCOPE_" + "_".join(str(part) for part in first["loc"]).upper()
        raise ConfigError(f"The environment variable {name} has an invalid value: {first['msg']}.") from error


def find_camera_file(settings: ScopeSettings) -> Path | None:
    """Return the camera file: the configured one, else ``scope.yaml`` in the working folder, else in the configuration folder."""
    if settings.config is not None:
        return settings.config
    return next((path for path in (Path("scope.yaml"), user_config_path("scope-ptz") / "scope.yaml") if path.is_file()), None)


def read_secret(name: str) -> str | None:
    """Return the value of an environment variable that a camera file names; None if it is unset or empty."""
    return os.environ.get(name) or None


def has_desktop() -> bool:
    """Return whether this machine has a desktop that can show a picture."""
    return sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


InlineProtocol = Literal["iterm", "kitty"]
"""Protocols for showing pictures in a terminal."""


def inline_pictures() -> InlineProtocol | None:
    """Return the protocol with which the current terminal can show pictures; None if no support is detected."""
    if os.environ.get("TERM_PROGRAM") in ("iTerm.app", "WezTerm"):
        return "iterm"
    return "kitty" if os.environ.get("KITTY_WINDOW_ID") or os.environ.get("TERM") == "xterm-kitty" else None


_AGENT_VARIABLES = frozenset(
    {
        "PATH", "HOME", "USER", "LOGNAME", "SHELL", "LANG", "LANGUAGE", "TZ", "TMPDIR", "TERM", "VIRTUAL_ENV", "CONDA_PREFIX",
        "LD_LIBRARY_PATH", "CUDA_VISIBLE_DEVICES", "SSL_CERT_FILE", "SSL_CERT_DIR",
    }
)  # fmt: skip
"""Environment variables that external agents receive, besides those whose names begin with ``LC_``."""


def agent_environment(names: tuple[str, ...], *, python_path: bool) -> dict[str, str]:
    """Return the environment of an external agent, without SCOPE's settings and keys.

    Args:
        names: Names of further variables that the user passes on.
        python_path: Whether to pass on PYTHONPATH.

    Raises:
        ConfigError: A variable that the user passes on is not set.
    """
    missing = [name for name in names if name not in os.environ]
    if missing:
        raise ConfigError(f"--agent-env names {missing[0]}, which is not set. Set the variable, or remove the option.")
    passed_names = {*names, *_AGENT_VARIABLES, *(["PYTHONPATH"] if python_path else [])}
    return {name: value for name, value in os.environ.items() if name in passed_names or name.startswith("LC_")}
