"""The one place that reads the environment: variables named ``SCOPE_...``."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Literal

from platformdirs import user_cache_path, user_config_path
from pydantic import Field, SecretStr, ValidationError
from pydantic_settings import BaseSettings, SettingsConfigDict

from scope_ptz.errors import ConfigError


class ScopeSettings(BaseSettings):
    """Defaults for every command. Options on the command line win over these."""

    model_config = SettingsConfigDict(env_prefix="SCOPE_", extra="ignore")

    runs_dir: Path = Field(default=Path("runs"), description="Where run folders are made.")
    scenes_dir: Path | None = Field(default=None, description="A folder of scene packs beside the built-in ones.")
    cache_dir: Path = Field(
        default_factory=lambda: user_cache_path("scope-ptz"), description="Where the Blender environment and unfinished bakes live."
    )
    blender_python: Path | None = Field(default=None, description="A Python interpreter that can import bpy.")
    blender: Path | None = Field(default=None, description="A blender program to use instead of the bpy wheel.")
    planner_key: SecretStr | None = Field(default=None, description="The key of the planner's server.")
    perception_key: SecretStr | None = Field(default=None, description="The key of the perception server.")
    models: Path | None = Field(default=None, description="A YAML file of models beside the built-in ones.")
    planner_url: str = Field(default="", description="Where the planner's model server listens.")
    perception_url: str = Field(default="", description="Where the model server of the eyes listens.")
    judge_url: str = Field(default="", description="Where the model server of the benchmark's judge listens.")
    judge_model: str = Field(default="", description="What that server calls the judge.")
    judge_key: SecretStr | None = Field(default=None, description="The key of the judge's server.")

    def models_file(self) -> Path | None:
        """The user's own models: the file that is named, or the one in the configuration folder when it is there."""
        if self.models is not None:
            return self.models
        usual = user_config_path("scope-ptz") / "models.yaml"
        return usual if usual.is_file() else None


def load_settings() -> ScopeSettings:
    """Read the environment; a wrong value raises ``ConfigError`` that names the variable."""
    try:
        return ScopeSettings()
    except ValidationError as error:
        first = error.errors()[0]
        name = "SCOPE_" + "_".join(str(part) for part in first["loc"]).upper()
        raise ConfigError(f"The environment variable {name} is wrong: {first['msg']}.") from error


def has_desktop() -> bool:
    """Whether this machine has a desktop on which a picture that is opened would be seen."""
    return sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


Inline = Literal["iterm", "kitty"]
"""Ways in which terminals show pictures among the text."""


def inline_pictures() -> Inline | None:
    """How the terminal that the program runs in shows pictures, None when it does not say that it can."""
    if os.environ.get("TERM_PROGRAM") in ("iTerm.app", "WezTerm"):
        return "iterm"
    return "kitty" if os.environ.get("KITTY_WINDOW_ID") or os.environ.get("TERM") == "xterm-kitty" else None
