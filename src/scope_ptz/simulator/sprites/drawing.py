"""Draw moving actors into a picture. Layers of the still world are read only where an actor may show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Perspective, Projection
from scope_ptz.simulator.actors import TOLERANCE_M, TOLERANCE_SHARE, Appearance, placed
from scope_ptz.simulator.mapping.grid import Grid, step_px
from scope_ptz.simulator.mapping.tiles import OUTLINE, Place, Tiles, bounds
from scope_ptz.simulator.occlusion import outlined_depth_part
from scope_ptz.simulator.sprites.choice import Aspect, Weighted, bend
from scope_ptz.simulator.viewpoint import Viewpoint

MIN_SHRINK = 0.75
"""Sprites are shrunk before they are sampled when the view is less dense than this share of theirs, which prevents aliasing."""

Floats = NDArray[np.float64]
Mask = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class ActorPatch:
    """What an actor adds to a part of a picture: (h, w, 4) premultiplied colour."""

    place: Place
    colour: NDArray[np.uint8]

    def draw(self, picture: NDArray[np.uint8]) -> None:
        """Blend the patch over an (H, W, 3) picture, in place."""
        part = picture[self.place]
        through = cv2.cvtColor(cv2.bitwise_not(cv2.extractChannel(self.colour, 3)), cv2.COLOR_GRAY2RGB)
        cv2.multiply(part, through, dst=through, scale=1 / 255)
        cv2.add(through, cv2.cvtColor(self.colour, cv2.COLOR_RGBA2RGB), dst=through)
        part[...] = through


def actor_patch(viewpoint: Viewpoint, projection: Projection, appearance: Appearance) -> ActorPatch | None:
    """Return an actor as it shows in a view, or None if nothing of it does."""
    choice = viewpoint.sprite_choice(appearance.actor, appearance.sheet)
    now = Aspect(appearance.offset_m, choice.heading(appearance.path_s))
    layers = [_Layer.of(viewpoint, appearance, weighted, now) for weighted in choice.choose(now, appearance.phase)]
    place = _place(layers, projection)
    if place is None:
        return None
    grid = Grid(projection, step_px(projection), place)
    maps = [layer.map(grid) for layer in layers]
    if not maps or any(where is None for where in maps):
        return None
    wheres = [where for where in maps if where is not None]
    colours = [layer.colour(viewpoint, where, projection) for layer, where in zip(layers, wheres, strict=True)]
    alpha = np.maximum.reduce([colour[..., 3] for colour in colours])
    x, y, width, height = cv2.boundingRect(alpha)
    if not width:
        return None
    inner = slice(y, y + height), slice(x, x + width)
    part = slice(place[0].start + y, place[0].start + y + height), slice(place[1].start + x, place[1].start + x + width)
    still_m = outlined_depth_part(viewpoint, projection, part, alpha[inner])
    still_m *= np.float32(1 + TOLERANCE_SHARE)
    still_m += np.float32(TOLERANCE_M)
    on_ground = _ground_shows(grid, part, float(appearance.offset_m[2]), still_m)
    total = np.zeros((height, width, 4), np.uint8)
    for layer, where, colour in zip(layers, wheres, colours, strict=True):
        shows = layer.shows(viewpoint, np.ascontiguousarray(where[inner]), still_m, on_ground)
        over = cv2.bitwise_and(colour[inner], colour[inner], mask=shows)
        total = over if len(layers) == 1 else cv2.addWeighted(total, 1.0, over, layer.weight, 0)
    return ActorPatch(part, np.asarray(total))


def _ground_shows(grid: Grid, part: Place, height_m: float, still_m: NDArray[np.float32]) -> Mask:
    """Return where the still world is no nearer than the ground on which the actor's shadow falls."""
    # The ground is height / drop away. Both are negative below the horizon, which turns the comparison round.
    drop = grid.to_pixels(grid.directions()[..., 2], part)
    with np.errstate(invalid="ignore"):
        reached = still_m * drop
    return np.asarray(cv2.compare(reached, height_m, cv2.CMP_LE if height_m < 0 else cv2.CMP_GE))


