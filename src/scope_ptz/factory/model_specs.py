"""Options that name a planner and perception, and the resolved planner and perception."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scope_ptz.endpoints.endpoint import Endpoint
    from scope_ptz.perception.backends.spec import BackendSpec
    from scope_ptz.perception.base import Perception
    from scope_ptz.planner.base import Planner
    from scope_ptz.planner.chat import ChatOptions
    from scope_ptz.planner.spec import PlannerSpec
    from scope_ptz.registry import Model


@dataclass(frozen=True, slots=True)
class ModelOptions:
    """Options for planner, perception and their servers, as the user gave them.

    ``own_planner`` and ``own_perception`` are objects that a caller from Python passes instead of names.
    """

    planner: str | None = None
    perception: str | None = None
    pair: str | None = None
    planner_url: str | None = None
    perception_url: str | None = None
    planner_model: str | None = None
    perception_model: str | None = None
    planner_key_file: Path | None = None
    perception_key_file: Path | None = None
    planner_options: tuple[str, ...] = ()
    perception_options: tuple[str, ...] = ()
    reader: str | None = None
    detector: str | None = None
    timeout_s: float | None = None
    own_planner: Planner | None = None
    own_perception: Perception | None = None


@dataclass(frozen=True, slots=True)
class ResolvedPlanner:
    """A resolved planner, from which ``make_planner`` creates one: the grammar, a chat model or a plug-in.

    Attributes:
        name: The name in traces and reports.
        endpoint: The chat model's server; None for other planners.
        options: The chat model's options; None for other planners.
        model: The registry's entry; None for a model that is not registered.
        plugin: The spec that the factory of a plug-in receives; None for other planners.
        instance: An existing planner that the caller passed. All other fields except the name are then None.
    """

    name: str
    endpoint: Endpoint | None = None
    options: ChatOptions | None = None
    model: Model | None = None
    plugin: PlannerSpec | None = None
    instance: Planner | None = None


@dataclass(frozen=True, slots=True)
class ResolvedPerception:
    """Resolved perception, from which ``make_perception`` creates one: built in, or a backend with its model.

    Attributes:
        name: The name in traces and reports.
        spec: The backend's spec; None for built-in perception.
        model: The registry's entry; None for a model that is not registered.
        instance: An existing perception that the caller passed. All other fields except the name are then None.
    """

    name: str
    spec: BackendSpec | None = None
    model: Model | None = None
    instance: Perception | None = None


@dataclass(frozen=True, slots=True)
class ResolvedPair:
    """A resolved planner and perception."""

    planner: ResolvedPlanner
    perception: ResolvedPerception
