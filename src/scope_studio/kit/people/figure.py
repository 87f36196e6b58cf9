"""The clothed human figure: trunk, sleeves, trousers, boots and hands, modelled around the joints of a pose."""

from __future__ import annotations

import itertools
import math

import numpy as np
from mathutils import Matrix, Vector

from scope_studio.kit.core.volumes import SurfaceMesh, Volume, crease
from scope_studio.kit.people.poses import SIDES, Joints

# Height, half width, half depth and forward shift of the clothed trunk, from hem to collar (m).
TRUNK = [
    (0.850, 0.160, 0.124, -0.008),
    (0.930, 0.168, 0.126, -0.006),
    (1.030, 0.154, 0.114, 0.006),
    (1.120, 0.156, 0.114, 0.010),
    (1.220, 0.168, 0.121, 0.012),
    (1.320, 0.176, 0.122, 0.008),
    (1.395, 0.160, 0.106, -0.002),
    (1.445, 0.118, 0.084, -0.010),
    (1.490, 0.076, 0.070, -0.012),
]


def _trunk_rows(joints: Joints, swell: float, girth: float, low: float, high: float) -> list[list[Vector]]:
    """Return rings of points around the posed trunk, one for every 2 cm of height from ``low`` to ``high``."""
    rows = []
    heights = np.arange(low, high + 1e-6, 0.02)
    table = np.array(TRUNK)
    for z in heights:
        w, d, shift = (float(np.interp(z, table[:, 0], table[:, k])) for k in (1, 2, 3))
        belly = (girth - 1.0) * math.exp(-(((z - 1.05) / 0.16) ** 2))
        row = []
        for k in range(28):
            a = 2 * math.pi * k / 28
            c, s = math.cos(a), math.sin(a)
            x = (w * (1 + 0.4 * (girth - 1)) + swell) * math.copysign(abs(c) ** 0.84, c)
            y = (d + swell + (0.13 * belly if s > 0 else 0.04 * belly)) * math.copysign(abs(s) ** 0.84, s) + shift
            row.append(joints.torso(Vector((x, y, z))))
        rows.append(row)
    return rows


def trunk(
    joints: Joints,
    *,
    swell: float,
    low: float,
    girth: float,
    woman: bool = False,
    neck: str | None = None,
    flare: float = 0.0,
    seed: float,
) -> tuple[SurfaceMesh, np.ndarray]:
    """Return the body of a garment, and the upright (rest) coordinates of its points.

    Args:
        swell: Distance between cloth and body (m).
        low: Height of the hem (m).
        girth: Girth of the trunk relative to the average (1.0).
        woman: Whether the figure is a woman's.
        neck: "collar", "hood" or None.
        flare: Additional width of the folds at the hem (m).
        seed: Seed for the folds.
    """
    upright = Joints(Matrix.Identity(4), Matrix.Identity(4), Matrix.Identity(4), [])
    v = Volume()
    v.rings(_trunk_rows(upright, swell, girth, low, 1.462))
    reach = max(0.0, swell)
    for side in SIDES:
        v.capsule((side * 0.05, -0.010, 1.446), (side * 0.150, -0.008, 1.414), 0.050 + reach, 0.054 + reach)
        v.capsule((side * 0.146, -0.006, 1.415), (side * 0.130, -0.004, 1.30), 0.048 + reach, 0.064 + reach)
        if woman:
            v.ellipsoid((side * 0.068, 0.082, 1.265), (0.066, 0.052 + reach * 0.5, 0.066))
    if neck == "hood":
        arc = [math.radians(180 + 30 * k) for k in range(7)]
        ring = [(0.082 * math.cos(t), -0.020 + 0.070 * math.sin(t), 1.490) for t in arc]
        for p, q in itertools.pairwise(ring):
            v.capsule(p, q, 0.030, 0.030)
    elif neck == "collar":
        turns = np.linspace(0, 2 * math.pi, 20, endpoint=False)
        heights = ((1.45, 0.080), (1.49, 0.074), (1.528, 0.072))
        v.rings([[(r * math.cos(t), -0.012 + r * 0.95 * math.sin(t), z - 0.014 * math.sin(t)) for t in turns] for z, r in heights])
    surface = crease(
        v.merge(0.012, 4),
        lambda p: 0.004 + (0.004 + flare) * np.clip((1.15 - p[:, 2]) / 0.3, 0, 1),
        (7.0, 7.0, 10.0),
        seed,
    )
    points, faces = crease(surface, 0.002, (22.0, 22.0, 26.0), seed + 5)
    posed = np.array([tuple(joints.torso(Vector(p))) for p in points])
    return (posed, faces), points


