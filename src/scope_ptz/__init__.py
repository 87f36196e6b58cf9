"""SCOPE: control a pan-tilt-zoom camera in plain language, and benchmark the models that interpret it.

    import scope_ptz

    with scope_ptz.open("highway-works") as scope:
        run = scope.ask("how many cones are there?")
        print(run.answer)

The public interface consists of the names in ``__all__``, the module ``scope_ptz.contracts``, which contains the types needed to
implement a camera, a planner or a perception backend, and ``scope_ptz.gym``, which needs the ``gym`` extra. Every other module is
internal and may change in any release.

Sessions: ``open``, ``open_async``, ``Scope``, ``AsyncScope``, ``Run``, ``CallResult``, ``Event``.
Scenes, models and tools: ``scenes``, ``SceneInfo``, ``models``, ``tool_schemas``.
Evaluations: ``load_tasks``, ``Task``, ``evaluate``, ``load_results``, ``EvaluationResults``, ``Trial``.
Contracts and conformance suites: ``Camera``, ``Frame``, ``Pose``, ``Planner``, ``Perception``, ``CameraConformance``,
``PerceptionConformance``.
Errors: ``ScopeError`` and its subclasses ``InputError``, ``CameraError``, ``PlannerError`` and ``PerceptionError``.

Importing the package is cheap, because each name is imported on first use.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from scope_ptz.version import __version__

if TYPE_CHECKING:
    from scope_ptz.api.async_scope import AsyncScope
    from scope_ptz.api.evaluations import EvaluationResults, evaluate, load_results, load_tasks
    from scope_ptz.api.opening import open, open_async  # noqa: A004 - used as scope_ptz.open
    from scope_ptz.api.run import CallResult, Event, Run
    from scope_ptz.api.scenes import SceneInfo, models, scenes, tool_schemas
    from scope_ptz.api.scope import Scope
    from scope_ptz.bench.scoring.trials import Trial
    from scope_ptz.bench.tasks.task import Task
    from scope_ptz.camera.base import Camera, Frame
    from scope_ptz.camera.conformance import CameraConformance
    from scope_ptz.errors import CameraError, InputError, PerceptionError, PlannerError, ScopeError
    from scope_ptz.geometry import Pose
    from scope_ptz.perception.base import Perception
    from scope_ptz.perception.conformance import PerceptionConformance
    from scope_ptz.planner.base import Planner

__all__ = [
    "AsyncScope",
    "CallResult",
    "Camera",
    "CameraConformance",
    "CameraError",
    "EvaluationResults",
    "Event",
    "Frame",
    "InputError",
    "Perception",
    "PerceptionConformance",
    "PerceptionError",
    "Planner",
    "PlannerError",
    "Pose",
    "Run",
    "SceneInfo",
    "Scope",
    "ScopeError",
    "Task",
    "Trial",
    "__version__",
    "evaluate",
    "load_results",
    "load_tasks",
    "models",
    "open",
    "open_async",
    "scenes",
    "tool_schemas",
]

_MODULES = {
    "scope_ptz.api.async_scope": ("AsyncScope",),
    "scope_ptz.api.evaluations": ("EvaluationResults", "evaluate", "load_results", "load_tasks"),
    "scope_ptz.api.opening": ("open", "open_async"),
    "scope_ptz.api.run": ("CallResult", "Event", "Run"),
    "scope_ptz.api.scenes": ("SceneInfo", "models", "scenes", "tool_schemas"),
    "scope_ptz.api.scope": ("Scope",),
    "scope_ptz.bench.scoring.trials": ("Trial",),
    "scope_ptz.bench.tasks.task": ("Task",),
    "scope_ptz.camera.base": ("Camera", "Frame"),
    "scope_ptz.camera.conformance": ("CameraConformance",),
    "scope_ptz.errors": ("CameraError", "InputError", "PerceptionError", "PlannerError", "ScopeError"),
    "scope_ptz.geometry": ("Pose",),
    "scope_ptz.perception.base": ("Perception",),
    "scope_ptz.perception.conformance": ("PerceptionConformance",),
    "scope_ptz.planner.base": ("Planner",),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'scope_ptz' has no attribute '{name}'")
    value = getattr(import_module(_MODULE_OF[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
