"""Measure instances in an image from runs: consecutive pixels in a row that have the same instance ID."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Equirectangular, Perspective, Projection

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Measures:
    """Measurements of every instance in an image, in ascending order of instance ID.

    ``pixels`` and ``solid_angle_sr`` are (n,). ``box`` (n, 4), ``centroid`` (n, 2) and ``point`` (n, 2) are fractions of the
    image's width and height. ``centroid`` may lie on another object; ``point`` lies on the instance itself.
    """

    ids: Ints
    pixels: Ints
    solid_angle_sr: Floats
    box: Floats
    centroid: Floats
    point: Floats


def measure(ids: NDArray[np.uint16], projection: Projection) -> Measures:
    """Measure every instance in an (H, W) image of instance IDs."""
    runs = _Runs(ids)
    height, width = ids.shape
    is_full_circle = isinstance(projection, Equirectangular) and projection.pan_span_deg >= 360.0 - 1e-9
    measured = runs.measured_runs(width) if is_full_circle else np.ones(len(runs.instance_id), dtype=bool)
    length = runs.stop - runs.start
    solid = _solid_angles(projection, runs.row, runs.start, runs.stop)

    def total(values: Floats | Ints) -> Floats:
        return np.asarray(np.add.reduceat(values * 1.0, runs.first)) if len(runs.first) else np.zeros(0)

    def lowest(values: Ints, otherwise: int) -> Floats:
        chosen = np.where(measured, values, otherwise)
        return np.asarray(np.minimum.reduceat(chosen, runs.first) * 1.0) if len(runs.first) else np.zeros(0)

    weight = length * measured.astype(np.int64)
    measured_pixels = np.maximum(total(weight), 1.0)
    centroid_x = total((runs.start + runs.stop) / 2 * weight) / measured_pixels
    centroid_y = total((runs.row + 0.5) * weight) / measured_pixels
    x_min, y_min = lowest(runs.start, width), lowest(runs.row, height)
    x_max, y_max = -lowest(-runs.stop, 0), -lowest(-runs.row - 1, 0)
    point_x, point_y = runs.nearest(centroid_x, centroid_y, measured)
    size = np.array([width, height], dtype=np.float64)
    return Measures(
        ids=runs.instance_id[runs.first],
        pixels=total(length).astype(np.int64),
        solid_angle_sr=total(solid),
        box=np.stack([x_min, y_min, x_max, y_max], axis=-1) / np.tile(size, 2),
        centroid=np.stack([centroid_x, centroid_y], axis=-1) / size,
        point=np.stack([point_x, point_y], axis=-1) / size,
    )


class _Runs:
    """The runs in an image whose instance ID is not 0, sorted by instance ID.

    ``instance_id``, ``row``, ``start`` and ``stop`` have one element for each run. ``first`` is the index of each instance's first
    run.
    """

    def __init__(self, ids: NDArray[np.uint16]) -> None:
        height, width = ids.shape
        begins = np.ones((height, width), dtype=bool)
        np.not_equal(ids[:, 1:], ids[:, :-1], out=begins[:, 1:])
        at = np.flatnonzero(begins)
        stops = np.append(at[1:], height * width)
        instance_id = ids.reshape(-1)[at].astype(np.int64)
        keep = instance_id > 0
        order = np.argsort(instance_id[keep], kind="stable")
        at, stops = at[keep][order], stops[keep][order]
        self.instance_id: Ints = instance_id[keep][order]
        self.row: Ints = at // width
        self.start: Ints = at - self.row * width
        self.stop: Ints = self.start + stops - at
        self.first: Ints = np.flatnonzero(np.diff(self.instance_id, prepend=-1))
        self.group: Ints = np.cumsum(np.diff(self.instance_id, prepend=-1) != 0) - 1

    def measured_runs(self, width: int) -> NDArray[np.bool_]:
        """Return a mask of the runs to measure. If an instance crosses the panorama's seam, only its larger part is measured."""
        measured = np.ones(len(self.instance_id), dtype=bool)
        edges = np.intersect1d(self.instance_id[self.start == 0], self.instance_id[self.stop == width])
        for instance_id in edges:
            of_instance = self.instance_id == instance_id
            left = of_instance & (self.start + self.stop < width)
            length = self.stop - self.start
            smaller = left if length[left].sum() * 2 < length[of_instance].sum() else of_instance & ~left
            measured[smaller] = False
        return measured

    def nearest(self, x: Floats, y: Floats, measured: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        """Return, for each instance, the centre of the pixel nearest to a point (in pixels)."""
        if not len(self.first):
            return np.zeros(0), np.zeros(0)
        near_x = np.clip(x[self.group], self.start + 0.5, self.stop - 0.5)
        distance = np.where(measured, np.hypot(near_x - x[self.group], self.row + 0.5 - y[self.group]), np.inf)
        best = np.lexsort((distance, self.instance_id))[self.first]
        return np.asarray(near_x[best]), np.asarray(self.row[best] + 0.5)


def _solid_angles(projection: Projection, row: Ints, start: Ints, stop: Ints) -> Floats:
    """Return the solid angle of each run in steradians, integrated exactly along the row at its mid-height."""
    if isinstance(projection, Perspective):
        f = projection.focal_px
        y = row + 0.5 - projection.height / 2

        def integral(column: Ints) -> Floats:
            # integral over x of f / (f^2 + x^2 + y^2)^(3/2), the solid angle per unit area of the image plane
            x = column - projection.width / 2
            return np.asarray(f * x / ((f**2 + y**2) * np.sqrt(f**2 + y**2 + x**2)))

        return integral(stop) - integral(start)
    if isinstance(projection, Equirectangular):
        slope = (projection.bottom_tilt_deg - projection.top_tilt_deg) / projection.height
        top = np.radians(projection.top_tilt_deg + slope * row)
        bottom = np.radians(projection.top_tilt_deg + slope * (row + 1))
        turn = math.radians(projection.pan_span_deg) / projection.width * (stop - start)
        return np.asarray(np.abs(np.sin(top) - np.sin(bottom)) * turn)
    raise TypeError(f"solid angles of {type(projection).__name__} are not supported")