@dataclass(frozen=True, slots=True)
class _Layer:
    """A sprite as it is drawn: the view that it fills, its ground point in its own pixels, and the bend about that point."""

    appearance: Appearance
    weight: float
    foot_px: Floats
    bend: Floats

    @classmethod
    def of(cls, viewpoint: Viewpoint, appearance: Appearance, weighted: Weighted, now: Aspect) -> _Layer:
        drawn = placed(viewpoint, appearance, weighted.sprite)
        size = drawn.sprite.width, drawn.sprite.height
        foot_px = drawn.view.points(drawn.offset_m) * size
        return cls(drawn, weighted.weight, np.asarray(foot_px), bend(appearance.actor, weighted.aspect, now))

    @property
    def view(self) -> Perspective:
        return self.appearance.view

    def outline(self) -> Floats:
        """Return (n, 3) directions around the bent sprite."""
        size = np.array([self.view.width, self.view.height])
        bent = (OUTLINE * size - self.foot_px) @ self.bend.T + self.foot_px
        return self.view.directions(bent / size)

    def map(self, grid: Grid) -> NDArray[np.float32] | None:
        """Return the (h, w, 2) position in the sprite of each pixel that the grid covers, or None if the sprite is out of view."""
        tiles = Tiles([self.view])
        showing = next(iter(tiles.in_view(grid.projection)), None)
        if showing is None:
            return None
        size = np.array([self.view.width, self.view.height])
        nodes = tiles.points(showing, grid.projection, grid.x, grid.y) * size
        return grid.to_pixels((nodes - self.foot_px) @ np.linalg.inv(self.bend).T + self.foot_px - 0.5)

    def colour(self, viewpoint: Viewpoint, where: NDArray[np.float32], projection: Projection) -> NDArray[np.uint8]:
        """Return the sprite's (h, w, 4) premultiplied colour at the points of a map."""
        colour = viewpoint.sprites.colour(self.appearance.sheet, self.appearance.sprite)
        shrink = projection.density / self.view.focal_px
        if shrink < MIN_SHRINK:
            size = max(1, round(colour.shape[1] * shrink)), max(1, round(colour.shape[0] * shrink))
            factor = np.array([size[0] / colour.shape[1], size[1] / colour.shape[0]], dtype=np.float32)
            colour = cv2.resize(colour, size, interpolation=cv2.INTER_AREA)
            where = (where + np.float32(0.5)) * factor - np.float32(0.5)
        return np.asarray(cv2.remap(colour, where, None, cv2.INTER_LINEAR, borderValue=(0, 0, 0, 0)))

    def shows(self, viewpoint: Viewpoint, where: NDArray[np.float32], still_m: NDArray[np.float32], on_ground: Mask) -> Mask:
        """Return where nothing hides the actor or its shadow."""
        codes = viewpoint.sprites.distances(self.appearance.sheet, self.appearance.sprite)
        metres = viewpoint.depth_metres[codes]
        metres[codes == 0] = 0.0
        own_m = cv2.remap(metres, where, None, cv2.INTER_NEAREST, borderValue=0.0)
        own = cv2.compare(own_m, 0, cv2.CMP_GT)
        before = cv2.compare(own_m, still_m * np.float32(self.appearance.scale), cv2.CMP_LE)
        return np.asarray(cv2.copyTo(before, own, on_ground.copy()))


def _place(layers: Sequence[_Layer], projection: Projection) -> Place | None:
    """Return the rows and columns of a view in which any of the layers shows."""
    outlines = projection.points(np.stack([layer.outline() for layer in layers]))
    places = [p for p in bounds(projection, outlines) if p[0].start < p[0].stop and p[1].start < p[1].stop]
    if not places:
        return None
    rows, columns = (slice(min(s.start for s in spans), max(s.stop for s in spans)) for spans in zip(*places, strict=True))
    return rows, columns
