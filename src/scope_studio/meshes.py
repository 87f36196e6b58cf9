"""Export the triangles of all annotated instances, to compute complete silhouettes that include hidden parts."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np

from scope_studio.kit.core.stage import Stage


def write(stage: Stage, out: Path) -> None:
    """Write the distinct meshes and their placements to an .npz file.

    The file contains ``vertices-K`` (n, 3) float32 and ``triangles-K`` (m, 3) int32 for each mesh K, ``uses`` (k, 2) int32 with the
    instance number and mesh index of each placement, and ``matrices`` (k, 4, 4) float64 with its world transform.
    """
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    arrays: dict[str, np.ndarray] = {}
    mesh_numbers: dict[str, int] = {}
    placements: list[tuple[int, int]] = []
    matrices: list[np.ndarray] = []
    for instance in stage.instances:
        for obj in instance.built.objects:
            if obj.type not in {"MESH", "CURVE", "FONT", "SURFACE"} or obj.hide_render:
                continue
            key = obj.data.name_full if not obj.modifiers else f"object {obj.name_full}"
            evaluated = obj.evaluated_get(depsgraph)
            if key not in mesh_numbers:
                mesh_numbers[key] = len(mesh_numbers)
                vertices, triangles = _triangles(evaluated)
                arrays[f"vertices-{mesh_numbers[key]}"], arrays[f"triangles-{mesh_numbers[key]}"] = vertices, triangles
            placements.append((instance.number, mesh_numbers[key]))
            matrices.append(np.array(evaluated.matrix_world))
    np.savez(out, uses=np.array(placements, dtype=np.int32).reshape(-1, 2), matrices=np.array(matrices).reshape(-1, 4, 4), **arrays)


def _triangles(evaluated: bpy.types.Object) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertices (n, 3) and triangles (m, 3) of an evaluated object."""
    mesh = evaluated.to_mesh()
    mesh.calc_loop_triangles()
    vertices = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
    mesh.vertices.foreach_get("co", vertices)
    triangles = np.empty(len(mesh.loop_triangles) * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    evaluated.to_mesh_clear()
    return vertices.reshape(-1, 3), triangles.reshape(-1, 3)
