"""Pictures and instance numbers of a scene at one instant: the still world and its moving actors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection
from scope_ptz.simulator.actors import Appearance, composited, draw, place_of, shows
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.reproject import colour_view, id_view, outlined_depth_view
from scope_ptz.simulator.viewpoint import Viewpoint


def picture(scene: Scene, viewpoint: str, projection: Projection, time_s: float) -> NDArray[np.uint8]:
    """Return what a camera at a viewpoint sees at a time, as (H, W, 3) RGB."""
    here = scene.viewpoint(viewpoint)
    actors = _in_view(scene, here, projection, time_s)
    # Distances before colour: decoding instance numbers needs the most memory, and then the colour is not in memory yet.
    depth_m = outlined_depth_view(here, projection, id_view(here, projection)) if actors else None
    image = colour_view(here, projection)
    if depth_m is not None:
        for actor in actors:
            draw(here, projection, actor, depth_m, image, None)
    return image


def instance_numbers(scene: Scene, viewpoint: str, projection: Projection, time_s: float) -> NDArray[np.uint16]:
    """Return the instance or actor that each pixel of that picture shows as (H, W) numbers, 0 for none."""
    here = scene.viewpoint(viewpoint)
    numbers = id_view(here, projection)
    if actors := _in_view(scene, here, projection, time_s):
        depth_m = outlined_depth_view(here, projection, numbers, [p for a in actors if (p := place_of(a, projection)) is not None])
        for actor in actors:
            draw(here, projection, actor, depth_m, None, numbers)
    return numbers


def _in_view(scene: Scene, viewpoint: Viewpoint, projection: Projection, time_s: float) -> list[Appearance]:
    return [a for a in composited(scene, viewpoint, time_s) if shows(a, projection)]
