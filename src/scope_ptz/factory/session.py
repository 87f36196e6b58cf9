"""The one place where the command line builds concrete cameras, perception and planners."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.errors import ConfigError, InputError
from scope_ptz.settings import ScopeSettings, load_settings

if TYPE_CHECKING:
    from scope_ptz.camera.simulated import SimulatedCamera
    from scope_ptz.factory.models import ResolvedPerception, ResolvedPlanner
    from scope_ptz.perception.base import Perception
    from scope_ptz.planner.base import Planner
    from scope_ptz.simulator.pack import Scene

DEFAULT_SCENE = "highway-works"
GROUND_TRUTH_NOTE = "Perception is the simulator's own ground truth, not a model."
NOISY_NOTE = "Perception is the simulator's ground truth with seeded mistakes, not a model."


@dataclass(frozen=True, slots=True)
class Start:
    """Where and when a session begins: a scene, in it a viewpoint or a preset (the scene's home when neither is given), and the
    scene time in seconds (the scene's own start when None)."""

    scene: str = DEFAULT_SCENE
    viewpoint: str | None = None
    preset: str | None = None
    time_s: float | None = None


def scene_search(settings: ScopeSettings) -> tuple[Path, ...]:
    """Return the folders that are searched for scenes before the built-in ones.

    Raises:
        ConfigError: SCOPE_SCENES_DIR names a folder that does not exist.
    """
    if settings.scenes_dir is None:
        return ()
    if not settings.scenes_dir.is_dir():
        raise ConfigError(f"SCOPE_SCENES_DIR is {settings.scenes_dir}, which is not a folder. Correct the variable, or unset it.")
    return (settings.scenes_dir,)


def open_scene(name: str) -> Scene:
    """A scene by name, from the configured folder or the package."""
    from scope_ptz.simulator.pack import load_scene

    return load_scene(name, scene_search(load_settings()))


async def open_camera(start: Start, scene: Scene, *, realtime: bool) -> SimulatedCamera:
    """A simulated camera at its start."""
    from scope_ptz.camera.simulated import SimulatedCamera
    from scope_ptz.simulator.clock import SceneClock

    if start.viewpoint and start.preset:
        raise InputError("Give --viewpoint or --preset, not both: a preset names its viewpoint.")
    began_s = scene.file.start_s if start.time_s is None else start.time_s
    camera = SimulatedCamera(scene, viewpoint=start.viewpoint, clock=SceneClock(began_s, realtime=realtime))
    if start.preset:
        await camera.go_to_preset(start.preset)
    return camera


def make_planner(choice: ResolvedPlanner) -> Planner:
    """The planner that was chosen."""
    if choice.endpoint is None:
        from scope_ptz.planner.grammar import GrammarPlanner

        return GrammarPlanner()
    from scope_ptz.planner.chat import ChatPlanner

    return ChatPlanner(choice.endpoint, choice.options)


def make_perception(choice: ResolvedPerception, scene: Scene, seed: int) -> tuple[Perception, str]:
    """The eyes that were chosen, and the note that says what they are. ``scene`` is shared with the camera, not read twice."""
    if choice.spec is not None:
        from scope_ptz.perception.backends import make_backend

        return make_backend(choice.spec), ""
    from scope_ptz.perception.ground_truth import GroundTruthPerception

    truth = GroundTruthPerception({scene.name: scene}.__getitem__)
    if choice.name == "ground-truth":
        return truth, GROUND_TRUTH_NOTE
    from scope_ptz.perception.noisy import NoisyPerception

    return NoisyPerception(truth, seed=seed), NOISY_NOTE
