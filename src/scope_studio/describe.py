"""Describe a scene as plain data, which is written to ``scene.json``."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from mathutils import Vector

from scope_studio.actor_bodies import ActorBodies
from scope_studio.kit.core.stage import Instance, Stage


def scene(stage: Stage, actor_bodies: ActorBodies) -> dict[str, Any]:
    """Return a scene's viewpoints, presets, instances with bounding boxes, text, actors and absent objects."""
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    corners: dict[str, np.ndarray] = {}
    return {
        "name": stage.name,
        "title": stage.title,
        "start_s": stage.start_s,
        "blender_version": bpy.app.version_string,
        "viewpoints": [
            {
                "name": v.name,
                "position_m": list(v.position),
                "pan0_bearing_deg": v.pan0_bearing_deg,
                "description": v.description,
            }
            for v in stage.viewpoints
        ],
        "presets": [
            {
                "name": p.name,
                "viewpoint": p.viewpoint,
                "pan_deg": p.pan_deg,
                "tilt_deg": p.tilt_deg,
                "zoom": p.zoom,
                "description": p.description,
            }
            for p in stage.presets
        ],
        "home_preset": stage.home_preset or "",
        "instances": [_instance(i, depsgraph, corners) for i in stage.instances],
        "texts": [text for i in stage.instances for text in _texts(i)],
        "actors": [
            {
                "id": a.id,
                "number": a.number,
                "category": a.category,
                "name": a.name,
                "attributes": a.attributes,
                "waypoints": [list(w) for w in a.waypoints],
                "period_s": a.period_s,
                "size_m": list(actor_bodies.size_m(a)),
            }
            for a in stage.actors
        ],
        "absent": list(stage.absent),
        "strides_m": {a.id: a.stride_m for a in stage.actors},
        "sun": _sun(),
    }


def _instance(instance: Instance, depsgraph: bpy.types.Depsgraph, cache: dict[str, np.ndarray]) -> dict[str, Any]:
    """Return the description of an instance, with its bounding box in world coordinates."""
    points = np.concatenate([_world_points(o, depsgraph, cache) for o in instance.built.objects])
    if len(points) == 0:
        raise ValueError(
            f"instance {instance.id} has no mesh with vertices. Add a mesh to the object, or place it without annotation"
        )
    return {
        "id": instance.id,
        "number": instance.number,
        "category": instance.category,
        "name": instance.name,
        "attributes": instance.attributes,
        "parent": instance.parent,
        "box_min_m": _round_values(points.min(axis=0)),
        "box_max_m": _round_values(points.max(axis=0)),
    }


def _world_points(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, cache: dict[str, np.ndarray]) -> np.ndarray:
    """Return the vertices (n, 3) of an object in world coordinates. ``cache`` stores the vertices of each mesh."""
    if obj.type not in {"MESH", "CURVE", "FONT", "SURFACE"}:
        return np.empty((0, 3))
    evaluated = obj.evaluated_get(depsgraph)
    key = f"{obj.data.name_full}" if not obj.modifiers else f"object {obj.name_full}"
    if key not in cache:
        mesh = evaluated.to_mesh()
        flat = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
        mesh.vertices.foreach_get("co", flat)
        cache[key] = flat.reshape(-1, 3).astype(np.float64)
        evaluated.to_mesh_clear()
    matrix = np.array(evaluated.matrix_world)
    return cache[key] @ matrix[:3, :3].T + matrix[:3, 3]


def _texts(instance: Instance) -> list[dict[str, Any]]:
    """Return descriptions of the text on an instance, in world coordinates."""
    matrix = instance.built.root.matrix_world
    scale = matrix.to_scale()[0]
    turn = matrix.to_quaternion()
    return [
        {
            "id": f"{instance.id}-text-{k:02d}",
            "text": mark.text,
            "parent": instance.id,
            "centre_m": _round_values(matrix @ Vector(mark.centre)),
            "right": _round_values(turn @ Vector(mark.right), 6),
            "up": _round_values(turn @ Vector(mark.up), 6),
            "width_m": round(mark.width_m * scale, 5),
            "height_m": round(mark.height_m * scale, 5),
            "cap_height_m": round(mark.cap_height_m * scale, 5),
        }
        for k, mark in enumerate(instance.built.texts, start=1)
    ]


def _sun() -> list[float] | None:
    """Return the unit vector towards the sun, which determines the shadows, or None if the scene has no sun."""
    for obj in bpy.data.objects:
        if obj.type == "LIGHT" and obj.data.type == "SUN":
            return _round_values(obj.matrix_world.to_quaternion() @ Vector((0, 0, 1)), 6)
    return None


def _round_values(values: Any, digits: int = 4) -> list[float]:
    """Return the values as rounded floats, without negative zeros."""
    return [round(float(v), digits) + 0.0 for v in values]
