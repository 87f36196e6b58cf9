"""The evaluation context: planners, perception, scenes, tasks and judges for the evaluation engine."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from anyio import to_thread

from scope_ptz.bench.engine.context import EvalContext, ModelRequest
from scope_ptz.bench.engine.entries import Entry, entries_of, imported_entries
from scope_ptz.bench.scoring.episode import Observation
from scope_ptz.camera.base import Frame, FrameOrigin
from scope_ptz.errors import PerceptionError
from scope_ptz.factory.models import (
    ModelOptions,
    ResolvedPerception,
    ResolvedPlanner,
    make_perception,
    make_planner,
    perception_note,
    resolve_models,
)
from scope_ptz.factory.scenes import scene_search
from scope_ptz.geometry import Equirectangular, Pose
from scope_ptz.planner.base import Decision, Planner, State
from scope_ptz.settings import load_settings
from scope_ptz.simulator.library import OPEN_VIEWPOINTS, Library
from scope_ptz.simulator.pack import Scene

if TYPE_CHECKING:
    from scope_ptz.bench.judging.judge import Complete
    from scope_ptz.bench.judging.server import JudgeServer
    from scope_ptz.factory.validation_perception import TruthCache
    from scope_ptz.perception.base import Perception
    from scope_ptz.perception.ground_truth import GroundTruthPerception


OPEN_VIEWPOINTS_WITHOUT_PICTURES = 3
"""Number of open viewpoints when no frames are rendered. A viewpoint then takes less memory, and tasks often use several."""
MAX_CACHED_VIEWS = 150
"""Maximum number of views with cached ground truth. Runs are ordered by viewpoint, so consecutive runs share views."""


class ThreadedPlanner(Planner):
    """A planner whose steps run in a worker thread, so that they do not block other runs.

    Args:
        decide: A function that returns the next decision for a state.
        name: The planner's name.
    """

    def __init__(self, decide: Callable[[State], Decision], name: str) -> None:
        self._decide, self.name = decide, name

    async def step(self, state: State) -> Decision:
        return await to_thread.run_sync(self._decide, state)


def evaluation_planner(resolved: ResolvedPlanner) -> Planner:
    """Create a planner for an evaluation. The grammar planner runs in a worker thread, so that it does not block other runs."""
    if resolved.plugin is not None or resolved.instance is not None:
        return make_planner(resolved)
    if resolved.endpoint is None:
        from scope_ptz.planner.grammar import decide

        return ThreadedPlanner(decide, make_planner(resolved).name)
    return make_planner(resolved)


def evaluation_perception(resolved: ResolvedPerception, scenes: Callable[[str], Scene], seed: int, truth: TruthCache) -> Perception:
    """Create the perception backend for an evaluation. ``truth`` caches the ground truth of each view."""
    return make_perception(resolved, scenes, seed, truth.read)


def eval_context(
    *,
    seed: int,
    planner: Planner | None = None,
    perception: ResolvedPerception | None = None,
    pictures: bool = True,
) -> EvalContext:
    """Create the context for an evaluation.

    Args:
        seed: Seed for every random choice.
        planner: The planner; None to create the one that the engine requests by name.
        perception: The resolved perception backend, which is created immediately so that errors are reported before the first run;
            None to create the one that the engine requests by name.
        pictures: Whether frames are rendered.
    """
    from scope_ptz.factory.validation_perception import TruthCache

    open_viewpoints = OPEN_VIEWPOINTS if pictures else OPEN_VIEWPOINTS_WITHOUT_PICTURES
    scenes, cache = Library(scene_search(load_settings()), open_viewpoints), TruthCache(MAX_CACHED_VIEWS)
    backend = evaluation_perception(perception, scenes, seed, cache) if perception is not None else None

    async def requested_planner(request: ModelRequest) -> Planner:
        return planner or evaluation_planner((await resolve_models(_model_options(request, "planner"))).planner)

    async def requested_perception(request: ModelRequest) -> Perception:
        return backend or evaluation_perception(
            (await resolve_models(_model_options(request, "perception"))).perception, scenes, seed, cache
        )

    async def requested_judge(request: ModelRequest, repeat: int) -> Complete:
        return (await _open_judge(request)).for_repeat(repeat)

    truth = _ground_truth(scenes, cache)

    async def true_count(scene: str, observation: Observation) -> int | None:
        return await _count(truth, scene, observation)

    return EvalContext(
        open_scene=scenes,
        make_planner=requested_planner,
        make_perception=requested_perception,
        make_judge=requested_judge,
        load_tasks=lambda split: load_entries(split, scenes),
        true_count=true_count,
        perception=backend,
        perception_note=perception_note(perception) if perception else "",
    )


def load_entries(split: str, scenes: Callable[[str], Scene]) -> tuple[Entry, ...]:
    """Load the tasks from a split or a task file.

    Args:
        split: The name of a split, or the path to a task file.
        scenes: A function that opens the tasks' scenes by name.
    """
    from scope_ptz.bench.tasks.imported import is_imported_file, load_imported
    from scope_ptz.bench.tasks.splits import load_split

    if is_imported_file(Path(split)):
        return imported_entries(load_imported(Path(split)))
    return entries_of(load_split(split), scenes)


def _ground_truth(scenes: Callable[[str], Scene], cache: TruthCache) -> GroundTruthPerception:
    from scope_ptz.perception.ground_truth import GroundTruthPerception

    return GroundTruthPerception(scenes, cache.read)


def _model_options(request: ModelRequest, role: str) -> ModelOptions:
    """Convert a model request from the engine's command line to options for ``resolve_models``.

    The options ``served`` and ``key_file`` are interpreted here; the others are passed on to the model.
    """
    options: Mapping[str, Any] = {name: value for name, value in request.options.items() if value is not None}
    other_options = tuple(f"{name}={value}" for name, value in options.items() if name not in ("served", "key_file"))
    key = Path(str(options["key_file"])) if "key_file" in options else None
    served = options.get("served")
    if role == "planner":
        return ModelOptions(
            planner=request.name, planner_url=request.url, planner_model=served, planner_key_file=key, planner_options=other_options
        )
    return ModelOptions(
        perception=request.name, perception_url=request.url, perception_model=served, perception_key_file=key,
        perception_options=other_options,
    )  # fmt: skip


async def _open_judge(request: ModelRequest) -> JudgeServer:
    from scope_ptz.factory.judges import TIMEOUT_S, open_judge

    options = {name: value for name, value in request.options.items() if value is not None}
    served, key = options.pop("served", request.name), options.pop("key_file", None)
    other_options = [f"{name}={value}" for name, value in options.items()]
    return await open_judge(request.url, str(served), Path(str(key)) if key else None, TIMEOUT_S, other_options)


async def _count(truth: GroundTruthPerception, scene: str, observation: Observation) -> int | None:
    """Return the true count for a perception call; None if ground truth cannot count the described objects."""
    from scope_ptz.factory.validation_perception import is_plain_noun

    if observation.viewpoint is None:
        return None
    view = observation.projection
    pose = Pose() if isinstance(view, Equirectangular) else Pose(view.pan_deg, view.tilt_deg)
    frame = Frame(
        image=np.zeros((1, 1, 3), np.uint8), pose=pose, hfov_deg=0.0, time_s=observation.time_s, projection=view,
        origin=FrameOrigin(scene, observation.viewpoint, pose, observation.time_s),
    )  # fmt: skip
    try:
        count = len((await truth.detect(frame, observation.request)).boxes)
        return count if count or is_plain_noun(truth.view(frame, observation.request), observation.request) else None
    except PerceptionError:
        return None
