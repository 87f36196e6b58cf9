"""Choose the target of a search: a visible object that the ground truth can name and that is not in view at the start."""

from __future__ import annotations

import numpy as np

from scope_ptz.errors import InputError, PerceptionError
from scope_ptz.geometry import Limits, Pose, direction, pan_tilt_deg
from scope_ptz.gym.world import World
from scope_ptz.perception.base import Box
from scope_ptz.perception.ground_truth import GroundTruthPerception

CENTRAL_OFFSET = 1 / 6
"""Maximum horizontal and vertical distance between the centre of a central box and the centre of the frame, as a fraction of the
frame's width and height. The box is then centred in the middle third of the frame."""

MAX_START_TILT_OFFSET_DEG = 10.0  # a search starts at most this far above or below START_TILT_DEG
START_TILT_DEG = -10.0
MAX_ATTEMPTS = 200  # random starts and targets to try before reporting that a scene has no suitable target


def is_central(box: Box) -> bool:
    """Return whether the centre of a box is in the middle third of the frame."""
    x, y = box.centre
    return abs(x - 0.5) <= CENTRAL_OFFSET and abs(y - 0.5) <= CENTRAL_OFFSET


def true_boxes(world: World, pose: Pose, description: str) -> tuple[Box, ...]:
    """Return the ground-truth boxes of the visible objects that match a description in the agent's frame at a pose."""
    truth = GroundTruthPerception(world.scene_by_name)
    frame = world.blank_frame(pose)
    return world.run(lambda: truth.detect(frame, description)).boxes


class Targets:
    """The suitable targets in each scene. They are cached for later episodes.

    Args:
        world: The world. Its camera determines the scene, the viewpoint and the time.
        names: Names from which to choose; empty for the names of all objects.
        zoom: Magnification at which a target is visible when the camera points at it.
    """

    def __init__(self, world: World, names: tuple[str, ...], zoom: float) -> None:
        self._world, self._names, self._zoom = world, names, zoom
        self._poses: dict[tuple[str, str], dict[str, list[Pose]]] = {}
        self._suitable: dict[tuple[str, str, str, Pose], bool] = {}

    def choose(self, rng: np.random.Generator, name: str | None = None) -> tuple[Pose, str]:
        """Return the pose at which a search starts, and the name of its target.

        Args:
            rng: Source of the random choices.
            name: The name to search for; None to choose one.

        Raises:
            InputError: No suitable target was found.
        """
        poses = self._poses_by_name()
        names = sorted(poses) if name is None else [known for known in poses if known == name]
        limits = self._world.camera.info.limits
        for _ in range(MAX_ATTEMPTS if names else 0):
            start = _random_start(rng, limits)
            chosen = names[int(rng.integers(len(names)))]
            aim = poses[chosen][int(rng.integers(len(poses[chosen])))]
            if self._is_suitable(chosen, aim) and not true_boxes(self._world, start, chosen):
                return start, chosen
        requested = [name] if name is not None else self._names
        raise InputError(
            f"The scene '{self._world.scene.name}' has no suitable target{' named ' + ' or '.join(requested) if requested else ''} "
            f"at the viewpoint {self._world.camera.viewpoint}, at zoom {self._zoom:g} and in frames of this size. Name other "
            "targets, increase target_zoom or choose larger frames."
        )

    def _is_suitable(self, name: str, aim: Pose) -> bool:
        """Return whether the ground truth contains an object of this name near the centre when the camera points at it."""
        key = (self._world.scene.name, self._world.camera.viewpoint, name, aim)
        if key not in self._suitable:
            try:
                self._suitable[key] = any(map(is_central, true_boxes(self._world, aim, name)))
            except PerceptionError:  # ground-truth perception cannot parse the name
                self._suitable[key] = False
        return self._suitable[key]

    def _poses_by_name(self) -> dict[str, list[Pose]]:
        """Return the poses that point at the objects of each name. Parts of objects, and objects out of reach, are omitted."""
        scene, camera = self._world.scene, self._world.camera
        key = (scene.name, camera.viewpoint)
        if key in self._poses:
            return self._poses[key]
        extents, limits = scene.viewpoint(camera.viewpoint).extents, camera.info.limits
        found: dict[str, list[Pose]] = {}
        for instance in scene.file.instances:
            extent = extents.get(instance.number)
            if (
                extent is None
                or not extent.hull
                or instance.parent is not None
                or (self._names and instance.name not in self._names)
            ):
                continue
            corners = np.array(extent.hull, dtype=np.float64).reshape(-1, 2)
            pan, tilt = (float(v) for v in pan_tilt_deg(direction(corners[:, 0], corners[:, 1]).mean(axis=0)))
            pose, clamped = limits.clamp(Pose(limits.aim_pan_deg(pan), tilt, self._zoom))
            if not clamped:
                found.setdefault(instance.name, []).append(pose)
        self._poses[key] = found
        return found


def _random_start(rng: np.random.Generator, limits: Limits) -> Pose:
    pan = rng.uniform(limits.min_pan_deg, limits.max_pan_deg)
    tilt = START_TILT_DEG + rng.uniform(-MAX_START_TILT_OFFSET_DEG, MAX_START_TILT_OFFSET_DEG)
    return limits.clamp(Pose(float(pan), float(tilt), limits.min_zoom))[0]
