"""Solid angles of silhouettes, compared with closed-form solutions."""

import math
from pathlib import Path

import numpy as np
import pytest

from scope_ptz.blender.extents import InstanceMesh, Ints, extent, extents
from scope_ptz.simulator.models import SceneViewpoint

QUAD: Ints = np.array([[0, 1, 2], [1, 3, 2]])


def rectangle(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> InstanceMesh:
    """Return a rectangle in a plane of constant y (vertical) or constant z (horizontal)."""
    corners = [(a, y[0], b) for b in z for a in x] if y[0] == y[1] else [(a, b, z[0]) for b in y for a in x]
    return InstanceMesh(7, np.array(corners, dtype=float), QUAD)


def solid_angle_of_rectangle(a: float, b: float, distance: float) -> float:
    """Return the solid angle of a rectangle with sides 2a and 2b that is centred on the axis."""
    return 4 * math.asin(a * b / math.sqrt((a * a + distance**2) * (b * b + distance**2)))


def test_a_rectangle() -> None:
    found = extent(rectangle((-1, 1), (10, 10), (-0.5, 0.5)))
    assert found.solid_angle_sr == pytest.approx(solid_angle_of_rectangle(1, 0.5, 10), rel=3e-3)
    assert found.distance_m == pytest.approx(10, abs=1e-3)
    assert np.abs(np.array(found.hull)).max(axis=0) == pytest.approx(
        [math.degrees(math.atan(0.1)), math.degrees(math.atan(0.05))], abs=0.02
    )


def test_a_thin_leaning_pole() -> None:
    width, length, lean = 0.06, 6.0, math.radians(25)
    along, across = np.array([math.sin(lean), 0, math.cos(lean)]), np.array([math.cos(lean), 0, -math.sin(lean)])
    corners = np.array([across * u * width / 2 + along * v * length / 2 + (0, 25, 0) for v in (-1, 1) for u in (-1, 1)])
    assert extent(InstanceMesh(1, corners, QUAD)).solid_angle_sr == pytest.approx(
        solid_angle_of_rectangle(width / 2, length / 2, 25), rel=0.02
    )


def test_ground_that_fills_half_of_the_sphere() -> None:
    found = extent(rectangle((-100, 100), (-100, 100), (-2, -2)))
    assert found.solid_angle_sr == pytest.approx(solid_angle_of_rectangle(100, 100, 2), rel=2e-3)
    assert found.hull == []
    assert found.distance_m == pytest.approx(2)


def test_overlapping_triangles_count_once() -> None:
    one = rectangle((-1, 1), (10, 10), (-1, 1))
    twice = InstanceMesh(7, np.concatenate([one.vertices, one.vertices * 1.5]), np.concatenate([QUAD, QUAD + 4]))
    assert extent(twice).solid_angle_sr == pytest.approx(extent(one).solid_angle_sr, rel=2e-3)


def test_meshes_are_converted_to_the_coordinates_of_the_viewpoint(tmp_path: Path) -> None:
    shape = rectangle((-1, 1), (0, 0), (-1, 1))
    place = np.eye(4)
    place[:3, 3] = (20.0, 0.0, 5.0)
    np.savez(
        tmp_path / "meshes.npz",
        **{"vertices-0": shape.vertices.astype(np.float32), "triangles-0": QUAD.astype(np.int32)},  # type: ignore[arg-type]
        uses=np.array([[3, 0]], dtype=np.int32),
        matrices=place[None] @ np.diag([1.0, 1, 1, 1]) @ np.array([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]]),
    )
    steps: list[tuple[int, int]] = []
    here = SceneViewpoint(name="mast", position_m=(0, 0, 5), pan0_bearing_deg=90)
    found = extents(tmp_path / "meshes.npz", here, lambda done, total: steps.append((done, total)))
    assert [e.number for e in found] == [3]
    assert np.array(found[0].hull).mean(axis=0) == pytest.approx([0, 0], abs=0.01)
    assert found[0].distance_m == pytest.approx(20, abs=1e-3)
    assert steps == [(1, 1)]
