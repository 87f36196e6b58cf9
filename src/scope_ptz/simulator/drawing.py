"""Draw moving actors into an image. Layers of the static world are read only where an actor may be visible."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Projection, angle_between_deg, pan_tilt_deg
from scope_ptz.geometry.sphere import camera_axes
from scope_ptz.simulator.actors import ActorInView
from scope_ptz.simulator.clearance import TOLERANCE_FRACTION, TOLERANCE_M
from scope_ptz.simulator.mapping.grid import Grid, step_px
from scope_ptz.simulator.mapping.tiles import OUTLINE, Place, bounds
from scope_ptz.simulator.models import ActorSheet, Sprite
from scope_ptz.simulator.occlusion import outlined_depth_part, sharpening_reach_px
from scope_ptz.simulator.sprites.choice import Aspect, WeightedSprite, warp_matrix
from scope_ptz.simulator.viewpoint import Viewpoint

LARGE_PX = 16_000
"""In rectangles with more pixels than this, occlusion is computed at half resolution."""

MIN_SHRINK = 0.75
"""A sprite is shrunk before sampling, to prevent aliasing, if the view's pixel density is below this fraction of the sprite's."""

Floats = NDArray[np.float64]
Mask = NDArray[np.uint8]

_BEHIND = 1e-6
_VISIBLE, _HIDDEN = np.uint8(255), np.uint8(0)


@dataclass(frozen=True, slots=True)
class ActorPatch:
    """An actor's contribution to a part of an image: (h, w, 4) premultiplied colour."""

    place: Place
    colour: NDArray[np.uint8]

    def draw(self, image: NDArray[np.uint8]) -> None:
        """Blend the patch over an (H, W, 3) image, in place."""
        part = image[self.place]
        blended = cv2.cvtColor(cv2.bitwise_not(cv2.extractChannel(self.colour, 3)), cv2.COLOR_GRAY2RGB)
        cv2.multiply(part, blended, dst=blended, scale=1 / 255)
        cv2.add(blended, cv2.cvtColor(self.colour, cv2.COLOR_RGBA2RGB), dst=blended)
        part[...] = blended


def actor_patch(viewpoint: Viewpoint, projection: Projection, actor: ActorInView) -> ActorPatch | None:
    """Return the visible part of an actor in a view, or None if the actor is not visible."""
    selector = viewpoint.sprite_selector(actor.actor, actor.sheet)
    cosine = float(actor.offset_m @ projection.directions((0.5, 0.5)) / np.linalg.norm(actor.offset_m))
    if math.degrees(math.acos(max(-1.0, min(1.0, cosine)))) > projection.max_off_axis_deg + selector.reach_deg(actor.offset_m):
        return None
    now = Aspect(actor.offset_m, selector.heading(actor.path_s))
    layers = [_Layer.of(viewpoint, actor, weighted, now) for weighted in selector.choose(now, actor.phase)]
    place = _place(layers, projection)
    if place is None:
        return None
    grid = Grid(projection, step_px(projection), place)
    rays = grid.directions()
    colours = [layer.colour(viewpoint, grid, rays, projection) for layer in layers]
    alpha = cv2.extractChannel(colours[0], 3)
    for colour in colours[1:]:
        alpha = cv2.max(alpha, cv2.extractChannel(colour, 3))
    x, y, width, height = cv2.boundingRect(alpha)
    if not width:
        return None
    inner = slice(y, y + height), slice(x, x + width)
    part = slice(place[0].start + y, place[0].start + y + height), slice(place[1].start + x, place[1].start + x + width)
    colours = [colour[inner] for colour in colours]
    steepest_rise = min(1.0, float(np.abs(rays[..., 2]).max()))
    _remove_hidden(viewpoint, projection, part, actor, layers, colours, alpha[inner], steepest_rise)
    total = colours[0] if len(layers) == 1 else cv2.addWeighted(colours[0], layers[0].weight, colours[1], layers[1].weight, 0)
    return ActorPatch(part, np.asarray(total))


