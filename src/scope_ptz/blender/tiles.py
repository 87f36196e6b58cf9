"""Select tiles: the parts of the sphere that get sharper pictures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Equirectangular, Perspective, direction, pan_tilt_deg
from scope_ptz.simulator.models import SceneFile, SceneText, SceneViewpoint

CELL_PAN_DEG, CELL_TILT_DEG = 6.0, 4.0
"""Size of the cells for sharp tiles."""

WIDER_PAN_DEG, WIDER_TILT_DEG = 30.0, 20.0
"""Size of the cells for wider tiles."""

OVERLAP_DEG = 0.15
"""A tile extends this many degrees beyond its cell, so that there is no gap between neighbours."""

MAX_JOINED, MAX_JOINED_TILT_DEG = 3, 35.0
"""Maximum number of neighbouring cells to render as one tile, and the maximum tilt of such cells."""

GRID_DEG = 0.25
"""Resolution, in degrees, of the map of directions to cover."""

WIDE_FOCAL_PX, TELE_FOCAL_PX = 897.0, 5212.0
"""Focal lengths for a 1280-pixel-wide frame at both ends of the zoom range."""

SMALL_SIDE_PX = 60.0
"""An instance is a target only if its longer side is shorter than this many pixels at the widest zoom."""

MIN_TELE_SIDE_PX, MIN_TELE_AREA_PX = 12.0, 70.0
"""An instance is a target only if its shorter side and its area reach these numbers of pixels at the closest zoom.

