"""What the command line lends to the evaluation engine: concrete planners, eyes, scenes and tasks."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from anyio import to_thread

from scope_ptz.bench.engine.context import EvalContext, ModelRequest
from scope_ptz.bench.engine.entries import Entry, entries_of, imported_entries
from scope_ptz.bench.scoring.episode import Look
from scope_ptz.camera.base import Frame, FrameOrigin
from scope_ptz.errors import PerceptionError
from scope_ptz.factory.models import ModelOptions, ResolvedPerception, ResolvedPlanner, resolve_models
from scope_ptz.factory.session import GROUND_TRUTH_NOTE, NOISY_NOTE, make_planner, scene_search
from scope_ptz.geometry import Equirectangular, Pose
from scope_ptz.planner.base import Decision, Planner, State
from scope_ptz.settings import load_settings
from scope_ptz.simulator.library import Library
from scope_ptz.simulator.pack import Scene

if TYPE_CHECKING:
    from scope_ptz.bench.judging.judge import Complete
    from scope_ptz.bench.judging.server import ServerPort
    from scope_ptz.perception.base import Perception
    from scope_ptz.perception.ground_truth import GroundTruthPerception


class Aside(Planner):
    """A planner that thinks without pause, put into a worker thread: other runs go on meanwhile."""

    def __init__(self, think: Callable[[State], Decision], name: str) -> None:
        self._think, self.name = think, name

    async def step(self, state: State) -> Decision:
        return await to_thread.run_sync(self._think, state)


def planner_for(choice: ResolvedPlanner) -> Planner:
    """The planner that was chosen, as the engine wants it: not blocking, its requests in the log."""
    if choice.endpoint is None:
        from scope_ptz.planner.grammar import decide

        return Aside(decide, make_planner(choice).name)
    from scope_ptz.bench.engine.wire import LoggedChat
    from scope_ptz.planner.chat import ChatPlanner

    return ChatPlanner(choice.endpoint, choice.options, client=LoggedChat(choice.endpoint))


def perception_for(choice: ResolvedPerception, scenes: Callable[[str], Scene], seed: int) -> Perception:
    """The eyes that were chosen, for frames of any scene."""
    if choice.spec is not None:
        from scope_ptz.perception.backends import make_backend

        return make_backend(choice.spec)
    if choice.name == "ground-truth":
        return _truth(scenes)
    from scope_ptz.perception.noisy import NoisyPerception

    return NoisyPerception(_truth(scenes), seed=seed)


def _truth(scenes: Callable[[str], Scene]) -> GroundTruthPerception:
    from scope_ptz.factory.validation_perception import KnownViews
    from scope_ptz.perception.ground_truth import GroundTruthPerception

    return GroundTruthPerception(scenes, KnownViews().look)


def eval_context(
    *,
    seed: int,
    planner: Planner | None = None,
    eyes: ResolvedPerception | None = None,
    judge: ServerPort | None = None,
) -> EvalContext:
    """EvalContext for an evaluation. Models that were not chosen yet are made from their names when they are wanted.

    ``planner``, ``eyes`` and ``judge``: those that are chosen already; eyes that cannot be made are told of now.
    """
    scenes = Library(scene_search(load_settings()))
    seeing = perception_for(eyes, scenes, seed) if eyes is not None else None

    async def a_planner(wish: ModelRequest) -> Planner:
        return planner or planner_for((await resolve_models(_wishes(wish, "planner"))).planner)

    async def some_eyes(wish: ModelRequest) -> Perception:
        return seeing or perception_for((await resolve_models(_wishes(wish, "eyes"))).eyes, scenes, seed)

    async def a_judge(wish: ModelRequest, repeat: int) -> Complete:
        return (await _judge(wish)).repeated(repeat)

    truth = _truth(scenes)

    async def really(scene: str, look: Look) -> int | None:
        return await _count(truth, scene, look)

    notes = {"ground-truth": GROUND_TRUTH_NOTE, "noisy": NOISY_NOTE}
    return EvalContext(
        open_scene=scenes,
        make_planner=a_planner,
        make_perception=some_eyes,
        make_judge=judge_maker(judge) if judge is not None else a_judge,
        load_tasks=lambda split: tasks_of(split, scenes),
        truth=really,
        eyes=seeing,
        perception_note=notes.get(eyes.name, "") if eyes else "",
    )


def _wishes(wish: ModelRequest, role: str) -> ModelOptions:
    """A model of the engine's own command line as options of ours: ``served``, ``key_file`` and what the backend knows."""
    given: Mapping[str, Any] = {name: value for name, value in wish.options.items() if value is not None}
    further = tuple(f"{name}={value}" for name, value in given.items() if name not in ("served", "key_file"))
    key = Path(str(given["key_file"])) if "key_file" in given else None
    served = given.get("served")
    if role == "planner":
        return ModelOptions(
            planner=wish.name, planner_url=wish.url, planner_model=served, planner_key_file=key, planner_options=further
        )
    return ModelOptions(
        perception=wish.name, perception_url=wish.url, perception_model=served, perception_key_file=key, perception_options=further
    )


def judge_maker(port: ServerPort) -> Callable[[ModelRequest, int], Awaitable[Complete]]:
    """Lends one judge, whatever name it is asked for by."""

    async def make(wish: ModelRequest, repeat: int) -> Complete:  # noqa: ARG001 - the engine asks by name
        return port.repeated(repeat)

    return make


async def _judge(wish: ModelRequest) -> ServerPort:
    from scope_ptz.cli.bench_judge import TIMEOUT_S, open_judge

    options = {name: value for name, value in wish.options.items() if value is not None}
    served, key = options.pop("served", wish.name), options.pop("key_file", None)
    further = [f"{name}={value}" for name, value in options.items()]
    return await open_judge(wish.url, str(served), Path(str(key)) if key else None, TIMEOUT_S, further)


async def _count(truth: GroundTruthPerception, scene: str, look: Look) -> int | None:
    """How many of what a look was asked for show in its very picture; None where that cannot be told of such a description."""
    from scope_ptz.factory.validation_perception import surely_named

    if look.viewpoint is None:
        return None
    view = look.projection
    pose = Pose() if isinstance(view, Equirectangular) else Pose(view.pan_deg, view.tilt_deg)
    frame = Frame(
        image=np.zeros((1, 1, 3), np.uint8), pose=pose, hfov_deg=0.0, time_s=look.time_s, projection=view,
        origin=FrameOrigin(scene, look.viewpoint, pose, look.time_s),
    )  # fmt: skip
    try:
        found = len((await truth.detect(frame, look.asked)).boxes)
        return found if found or surely_named(truth.view(frame, look.asked), look.asked) else None
    except PerceptionError:
        return None


def tasks_of(split: str, scenes: Callable[[str], Scene]) -> tuple[Entry, ...]:
    """The tasks of a split by name, or of a file."""
    from scope_ptz.bench.tasks.imported import holds_imported, load_imported
    from scope_ptz.bench.tasks.splits import load_split

    if holds_imported(Path(split)):
        return imported_entries(load_imported(Path(split)))
    return entries_of(load_split(split), scenes)
