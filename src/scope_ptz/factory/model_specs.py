"""Options for choosing a planner and a perception backend, and the results of resolving them."""

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
    """Options for the planner, the perception backend and their servers, as specified by the user.

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
    """A resolved planner: the grammar, a chat model or a plug-in. ``make_planner`` creates the planner from it.

    Attributes:
        name: The name in traces and reports.
        endpoint: The chat model's server; None for other planners.
        options: The chat model's options; None for other planners.
        model: The registry entry; None for a model that is not registered.
        plugin: The spec for a plug-in's factory; None for other planners.
        instance: An existing planner that the caller passed; all other fields except the name are then None.
        is_hybrid: Whether the grammar plans the instructions that it understands, and the chat model or plug-in only the others.
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
    """A resolved perception backend. ``make_perception`` creates the backend from it.

    Attributes:
        name: The name in traces and reports.
        spec: The backend's spec; None for a built-in backend.
        model: The registry entry; None for a model that is not registered.
        instance: An existing perception backend that the caller passed; all other fields except the name are then None.
    """

    name: str
    spec: BackendSpec | None = None
    model: Model | None = None
    instance: Perception | None = None


@dataclass(frozen=True, slots=True)
class ResolvedPair:
    """A resolved planner and perception backend."""

    planner: ResolvedPlanner
    perception: ResolvedPerception
