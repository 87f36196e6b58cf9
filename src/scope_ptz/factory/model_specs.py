"""Options that name a planner and a perception backend, and the results of resolving them."""

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

    ``planner_instance`` and ``perception_instance`` are objects that Python code passes instead of names.
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
    planner_instance: Planner | None = None
    perception_instance: Perception | None = None


@dataclass(frozen=True, slots=True)
class ResolvedPlanner:
    """The result of resolving the options for a planner: the grammar, a chat model or a plug-in.

    ``make_planner`` creates the planner from this result.

    Attributes:
        name: The name in traces and reports.
        endpoint: The chat model's server; None for other planners.
        options: The chat model's options; None for other planners.
        model: The registry's entry; None for a model that is not registered.
        plugin: The spec that the factory of a plug-in receives; None for other planners.
        instance: An existing planner that the caller passed. All other fields except the name are then None.
        is_hybrid: Whether the grammar plans what it understands, and the chat model or plug-in plans only the rest.
    """

    name: str
    endpoint: Endpoint | None = None
    options: ChatOptions | None = None
    model: Model | None = None
    plugin: PlannerSpec | None = None
    instance: Planner | None = None
    is_hybrid: bool = False


@dataclass(frozen=True, slots=True)
class ResolvedPerception:
    """The result of resolving the options for a perception backend, which ``make_perception`` creates.

    Attributes:
        name: The name in traces and reports.
        spec: The backend's spec; None for a built-in backend.
        model: The registry's entry; None for a model that is not registered.
        instance: An existing perception backend that the caller passed. All other fields except the name are then None.
    """

    name: str
    spec: BackendSpec | None = None
    model: Model | None = None
    instance: Perception | None = None


@dataclass(frozen=True, slots=True)
class ResolvedPair:
    """The result of resolving the options for a pair."""

    planner: ResolvedPlanner
    perception: ResolvedPerception
