"""A small world that can be ray-cast exactly: ground, sky, balls and blocks. It is the reference for all stored layers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Ball:
    number: int
    centre: tuple[float, float, float]
    radius: float
    colour: tuple[float, float, float]

    def hit(self, origin: Floats, rays: Floats) -> Floats:
        """Return the distances along unit rays (n, 3), infinite for misses."""
        offset = origin - np.array(self.centre)
        b = rays @ offset
        root = b**2 - (offset @ offset - self.radius**2)
        with np.errstate(invalid="ignore"):
            t = -b - np.sqrt(root)
        return np.where((root > 0) & (t > 0), t, np.inf)

    @property
    def box(self) -> tuple[Floats, Floats]:
        return np.array(self.centre) - self.radius, np.array(self.centre) + self.radius

    def outline(self, origin: Floats) -> Floats:
        """Return points (n, 3) whose convex hull is the silhouette."""
        return _ring(np.array(self.centre) - origin, self.radius) + origin


@dataclass(frozen=True)
class Block:
    number: int
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    colour: tuple[float, float, float]

    def hit(self, origin: Floats, rays: Floats) -> Floats:
        with np.errstate(divide="ignore", invalid="ignore"):
            a, b = (np.array(self.low) - origin) / rays, (np.array(self.high) - origin) / rays
        near, far = np.minimum(a, b).max(axis=-1), np.maximum(a, b).min(axis=-1)
        return np.where((near < far) & (near > 0), near, np.inf)

    @property
    def box(self) -> tuple[Floats, Floats]:
        return np.array(self.low), np.array(self.high)

    def outline(self, origin: Floats) -> Floats:
        low, high = self.box
        return np.array([[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


Solid = Ball | Block


Window = tuple[slice, slice]


def cast(
    origin: Floats, rays: Floats, solids: list[tuple[Solid, Window]], *, coloured: bool = True
) -> tuple[NDArray[np.uint8], NDArray[np.uint16], Floats]:
    """Return colours (h, w, 3), instance IDs (h, w) and distances (h, w) along unit rays (h, w, 3), all in world axes.

    Each solid comes with the window of the picture that contains it.
    """
    with np.errstate(divide="ignore"):
        best = np.where(rays[..., 2] < -1e-9, -origin[2] / rays[..., 2], np.inf)
    best[best > 400.0] = np.inf
    number = np.zeros(rays.shape[:2], dtype=np.uint16)
    colour = np.zeros(rays.shape)
    if coloured:
        ground = np.isfinite(best)
        colour[ground] = _texture((origin + best[ground, None] * rays[ground]).astype(np.float32)) * [0.55, 0.6, 0.5]
        colour[~ground] = _sky(rays[~ground])
    for solid, window in solids:
        part = rays[window]
        t = solid.hit(origin, part)
        nearer = t < best[window]
        best[window] = np.where(nearer, t, best[window])
        number[window][nearer] = solid.number
        if coloured:
            hit = origin + t[nearer, None] * part[nearer]
            colour[window][nearer] = np.array(solid.colour) * (0.75 + 0.25 * np.sin(hit @ [5.0, 4.0, 6.0]))[:, None]
    return np.rint(colour * 255).astype(np.uint8), number, best


def _texture(points: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the brightness of the ground (n, 1), from 0 to 1. It fades to grey with distance."""
    waves = [(1.3, 0.4, 0.25), (-0.5, 1.1, 0.25), (0.31, 0.22, 0.3), (-0.12, 0.17, 0.2)]
    away = np.linalg.norm(points, axis=-1)
    value = sum(a * np.sin(points[:, 0] * u + points[:, 1] * v) / (1 + (away * np.hypot(u, v) / 12) ** 2) for u, v, a in waves)
    return np.asarray(0.5 + 0.45 * value)[:, None]


def _sky(rays: Floats) -> Floats:
    height = np.clip(rays[:, 2:], 0, 1)
    return np.asarray(np.array([0.8, 0.87, 0.95]) * (1 - height) + np.array([0.25, 0.45, 0.8]) * height)


def _ring(towards: Floats, radius: float) -> Floats:
    distance = float(np.linalg.norm(towards))
    ahead = towards / distance
    side = np.cross(ahead, [0.0, 0.0, 1.0])
    side /= np.linalg.norm(side)
    top = np.cross(side, ahead)
    # The circle in which the tangents from the viewpoint touch the ball.
    forward, out = distance - radius**2 / distance, radius * np.sqrt(1 - (radius / distance) ** 2)
    turn = np.linspace(0, 2 * np.pi, 24, endpoint=False)[:, None]
    return np.asarray(ahead * forward + out * (np.cos(turn) * side + np.sin(turn) * top))
