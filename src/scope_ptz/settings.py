"""Settings from environment variables named ``SCOPE_...``. No other module reads the environment."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Literal

from platformdirs import user_cache_path, user_config_path
from pydantic import BaseModel, Field, SecretStr, ValidationError

from scope_ptz.errors import ConfigError

_PREFIX = "scope_"


class ScopeSettings(BaseModel):
    """Defaults for every command. Command-line options take precedence."""

    runs_dir: Path = Field(default=Path("runs"), description="Folder for run folders.")
    scenes_dir: Path | None = Field(default=None, description="Folder with more scene packs.")
    cache_dir: Path = Field(
        default_factory=lambda: user_cache_path("scope-ptz"), description="Folder for the Blender environment and unfinished bakes."
    )
    blender_python: Path | None = Field(default=None, description="A Python interpreter that can import bpy.")
    blender: Path | None = Field(default=None, description="A blender program to use in place of the bpy wheel.")
    planner_key: SecretStr | None = Field(default=None, description="Key for the planner's server.")
    perception_key: SecretStr | None = Field(default=None, description="Key for the perception server.")
    models: Path | None = Field(default=None, description="YAML file with more models.")
    planner_url: str = Field(default="", description="Address of the planner's server.")
    perception_url: str = Field(default="", description="Address of the perception server.")
    judge_url: str = Field(default="", description="Address of the judge's server.")
    judge_model: str = Field(default="", description="Name of the judge on its server.")
    judge_key: SecretStr | None = Field(default=None, description="Key for the judge's server.")

    def models_file(self) -> Path | None:
        """Return the user's models file: the configured one, or ``models.yaml`` in the configuration folder if it exists."""
        if self.models is not None:
            return self.models
        usual = user_config_path("scope-ptz") / "models.yaml"
        return usual if usual.is_file() else None


def load_settings() -> ScopeSettings:
    """Read the settings. The case of the variables' names does not matter.

    Raises:
        ConfigError: A variable has a wrong value. The message names it.
    """
    given = {name.lower().removeprefix(_PREFIX): text for name, text in os.environ.items() if name.lower().startswith(_PREFIX)}
    try:
        return ScopeSettings.model_validate({name: given[name] for name in ScopeSettings.model_fields if name in given})
    except ValidationError as error:
        first = error.errors()[0]
        name = "SCOPE_" + "_".join(str(part) for part in first["loc"]).upper()
        raise ConfigError(f"The environment variable {name} is wrong: {first['msg']}.") from error


def has_desktop() -> bool:
    """Return whether this machine has a desktop that can show a picture."""
    return sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


Inline = Literal["iterm", "kitty"]
"""Protocols for pictures in a terminal."""


def inline_pictures() -> Inline | None:
    """Return the protocol by which the current terminal shows pictures, None if it announces none."""
    if os.environ.get("TERM_PROGRAM") in ("iTerm.app", "WezTerm"):
        return "iterm"
    return "kitty" if os.environ.get("KITTY_WINDOW_ID") or os.environ.get("TERM") == "xterm-kitty" else None
