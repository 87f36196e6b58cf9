"""What whoever starts an evaluation lends to it: scenes, planners, eyes, the truth of a look, and someone who watches.

The engine's own objects are made by the engine, from names; what they need that a name cannot carry they find here.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from scope_ptz.bench.engine.entries import Entry, OpenScene
from scope_ptz.bench.judging.judge import Complete
from scope_ptz.bench.scoring.episode import Observation
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.errors import ConfigError
from scope_ptz.planner.base import Planner

if TYPE_CHECKING:
    from scope_ptz.bench.engine.perception import Eyes


@dataclass(frozen=True, slots=True)
class ModelRequest:
    """A model by name, as it was asked for: ``url`` of its server, ``options`` as the command line gives them."""

    name: str
    url: str | None = None
    options: Mapping[str, Any] = field(default_factory=dict)


TruthOf = Callable[[str, Observation], Awaitable[int | None]]
"""How many of what was asked really show in the picture of a look into a scene."""
LoadTasks = Callable[[str], tuple[Entry, ...]]
"""The tasks of a split by its name, or of a file."""


class Watcher:
    """Told of every run that begins and ends. The default watches nothing."""

    def began(self, sample: str, entry: Entry) -> None:
        """A run began."""

    def ended(self, sample: str, trial: Trial) -> None:
        """A run was judged by its checks."""


@dataclass(frozen=True, slots=True)
class EvalContext:
    """``make_judge``: a judge's port for its n-th judgement of a run; ``truth``: None where no ground truth can be had;
    ``eyes``: those that are made already."""

    open_scene: OpenScene
    make_planner: Callable[[ModelRequest], Awaitable[Planner]]
    make_perception: Callable[[ModelRequest], Awaitable[Eyes]]
    make_judge: Callable[[ModelRequest, int], Awaitable[Complete]]
    load_tasks: LoadTasks
    truth: TruthOf | None = None
    watcher: Watcher = field(default_factory=Watcher)
    perception_note: str = ""
    eyes: Eyes | None = None


EQUIPMENT: ContextVar[EvalContext | None] = ContextVar("scope_equipment", default=None)


def equipment() -> EvalContext:
    """What was lent to the evaluation that is going on."""
    lent = EQUIPMENT.get()
    if lent is None:
        raise ConfigError("Run this by `scope bench run` or by `inspect eval scope_ptz/bench`.")
    return lent
