"""Pictures and instance numbers of a scene at one instant: the still world with its moving actors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection
from scope_ptz.world.pack import Scene
from scope_ptz.world.reproject import colour_view, id_view


def picture(scene: Scene, viewpoint: str, projection: Projection, time_s: float) -> NDArray[np.uint8]:
    """(H, W, 3) RGB: what a camera at a viewpoint sees at a time."""
    return colour_view(scene.viewpoint(viewpoint), projection)


def instance_numbers(scene: Scene, viewpoint: str, projection: Projection, time_s: float) -> NDArray[np.uint16]:
    """(H, W): which instance or actor each pixel of that picture shows, 0 for none."""
    return id_view(scene.viewpoint(viewpoint), projection)
