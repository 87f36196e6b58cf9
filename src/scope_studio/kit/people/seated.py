"""Poses of people who sit at a table: variants of ``stances.sitting`` with different hand positions."""

from __future__ import annotations

from dataclasses import replace

from scope_studio.kit.people.poses import Pose
from scope_studio.kit.people.stances import reaching, sitting


def at_table(seed: int) -> Pose:
    """Return a pose with the forearms on a table 0.74 m high, whose edge is 0.22 m in front of the hips."""
    return reaching(sitting(0.45, seed=seed), left=(-0.13, 0.42, 0.80), right=(0.16, 0.43, 0.80), elbow_up=-0.6)


def with_cup(seed: int) -> Pose:
    """Return a pose with a cup at the chin in the right hand and the left hand on the table."""
    return reaching(sitting(0.45, seed=seed), left=(-0.15, 0.40, 0.80), right=(0.07, 0.27, 1.06), elbow_up=-0.9)


def with_phone(seed: int) -> Pose:
    """Return the pose of a person who looks at a phone in front of the chest."""
    base = replace(sitting(0.45, seed=seed, crossed=True), head_pitch=-26.0, head_yaw=0.0)
    return reaching(base, left=(-0.04, 0.33, 0.88), right=(0.05, 0.33, 0.90), elbow_up=-0.8)
