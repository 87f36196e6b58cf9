"""Select the sprites that show an actor best, warp them to its current aspect, and fade between them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Perspective, angle_between_deg, pan_tilt_deg
from scope_ptz.geometry.sphere import camera_axes
from scope_ptz.simulator.models import SceneActor, Sprite, Vec3

SAME_HEADING_DEG = 15.0
"""Maximum difference, in degrees, between an actor's heading and its heading in a sprite. Beyond it, the lighting is wrong."""

DEGREES_PER_OCTAVE = 6.0
"""A sprite rendered at half or twice the distance counts as if its viewing angle differed by this many degrees."""

FADE_FRACTION = 0.12
"""Half the width of the fade between two sprites, as a fraction of the difference between their viewing angles."""

FADE_DEG = 12.0
"""Sprites that differ by more degrees than this fade proportionally faster, because blending them would show a double image."""

MAX_STRETCH = 1.25
"""Maximum factor by which a sprite is stretched or compressed to match the actor's current aspect."""

REGULARIZATION_WEIGHT = 0.02
"""Weight of the unwarped sprite in the least-squares fit in ``warp_matrix``, relative to the actor's squared size in the sprite."""

Floats = NDArray[np.float64]


class Aspect(NamedTuple):
    """An actor's position and heading in camera coordinates.

    ``offset_m`` is the (3,) offset from the optical centre to the actor's ground point in metres. ``heading`` is a horizontal (3,)
    unit vector.
    """

    offset_m: Floats
    heading: Floats


class WeightedSprite(NamedTuple):
    """A sprite, the actor's aspect in it, and the sprite's weight in the picture, from 0 to 1."""

    sprite: Sprite
    aspect: Aspect
    weight: float


class SpriteSelector:
    """Selects one actor's sprites for a view.

    Args:
        actor: The actor.
        sprites: The actor's sprites. Sprites that share a picture are counted once.
        offset: Converts world points to offsets from the optical centre.
        world_to_camera: (3, 3) rotation from world axes to camera coordinates.
    """

    def __init__(
        self, actor: SceneActor, sprites: Sequence[Sprite], offset: Callable[[Floats], Floats], world_to_camera: Floats
    ) -> None:
        self._rotation = world_to_camera
        self._path = np.array(actor.waypoints, dtype=np.float64)
        places: dict[Vec3, dict[tuple[int, int], Sprite]] = {}
        for sprite in sorted(sprites, key=self._path_error_m):
            pictures = places.setdefault(sprite.position_m, {})
            pictures.setdefault((sprite.left, sprite.top), sprite)
        self._places = [list(pictures.values()) for pictures in places.values()]
        self._offsets = offset(np.array(list(places)))
        self._headings = np.stack([self.heading(pictures[0].path_s) for pictures in self._places])
        self._reach_m = max(
            _reach_m(picture, offset_m)
            for pictures, offset_m in zip(self._places, self._offsets, strict=True)
            for picture in pictures
        )

    def heading(self, path_s: float) -> Floats:
        """Return the (3,) direction in which the actor faces at a given path time, in camera coordinates."""
        leg = int(np.clip(np.searchsorted(self._path[:, 0], path_s, side="right") - 1, 0, len(self._path) - 2))
        step = self._path[leg + 1, 1:3] - self._path[leg, 1:3]
        bearing = math.atan2(step[0], step[1])  # north (0) for an actor that does not move
        return np.asarray(self._rotation @ np.array([math.sin(bearing), math.cos(bearing), 0.0]))

    def reach_deg(self, offset_m: Floats) -> float:
        """Return the largest angle between the actor's ground point, which lies at ``offset_m``, and any pixel in its sprites."""
        return math.degrees(math.atan2(MAX_STRETCH * self._reach_m, float(np.linalg.norm(offset_m))))

    def choose(self, now: Aspect, phase: float) -> list[WeightedSprite]:
        """Return the one or two sprites that show the actor best, with weights that add up to 1.

        Args:
            now: The actor's current aspect.
            phase: The current phase of the stride.
        """
        cost = self._mismatch(now)
        order = np.argsort(cost, kind="stable")[:2].tolist()
        second_weight = 0.0
        if len(order) == 2 and math.isfinite(cost[order[1]]):
            total = max(1e-9, float(cost[order].sum()))
            fade = FADE_FRACTION * min(1.0, FADE_DEG / total)
            closeness = max(0.0, (float(cost[order[0]]) / total - (0.5 - fade)) / (2 * fade))
            second_weight = closeness * closeness * (3 - 2 * closeness)
        weights = [1.0 - second_weight, second_weight]
        return [self._weighted_sprite(place, phase, weight) for place, weight in zip(order, weights, strict=False) if weight > 0]

    def _mismatch(self, now: Aspect) -> Floats:
        """Return the mismatch between the sprites at each position and the current aspect, in degrees of viewing angle."""
        octaves = np.log2(np.linalg.norm(self._offsets, axis=-1) / float(np.linalg.norm(now.offset_m)))
        value = angle_between_deg(self._offsets, now.offset_m) + DEGREES_PER_OCTAVE * np.abs(octaves)
        wrong_heading = self._headings @ now.heading < math.cos(math.radians(SAME_HEADING_DEG))
        return np.where(wrong_heading & ~wrong_heading.all(), np.inf, value)

    def _weighted_sprite(self, place: int, phase: float, weight: float) -> WeightedSprite:
        sprite = min(self._places[place], key=lambda s: min(abs(s.phase - phase), 1.0 - abs(s.phase - phase)))
        return WeightedSprite(sprite, Aspect(self._offsets[place], self._headings[place]), weight)

    def _path_error_m(self, sprite: Sprite) -> float:
        """Return the distance between the actor's position at a sprite's time and the position stored in the sprite."""
        position = [np.interp(sprite.path_s, self._path[:, 0], self._path[:, axis]) for axis in (1, 2, 3)]
        return float(np.linalg.norm(np.array(position) - sprite.position_m))


