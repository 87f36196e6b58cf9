"""Keyframes of actors: the positions on an actor's path at which it is rendered, and the view for each render."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scope_ptz.blender.requests import perspective_request
from scope_ptz.blender.tiles import TELE_FOCAL_PX
from scope_ptz.geometry import Perspective, pan_tilt_deg
from scope_ptz.geometry.sphere import camera_axes
from scope_ptz.simulator.models import Band, SceneActor, SceneViewpoint

TURN_STEP_DEG, DISTANCE_STEP = 2.5, 1.06
"""Changes that require a new keyframe: in the viewing angle, in degrees, and in the distance, as a factor.

If this gives too many keyframes, both steps are increased.
"""

GAIT_PHASES = 8  # number of pictures of a walker at each position
MIN_SIDE_PX = 6.0  # actors that stay smaller at the closest zoom are not rendered
MAX_SIDE_PX = 420  # maximum side of a picture
PATH_SAMPLES = 1200  # number of points along a path
MARGIN = 1.06  # ratio of a view's size to the actor's size

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Keyframe:
    """A picture of an actor to render: its time on the path, its gait phase, and the view.

    Attributes:
        extra_times_s: Other path times for which the pack uses the same picture: those at the adjacent corners of the path.
            Without them, the picture nearest in time to an actor at a corner could show the actor heading along the other leg.
    """

    time_s: float
    phase: float
    position_m: tuple[float, float, float]
    view: Perspective
    extra_times_s: tuple[float, ...] = ()

    def request(self) -> dict[str, Any]:
        """Return the keyframe as a parameter for the worker's operation ``sprites``."""
        return {
            "time_s": self.time_s,
            "phase": self.phase,
            "position_m": list(self.position_m),
            "projection": perspective_request(self.view),
        }


def keyframes(
    actor: SceneActor, stride_m: float | None, viewpoint: SceneViewpoint, band: Band, sun: Floats | None, limit: int
) -> list[Keyframe]:
    """Return an actor's keyframes for a viewpoint. Walkers get a keyframe for every gait phase at each position.

    Each leg of the path has at least one position, even if that exceeds ``limit`` keyframes.
    """
    samples = _PathSamples.along(actor, viewpoint)
    pictures_per_sample = GAIT_PHASES if stride_m else 1
    coarseness = 1.0
    while len(chosen := samples.distinct(coarseness)) * pictures_per_sample > limit and len(chosen) > len(actor.waypoints) - 1:
        coarseness *= 1.15
    frames = []
    for k, others in chosen.items():
        view = _enclosing_view(_corners(actor, samples, k, sun), viewpoint, band)
        if view is not None:
            x, y, z = (round(float(v), 4) for v in samples.positions[k])
            times = tuple(round(float(samples.times[other]), 4) for other in others)
            frames += [
                Keyframe(round(float(samples.times[k]), 4), p / pictures_per_sample, (x, y, z), view, times)
                for p in range(pictures_per_sample)
            ]
    return frames


