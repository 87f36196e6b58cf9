"""Choose what to search for: a thing that the ground truth can name, that can be seen, and that is not in view at the start."""

from __future__ import annotations

import numpy as np

from scope_ptz.errors import InputError, PerceptionError
from scope_ptz.geometry import Limits, Pose, direction, pan_tilt_deg
from scope_ptz.gym.world import World
from scope_ptz.perception.base import Box
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.simulator.viewpoint import Viewpoint

CENTRAL_OFFSET = 1 / 6
"""A target is near the centre if its middle is at most this fraction of the width and height from it: in the middle third."""

MAX_START_TILT_DEG = 10.0  # searches start with at most this tilt up or down from START_TILT_DEG
START_TILT_DEG = -10.0
MAX_ATTEMPTS = 200  # starts and targets that are tried before a scene is said to have no suitable target


def is_central(box: Box) -> bool:
    """Return whether the middle of a box lies in the middle third of the frame."""
    x, y = box.centre
    return abs(x - 0.5) <= CENTRAL_OFFSET and abs(y - 0.5) <= CENTRAL_OFFSET


def true_boxes(world: World, pose: Pose, description: str) -> tuple[Box, ...]:
    """Return the boxes of all visible things that fit a description in the agent's frame at a pose, by the ground truth."""
    truth = GroundTruthPerception(world.scene_named)
    frame = world.blank_frame(pose)
    return world.run(lambda: truth.detect(frame, description)).boxes


def choose_search(world: World, rng: np.random.Generator, targets: tuple[str, ...], target_zoom: float) -> tuple[Pose, str]:
    """Return the start of a search and what to search for.

    Args:
        world: The world, with the camera at its viewpoint.
        rng: Source of the random choices.
        targets: Names from which to choose; empty for the names of all things in the scene.
        target_zoom: Magnification at which the target is visible when the camera points at it.

    Raises:
        InputError: No suitable target was found.
    """
    viewpoint = world.scene.viewpoint(world.camera.viewpoint)
    limits = world.camera.info.limits
    poses = _poses_by_name(world, viewpoint, targets, target_zoom, limits)
    names = sorted(poses)
    for _ in range(MAX_ATTEMPTS if names else 0):
        start = _random_start(rng, limits)
        name = names[int(rng.integers(len(names)))]
        aim = poses[name][int(rng.integers(len(poses[name])))]
        try:
            if not any(map(is_central, true_boxes(world, aim, name))) or true_boxes(world, start, name):
                continue
        except PerceptionError:  # the language of descriptions does not know the name
            continue
        return start, name
    wanted = f"none of {', '.join(targets)}" if targets else "nothing"
    raise InputError(
        f"In the scene '{world.scene.name}' from {world.camera.viewpoint}, {wanted} can be searched for at zoom {target_zoom:g} in "
        "frames of this size. Name other targets, raise target_zoom or choose larger frames."
    )


def _random_start(rng: np.random.Generator, limits: Limits) -> Pose:
    pan = rng.uniform(limits.min_pan_deg, limits.max_pan_deg)
    tilt = START_TILT_DEG + rng.uniform(-MAX_START_TILT_DEG, MAX_START_TILT_DEG)
    return limits.clamp(Pose(float(pan), float(tilt), limits.min_zoom))[0]


def _poses_by_name(
    world: World, viewpoint: Viewpoint, targets: tuple[str, ...], zoom: float, limits: Limits
) -> dict[str, list[Pose]]:
    """Return the poses that point at the things of each name. Parts of things, and things out of reach, are left out."""
    found: dict[str, list[Pose]] = {}
    for thing in world.scene.file.instances:
        extent = viewpoint.extents.get(thing.number)
        if extent is None or not extent.hull or thing.parent is not None or (targets and thing.name not in targets):
            continue
        corners = np.array(extent.hull, dtype=np.float64).reshape(-1, 2)
        pan, tilt = (float(v) for v in pan_tilt_deg(direction(corners[:, 0], corners[:, 1]).mean(axis=0)))
        pose, clamped = limits.clamp(Pose(limits.aim_pan_deg(pan), tilt, zoom))
        if not clamped:
            found.setdefault(thing.name, []).append(pose)
    return found
