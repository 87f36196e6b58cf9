"""The session options that ``scope_ptz.open`` and ``scope_ptz.open_async`` accept."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

from scope_ptz.agent.records import Budgets
from scope_ptz.camera.base import Camera
from scope_ptz.errors import InputError
from scope_ptz.factory.models import ModelOptions
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import Planner

StrPath = str | PathLike[str]


@dataclass(frozen=True, slots=True)
class ModelServerOptions:
    """Options for served models: addresses, served names, keys and request options, as described in ``scope_ptz.open``."""

    pair: str | None = None
    planner_url: str | None = None
    perception_url: str | None = None
    planner_model: str | None = None
    perception_model: str | None = None
    planner_key_file: StrPath | None = None
    perception_key_file: StrPath | None = None
    planner_options: Mapping[str, Any] | None = None
    perception_options: Mapping[str, Any] | None = None
    reader: str | None = None
    detector: str | None = None
    timeout_s: float | None = None

    def model_options(self, planner: Planner | str | None, perception: Perception | str | None) -> ModelOptions:
        """Convert the options to the form that the factory accepts.

        Args:
            planner: A name, an object, or None for the default.
            perception: A name, an object, or None for the default.

        Raises:
            InputError: An object is combined with options that apply only to names.
        """
        check_type("planner", planner, Planner)
        check_type("perception", perception, Perception)
        objects = [role for role, value in (("planner", planner), ("perception", perception)) if not isinstance(value, str | None)]
        for role in objects:
            options = (f"{role}_url", f"{role}_model", f"{role}_key_file", f"{role}_options")
            extra = [name for name in (*options, "pair") if getattr(self, name)]
            extra += [name for name in ("reader", "detector") if role == "perception" and getattr(self, name)]
            if extra:
                raise InputError(f"{role}= is an object, which cannot be combined with {', '.join(extra)}. Remove the argument.")
        return ModelOptions(
            planner=planner if isinstance(planner, str) else None,
            perception=perception if isinstance(perception, str) else None,
            pair=self.pair,
            planner_url=self.planner_url,
            perception_url=self.perception_url,
            planner_model=self.planner_model,
            perception_model=self.perception_model,
            planner_key_file=_path(self.planner_key_file),
            perception_key_file=_path(self.perception_key_file),
            planner_options=_to_option_strings(self.planner_options),
            perception_options=_to_option_strings(self.perception_options),
            reader=self.reader,
            detector=self.detector,
            timeout_s=self.timeout_s,
            planner_instance=planner if isinstance(planner, Planner) else None,
            perception_instance=perception if isinstance(perception, Perception) else None,
        )


@dataclass(frozen=True, slots=True)
class SessionOptions:
    """All options of a session, with the defaults of ``scope_ptz.open``."""

    camera: Camera | str
    planner: Planner | str | None = None
    perception: Perception | str | None = None
    served: ModelServerOptions = field(default_factory=ModelServerOptions)
    viewpoint: str | None = None
    preset: str | None = None
    time_s: float | None = None
    seed: int = 0
    realtime: bool = False
    dry_run: bool = False
    runs_dir: Path | None = None
    budgets: Budgets = field(default_factory=Budgets)


def check_type(option: str, given: object, contract: type) -> None:
    """Raise ``InputError`` unless the value of an option is a name, None, or an instance of ``contract``."""
    if not isinstance(given, str | contract | None):
        expected = (
            "an instance of the class, not the class itself" if isinstance(given, type) else f"a scope_ptz.{contract.__name__}"
        )
        raise InputError(f"{option}= must be a name or {expected}; got {given!r}.")


def _path(given: StrPath | None) -> Path | None:
    return None if given is None else Path(given)


def _to_option_strings(options: Mapping[str, Any] | None) -> tuple[str, ...]:
    """Convert options to ``NAME=JSON`` strings, which the factory parses back to the same values."""
    return tuple(f"{name}={json.dumps(value)}" for name, value in (options or {}).items())
