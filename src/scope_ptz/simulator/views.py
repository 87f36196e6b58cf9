"""Pictures and instance numbers of a scene at one instant: the still world and its moving actors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection
from scope_ptz.simulator.actors import composited, composited_actors, draw_numbers, place_of
from scope_ptz.simulator.drawing import actor_patch
from scope_ptz.simulator.occlusion import outlined_depth_view
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.reproject import colour_view, id_view

RENDERING_VERSION = 2
"""Version of the rendering, which traces record. It is raised when the same pack, pose and time give other pixels.

- 1: tiles end in hard edges; actors are shown by the sprite nearest on their path.
- 2: tiles are blended and matched in tone; actors are shown by the sprites nearest in viewing angle, bent and faded.

The ground truth of a view is the same in both.
"""


def picture(scene: Scene, viewpoint: str, projection: Projection, time_s: float) -> NDArray[np.uint8]:
    """Return what a camera at a viewpoint sees at a time, as (H, W, 3) RGB."""
    here = scene.viewpoint(viewpoint)
    # Actors before the still world: decoding instance numbers needs the most memory, and then the colour is not in memory yet.
    patches = [actor_patch(here, projection, actor) for actor in composited_actors(scene, here, time_s)]
    image = colour_view(here, projection)
    for patch in patches:
        if patch is not None:
            patch.draw(image)
    return image


def instance_numbers(scene: Scene, viewpoint: str, projection: Projection, time_s: float) -> NDArray[np.uint16]:
    """Return the instance or actor that each pixel of that picture shows as (H, W) numbers, 0 for none."""
    here = scene.viewpoint(viewpoint)
    numbers = id_view(here, projection)
    places = [(actor, place_of(actor, projection)) for actor in composited(scene, here, time_s)]
    # The distances of all actors come first, because drawing changes the numbers that they are read with.
    behind = [(actor, outlined_depth_view(here, projection, numbers, place)) for actor, place in places if place is not None]
    for actor, depth_m in behind:
        draw_numbers(here, projection, actor, depth_m, numbers)
    return numbers