def sleeves(joints: Joints, *, loose: float, seed: float) -> tuple[SurfaceMesh, np.ndarray]:
    """Return both sleeves, and the distance of each point from the shoulder along the arm (m).

    ``loose`` is the additional width of the sleeve (m).
    """
    v = Volume()
    for i in range(2):
        shoulder, elbow, wrist = joints.shoulders[i], joints.elbows[i], joints.wrists[i]
        v.capsule(shoulder.lerp(elbow, 0.03), shoulder.lerp(elbow, 0.5), 0.054 + loose, 0.053 + loose)
        v.capsule(shoulder.lerp(elbow, 0.5), elbow, 0.053 + loose, 0.046 + loose)
        v.capsule(elbow, elbow.lerp(wrist, 0.45), 0.046 + loose, 0.043 + loose)
        v.capsule(elbow.lerp(wrist, 0.45), elbow.lerp(wrist, 0.93), 0.043 + loose, 0.034 + loose)
    points, faces = v.merge(0.012, 4)
    bones = []
    for i in range(2):
        bones.append((joints.shoulders[i], joints.elbows[i], 0.0, 0.295))
        bones.append((joints.elbows[i], joints.wrists[i], 0.295, 0.55))
    along = _interpolate_along_bones(points, bones)
    bend = [(e - s).angle(w - e) for s, e, w in zip(joints.shoulders, joints.elbows, joints.wrists, strict=True)]
    depth = 0.006 + 0.006 * min(1.0, max(bend))
    near = np.exp(-(((along - 0.295) / 0.09) ** 2))
    surface = crease((points, faces), 0.0035 + depth * near, (9.0, 9.0, 17.0), seed)
    return crease(surface, 0.002, (26.0, 26.0, 30.0), seed + 5), along


def trousers(joints: Joints, *, loose: float, girth: float, seed: float) -> tuple[SurfaceMesh, np.ndarray]:
    """Return both legs and the seat, and the height of each point along the upright leg (m above the sole)."""
    v = Volume()
    w = 1 + 0.5 * (girth - 1)
    v.ellipsoid((0, -0.004, 0.955), (0.150 * w, 0.108 * w, 0.105), joints.pelvis)
    for i, side in enumerate(SIDES):
        hip, knee, ankle = joints.hips[i], joints.knees[i], joints.ankles[i]
        cuff = knee.lerp(ankle, 0.98)
        v.ellipsoid((side * 0.072, -0.026, 0.905), (0.086 * w, 0.090 * w, 0.105), joints.pelvis)
        v.capsule(hip, hip.lerp(knee, 0.5), 0.089 * w + loose * 0.4, 0.078 + loose * 0.6)
        v.capsule(hip.lerp(knee, 0.5), knee, 0.078 + loose * 0.6, 0.062 + loose)
        v.capsule(knee, knee.lerp(ankle, 0.4), 0.062 + loose, 0.060 + loose)
        v.capsule(knee.lerp(ankle, 0.4), cuff, 0.060 + loose, 0.054 + loose)
    points, faces = v.merge(0.013, 4)
    bones = []
    for i in range(2):
        bones.append((joints.hips[i], joints.knees[i], 0.92, 0.495))
        bones.append((joints.knees[i], joints.ankles[i], 0.495, 0.085))
    along = _interpolate_along_bones(points, bones)

    knee_weight = np.exp(-(((along - 0.50) / 0.09) ** 2))
    cuff_weight = np.exp(-(((along - 0.10) / 0.10) ** 2))
    crotch_weight = np.exp(-(((along - 0.86) / 0.07) ** 2))
    surface = crease(
        (points, faces), 0.0035 + 0.007 * knee_weight + 0.012 * cuff_weight + 0.005 * crotch_weight, (8.0, 8.0, 15.0), seed
    )
    return crease(surface, 0.002, (24.0, 24.0, 30.0), seed + 3), along


def _interpolate_along_bones(points: np.ndarray, bones: list[tuple[Vector, Vector, float, float]]) -> np.ndarray:
    """Return a value for each point, interpolated between the ends of the nearest bone.

    Bones are (start, end, value at the start, value at the end).
    """
    best = np.full(len(points), 1e9)
    value = np.zeros(len(points))
    for a, b, va, vb in bones:
        p, q = np.array(a), np.array(b)
        raw = (points - p) @ (q - p) / max(1e-9, float((q - p) @ (q - p)))
        d = np.linalg.norm(points - (p + np.clip(raw, 0, 1)[:, None] * (q - p)), axis=1)
        nearer = d < best
        best = np.where(nearer, d, best)
        value = np.where(nearer, va + (vb - va) * raw, value)
    return value


