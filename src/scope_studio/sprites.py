"""Render the sprites of a moving actor. A sprite shows only the actor's body and its shadow on flat ground."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from scope_studio import render
from scope_studio.actor_bodies import ActorBodies, set_visible
from scope_studio.kit.core.stage import Stage, Viewpoint

SHADOW_PLANE_M = 60.0
"""Side length in metres of the plane that receives the shadow."""


def render_frames(
    stage: Stage,
    actor_bodies: ActorBodies,
    actor_id: str,
    viewpoint: Viewpoint,
    frames: list[dict[str, Any]],
    samples: int,
    out_dir: Path,
    progress: Callable[[int, int], None],
) -> None:
    """Render one sprite for each frame.

    A frame is a dict with ``time_s``, ``phase``, ``position_m`` and ``projection``. Frame 0 is written as ``000.png`` (RGBA)
    and ``000.npz`` (distances). Existing frames are skipped.
    """
    actor = next(a for a in stage.actors if a.id == actor_id)
    with _shadow_plane() as ground:
        for k, frame in enumerate(frames):
            picture = out_dir / f"{k:03d}.png"
            if not picture.with_suffix(".npz").exists():
                built = actor_bodies.place(actor, frame["time_s"], frame["phase"])
                if built is None:
                    raise ValueError(f"no sprite can be rendered: {actor_id} is not in the scene at {frame['time_s']} s")
                ground.location = frame["position_m"]
                ground.hide_render = False
                bpy.context.view_layer.update()
                partial = picture.with_suffix(".part")
                render.colour(viewpoint, frame["projection"], samples, k, partial, alpha=True)
                partial.replace(picture)
                ground.hide_render = True
                ids, depth = render.truth_arrays(viewpoint, frame["projection"])
                with partial.open("wb") as file:
                    np.savez(file, depth=np.where(ids == actor.number, depth, 0).astype(np.float32))
                partial.replace(picture.with_suffix(".npz"))
                set_visible(built, False)
            progress(k + 1, len(frames))


@contextmanager
def _shadow_plane() -> Iterator[bpy.types.Object]:
    """Hide every visible object while the context is active, and yield a plane that receives shadows."""
    hidden = [o for o in bpy.data.objects if o.type not in {"LIGHT", "CAMERA"} and not o.hide_render]
    for obj in hidden:
        obj.hide_render = True
    mesh = bpy.data.meshes.new("shadow catcher")
    h = SHADOW_PLANE_M / 2
    mesh.from_pydata([(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)], [], [(0, 1, 2, 3)])
    ground = bpy.data.objects.new("shadow catcher", mesh)
    ground.is_shadow_catcher = True
    bpy.context.scene.collection.objects.link(ground)
    try:
        yield ground
    finally:
        bpy.data.objects.remove(ground)
        bpy.data.meshes.remove(mesh)
        for obj in hidden:
            obj.hide_render = False
