"""Scripted policies for active search, as a baseline for learned ones.

All but ``RandomActions`` use the observation ``detection``, so the environment needs perception. They turn towards the target as
soon as perception reports it, and submit when it is near the centre. They differ in how they search before that.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose, direction, pan_tilt_deg
from scope_ptz.gym.move_actions import move_action, move_space
from scope_ptz.gym.search_env import FRAME_SIZE, SearchEnv
from scope_ptz.gym.search_scores import SearchOutcome
from scope_ptz.gym.search_targets import is_central
from scope_ptz.perception.base import Box

PAN_STEP_DEG, ROWS_DEG = 60.0, (-12.0, -40.0, 16.0)
"""Search raster at the widest view (71 by 44 degrees): the pan step between looks, and the tilt of each row, horizon first."""

MISS_PROBABILITY = 0.3  # the greedy policy assumes that perception misses a target in view with this probability
TRAVEL_COST = 1e-6  # per degree of travel; it breaks ties between equally promising views
Action = NDArray[np.float32]


class SearchPolicy(Protocol):
    """A policy for ``scope_ptz/Search-v0``."""

    def begin(self, seed: int) -> None:
        """Begin an episode."""

    def act(self, observation: Mapping[str, Any]) -> Action:
        """Return the action for an observation."""
        ...


def run_search(env: SearchEnv, policy: SearchPolicy, seed: int) -> SearchOutcome:
    """Run one search with a policy. The same seed gives the same search."""
    observation, info = env.reset(seed=seed)
    policy.begin(seed)
    ended = False
    while not ended:
        observation, _, terminated, truncated, info = env.step(policy.act(observation))
        ended = terminated or truncated
    return SearchOutcome(bool(info["success"]), int(info["looks"]))


class RandomActions:
    """Uniformly random actions, which submit one time in four. Observations are ignored."""

    def begin(self, seed: int) -> None:
        self._space = move_space()
        self._space.seed(seed)

    def act(self, observation: Mapping[str, Any]) -> Action:  # noqa: ARG002 - the signature of policies
        return self._space.sample()


class _DetectionPolicy(ABC):
    """A policy that turns towards the reported target, and otherwise in the direction that ``_next_look`` returns."""

    def begin(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._limits = Limits()

    def act(self, observation: Mapping[str, Any]) -> Action:
        pan, tilt, zoom = (float(v) for v in observation["pose"])
        view = Perspective(pan, tilt, AXIS_M5075_G.hfov_deg(zoom), *FRAME_SIZE)
        found, x, y, *_ = (float(v) for v in observation["detection"])
        self._record_view(view)
        if not found:
            return self._turn(view, *self._next_look(view))
        if is_central(Box(x_min=x, y_min=y, x_max=x, y_max=y)):
            return move_action(finish=True)
        return self._turn(view, *(float(v) for v in pan_tilt_deg(view.directions(np.array([x, y])))))

    def _turn(self, view: Perspective, pan_deg: float, tilt_deg: float) -> Action:
        aim, _ = self._limits.clamp(Pose(self._limits.aim_pan_deg(pan_deg), tilt_deg, 1.0))
        return move_action(aim.pan_deg - view.pan_deg, aim.tilt_deg - view.tilt_deg)

    def _record_view(self, view: Perspective) -> None:
        """Record a view that perception has searched. The default implementation does nothing."""

    @abstractmethod
    def _next_look(self, view: Perspective) -> tuple[float, float]:
        """Return the pan and tilt, in degrees, of the next look."""


class RandomLooks(_DetectionPolicy):
    """Looks in random directions until perception reports the target."""

    def _next_look(self, view: Perspective) -> tuple[float, float]:  # noqa: ARG002
        limits = self._limits
        return float(self._rng.uniform(limits.min_pan_deg, limits.max_pan_deg)), float(self._rng.choice(ROWS_DEG))


class Sweep(_DetectionPolicy):
    """Scans a fixed raster row by row, alternately from left to right and from right to left."""

    def begin(self, seed: int) -> None:
        super().begin(seed)
        self._looks = self._raster()

    def _raster(self) -> Iterator[tuple[float, float]]:
        half = PAN_STEP_DEG / 2
        pans = np.arange(-180 + half, 180, PAN_STEP_DEG).tolist()
        while True:
            for row, tilt in enumerate(ROWS_DEG):
                for pan in pans if row % 2 == 0 else reversed(pans):
                    yield pan, tilt

    def _next_look(self, view: Perspective) -> tuple[float, float]:  # noqa: ARG002
        return next(self._looks)


class Greedy(_DetectionPolicy):
    """Looks next at the view that most probably contains the target. Ties go to the nearest view.

    It keeps a probability for each direction. After a look without the target, the probabilities in that view are multiplied by
    ``MISS_PROBABILITY``.
    """

    def begin(self, seed: int) -> None:
        super().begin(seed)
        pans, tilts = (grid.ravel() for grid in np.meshgrid(np.arange(-180.0, 180.0, 6.0), np.arange(-54.0, 31.0, 6.0)))
        self._directions = direction(pans, tilts)
        # Targets are more likely near the horizon than directly below the camera. The cosine is the solid angle of a grid cell.
        self._belief = np.cos(np.radians(tilts)) * np.where((tilts > -36) & (tilts < 12), 1.0, 0.3)
        self._candidates = [(float(pan), tilt) for pan in np.arange(-170.0, 171.0, 10.0) for tilt in ROWS_DEG]
        wide = AXIS_M5075_G.hfov_deg(1.0)
        self._coverage = np.array(
            [self._directions_in(Perspective(pan, tilt, wide, *FRAME_SIZE)) for pan, tilt in self._candidates]
        )

    def _directions_in(self, view: Perspective) -> NDArray[np.bool_]:
        points = view.points(self._directions)
        with np.errstate(invalid="ignore"):
            return np.asarray(((points >= 0) & (points <= 1)).all(axis=-1))

    def _record_view(self, view: Perspective) -> None:
        self._belief = np.where(self._directions_in(view), MISS_PROBABILITY * self._belief, self._belief)

    def _next_look(self, view: Perspective) -> tuple[float, float]:
        gains = self._coverage @ self._belief / self._belief.sum()
        travel_deg = np.array([abs(pan - view.pan_deg) + abs(tilt - view.tilt_deg) for pan, tilt in self._candidates])
        return self._candidates[int(np.argmax(gains - TRAVEL_COST * travel_deg))]