def boots(joints: Joints, *, shoe: bool) -> SurfaceMesh:
    """Return both boots or low shoes, without their soles."""
    v = Volume()
    for i in range(2):
        f = joints.feet[i]
        v.ellipsoid((0, 0.150, 0.048), (0.047, 0.062, 0.040 if not shoe else 0.030), f)
        v.capsule(f @ Vector((0, 0.06, 0.052)), f @ Vector((0, 0.13, 0.044)), 0.046, 0.044)
        v.capsule(f @ Vector((0, -0.035, 0.055)), f @ Vector((0, 0.07, 0.058)), 0.043, 0.043)
        v.ellipsoid((0, -0.045, 0.048), (0.040, 0.044, 0.044), f)
        if not shoe:
            v.capsule(f @ Vector((0, -0.012, 0.07)), joints.ankles[i].lerp(joints.knees[i], 0.22), 0.048, 0.049)
    return v.merge(0.009, 3)


def sole_outline(foot: Matrix, side: int, low: float, high: float) -> list[list[tuple[float, float, float]]]:
    """Return the lower and upper outline of a boot sole in world coordinates."""
    half = [
        (-0.088, 0.0),
        (-0.080, 0.026),
        (-0.05, 0.038),
        (0.0, 0.038),
        (0.06, 0.043),
        (0.12, 0.051),
        (0.165, 0.047),
        (0.198, 0.026),
        (0.206, 0.0),
    ]
    ring = [(x, y) for y, x in half] + [(-x, y) for y, x in half[-2:0:-1]]
    return [[tuple(foot @ Vector((x + side * -0.004 * (y > 0.1), y, z))) for x, y in ring] for z in (low, high)]


def hands(joints: Joints, curls: tuple[float, float], *, glove: bool) -> SurfaceMesh:
    """Return both hands with fingers. A curl of -1 points the index finger, 0 is flat, 1 is a fist."""
    v = Volume()
    glove_m = 0.0015 if glove else 0.0
    for i, side in enumerate(SIDES):
        wrist, elbow = joints.wrists[i], joints.elbows[i]
        along = (wrist - elbow).normalized()
        inward = joints.chest.to_3x3() @ Vector((-side * 1.0, 0.25, -0.1))
        normal = (inward - along * along.dot(inward)).normalized()  # unit vector out of the palm
        across = along.cross(normal)  # unit vector towards the thumb on one side, away from it on the other
        thumb_side = across * (-side if across.dot(Vector((0, 1, 0.3))) * -side > 0 else side)
        curl = curls[i]
        v.capsule(wrist - along * 0.045, wrist + along * 0.01, 0.029 + glove_m, 0.027 + glove_m, flat=0.78, across=across)
        v.capsule(wrist + along * 0.015, wrist + along * 0.075, 0.032 + glove_m, 0.040 + glove_m, flat=0.40, across=across)
        for k in range(4):
            straight = curl < 0 and k == 0
            bend = 0.12 if straight else (abs(curl) if curl >= 0 else 1.0)
            a1, a2 = bend * 1.15, bend * 2.5
            base = wrist + along * (0.085 - 0.004 * abs(k - 1.2)) + thumb_side * (0.029 - 0.0195 * k)
            length = (0.038, 0.043, 0.040, 0.032)[k]
            mid = base + (along * math.cos(a1) + normal * math.sin(a1)) * length
            tip = mid + (along * math.cos(a2) + normal * math.sin(a2)) * length * 0.85
            v.capsule(base, mid, 0.0105 + glove_m, 0.0095 + glove_m, sides=8)
            v.capsule(mid, tip, 0.0095 + glove_m, 0.008 + glove_m, sides=8)
        root = wrist + along * 0.025 + thumb_side * 0.026 + normal * 0.006
        joint = root + along * 0.036 + thumb_side * 0.022 + normal * 0.014
        v.capsule(root, joint, 0.014 + glove_m, 0.011 + glove_m, sides=8)
        v.capsule(joint, joint + along * 0.028 + normal * 0.010 * (1 + max(0.0, curl)), 0.011 + glove_m, 0.008 + glove_m, sides=8)
    return v.merge(0.0055, 2)