def _remove_hidden(
    viewpoint: Viewpoint,
    projection: Projection,
    part: Place,
    actor: ActorInView,
    layers: Sequence[_Layer],
    colours: Sequence[NDArray[np.uint8]],
    alpha: Mask,
    steepest_rise: float,
) -> None:
    """Set each layer's colour to 0 in the pixels where the actor or its shadow is hidden."""
    uncertain = viewpoint.clearance.find_uncertain_part(
        projection,
        part,
        alpha,
        steepest_rise=steepest_rise,
        reach_px=sharpening_reach_px(viewpoint, projection),
        far_m=max(layer.farthest_m(viewpoint) for layer in layers),
        ground_m=float(actor.offset_m[2]),
    )
    if uncertain is None:
        return
    alpha = alpha[uncertain]
    (top, left), (height, width) = (span.start for span in uncertain), alpha.shape
    inner = slice(part[0].start + top, part[0].start + top + height), slice(part[1].start + left, part[1].start + left + width)
    masks = _visible_masks(viewpoint, projection, inner, actor, layers, alpha)
    for mask, colour in zip(masks, colours, strict=True):
        colour[uncertain] = cv2.multiply(colour[uncertain], cv2.merge([mask] * 4), scale=1 / 255)


def _visible_masks(
    viewpoint: Viewpoint, projection: Projection, part: Place, actor: ActorInView, layers: Sequence[_Layer], alpha: Mask
) -> list[Mask]:
    """Return, for each layer, a mask of the pixels in a part of a view: 255 where the actor or its shadow is not hidden.

    Large parts are computed at half resolution and interpolated, so their occlusion edges are soft and accurate to two pixels.
    """
    grid = Grid(projection, step_px(projection), part)
    rays, stride = grid.directions(), 2 if alpha.size > LARGE_PX else 1
    every = slice(None, None, stride)
    static_m = outlined_depth_part(viewpoint, projection, part, alpha, stride)
    cv2.addWeighted(static_m, 1 + TOLERANCE_FRACTION, static_m, 0, TOLERANCE_M, dst=static_m)
    on_ground = _visible_ground(grid.to_pixels(rays[..., 2])[every, every], float(actor.offset_m[2]), static_m)
    masks = [
        layer.visible_mask(viewpoint, grid.to_pixels(layer.positions(rays))[every, every], static_m, on_ground) for layer in layers
    ]
    if stride == 1:
        return masks
    size = alpha.shape[1], alpha.shape[0]
    return [np.asarray(cv2.resize(mask, size, interpolation=cv2.INTER_LINEAR)) for mask in masks]


def _visible_ground(drop: NDArray[np.float32], height_m: float, static_m: NDArray[np.float32]) -> Mask:
    """Return a mask of the pixels in which the static world is not nearer than the ground under the actor's shadow.

    Args:
        drop: (h, w) vertical components of the unit vectors through the pixels.
        height_m: Height of the ground relative to the optical centre.
        static_m: (h, w) distances to the static world.
    """
    # The distance to the ground is height / drop. Both are negative below the horizon, which reverses the comparison.
    reached = static_m * drop
    return np.where(reached <= height_m if height_m < 0 else reached >= height_m, _VISIBLE, _HIDDEN)


