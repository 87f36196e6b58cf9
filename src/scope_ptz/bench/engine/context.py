"""The context that the caller of an evaluation passes to the engine: scenes, models, true counts and a watcher.

Inspect creates solvers and scorers from names. The context provides the objects that cannot be created from a name.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from scope_ptz.bench.agents.planner import ChannelPlanner
from scope_ptz.bench.engine.entries import Entry, OpenScene
from scope_ptz.bench.judging.judge import Complete
from scope_ptz.bench.scoring.episode import Observation
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.planner.base import Planner

if TYPE_CHECKING:
    from scope_ptz.perception.base import Perception


@dataclass(frozen=True, slots=True)
class ModelRequest:
    """A model requested by name.

    Attributes:
        name: Name of the model.
        url: Base URL of its server; None for the default.
        options: Options of the model from Inspect's command line.
    """

    name: str
    url: str | None = None
    options: Mapping[str, Any] = field(default_factory=dict)


TrueCount = Callable[[str, Observation], Awaitable[int | None]]
"""Returns the true count for a perception call in the scene with the given name; None if the ground truth does not define it."""
Order = Callable[[Sequence[Entry]], list[Entry]]
"""Returns entries in the order in which they are run."""
OpenAgent = Callable[[], Awaitable[ChannelPlanner]]
"""Starts or connects an external agent for one run."""
LoadTasks = Callable[[str], tuple[Entry, ...]]
"""Returns the entries of a split, given by its name, or of a task file, given by its path."""


class Watcher:
    """Observer of an evaluation, notified when a run begins or ends. The default does nothing."""

    def run_began(self, sample: str, entry: Entry) -> None:
        """Called when a run begins."""

    def run_ended(self, sample: str, trial: Trial) -> None:
        """Called when a run has ended and been scored by the checks."""


@dataclass(frozen=True, slots=True)
class EvalContext:
    """The resources that solvers and scorers of an evaluation use.

    Attributes:
        open_scene: Opens a scene, or a variation of one, by name.
        make_planner: Creates a planner by name.
        make_perception: Creates a perception backend by name.
        make_judge: Connects to a judge. Its second argument is the index of the judgement, from 0.
        load_tasks: Loads the entries of a split or a task file.
        true_count: Returns the true counts for perception calls; None if there is no ground truth.
        watcher: Notified when a run begins or ends.
        order: Orders the entries; None for the order that needs the least memory.
        open_agent: Starts or connects the external agent for a run; None to start the agent that the task names.
        perception_note: Note for the trace about the origin of the perception backend.
        perception: A perception backend that was created in advance, if any. Its creator closes it.
    """

    open_scene: OpenScene
    make_planner: Callable[[ModelRequest], Awaitable[Planner]]
    make_perception: Callable[[ModelRequest], Awaitable[Perception]]
    make_judge: Callable[[ModelRequest, int], Awaitable[Complete]]
    load_tasks: LoadTasks
    true_count: TrueCount | None = None
    watcher: Watcher = field(default_factory=Watcher)
    order: Order | None = None
    open_agent: OpenAgent | None = None
    perception_note: str = ""
    perception: Perception | None = None
