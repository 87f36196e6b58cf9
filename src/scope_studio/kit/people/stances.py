"""Poses of people who hold, push, ride or sit on something."""

from __future__ import annotations

from dataclasses import replace
from random import Random

from mathutils import Vector

from scope_studio.kit.core.mesh import Point
from scope_studio.kit.people.poses import Arm, Foot, Pose, solve, standing, walking
from scope_studio.kit.vehicles import cycles

UMBRELLA_GRIP: Point = (0.17, 0.24, 1.24)
"""Position in metres of the right hand on the handle in ``with_umbrella``."""
PRAM_HANDLE: Point = (0.17, 0.40, 1.04)
"""Position in metres of the right hand in ``pushing``. The left hand is its mirror image."""
LEAD_GRIP: Point = (0.27, 0.22, 0.98)
"""Position in metres of the right hand in ``leading``, which holds a dog's lead."""
WRIST_TO_PALM_M = 0.085
"""Distance in metres from the wrist to the centre of a closed hand."""


def reaching(pose: Pose, *, left: Point | None = None, right: Point | None = None, elbow_up: float = -0.5) -> Pose:
    """Return ``pose`` with closed hands at the given positions, in metres on a figure that is not yet scaled to its height.

    ``elbow_up`` is the upward component of the direction in which the elbows point.
    """
    chest = solve(pose).chest
    arms = list(pose.arms)
    for index, (side, target) in enumerate(zip((-1, 1), (left, right), strict=True)):
        if target is None:
            continue
        shoulder = chest @ Vector((side * 0.178, -0.008, 1.412))
        direction = (Vector(target) - shoulder).normalized()
        wrist = chest.inverted() @ (Vector(target) - direction * WRIST_TO_PALM_M)
        arms[index] = Arm(hand=tuple(wrist), elbow=(0.7, -0.8, elbow_up), curl=0.9)
    return replace(pose, arms=(arms[0], arms[1]))


def with_umbrella(phase: float | None = None, *, seed: int = 0) -> Pose:
    """Return a standing pose, or a walking pose if a gait phase is given, with the right hand at ``UMBRELLA_GRIP``."""
    random = Random(f"umbrella {seed}")
    base = standing(random) if phase is None else walking(phase)
    return reaching(replace(base, twist=0.0), right=UMBRELLA_GRIP, elbow_up=-0.9)


def leading(phase: float | None = None, *, seed: int = 0) -> Pose:
    """Return a standing pose, or a walking pose if a gait phase is given, with the right hand at ``LEAD_GRIP``."""
    base = standing(Random(f"lead {seed}")) if phase is None else walking(phase)
    return reaching(replace(base, twist=0.0), right=LEAD_GRIP, elbow_up=-0.9)


def pushing(phase: float) -> Pose:
    """Return a walking pose with both hands on a handle at ``PRAM_HANDLE``."""
    x, y, z = PRAM_HANDLE
    return reaching(replace(walking(phase), lean=9, twist=0.0), left=(-x, y, z), right=PRAM_HANDLE)


def sitting(seat_m: float = 0.46, *, seed: int = 0, crossed: bool = False) -> Pose:
    """Return a sitting pose facing +y, with hips over the origin and hands in the lap. With ``crossed``, the ankles are crossed."""
    random = Random(f"sit {seed}")
    spread = random.uniform(0.10, 0.15)
    near = random.uniform(0.36, 0.44)
    feet = (Foot(-spread, near, 8), Foot(spread, near + random.uniform(-0.06, 0.06), 8))
    if crossed:
        feet = (Foot(0.03, near + 0.16, 0, 12), Foot(-0.02, near + 0.24, 0, 18))
    pose = Pose(
        feet,
        (Arm(), Arm()),
        hip=(0, 0, seat_m + 0.095 - 0.925),
        hip_lean=-6,
        lean=random.uniform(4, 12),
        head_yaw=random.uniform(-26, 26),
        head_pitch=random.uniform(-10, 0),
    )
    lap = seat_m + 0.17
    return reaching(pose, left=(-0.09, 0.27, lap), right=(0.09, 0.25, lap + 0.01))


def riding(crank_deg: float) -> Pose:
    """Return the pose of a rider of a ``cycles.bicycle`` at the origin, with hands on the grips and feet on the pedals."""
    feet = []
    for side in (-1, 1):
        y, z = cycles.pedal(crank_deg, side)
        feet.append(Foot(side * 0.135, y - 0.10, 2.0, -14.0, z + 0.015))
    pose = Pose(
        (feet[0], feet[1]),
        (Arm(), Arm()),
        hip=(0, cycles.SADDLE[1] + 0.03, cycles.SADDLE[2] + 0.11 - 0.925),
        hip_lean=14,
        lean=14,
        head_pitch=14,
    )
    x, y, z = cycles.GRIP
    return reaching(pose, left=(-x, y, z), right=(x, y, z))