@dataclass(frozen=True, slots=True)
class _Layer:
    """A sprite that is drawn into a view.

    Attributes:
        sheet: The actor's sheet.
        sprite: The sprite.
        weight: The sprite's weight in the blend of sprites, from 0 to 1.
        scale: The actor's apparent size relative to its size in the sprite.
        density: The sprite's pixels per radian at the size at which it is drawn.
        to_sprite: (3, 3) homography from directions to sprite pixels.
        box: Rectangle (left, top, width, height) of the sprite's pixels that are not empty.
    """

    sheet: ActorSheet
    sprite: Sprite
    weight: float
    scale: float
    density: float
    to_sprite: Floats
    box: tuple[int, int, int, int]

    @classmethod
    def of(cls, viewpoint: Viewpoint, actor: ActorInView, weighted: WeightedSprite, now: Aspect) -> _Layer:
        sprite, stored_m, current_m = weighted.sprite, weighted.aspect.offset_m, actor.offset_m
        scale = float(np.linalg.norm(stored_m) / np.linalg.norm(current_m))
        focal_px = sprite.width / 2 / math.tan(math.radians(sprite.hfov_deg / 2))
        # In the image plane of a camera aimed at the actor's ground point, the sprite is scaled and warped about that point.
        plane = np.eye(3)
        plane[:2, :2] = np.linalg.inv(scale * warp_matrix(actor.actor, weighted.aspect, now))
        current_axes, stored_axes = (camera_axes(*map(float, pan_tilt_deg(m))) for m in (current_m, stored_m))
        pixels = np.array([[focal_px, 0.0, sprite.width / 2], [0.0, -focal_px, sprite.height / 2], [0.0, 0.0, 1.0]])
        to_sprite = pixels @ camera_axes(sprite.pan_deg, sprite.tilt_deg) @ stored_axes.T @ plane @ current_axes
        box = viewpoint.sprites.box(actor.sheet, sprite)
        return cls(actor.sheet, sprite, weighted.weight, scale, focal_px * scale, to_sprite, box)

    def outline(self) -> Floats:
        """Return (n, 3) directions around the sprite's box."""
        left, top, width, height = self.box
        pixels = np.column_stack([OUTLINE * (width + 2, height + 2) + (left - 1, top - 1), np.ones(len(OUTLINE))])
        rays = pixels @ np.linalg.inv(self.to_sprite).T
        return np.asarray(rays / np.linalg.norm(rays, axis=-1, keepdims=True))

    def positions(self, rays: Floats, size: tuple[float, float] = (1.0, 1.0)) -> Floats:
        """Return the (h, w, 2) sprite positions for (h, w, 3) directions. Directions behind the camera get positions far outside.

        Args:
            rays: Directions in camera coordinates.
            size: Width and height of the sprite that is sampled, relative to the stored one.
        """
        pixels = rays @ self.to_sprite.T
        ahead = pixels[..., 2]
        behind = ahead <= _BEHIND
        positions = pixels[..., :2] * size / np.where(behind, 1.0, ahead)[..., None] - 0.5
        positions[behind] = -1e4
        return np.asarray(positions)

    def colour(self, viewpoint: Viewpoint, grid: Grid, rays: Floats, projection: Projection) -> NDArray[np.uint8]:
        """Return the sprite's (h, w, 4) premultiplied colour in the part of a view that a grid covers."""
        colour = viewpoint.sprites.colour(self.sheet, self.sprite)
        height, width = colour.shape[:2]
        shrink = projection.pixels_per_radian / self.density
        if shrink < MIN_SHRINK:
            size = max(1, round(width * shrink)), max(1, round(height * shrink))
            colour = viewpoint.sprites.shrunk_colour(self.sheet, self.sprite, *size)
        where = grid.to_pixels(self.positions(rays, (colour.shape[1] / width, colour.shape[0] / height)))
        return np.asarray(cv2.remap(colour, where, None, cv2.INTER_LINEAR, borderValue=(0, 0, 0, 0)))

    def farthest_m(self, viewpoint: Viewpoint) -> float:
        """Return the distance to the actor's farthest point, not counting its shadow."""
        return float(viewpoint.depth_metres[viewpoint.sprites.farthest_code(self.sheet, self.sprite)]) / self.scale

    def visible_mask(
        self, viewpoint: Viewpoint, where: NDArray[np.float32], static_m: NDArray[np.float32], on_ground: Mask
    ) -> Mask:
        """Return a mask of the pixels where the actor or its shadow is not hidden."""
        codes = cv2.remap(viewpoint.sprites.distances(self.sheet, self.sprite), where, None, cv2.INTER_NEAREST, borderValue=0.0)
        in_front = np.take(viewpoint.depth_metres, codes) <= static_m * np.float32(self.scale)
        return np.where(codes > 0, np.where(in_front, _VISIBLE, _HIDDEN), on_ground)


def _place(layers: Sequence[_Layer], projection: Projection) -> Place | None:
    """Return the rows and columns of a view that the layers cover; None if all layers are outside the view."""
    rays = np.stack([layer.outline() for layer in layers])
    outlines = projection.points(rays)
    if np.isnan(outlines).any():  # partly behind the camera
        centres = rays.mean(axis=1)
        reach_deg = angle_between_deg(rays, centres[:, None]).max(axis=1)
        near = angle_between_deg(centres, projection.directions((0.5, 0.5))) <= reach_deg + projection.max_off_axis_deg
        outlines = outlines[near]
    places = [p for p in bounds(projection, outlines) if p[0].start < p[0].stop and p[1].start < p[1].stop]
    if not places:
        return None
    rows, columns = (slice(min(s.start for s in spans), max(s.stop for s in spans)) for spans in zip(*places, strict=True))
    return rows, columns
