"""Poses of a person, and a walking gait. Two-bone inverse kinematics computes the joints from the positions of feet and hands."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from random import Random

from mathutils import Matrix, Vector

SIDES = (-1, 1)
"""Left (x < 0) and right (x > 0). Pairs of limbs and joints are in this order."""

STRIDE_M = 1.32
"""Length in metres of one gait cycle (two steps) of a person of average height."""

HIP, WAIST, NECK = 0.925, 1.06, 1.525
"""Heights of joints of the upright figure in metres."""
THIGH, SHIN, ANKLE = 0.435, 0.410, 0.085
"""Lengths of thigh and shin, and height of the ankle, in metres."""
UPPER_ARM, FOREARM = 0.295, 0.255
"""Lengths of the upper arm and the forearm in metres."""
SHOULDER = (0.178, -0.008, 1.412)
"""Position of the right shoulder of the upright figure in metres."""


@dataclass(frozen=True)
class Foot:
    """Position of a foot: point below the ankle (m), outward rotation and pitch (degrees; positive raises the toes), lift (m)."""

    x: float
    y: float
    out: float = 8.0
    pitch: float = 0.0
    lift: float = 0.0


@dataclass(frozen=True)
class Arm:
    """The position of an arm.

    It is defined by angles in degrees (``forward``, ``out``, ``bend``), or by the position of the ``hand`` in the coordinates of
    the upright body. With ``hand``, ``elbow`` is the direction in which the elbow points (x is outwards). ``curl`` closes the
    fingers: -1 points the index finger, 0 is flat, and 1 is a fist.
    """

    forward: float = 4.0
    out: float = 9.0
    bend: float = 16.0
    hand: tuple[float, float, float] | None = None
    elbow: tuple[float, float, float] = (0.6, -1.0, -0.5)
    curl: float = 0.5


@dataclass(frozen=True)
class Pose:
    """Parameters of a pose. Angles are in degrees. Positive lean is forward, positive twist and yaw are to the left."""

    feet: tuple[Foot, Foot]
    arms: tuple[Arm, Arm]
    hip: tuple[float, float, float] = (0.0, 0.0, 0.0)
    hip_yaw: float = 0.0
    hip_roll: float = 0.0
    hip_lean: float = 0.0
    lean: float = 3.0
    twist: float = 0.0
    tilt: float = 0.0
    head_yaw: float = 0.0
    head_pitch: float = -4.0
    head_roll: float = 0.0


@dataclass
class Joints:
    """A solved pose: frames that transform rest to posed coordinates, and joint positions. Pairs are in the order of ``SIDES``."""

    pelvis: Matrix
    chest: Matrix
    head: Matrix
    feet: list[Matrix]
    hips: list[Vector] = field(default_factory=list)
    knees: list[Vector] = field(default_factory=list)
    ankles: list[Vector] = field(default_factory=list)
    shoulders: list[Vector] = field(default_factory=list)
    elbows: list[Vector] = field(default_factory=list)
    wrists: list[Vector] = field(default_factory=list)

    def torso(self, rest: Vector) -> Vector:
        """Return the posed position of a point of the upright trunk."""
        t = min(1.0, max(0.0, (rest.z - 0.96) / 0.24))
        t = t * t * (3 - 2 * t)
        return (self.pelvis @ rest).lerp(self.chest @ rest, t)


def _turn(pivot: tuple[float, float, float], lean: float, tilt: float, yaw: float) -> Matrix:
    """Return a rotation about a pivot. The angles are in degrees."""
    rotation = Matrix.Rotation(math.radians(yaw), 4, "Z") @ Matrix.Rotation(math.radians(tilt), 4, "Y")
    rotation @= Matrix.Rotation(-math.radians(lean), 4, "X")
    return Matrix.Translation(pivot) @ rotation @ Matrix.Translation(-Vector(pivot))


def _solve_two_bones(a: Vector, target: Vector, first: float, second: float, pole: Vector) -> tuple[Vector, Vector]:
    """Return the positions of the middle joint and the end of a two-bone chain from ``a`` towards ``target``."""
    reach = target - a
    d = min(reach.length, (first + second) * 0.9995)
    axis = reach.normalized()
    along = (first * first - second * second + d * d) / (2 * d)
    height = math.sqrt(max(0.0, first * first - along * along))
    side = pole - axis * axis.dot(pole)
    side = side.normalized() if side.length > 1e-4 else axis.orthogonal().normalized()
    return a + axis * along + side * height, a + axis * d


def _foot_frame(foot: Foot, side: int) -> Matrix:
    """Return the transform of a foot from rest to posed coordinates."""
    pivot = (0.0, 0.135, 0.0) if foot.pitch < 0 else (0.0, -0.07, 0.0)
    rotation = Matrix.Translation(pivot) @ Matrix.Rotation(math.radians(foot.pitch), 4, "X") @ Matrix.Translation(-Vector(pivot))
    return Matrix.Translation((foot.x, foot.y, foot.lift)) @ Matrix.Rotation(-side * math.radians(foot.out), 4, "Z") @ rotation


def solve(pose: Pose) -> Joints:
    """Return the joint positions of a pose. The pelvis is lowered until the feet reach the ground."""
    feet = [_foot_frame(f, s) for f, s in zip(pose.feet, SIDES, strict=True)]
    ankles = [f @ Vector((0, 0, ANKLE)) for f in feet]
    turn = Matrix.Translation(pose.hip) @ _turn((0, 0, HIP), pose.hip_lean, pose.hip_roll, pose.hip_yaw)
    drop = 0.0
    for side, ankle in zip(SIDES, ankles, strict=True):
        hip = turn @ Vector((side * 0.09, 0, HIP))
        level = math.hypot(hip.x - ankle.x, hip.y - ankle.y)
        reach = math.sqrt(max(0.01, ((THIGH + SHIN) * 0.996) ** 2 - level**2))
        drop = max(drop, hip.z - (ankle.z + reach))
    pelvis = Matrix.Translation((0, 0, -drop)) @ turn
    chest = pelvis @ _turn((0, 0.01, WAIST), pose.lean, pose.tilt, pose.twist)
    head = chest @ _turn((0, 0, NECK), pose.lean * -0.6 - pose.head_pitch, pose.head_roll, pose.head_yaw)
    joints = Joints(pelvis, chest, head, feet, ankles=ankles)
    for index, side in enumerate(SIDES):
        hip = pelvis @ Vector((side * 0.09, 0, HIP))
        toes = feet[index].to_3x3() @ Vector((0, 1, 0))
        knee, ankle = _solve_two_bones(hip, ankles[index], THIGH, SHIN, Vector((toes.x * 0.7 + side * 0.04, max(0.5, toes.y), 0.3)))
        shoulder = chest @ Vector((side * SHOULDER[0], SHOULDER[1], SHOULDER[2]))
        elbow, wrist = _arm(pose.arms[index], side, shoulder, chest)
        joints.hips.append(hip)
        joints.knees.append(knee)
        joints.ankles[index] = ankle
        joints.shoulders.append(shoulder)
        joints.elbows.append(elbow)
        joints.wrists.append(wrist)
    return joints


def _arm(arm: Arm, side: int, shoulder: Vector, chest: Matrix) -> tuple[Vector, Vector]:
    """Return the positions of the elbow and the wrist."""
    if arm.hand is not None:
        pole = chest.to_3x3() @ Vector((side * arm.elbow[0], arm.elbow[1], arm.elbow[2]))
        return _solve_two_bones(shoulder, chest @ Vector(arm.hand), UPPER_ARM, FOREARM, pole)
    swing = chest.to_3x3() @ (
        Matrix.Rotation(-side * math.radians(arm.out), 3, "Y") @ Matrix.Rotation(math.radians(arm.forward), 3, "X")
    )
    elbow = shoulder + swing @ Vector((0, 0, -UPPER_ARM))
    inward = Matrix.Rotation(side * math.radians(arm.out + 4), 3, "Y")
    return elbow, elbow + swing @ inward @ Matrix.Rotation(math.radians(arm.bend), 3, "X") @ Vector((0, 0, -FOREARM))


def _gait_foot(phase: float, x: float) -> Foot:
    """Return the position of a foot of a walking person. It strikes the ground at phase 0 and stays there for 0.6 of the cycle."""
    p = phase % 1.0
    start, stop = 0.33, 0.33 - 0.6 * STRIDE_M
    if p < 0.6:
        pitch = 18.0 * max(0.0, 1.0 - p / 0.10) - 48.0 * max(0.0, (p - 0.36) / 0.24) ** 1.5
        return Foot(x, start - p * STRIDE_M, 6.0, pitch)
    t = (p - 0.6) / 0.4
    ease = t * t * (3 - 2 * t)
    return Foot(
        x,
        stop + (start - stop) * ease,
        6.0,
        -48.0 + 66.0 * min(1.0, t * 1.15) ** 0.8,
        0.055 * math.sin(math.pi * min(1.0, t * 1.05)) ** 2,
    )


def walking(phase: float) -> Pose:
    """Return the pose of a walking person at a gait phase in [0, 1)."""
    swing = math.cos(2 * math.pi * phase)
    right, left = _gait_foot(phase, 0.075), _gait_foot(phase + 0.5, -0.075)
    arms = tuple(Arm(5 + s * 22 * swing * -1, 8, 18 + 12 * max(0.0, -s * swing)) for s in SIDES)
    sway = 0.018 * math.cos(2 * math.pi * (phase - 0.3))
    return Pose(
        (left, right),
        (arms[0], arms[1]),
        hip=(sway, 0, 0),
        hip_yaw=5 * swing,
        lean=5,
        twist=-9 * swing,
        head_yaw=3.0,
        head_pitch=-3,
    )


def standing(random: Random) -> Pose:
    """Return a standing pose with the weight on one leg and a random position of the arms."""
    lead = random.choice(SIDES)
    feet = [Foot(-0.105, 0.0, 10 + random.uniform(0, 8)), Foot(0.105, 0.0, 10 + random.uniform(0, 8))]
    free = 0 if lead > 0 else 1
    feet[free] = replace(feet[free], y=random.uniform(0.05, 0.13), x=feet[free].x * 1.25, out=24.0)
    arms = [Arm(random.uniform(0, 7), random.uniform(8, 12), random.uniform(12, 24)) for _ in SIDES]
    choice = random.random()
    if choice < 0.4:
        arms[free] = Arm(hand=(-lead * 0.185, 0.055, 1.0), elbow=(1.0, -0.8, 0.0), curl=0.7)
    elif choice < 0.6:
        arms = [Arm(hand=(s * 0.06, 0.17 + 0.012 * s, 1.03), elbow=(1.0, -0.4, -0.4), curl=0.6) for s in SIDES]
    return Pose(
        (feet[0], feet[1]),
        (arms[0], arms[1]),
        hip=(lead * 0.035, 0.0, 0.0),
        hip_roll=-lead * 3.5,
        tilt=lead * 4.0,
        twist=random.uniform(-6, 6),
        head_yaw=random.uniform(-24, 24),
        head_pitch=random.uniform(-7, 3),
        head_roll=random.uniform(-4, 4),
    )


def named_pose(name: str, phase: float, random: Random) -> Pose:
    """Return the pose with this name.

    Raises:
        ValueError: No pose has this name.
    """
    base = standing(random)
    relaxed = Arm(3, 9, 18)
    if name == "stand":
        return base
    if name == "walk":
        return replace(walking(phase), head_yaw=random.uniform(-10, 10))
    if name == "point":
        return replace(
            base,
            arms=(relaxed, Arm(hand=(0.36, 0.50, 1.42), elbow=(0.8, 0, -1), curl=-1.0)),
            twist=8,
            head_yaw=-26,
            head_pitch=0,
        )
    if name == "phone":
        return replace(
            base,
            arms=(
                Arm(hand=(-0.10, 0.16, 1.06), elbow=(1, -0.6, -0.4)),
                Arm(hand=(0.155, 0.045, 1.545), elbow=(0.9, 0.5, -1.0), curl=0.8),
            ),
            head_roll=7,
        )
    if name == "clipboard":
        return replace(
            base,
            arms=(
                Arm(hand=(-0.10, 0.27, 1.13), elbow=(1, -0.3, -0.8), curl=0.6),
                Arm(hand=(0.06, 0.29, 1.19), elbow=(1, -0.2, -0.7), curl=0.8),
            ),
            head_pitch=-24,
            head_yaw=6,
            twist=2,
        )
    if name == "carry":
        arms = tuple(Arm(hand=(s * 0.165, 0.34, 1.03), elbow=(0.8, -1, -0.3), curl=0.5) for s in SIDES)
        return replace(walking(phase), arms=(arms[0], arms[1]), lean=-2, twist=0)
    if name == "kneel":
        feet = (Foot(-0.11, 0.26, 8), Foot(0.11, -0.52, 0, -62))
        arms = (
            Arm(hand=(-0.14, 0.44, 0.86), elbow=(1, -0.5, 0.2), curl=0.5),
            Arm(hand=(0.12, 0.50, 0.82), elbow=(1, -0.5, 0.2), curl=0.8),
        )
        return Pose(feet, arms, hip=(0, -0.10, -0.40), hip_lean=14, lean=26, twist=-6, head_pitch=-14, head_yaw=5)
    if name == "shovel":
        feet = (Foot(-0.17, 0.20, 16), Foot(0.15, -0.20, 26))
        arms = (
            Arm(hand=(-0.13, 0.42, 1.02), elbow=(1, -0.2, -0.6), curl=0.9),
            Arm(hand=(0.17, 0.24, 1.20), elbow=(1, -0.9, 0.2), curl=0.9),
        )
        return Pose(feet, arms, hip=(0, -0.06, -0.07), hip_lean=16, hip_yaw=-10, lean=22, twist=-6, head_pitch=-10, head_yaw=8)
    raise ValueError(f"pose must be stand, walk, point, carry, kneel, shovel, phone or clipboard, not {name!r}")