@dataclass(frozen=True, slots=True)
class _PathSamples:
    """Dense samples along a path: times ``(n,)``, positions ``(n, 3)``, bearings, and angles as seen from the viewpoint."""

    times: Floats
    positions: Floats
    bearings_deg: Floats
    aspects_deg: Floats
    elevations_deg: Floats
    distances_m: Floats
    legs: NDArray[np.int64]

    @classmethod
    def along(cls, actor: SceneActor, viewpoint: SceneViewpoint) -> _PathSamples:
        waypoints = np.array(actor.waypoints)
        times = np.linspace(waypoints[0, 0], waypoints[-1, 0], PATH_SAMPLES)
        positions = np.stack([np.interp(times, waypoints[:, 0], waypoints[:, k]) for k in (1, 2, 3)], axis=-1)
        leg = np.clip(np.searchsorted(waypoints[:, 0], times, side="right") - 1, 0, len(waypoints) - 2)
        step = np.diff(waypoints[:, 1:], axis=0)[leg]
        bearings = np.degrees(np.arctan2(step[:, 0], step[:, 1]))
        offset = positions - np.array(viewpoint.position_m)
        bearings_from_viewpoint, elevations = pan_tilt_deg(offset)
        return cls(times, positions, bearings, bearings - bearings_from_viewpoint, elevations, np.linalg.norm(offset, axis=1), leg)

    def distinct(self, coarseness: float) -> dict[int, list[int]]:
        """Return samples that each differ visibly from the one before, with at least one for each leg of the path.

        Keys are sample indices. Each value lists other samples that share the picture: the start of the leg for the leg's first
        chosen sample, and the end of the leg for the last one.
        """
        chosen: dict[int, list[int]] = {}
        for leg in np.unique(self.legs):
            first, last = (int(k) for k in np.flatnonzero(self.legs == leg)[[0, -1]])
            distinct_in_leg = self._distinct_between(first, last, coarseness)
            if len(distinct_in_leg) == 1:
                distinct_in_leg = [(first + last) // 2]
            chosen |= {k: [] for k in distinct_in_leg}
            chosen[distinct_in_leg[0]].append(first)
            chosen[distinct_in_leg[-1]].append(last)
        return chosen

    def _distinct_between(self, first: int, end: int, coarseness: float) -> list[int]:
        chosen = [first]
        for k in range(first + 1, end + 1):
            last = chosen[-1]
            turn = abs((self.aspects_deg[k] - self.aspects_deg[last] + 180.0) % 360.0 - 180.0)
            turn = max(turn, abs(self.elevations_deg[k] - self.elevations_deg[last]))
            ratio = self.distances_m[k] / self.distances_m[last]
            if turn >= TURN_STEP_DEG * coarseness or max(ratio, 1 / ratio) >= 1 + (DISTANCE_STEP - 1) * coarseness:
                chosen.append(k)
        return chosen


def _corners(actor: SceneActor, samples: _PathSamples, k: int, sun: Floats | None) -> Floats:
    """Return the corners of the actor's box in the world, and the points where their shadows fall on level ground."""
    bearing = math.radians(float(samples.bearings_deg[k]))
    ahead, right = np.array([math.sin(bearing), math.cos(bearing), 0.0]), np.array([math.cos(bearing), -math.sin(bearing), 0.0])
    width, length, height = actor.size_m
    corners = np.array(
        [
            samples.positions[k] + right * x * width / 2 + ahead * y * length / 2 + np.array([0.0, 0.0, z * height])
            for x in (-1, 1)
            for y in (-1, 1)
            for z in (0, 1)
        ]
    )
    if sun is None or sun[2] < 0.2:
        return corners
    high = corners[corners[:, 2] > samples.positions[k][2] + height / 2]
    return np.concatenate([corners, high - sun * (height / sun[2])])


def _enclosing_view(corners: Floats, viewpoint: SceneViewpoint, band: Band) -> Perspective | None:
    """Return a view that just contains all corners; None if it extends beyond the band, is too small or is too close."""
    offset = corners - np.array(viewpoint.position_m)
    aim = offset.mean(axis=0)
    for _ in range(3):
        pan, tilt = (float(v) for v in pan_tilt_deg(aim))
        axes = camera_axes(pan, tilt)
        local = offset @ axes.T
        if local[:, 2].min() <= 0.05 * np.linalg.norm(aim):
            return None
        flat = local[:, :2] / local[:, 2:]
        centre = (flat.min(axis=0) + flat.max(axis=0)) / 2
        aim = axes.T @ np.array([centre[0], centre[1], 1.0])
    half = np.abs(flat).max(axis=0) * MARGIN
    if half.max() > 1.2 or 2 * half.max() * TELE_FOCAL_PX < MIN_SIDE_PX:
        return None
    focal_px = min(TELE_FOCAL_PX, MAX_SIDE_PX / (2 * float(half.max())))
    width, height = (2 * math.ceil(float(v) * focal_px) for v in half)
    local_pan = (pan - viewpoint.pan0_bearing_deg + 180.0) % 360.0 - 180.0
    view = Perspective(local_pan, tilt, math.degrees(2 * math.atan(width / 2 / focal_px)), width, height)
    _, tilts = pan_tilt_deg(offset)
    return view if tilts.max() < band.top_tilt_deg and tilts.min() > band.bottom_tilt_deg else None
