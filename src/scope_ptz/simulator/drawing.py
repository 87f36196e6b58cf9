"""Draw moving actors into an image. Layers of the static world are read only where an actor may be visible."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Perspective, Projection, angle_between_deg, pan_tilt_deg
from scope_ptz.geometry.sphere import camera_axes
from scope_ptz.simulator.actors import TOLERANCE_FRACTION, TOLERANCE_M, ActorInView
from scope_ptz.simulator.mapping.grid import Grid, step_px
from scope_ptz.simulator.mapping.tiles import OUTLINE, Place, bounds
from scope_ptz.simulator.models import ActorSheet, Sprite
from scope_ptz.simulator.occlusion import outlined_depth_part
from scope_ptz.simulator.sprites.choice import Aspect, WeightedSprite, warp_matrix
from scope_ptz.simulator.viewpoint import Viewpoint

LARGE_PX = 120_000
"""For actors that cover more pixels than this, occlusion is computed at half resolution."""

MIN_SHRINK = 0.75
"""A sprite is shrunk before sampling, to prevent aliasing, if the view's pixel density is below this fraction of the sprite's."""

Floats = NDArray[np.float64]
Mask = NDArray[np.uint8]

_BEHIND = 1e-6


@dataclass(frozen=True, slots=True)
class ActorPatch:
    """An actor's contribution to a part of an image: (h, w, 4) premultiplied colour."""

    place: Place
    colour: NDArray[np.uint8]

    def draw(self, image: NDArray[np.uint8]) -> None:
        """Blend the patch over an (H, W, 3) image, in place."""
        part = image[self.place]
        through = cv2.cvtColor(cv2.bitwise_not(cv2.extractChannel(self.colour, 3)), cv2.COLOR_GRAY2RGB)
        cv2.multiply(part, through, dst=through, scale=1 / 255)
        cv2.add(through, cv2.cvtColor(self.colour, cv2.COLOR_RGBA2RGB), dst=through)
        part[...] = through


def actor_patch(viewpoint: Viewpoint, projection: Projection, actor: ActorInView) -> ActorPatch | None:
    """Return the visible part of an actor in a view, or None if it is not visible."""
    choice = viewpoint.sprite_choice(actor.actor, actor.sheet)
    if angle_between_deg(actor.offset_m, projection.directions((0.5, 0.5))) > projection.max_off_axis_deg + choice.reach_deg(
        actor.offset_m
    ):
        return None
    now = Aspect(actor.offset_m, choice.heading(actor.path_s))
    layers = [_Layer.of(viewpoint, actor, weighted, now) for weighted in choice.choose(now, actor.phase)]
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
    masks = _visible_masks(viewpoint, projection, part, actor, layers, alpha[inner])
    total = np.zeros((height, width, 4), np.uint8)
    for layer, shows, colour in zip(layers, masks, colours, strict=True):
        over = cv2.bitwise_and(colour[inner], colour[inner], mask=shows)
        total = over if len(layers) == 1 else cv2.addWeighted(total, 1.0, over, layer.weight, 0)
    return ActorPatch(part, np.asarray(total))


