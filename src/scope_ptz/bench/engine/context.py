"""The context that the caller of an evaluation provides to the engine: scenes, planners, perception, true counts, a watcher.

Inspect creates solvers and scorers from names. The context gives them the objects that a name cannot describe.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from scope_ptz.bench.engine.entries import Entry, OpenScene
from scope_ptz.bench.judging.judge import Complete
from scope_ptz.bench.scoring.episode import Observation
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.planner.base import Planner

if TYPE_CHECKING:
    from scope_ptz.perception.base import Perception


@dataclass(frozen=True, slots=True)
class ModelRequest:
    """A model requested by name. ``url`` is the address of its server; ``options`` are those of the engine's command line."""

    name: str
    url: str | None = None
    options: Mapping[str, Any] = field(default_factory=dict)


TrueCount = Callable[[str, Observation], Awaitable[int | None]]
"""Returns how many of the things that a perception call asked for are visible; None if the ground truth cannot tell."""
LoadTasks = Callable[[str], tuple[Entry, ...]]
"""Returns the tasks of a split, given by its name, or of a file, given by its path."""


class Watcher:
    """Observer of an evaluation, notified when a run begins or ends. The default does nothing."""

    def began(self, sample: str, entry: Entry) -> None:
        """Called when a run begins."""

    def ended(self, sample: str, trial: Trial) -> None:
        """Called when a run has ended and its checks were applied."""


@dataclass(frozen=True, slots=True)
class EvalContext:
    """The resources that solvers and scorers of an evaluation use.

    Attributes:
        open_scene: Opens a scene, or a variation of one, by name.
        make_planner: Makes a planner by name.
        make_perception: Makes perception by name.
        make_judge: Connects to a judge for its judgement with the given index, from 0.
        load_tasks: Loads tasks by split or file.
        true_count: Ground truth for perception calls; None if there is none.
        watcher: Notified when a run begins or ends.
        perception_note: Note for the trace about the origin of the perception.
        perception: The perception, if it was made in advance; its creator closes it.
    """

    open_scene: OpenScene
    make_planner: Callable[[ModelRequest], Awaitable[Planner]]
    make_perception: Callable[[ModelRequest], Awaitable[Perception]]
    make_judge: Callable[[ModelRequest, int], Awaitable[Complete]]
    load_tasks: LoadTasks
    true_count: TrueCount | None = None
    watcher: Watcher = field(default_factory=Watcher)
    perception_note: str = ""
    perception: Perception | None = None
