"""Stances of people at table: variations of ``stances.sitting`` for what the hands do."""

from __future__ import annotations

from dataclasses import replace

from scope_studio.kit.people.poses import Pose
from scope_studio.kit.people.stances import reaching, sitting


def at_table(seed: int) -> Pose:
    """Forearms on a table 0.74 m high, its edge 0.22 m before the hips."""
    return reaching(sitting(0.45, seed=seed), left=(-0.13, 0.42, 0.80), right=(0.16, 0.43, 0.80), drop=-0.6)


def with_cup(seed: int) -> Pose:
    """The right hand lifts a cup to the chin, the left lies on the table."""
    return reaching(sitting(0.45, seed=seed), left=(-0.15, 0.40, 0.80), right=(0.07, 0.27, 1.06), drop=-0.9)


def with_phone(seed: int) -> Pose:
    """Looking down at a phone held before the chest."""
    base = replace(sitting(0.45, seed=seed, crossed=True), head_pitch=-26.0, head_yaw=0.0)
    return reaching(base, left=(-0.04, 0.33, 0.88), right=(0.05, 0.33, 0.90), drop=-0.8)