def _visible_masks(
    viewpoint: Viewpoint, projection: Projection, part: Place, actor: ActorInView, layers: Sequence[_Layer], alpha: Mask
) -> list[Mask]:
    """Return, for each layer, a mask of the pixels in a part of a view where the actor or its shadow is not hidden.

    Large parts are computed at half resolution, so occlusion edges on an actor that fills the view are accurate to two pixels.
    """
    height, width = alpha.shape
    if isinstance(projection, Perspective) and height * width > LARGE_PX and not (projection.width % 2 or projection.height % 2):
        half = Perspective(
            projection.pan_deg, projection.tilt_deg, projection.hfov_deg, projection.width // 2, projection.height // 2
        )
        rows, columns = (slice(span.start // 2, -(-span.stop // 2)) for span in part)
        size = columns.stop - columns.start, rows.stop - rows.start
        y, x = part[0].start - 2 * rows.start, part[1].start - 2 * columns.start
        small = cv2.resize(alpha, size, interpolation=cv2.INTER_AREA)
        masks = _visible_masks(viewpoint, half, (rows, columns), actor, layers, small)
        grown = (cv2.resize(mask, (2 * size[0], 2 * size[1]), interpolation=cv2.INTER_NEAREST) for mask in masks)
        return [mask[y : y + height, x : x + width] for mask in grown]
    grid = Grid(projection, step_px(projection), part)
    rays = grid.directions()
    static_m = outlined_depth_part(viewpoint, projection, part, alpha)
    cv2.addWeighted(static_m, 1 + TOLERANCE_FRACTION, static_m, 0, TOLERANCE_M, dst=static_m)
    on_ground = _visible_ground(grid.to_pixels(rays[..., 2]), float(actor.offset_m[2]), static_m)
    return [layer.visible_mask(viewpoint, grid.to_pixels(layer.positions(rays)), static_m, on_ground) for layer in layers]


def _visible_ground(drop: NDArray[np.float32], height_m: float, static_m: NDArray[np.float32]) -> Mask:
    """Return a mask of the pixels where the static world is not nearer than the ground on which the actor's shadow falls.

    Args:
        drop: (h, w) vertical components of the unit vectors through the pixels.
        height_m: Height of the ground relative to the optical centre.
        static_m: (h, w) distances of the static world.
    """
    # The distance to the ground is height / drop. Both are negative below the horizon, which reverses the comparison.
    reached = cv2.multiply(static_m, drop)
    return np.asarray(reached <= height_m if height_m < 0 else reached >= height_m).view(np.uint8)


@dataclass(frozen=True, slots=True)
class _Layer:
    """A sprite that is drawn into a view.

    Attributes:
        sheet: The actor's sheet.
        sprite: The sprite.
        weight: Its weight in the blend of sprites, 0 to 1.
        scale: How many times larger the actor appears than in the sprite.
        density: The sprite's pixels per radian at the size at which it is drawn.
        to_sprite: (3, 3) homography from directions to pixels of the sprite.
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
        sprite, then_m, now_m = weighted.sprite, weighted.aspect.offset_m, actor.offset_m
        scale = float(np.linalg.norm(then_m) / np.linalg.norm(now_m))
        focal_px = sprite.width / 2 / math.tan(math.radians(sprite.hfov_deg / 2))
        # In the image plane of a camera aimed at the actor's ground point, the sprite is scaled and warped about that point.
        plane = np.eye(3)
        plane[:2, :2] = np.linalg.inv(scale * warp_matrix(actor.actor, weighted.aspect, now))
        looking_now, looking_then = (camera_axes(*map(float, pan_tilt_deg(m))) for m in (now_m, then_m))
        pixels = np.array([[focal_px, 0.0, sprite.width / 2], [0.0, -focal_px, sprite.height / 2], [0.0, 0.0, 1.0]])
        to_sprite = pixels @ camera_axes(sprite.pan_deg, sprite.tilt_deg) @ looking_then.T @ plane @ looking_now
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

    def visible_mask(
        self, viewpoint: Viewpoint, where: NDArray[np.float32], static_m: NDArray[np.float32], on_ground: Mask
    ) -> Mask:
        """Return a mask of the pixels where the actor or its shadow is not hidden."""
        codes = cv2.remap(viewpoint.sprites.distances(self.sheet, self.sprite), where, None, cv2.INTER_NEAREST, borderValue=0.0)
        before = np.take(viewpoint.depth_metres, codes) <= static_m * np.float32(self.scale)
        return np.where(codes > 0, before.view(np.uint8), on_ground)


def _place(layers: Sequence[_Layer], projection: Projection) -> Place | None:
    """Return the rows and columns of a view that the layers cover; None if all are outside."""
    rays = np.stack([layer.outline() for layer in layers])
    middles = rays.mean(axis=1)
    reach_deg = angle_between_deg(rays, middles[:, None]).max(axis=1)
    near = angle_between_deg(middles, projection.directions((0.5, 0.5))) <= reach_deg + projection.max_off_axis_deg
    if not near.any():
        return None
    outlines = projection.points(rays[near])
    places = [p for p in bounds(projection, outlines) if p[0].start < p[0].stop and p[1].start < p[1].stop]
    if not places:
        return None
    rows, columns = (slice(min(s.start for s in spans), max(s.stop for s in spans)) for spans in zip(*places, strict=True))
    return rows, columns
