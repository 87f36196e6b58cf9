"""Which sprites show an actor best, how they are bent to its present aspect, and how one fades into the next."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import angle_between_deg, pan_tilt_deg
from scope_ptz.geometry.sphere import camera_axes
from scope_ptz.simulator.models import SceneActor, Sprite, Vec3

SAME_HEADING_DEG = 15.0
"""Largest difference in degrees between an actor's heading now and in its sprite. Beyond it, the light would be wrong."""

DEGREES_PER_OCTAVE = 6.0
"""A sprite taken at half or twice the distance is as unsuitable as one seen from this many degrees aside."""

FADE_SHARE = 0.12
"""Half the share of the way between two sprites on which one fades into the other."""

FADE_DEG = 12.0
"""Sprites further apart than this fade faster, in inverse proportion, because a fade shows both at once."""

MAX_STRETCH = 1.25
"""Limit on how much a sprite is stretched or squeezed to the present aspect of its actor."""

STIFFNESS = 0.02
"""Weight of leaving a sprite as it is, relative to the squared size of the actor in it."""

Floats = NDArray[np.float64]


class Aspect(NamedTuple):
    """How an actor is seen: (3,) offset of its ground point from the optical centre, in metres, and its (3,) heading, a unit vector
    on the ground. Both are in the camera's own frame."""

    offset_m: Floats
    heading: Floats


class Weighted(NamedTuple):
    """A sprite, the aspect of the actor in it, and its share in the picture, 0 to 1."""

    sprite: Sprite
    aspect: Aspect
    weight: float


class SpriteChoice:
    """Chooses among the sprites of one actor.

    Args:
        actor: The actor.
        sprites: Its sprites. Those that name the same picture for several times count once.
        offset: Turns world points into offsets from the optical centre.
        world_to_camera: (3, 3) rotation from world axes to the camera's own frame.
    """

    def __init__(
        self, actor: SceneActor, sprites: Sequence[Sprite], offset: Callable[[Floats], Floats], world_to_camera: Floats
    ) -> None:
        self._turn = world_to_camera
        self._path = np.array(actor.waypoints, dtype=np.float64)
        places: dict[Vec3, dict[tuple[int, int], Sprite]] = {}
        for sprite in sorted(sprites, key=self._away_m):
            pictures = places.setdefault(sprite.position_m, {})
            pictures.setdefault((sprite.left, sprite.top), sprite)
        self._places = [list(pictures.values()) for pictures in places.values()]
        self._offsets = offset(np.array(list(places)))
        self._headings = np.stack([self.heading(pictures[0].path_s) for pictures in self._places])

    def heading(self, path_s: float) -> Floats:
        """Return the (3,) direction in which the actor faces at a time of its path, in the camera's own frame."""
        leg = int(np.clip(np.searchsorted(self._path[:, 0], path_s, side="right") - 1, 0, len(self._path) - 2))
        step = self._path[leg + 1, 1:3] - self._path[leg, 1:3]
        bearing = math.atan2(step[0], step[1])  # north for an actor that stands still
        return np.asarray(self._turn @ np.array([math.sin(bearing), math.cos(bearing), 0.0]))

    def choose(self, now: Aspect, phase: float) -> list[Weighted]:
        """Return the one or two sprites that show the actor best, with shares that add up to 1.

        Args:
            now: How the actor is seen at present.
            phase: The present phase of the stride.
        """
        unsuitable = self._unsuitability(now)
        order = np.argsort(unsuitable, kind="stable")[:2].tolist()
        share = 0.0
        if len(order) == 2 and math.isfinite(unsuitable[order[1]]):
            apart = max(1e-9, float(unsuitable[order].sum()))
            fade = FADE_SHARE * min(1.0, FADE_DEG / apart)
            closeness = max(0.0, (float(unsuitable[order[0]]) / apart - (0.5 - fade)) / (2 * fade))
            share = closeness * closeness * (3 - 2 * closeness)
        shares = [1.0 - share, share]
        return [self._weighted(place, phase, weight) for place, weight in zip(order, shares, strict=False) if weight > 0]

    def _unsuitability(self, now: Aspect) -> Floats:
        """Return how badly the sprites of each place suit, in degrees of viewing angle."""
        octaves = np.log2(np.linalg.norm(self._offsets, axis=-1) / float(np.linalg.norm(now.offset_m)))
        value = angle_between_deg(self._offsets, now.offset_m) + DEGREES_PER_OCTAVE * np.abs(octaves)
        another = self._headings @ now.heading < math.cos(math.radians(SAME_HEADING_DEG))
        return np.where(another & ~another.all(), np.inf, value)

    def _weighted(self, place: int, phase: float, weight: float) -> Weighted:
        sprite = min(self._places[place], key=lambda s: min(abs(s.phase - phase), 1.0 - abs(s.phase - phase)))
        return Weighted(sprite, Aspect(self._offsets[place], self._headings[place]), weight)

    def _away_m(self, sprite: Sprite) -> float:
        """Return how far the actor is from where a sprite shows it, at the sprite's time."""
        there = [np.interp(sprite.path_s, self._path[:, 0], self._path[:, axis]) for axis in (1, 2, 3)]
        return float(np.linalg.norm(np.array(there) - sprite.position_m))


def bend(actor: SceneActor, stored: Aspect, now: Aspect) -> Floats:
    """Return the (2, 2) matrix that bends a sprite about its ground point to the present aspect of its actor.

    It is the best linear map (right, up) from the actor's length, width and height as they appear in the sprite to
    how they appear now. It turns a bicycle seen from above into the direction in which it rides, and shortens what is seen from
    further above. Size is left alone: the sprite is scaled by distance.
    """
    width, length, height = actor.size_m
    then, present = (_projected(aspect, length, width, height) for aspect in (stored, now))
    stiff = STIFFNESS * float((then**2).sum()) * np.eye(2)
    fitted = (present @ then.T + stiff) @ np.linalg.inv(then @ then.T + stiff)
    left, stretch, right = np.linalg.svd(fitted)
    return np.asarray(left @ np.diag(np.clip(stretch, 1 / MAX_STRETCH, MAX_STRETCH)) @ right)


def _projected(aspect: Aspect, length: float, width: float, height: float) -> Floats:
    """Return (2, 3): half the length, half the width and the height of an actor, right and up as seen from the optical centre."""
    pan, tilt = (float(a) for a in pan_tilt_deg(aspect.offset_m))
    up = np.array([0.0, 0.0, 1.0])
    box = np.stack([aspect.heading * length / 2, np.cross(aspect.heading, up) * width / 2, up * height])
    return np.asarray(camera_axes(pan, tilt)[:2] @ box.T)
