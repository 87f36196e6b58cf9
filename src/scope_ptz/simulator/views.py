"""Pictures and instance IDs of a scene at one instant, with both the static world and moving actors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection
from scope_ptz.simulator.actors import composited_actors, composited_appearances, draw_instance_ids, place_of
from scope_ptz.simulator.drawing import actor_patch
from scope_ptz.simulator.occlusion import outlined_depth_view
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.reproject import colour_view, id_view

RENDERING_VERSION = 3
"""The rendering version, which traces record. It increases when the same pack, pose and time give different pixels.

- 1: tiles end in hard edges; actors are shown by the sprite nearest on their path.
- 2: tiles are blended and matched in tone; actors are shown by the sprites nearest in viewing angle, which are warped and blended.
- 3: colours are sampled at positions rounded to 1/32 of a stored pixel; edges that hide a part of an actor are soft if the part is
  large; occlusion is not tested where only ground, or nothing nearer than the actor, is in view, so shadows may fall on objects
  behind the actor.

The ground truth of a view is the same in all versions.
"""


def picture(scene: Scene, viewpoint: str, projection: Projection, time_s: float) -> NDArray[np.uint8]:
    """Return the picture from a viewpoint at a scene time as (H, W, 3) RGB."""
    opened = scene.viewpoint(viewpoint)
    actors = composited_actors(scene, opened, time_s)
    atlas, still = opened.colour_atlas, opened.still_views
    if not (opened.id_atlas.is_in_use and atlas.is_in_use) or still.is_cached(projection):
        # Render actors first: they need instance IDs, whose decoding takes the most memory, and colours are not in memory yet.
        patches = [actor_patch(opened, projection, actor) for actor in actors]
        image = still.get(projection, lambda: colour_view(opened, projection))
    else:
        # Another thread renders the static world while this one renders the actors. OpenCV releases the GIL.
        opened.tiles.in_view(projection)  # both threads need the result, which is cached
        static = opened.render_in_background(lambda: colour_view(opened, projection))
        patches = [actor_patch(opened, projection, actor) for actor in actors]
        image = still.get(projection, static.result)
    for patch in patches:
        if patch is not None:
            patch.draw(image)
    return image


def instance_ids(scene: Scene, viewpoint: str, projection: Projection, time_s: float) -> NDArray[np.uint16]:
    """Return the (H, W) instance IDs of the instances and actors that the pixels of ``picture`` show; 0 for none."""
    opened = scene.viewpoint(viewpoint)
    ids = id_view(opened, projection)
    places = [(actor, place_of(actor, projection)) for actor in composited_appearances(scene, opened, time_s)]
    # Read the distances for all actors first, because drawing changes the instance IDs on which the distances depend.
    depths = [(actor, outlined_depth_view(opened, projection, ids, place)) for actor, place in places if place is not None]
    for actor, depth_m in depths:
        draw_instance_ids(opened, projection, actor, depth_m, ids)
    return ids