def _reach_m(sprite: Sprite, offset_m: Floats) -> float:
    """Return the largest distance between a sprite's pixels and its ground point, perpendicular to the line of sight.

    The distance is infinite if the sprite extends about 90 degrees or more from its ground point.
    """
    view = Perspective(sprite.pan_deg, sprite.tilt_deg, sprite.hfov_deg, sprite.width, sprite.height)
    margin = np.array([2.0 / sprite.width, 2.0 / sprite.height])
    corners = view.directions(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]) * (1 + 2 * margin) - margin)
    reach_deg = float(angle_between_deg(corners, offset_m).max())
    return float(np.linalg.norm(offset_m)) * math.tan(math.radians(reach_deg)) if reach_deg < 89.0 else math.inf


def warp_matrix(actor: SceneActor, stored: Aspect, now: Aspect) -> Floats:
    """Return the (2, 2) matrix that warps a sprite about its ground point to the actor's current aspect.

    The matrix is the linear map, in (right, up) coordinates, that best fits the projections of the actor's length, width and height
    in the sprite to their current projections (least squares). For example, it rotates a bicycle seen from above into its current
    direction. It does not correct the size for distance, because the sprite is scaled separately.
    """
    width, length, height = actor.size_m
    sprite_box, current_box = (_project_box(aspect, length, width, height) for aspect in (stored, now))
    regularization = REGULARIZATION_WEIGHT * float((sprite_box**2).sum()) * np.eye(2)
    fitted = (current_box @ sprite_box.T + regularization) @ np.linalg.inv(sprite_box @ sprite_box.T + regularization)
    left, stretch, right = np.linalg.svd(fitted)
    return np.asarray(left @ np.diag(np.clip(stretch, 1 / MAX_STRETCH, MAX_STRETCH)) @ right)


def _project_box(aspect: Aspect, length: float, width: float, height: float) -> Floats:
    """Return the (2, 3) projections (right, up) of an actor's half length, half width and height, seen from the optical centre."""
    pan, tilt = (float(a) for a in pan_tilt_deg(aspect.offset_m))
    east, north, _ = aspect.heading.tolist()
    box = np.array([aspect.heading * length / 2, (north * width / 2, -east * width / 2, 0.0), (0.0, 0.0, height)])
    return np.asarray(camera_axes(pan, tilt)[:2] @ box.T)
