"""Re-projection: compute any view from a viewpoint's stored pictures, with one map and one look-up.

The map gives each view pixel's position on the sheet of stored pictures. It is computed exactly at the nodes of a coarse grid and
interpolated between them; the grid is fine enough to keep errors below ``grid.MAX_MAP_ERROR_PX``. The same pack and projection
always give the same bytes.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection, pan_tilt_deg
from scope_ptz.simulator.mapping.atlas_map import Map, atlas_map
from scope_ptz.simulator.mapping.tiles import Place
from scope_ptz.simulator.sheets.atlas import Atlas
from scope_ptz.simulator.viewpoint import Viewpoint

STRIP_PX = 256  # number of rows whose colours are sampled at once


def colour_view(viewpoint: Viewpoint, projection: Projection) -> NDArray[np.uint8]:
    """Return the static world in a view as (H, W, 3) RGB."""
    atlas = viewpoint.colour_atlas
    with atlas.reading():
        return sample_colours(atlas, view_map(viewpoint, atlas, projection))


def sample_colours(atlas: Atlas, positions: Map) -> NDArray[np.uint8]:
    """Return the (H, W, 3) colours at (H, W, 2) positions on an atlas's sheet. Positions are rounded to 1/32 of a sheet pixel."""
    # OpenCV looks up rounded positions in about two thirds of the time that exact positions take. Strips need less memory.
    image = np.empty((*positions.shape[:2], atlas.sheet.shape[2]), np.uint8)
    for top in range(0, len(positions), STRIP_PX):
        strip = slice(top, top + STRIP_PX)
        pixels, fractions = cv2.convertMaps(positions[strip], None, cv2.CV_16SC2)
        cv2.remap(atlas.sheet, pixels, fractions, cv2.INTER_LINEAR, dst=image[strip])
    return image


def id_view(viewpoint: Viewpoint, projection: Projection, part: Place | None = None) -> NDArray[np.uint16]:
    """Return the static world's (H, W) instance IDs in a view or a part of it; 0 where nothing is annotated."""
    atlas = viewpoint.id_atlas
    return atlas.sample(view_map(viewpoint, atlas, projection, part))


def depth_view(viewpoint: Viewpoint, projection: Projection) -> NDArray[np.float32]:
    """Return the static world's (H, W) distances from the optical centre in metres, infinite for the sky."""
    atlas = viewpoint.depth_atlas
    codes = cv2.remap(atlas.sheet, view_map(viewpoint, atlas, projection), None, cv2.INTER_NEAREST)
    return np.asarray(np.take(viewpoint.depth_metres, codes))


def view_map(viewpoint: Viewpoint, atlas: Atlas, projection: Projection, part: Place | None = None) -> Map:
    """Return the positions of a view's pixels on the sheet of one of the viewpoint's atlases; see ``atlas_map``."""
    return atlas_map(viewpoint.tiles, viewpoint.manifest.band, atlas, projection, part)


def distances_m(viewpoint: Viewpoint, directions: NDArray[np.float64]) -> tuple[NDArray[np.float32], NDArray[np.uint16]]:
    """Return distances along directions, and the instances on which they were measured.

    Both are taken from the nearest texel of the depth layer.

    Args:
        viewpoint: The viewpoint.
        directions: (n, 3) unit vectors in camera coordinates.

    Returns:
        (n,) metres, infinite for the sky, and (n,) instance IDs.
    """
    viewpoint.owner_atlas.ensure(0)
    slot, band = viewpoint.depth_atlas.ensure(0), viewpoint.manifest.band
    pan_deg, tilt_deg = pan_tilt_deg(directions)
    down = (band.top_tilt_deg - tilt_deg) / (band.top_tilt_deg - band.bottom_tilt_deg)
    columns = slot.x + np.floor((pan_deg + 180.0) / 360.0 * slot.width).astype(int) % slot.width
    rows = slot.y + np.clip(np.floor(down * slot.height).astype(int), 0, slot.height - 1)
    metres = np.take(viewpoint.depth_metres, viewpoint.depth_atlas.sheet[rows, columns])
    return metres, viewpoint.owner_atlas.at(rows, columns)