Smaller instances could not be counted even at that zoom.
"""

MAX_WIDE_CAPS_PX = 20.0
"""Text is a target only if its capitals are less than this many pixels high at the widest zoom."""

MIN_TELE_CAPS_PX = 12.0
MAX_READING_ANGLE_DEG = 58.0
"""Text is a target only if its capitals are at least ``MIN_TELE_CAPS_PX`` high at the closest zoom. In addition, the angle
between its normal and the line of sight must be at most ``MAX_READING_ANGLE_DEG``.
"""

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Target:
    """An instance or text that the tiles must cover. ``directions`` has the shape ``(n, 2)``: pan and tilt in degrees."""

    name: str
    directions: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Cell:
    """A part of the sphere between two pan angles and two tilt angles."""

    pan_deg: float
    tilt_deg: float
    span_pan_deg: float
    span_tilt_deg: float

    def view(self, density_px_per_deg: float) -> Perspective:
        """Return the smallest view that contains the cell with its overlap and has the given density at its centre."""
        edge = np.linspace(-0.5, 0.5, 17)
        pans, tilts = np.meshgrid(edge * (self.span_pan_deg + 2 * OVERLAP_DEG), edge * (self.span_tilt_deg + 2 * OVERLAP_DEG))
        axes = Perspective(self.pan_deg, self.tilt_deg, 90.0, 2, 2)
        shown = axes.points(direction(self.pan_deg + pans, self.tilt_deg + tilts))
        half_x, half_y = (2 * float(np.abs(shown[..., k] - 0.5).max()) for k in range(2))
        focal_px = math.degrees(density_px_per_deg)
        width, height = (2 * math.ceil(half * focal_px) for half in (half_x, half_y))
        return Perspective(self.pan_deg, self.tilt_deg, math.degrees(2 * math.atan(width / 2 / focal_px)), width, height)


def targets(scene: SceneFile, viewpoint: SceneViewpoint, ids: NDArray[np.uint16], projection: Equirectangular) -> list[Target]:
    """Return the text that can be read, and the small instances that can be counted, only after zooming in.

    Args:
        scene: The scene.
        viewpoint: The panorama's viewpoint.
        ids: The panorama's instance IDs ``(H, W)``.
        projection: The panorama's projection.
    """
    found = []
    rows, columns = np.nonzero(ids)
    numbers = ids[rows, columns]
    order = np.argsort(numbers, kind="stable")
    names = {i.number: i.id for i in scene.instances}
    ends = np.flatnonzero(np.diff(numbers[order], append=-1)) + 1
    first = 0
    for last in ends:
        part = order[first:last]
        first = int(last)
        points = np.stack([(columns[part] + 0.5) / projection.width, (rows[part] + 0.5) / projection.height], axis=-1)
        if _is_small(points, projection):
            pan, tilt = pan_tilt_deg(projection.directions(points))
            found.append(Target(names.get(int(numbers[part[0]]), str(numbers[part[0]])), np.stack([pan, tilt], axis=-1)))
    found += [Target(t.id, covered) for t in scene.texts if (covered := _text_directions(t, viewpoint)) is not None]
    return found


def _is_small(points: NDArray[np.float64], projection: Equirectangular) -> bool:
    directions = projection.directions(points)
    _, tilt = pan_tilt_deg(directions)
    pixel_sr = math.radians(projection.pan_span_deg / projection.width) ** 2
    solid_angle = float(np.cos(np.radians(tilt)).sum()) * pixel_sr
    centre_pan, centre_tilt = (float(v) for v in pan_tilt_deg(directions.mean(axis=0)))
    shown = Perspective(centre_pan, centre_tilt, 90.0, 2, 2).points(directions)
    if np.isnan(shown).any():
        return False
    shorter, longer = np.sort(2 * np.ptp(shown, axis=0) + math.sqrt(pixel_sr))
    if longer * WIDE_FOCAL_PX >= SMALL_SIDE_PX:
        return False
    return bool(shorter * TELE_FOCAL_PX >= MIN_TELE_SIDE_PX and solid_angle * TELE_FOCAL_PX**2 >= MIN_TELE_AREA_PX)


def _text_directions(text: SceneText, viewpoint: SceneViewpoint) -> NDArray[np.float64] | None:
    """Return directions across text if it is legible only when zoomed in; otherwise None. Occlusion is ignored."""
    centre, right, up = (np.array(v) for v in (text.centre_m, text.right, text.up))
    towards = np.array(viewpoint.position_m) - centre
    distance = float(np.linalg.norm(towards))
    cosine = float(np.cross(right, up) @ towards) / distance
    angular_height = text.cap_height_m / distance
    if cosine < math.cos(math.radians(MAX_READING_ANGLE_DEG)) or angular_height * TELE_FOCAL_PX < MIN_TELE_CAPS_PX:
        return None
    if angular_height * WIDE_FOCAL_PX > MAX_WIDE_CAPS_PX:
        return None
    u, v = np.meshgrid(np.linspace(-0.6, 0.6, 25), np.linspace(-0.7, 0.7, 9))
    points = centre + u[..., None] * right * text.width_m + v[..., None] * up * text.height_m - viewpoint.position_m
    pan, tilt = pan_tilt_deg(points.reshape(-1, 3))
    return np.stack([(pan - viewpoint.pan0_bearing_deg + 180.0) % 360.0 - 180.0, tilt], axis=-1)


def cover(targets: Sequence[Target]) -> list[Cell]:
    """Return grid cells that cover all targets. The grid is shifted so that the fewest cells are needed."""
    if not targets:
        return []
    needed = _coverage_map(targets)
    shifts = np.arange(0.0, CELL_TILT_DEG, GRID_DEG)
    return min((_cells(needed, float(shift), CELL_PAN_DEG, CELL_TILT_DEG) for shift in shifts), key=len)


def busiest_cells(ids: NDArray[np.uint16], projection: Equirectangular, limit: int) -> list[Cell]:
    """Return the cells for wider tiles that contain the greatest total length of instance outlines.

    Args:
        ids: The panorama's instance IDs ``(H, W)``.
        projection: The panorama's projection.
        limit: Maximum number of cells.
    """
    outlines = _outlines(ids, projection)
    everywhere = np.ones_like(outlines, dtype=bool)
    best: list[Cell] = []
    best_total = -1.0
    for shift in np.arange(0.0, WIDER_TILT_DEG, 1.0):
        cells = _cells(everywhere, float(shift), WIDER_PAN_DEG, WIDER_TILT_DEG)
        found = [(_outline_length(outlines, cell), k) for k, cell in enumerate(cells)]
        chosen = sorted(found, reverse=True)[:limit]
        if (total := sum(length for length, _ in chosen)) > best_total:
            best, best_total = [cells[k] for k in sorted(k for length, k in chosen if length > 0)], total
    return best


def covers(views: Sequence[Perspective], target: Target) -> bool:
    """Return whether every direction of a target is in at least one of the views."""
    return bool(np.any([_inside_mask(view, target) for view in views], axis=0).all()) if views else False


def _inside_mask(view: Perspective, target: Target) -> Mask:
    points = np.nan_to_num(view.points(direction(target.directions[:, 0], target.directions[:, 1])), nan=-1.0)
    return np.asarray(np.all((points >= 0) & (points <= 1), axis=-1))


def select_most_useful(cells: Sequence[Cell], targets: Sequence[Target], limit: int) -> list[Cell]:
    """Return the ``limit`` cells that show parts of the most targets, in their original order."""
    views = [cell.view(1.0) for cell in cells]
    shown = [sum(bool(_inside_mask(view, target).any()) for target in targets) for view in views]
    selected = sorted(sorted(range(len(cells)), key=lambda k: (-int(shown[k]), k))[:limit])
    return [cells[k] for k in selected]


def join_in_rows(cells: Sequence[Cell]) -> list[Cell]:
    """Join neighbouring cells in a row to reduce the number of renders.

    Rows far from the horizon are not joined, because a long cell there would fill little of its picture.
    """
    found: list[Cell] = []
    length = 0
    for cell in sorted(cells, key=lambda c: (c.tilt_deg, c.pan_deg)):
        last = found[-1] if found else None
        touching = last is not None and abs(cell.pan_deg - last.pan_deg - (last.span_pan_deg + cell.span_pan_deg) / 2) < 1e-6
        in_row = last is not None and last.tilt_deg == cell.tilt_deg and abs(cell.tilt_deg) < MAX_JOINED_TILT_DEG
        if last is not None and in_row and touching and length < MAX_JOINED:
            span_deg = last.span_pan_deg + cell.span_pan_deg
            centre_deg = cell.pan_deg + cell.span_pan_deg / 2 - span_deg / 2
            found[-1] = Cell(centre_deg, cell.tilt_deg, span_deg, cell.span_tilt_deg)
            length += 1
        else:
            found.append(cell)
            length = 1
    return found


def _coverage_map(targets: Sequence[Target]) -> Mask:
    """Return a map of the directions to cover, with the shape ``(720, 1440)``; row 0 is tilt -90, column 0 is pan -180."""
    grid = np.zeros((round(180 / GRID_DEG), round(360 / GRID_DEG)), dtype=bool)
    for target in targets:
        rows = np.clip(((target.directions[:, 1] + 90) / GRID_DEG).astype(int), 0, grid.shape[0] - 1)
        grid[rows, ((target.directions[:, 0] + 180) / GRID_DEG).astype(int) % grid.shape[1]] = True
    return grid


def _outlines(ids: NDArray[np.uint16], projection: Equirectangular) -> NDArray[np.float64]:
    """Return the length of the instance outlines in each grid square, on the grid of ``_coverage_map``.

    The panorama must span 360 degrees.
    """
    edge = np.zeros(ids.shape, dtype=bool)
    edge[:, 1:] = ids[:, 1:] != ids[:, :-1]
    edge[1:] |= ids[1:] != ids[:-1]
    rows, columns = np.nonzero(edge)
    tilts = projection.top_tilt_deg - (rows + 0.5) / projection.height * (projection.top_tilt_deg - projection.bottom_tilt_deg)
    pans = (columns + 0.5) / projection.width * 360.0
    bins = [round(180 / GRID_DEG), round(360 / GRID_DEG)]
    weights = np.cos(np.radians(tilts))  # pixels near the poles are narrower
    return np.histogram2d(tilts, pans, bins=bins, range=[[-90.0, 90.0], [0.0, 360.0]], weights=weights)[0]


def _outline_length(outlines: NDArray[np.float64], cell: Cell) -> float:
    tilts, pans = (np.arange(-span / 2, span / 2, GRID_DEG) for span in (cell.span_tilt_deg, cell.span_pan_deg))
    rows = ((cell.tilt_deg + tilts + 90.0) / GRID_DEG).astype(int)
    columns = ((cell.pan_deg + pans + 180.0) / GRID_DEG).astype(int) % outlines.shape[1]
    return float(outlines[rows[(rows >= 0) & (rows < outlines.shape[0])]][:, columns].sum())


def _cells(needed: Mask, shift_deg: float, span_pan_deg: float, span_tilt_deg: float) -> list[Cell]:
    cells: list[Cell] = []
    low = -90.0 - shift_deg
    while low < 90.0:
        high = low + span_tilt_deg
        rows = slice(max(0, round((low + 90) / GRID_DEG)), max(0, round((high + 90) / GRID_DEG)))
        columns = np.asarray(needed[rows].any(axis=0))
        if columns.any():
            nearest = 0.0 if low < 0 < high else min(abs(low), abs(high))
            count = max(3, round(360 * math.cos(math.radians(min(nearest, 85.0))) / span_pan_deg))
            starts = _best_starts(columns, 360.0 / count)
            cells += [Cell((s + 180.0 / count) % 360.0 - 180.0, (low + high) / 2, 360.0 / count, span_tilt_deg) for s in starts]
        low = high
    return cells


def _best_starts(columns: Mask, span_deg: float) -> list[float]:
    """Return the left edges of the columns to render, in degrees from pan -180, for the offset with the fewest columns."""
    pans_deg = np.flatnonzero(columns) * GRID_DEG
    best: list[float] = []
    for offset in np.arange(0.0, span_deg, GRID_DEG):
        index = np.unique(np.concatenate([((pans_deg + d - offset) % 360.0) // span_deg for d in (0.0, 0.99 * GRID_DEG)]))
        if not best or len(index) < len(best):
            best = [float(offset + i * span_deg) for i in index]
    return best
