"""The geometry of a scene's texts as seen from one viewpoint, independent of the camera's pose."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection, angle_between_deg
from scope_ptz.simulator.clearance import TOLERANCE_FRACTION, TOLERANCE_M
from scope_ptz.simulator.models import SceneText
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.reproject import distances_m
from scope_ptz.simulator.viewpoint import Viewpoint

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

_ACROSS, _ALONG = np.meshgrid((np.arange(24) + 0.5) / 24 - 0.5, (np.arange(8) + 0.5) / 8 - 0.5)
CELLS = _ACROSS.size
"""Number of cells in the grid over a text's letters. The text is sampled at the cell centres."""


class TextGeometry:
    """The texts that face a viewpoint. This object does not refer to the viewpoint, so that the viewpoint's layers can be released.

    Attributes:
        texts: The texts that face the viewpoint.
        angle_deg: The angle between each text's normal and the line of sight, below 90.
        rays: (n, CELLS, 3) vectors in metres from the optical centre to each text's cells.
        capitals: (n, 2, 3) vectors to the bottom and the top of a capital letter in each text.
    """

    def __init__(self, texts: Iterable[SceneText], families: Mapping[str, frozenset[int]], viewpoint: Viewpoint) -> None:
        angles = [(text, _angle_deg(text, viewpoint)) for text in texts]
        self.texts = [text for text, angle_deg in angles if angle_deg < 90.0]
        self.angle_deg = [angle_deg for _, angle_deg in angles if angle_deg < 90.0]
        count = len(self.texts)
        self.rays = np.array([_cells(text, viewpoint) for text in self.texts]).reshape(count, CELLS, 3)
        self.capitals = np.array([_capital(text, viewpoint) for text in self.texts]).reshape(count, 2, 3)
        self._corners = np.array([_corners(text, viewpoint) for text in self.texts]).reshape(count, 4, 3)
        objects = {family: k for k, family in enumerate({families[text.parent] for text in self.texts})}
        self._object = np.array([objects[families[text.parent]] for text in self.texts], dtype=np.int64)
        self._object_of_instance = np.full(65536, -1, dtype=np.int64)
        for family, k in objects.items():
            self._object_of_instance[list(family)] = k
        self._measured = np.zeros(count, dtype=bool)
        self._nearer = np.zeros((count, CELLS), dtype=bool)
        self._owners = np.zeros((count, CELLS), dtype=np.uint16)

    def may_show(self, projection: Projection) -> Ints:
        """Return the indices of the texts whose corners do not all lie beyond one edge of an image."""
        points = projection.points(self._corners)
        with np.errstate(invalid="ignore"):
            beyond = np.any(np.all(points < 0, axis=1) | np.all(points > 1, axis=1), axis=-1)
        behind = np.isnan(points).all(axis=(1, 2))
        return np.flatnonzero(~beyond & ~behind)

    def unhidden_mask(self, viewpoint: Viewpoint, texts: Ints, cells: Ints, shown_ids: NDArray[np.uint16]) -> Flags:
        """Return a mask of the cells that are not hidden.

        Instance IDs show whether another object hides a text. Distances show whether a part of the same object hides it, such
        as a shop's awning in front of the name on its door.

        Args:
            viewpoint: The viewpoint that this geometry belongs to.
            texts: (n,) index of the text that each cell belongs to.
            cells: (n,) index of each cell in its text's grid.
            shown_ids: (n,) instance ID of the pixel that each cell falls into.
        """
        self._measure(viewpoint, np.unique(texts))
        same_object = self._object_of_instance[shown_ids] == self._object[texts]
        return np.asarray(same_object & ~(self._nearer[texts, cells] & (self._owners[texts, cells] == shown_ids)))

    def _measure(self, viewpoint: Viewpoint, texts: Ints) -> None:
        """Compare text cells with the depth layer, once for each text."""
        new = texts[~self._measured[texts]]
        if not new.size:
            return
        rays = self.rays[new].reshape(-1, 3)
        static_m, owners = distances_m(viewpoint, rays)
        nearer = static_m * (1 + TOLERANCE_FRACTION) + TOLERANCE_M < np.linalg.norm(rays, axis=-1)
        self._nearer[new], self._owners[new] = nearer.reshape(-1, CELLS), owners.reshape(-1, CELLS)
        self._measured[new] = True


_GEOMETRIES: WeakKeyDictionary[Viewpoint, WeakKeyDictionary[Scene, TextGeometry]] = WeakKeyDictionary()


def text_geometry(scene: Scene, viewpoint: Viewpoint) -> TextGeometry:
    """Return the geometry of a scene's texts as seen from a viewpoint. The result is cached."""
    by_scene = _GEOMETRIES.setdefault(viewpoint, WeakKeyDictionary())
    if scene not in by_scene:
        by_scene[scene] = TextGeometry(scene.file.texts, scene.families, viewpoint)
    return by_scene[scene]


def _axes(text: SceneText) -> Sequence[Floats]:
    """Return a text's centre and its right and up vectors."""
    return tuple(np.array(vector, dtype=np.float64) for vector in (text.centre_m, text.right, text.up))


def _angle_deg(text: SceneText, viewpoint: Viewpoint) -> float:
    centre, right, up = _axes(text)
    return float(angle_between_deg(np.cross(right, up), viewpoint.position_m - centre))


def _cells(text: SceneText, viewpoint: Viewpoint) -> Floats:
    centre, right, up = _axes(text)
    cells = centre + _ACROSS[..., None] * text.width_m * right + _ALONG[..., None] * text.height_m * up
    return viewpoint.offset(cells.reshape(-1, 3))


def _corners(text: SceneText, viewpoint: Viewpoint) -> Floats:
    centre, right, up = _axes(text)
    across, along = right * (text.width_m / 2), up * (text.height_m / 2)
    return viewpoint.offset(np.array([centre + a * across + b * along for a in (-1, 1) for b in (-1, 1)]))


def _capital(text: SceneText, viewpoint: Viewpoint) -> Floats:
    centre, _, up = _axes(text)
    return viewpoint.offset(centre + np.array([[-0.5], [0.5]]) * text.cap_height_m * up)
