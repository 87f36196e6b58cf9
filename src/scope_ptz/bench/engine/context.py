"""The context that the caller of an evaluation provides: scenes, models, true counts and a watcher.

Inspect creates solvers and scorers from their names. The context provides the objects that cannot be created in this way.
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
    """A request for a model by name.

    Attributes:
        name: Name of the model.
        url: Base URL of its server; None for the default.
        options: Model options from Inspect's command line.
    """

    name: str
    url: str | None = None
    options: Mapping[str, Any] = field(default_factory=dict)


TrueCount = Callable[[str, Observation], Awaitable[int | None]]
"""Function that returns the true count for a perception call in the named scene, or None if the ground truth does not define it."""
Order = Callable[[Sequence[Entry]], list[Entry]]
"""Function that returns entries in the order in which to run them."""
OpenAgent = Callable[[], Awaitable[ChannelPlanner]]
"""Function that starts or connects an external agent for one run."""
LoadTasks = Callable[[str], tuple[Entry, ...]]
"""Function that returns the entries of a split, given by name, or of a task file, given by path."""


class Watcher:
    """An observer that is notified when a run begins or ends. This base class does nothing."""

    def run_began(self, sample: str, entry: Entry) -> None:
        """Handle the beginning of a run."""

    def run_ended(self, sample: str, trial: Trial) -> None:
        """Handle the end of a run, after the checks have scored it."""


@dataclass(frozen=True, slots=True)
class EvalContext:
    """The resources that the solvers and scorers of an evaluation use.

    Attributes:
        open_scene: Opens a scene, or a variation of one, by name.
        make_planner: Creates a planner by name.
        make_perception: Creates a perception backend by name.
        make_judge: Connects to a judge by name. The second argument is the index of the judgement, from 0.
        load_tasks: Loads the entries of a split or a task file.
        true_count: Returns the true counts for perception calls; None if there is no ground truth.
        watcher: Observer that is notified when a run begins or ends.
        order: Puts entries in the order in which to run them; None for the order that needs the least memory.
        open_agent: Starts or connects the external agent for a run; None to use the agent named in the task options.
        perception_note: Note about the origin of the perception backend, for the trace.
        perception: A perception backend created by the caller, who also closes it; None to create one with ``make_perception``.
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
