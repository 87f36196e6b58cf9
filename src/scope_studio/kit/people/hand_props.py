"""Objects in the hands of people, such as tools, phones, boxes and bags."""

from __future__ import annotations

import itertools
from collections.abc import Callable

from mathutils import Matrix, Vector

from scope_studio.kit.core.finishes import glow, paint, sheet, steel, timber
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.people.poses import Joints


def _grip(joints: Joints, index: int, reach: float = 0.085) -> Vector:
    """Return the centre of the closed hand, left (``index`` 0) or right (1)."""
    wrist, elbow = joints.wrists[index], joints.elbows[index]
    return wrist + (wrist - elbow).normalized() * reach


def _aim(s: Solid, origin: Vector, forward: Vector, up: Vector) -> None:
    """Move the frame of ``s`` so that +y is ``forward`` and +z is as close to ``up`` as possible."""
    y = forward.normalized()
    x = y.cross(up).normalized()
    z = x.cross(y)
    turn = Matrix((x, y, z)).transposed().to_4x4()
    s.frame = s.frame @ Matrix.Translation(origin) @ turn


def _shovel(s: Solid, joints: Joints) -> None:
    left, right = _grip(joints, 0, 0.07), _grip(joints, 1, 0.07)
    along = (left - right).normalized()
    top = right - along * 0.10
    tip = top + along * 1.12
    s.rod(tuple(top), tuple(tip), 0.016, timber())
    cross = along.cross(Vector((0, 0, 1))).normalized()
    s.rod(tuple(top - cross * 0.06), tuple(top + cross * 0.06), 0.015, timber())
    _aim(s, tip, along, Vector((0, 0, 1)))
    s.rod((0, -0.12, 0), (0, 0.08, 0), 0.021, steel(dark=True))
    blade = [(-0.115, 0.03), (0.115, 0.03), (0.12, 0.20), (0.085, 0.29), (0.0, 0.33), (-0.085, 0.29), (-0.12, 0.20)]
    s.prism(blade, (-0.004, 0.004), steel(dark=True), "XY")


def _broom(s: Solid, joints: Joints) -> None:
    left, right = _grip(joints, 0, 0.07), _grip(joints, 1, 0.07)
    along = (left - right).normalized()
    top, tip = right - along * 0.15, right + along * 1.25
    s.rod(tuple(top), tuple(tip), 0.014, timber())
    _aim(s, tip, along, Vector((0, 0, 1)))
    s.box((0.42, 0.05, 0.06), (0, 0.01, 0), timber(fresh=False))
    s.box((0.42, 0.08, 0.05), (0, 0.07, 0), paint("dark red", roughness=0.8), 0.012)


def _phone(s: Solid, joints: Joints) -> None:
    _aim(
        s,
        _grip(joints, 1, 0.075) + joints.head.to_3x3() @ Vector((-0.03, 0.0, 0.0)),
        joints.head.to_3x3() @ Vector((0.0, 0.45, -0.9)),
        joints.head.to_3x3() @ Vector((-1, 0, 0)),
    )
    s.box((0.070, 0.148, 0.009), (0, 0, 0), paint("black", dirt=0.05, roughness=0.2), 0.003)


def _clipboard(s: Solid, joints: Joints) -> None:
    _aim(s, _grip(joints, 0, 0.06) + Vector((0.09, 0.04, 0.035)), Vector((0.0, 0.86, 0.45)), Vector((0, -0.5, 0.86)))
    s.box((0.235, 0.325, 0.006), (0, 0, 0), paint("brown", dirt=0.1), 0.002)
    s.box((0.210, 0.285, 0.003), (0, -0.012, 0.0045), sheet("white", dirt=0.05), 0.001)
    s.box((0.10, 0.03, 0.012), (0, 0.145, 0.008), steel(), 0.003)
    for i in range(9):
        s.box((0.15 - 0.03 * (i % 3), 0.004, 0.001), (-0.012 * (i % 3), 0.10 - 0.025 * i, 0.0068), paint("dark grey"), 0.0)


def _box(s: Solid, joints: Joints) -> None:
    middle = (_grip(joints, 0) + _grip(joints, 1)) / 2
    across = (_grip(joints, 1) - _grip(joints, 0)).normalized()
    width = (_grip(joints, 1) - _grip(joints, 0)).length
    _aim(s, middle + Vector((0, 0.06, 0.06)), Vector((0, 0, 1)).cross(across), Vector((0, 0, 1)))
    s.box((width - 0.02, 0.30, 0.26), (0, 0, 0), paint("brown", dirt=0.2, roughness=0.85), 0.006)
    s.box((0.05, 0.302, 0.262), (0, 0, 0), paint("beige", dirt=0.1), 0.004)


def _cone(s: Solid, joints: Joints) -> None:
    middle = (_grip(joints, 0) + _grip(joints, 1)) / 2 + Vector((0, 0.02, -0.16))
    s.frame = s.frame @ Matrix.Translation(middle)
    orange, white = paint("orange", dirt=0.34, roughness=0.46), sheet("white", dirt=0.3)
    s.box((0.42, 0.42, 0.035), (0, 0, 0), paint("black"), 0.012)
    cuts = [(0.16, 0.0), (0.097, 0.30), (0.076, 0.43), (0.065, 0.50), (0.047, 0.62), (0.030, 0.75)]
    for i, (low, high) in enumerate(itertools.pairwise(cuts)):
        s.lathe([low, high], white if i in (1, 3) else orange, steps=24)


def _bag(s: Solid, joints: Joints) -> None:
    grip = _grip(joints, 1)
    for dy in (-0.05, 0.05):
        s.tube([tuple(grip + Vector((0, dy * 0.4, 0))), tuple(grip + Vector((0, dy, -0.17)))], 0.007, paint("brown"))
    s.frame = s.frame @ Matrix.Translation(grip + Vector((0, 0, -0.32)))
    s.box((0.10, 0.34, 0.30), (0, 0, 0), paint("brown", dirt=0.15, roughness=0.6), 0.03)


def _toolbox(s: Solid, joints: Joints) -> None:
    grip = _grip(joints, 1)
    s.frame = s.frame @ Matrix.Translation(grip)
    s.tube([(0, -0.14, -0.09), (0, -0.10, 0), (0, 0.10, 0), (0, 0.14, -0.09)], 0.012, paint("black"))
    s.box((0.20, 0.44, 0.19), (0, 0, -0.18), paint("red", dirt=0.3), 0.012)


def _trowel(s: Solid, joints: Joints) -> None:
    grip = _grip(joints, 1)
    _aim(s, grip, Vector((-0.2, 0.6, -0.75)), Vector((0, 0.6, 0.6)))
    s.rod((0, -0.06, 0), (0, 0.07, 0), 0.014, timber())
    s.prism([(-0.05, 0.09), (0.05, 0.09), (0.012, 0.25), (-0.012, 0.25)], (-0.002, 0.002), steel(), "XY")


def _torch(s: Solid, joints: Joints) -> None:
    grip = _grip(joints, 1)
    _aim(s, grip, joints.chest.to_3x3() @ Vector((0.0, 0.9, -0.35)), Vector((0, 0, 1)))
    s.rod((0, -0.10, 0), (0, 0.11, 0), 0.017, paint("black", dirt=0.1))
    s.lathe([(0.018, 0.10), (0.030, 0.15), (0.030, 0.18)], paint("black", dirt=0.1), axis="Y", steps=16)
    s.lathe([(0.026, 0.178), (0.024, 0.184)], glow("white", 12.0), axis="Y", steps=16)


PROP_BUILDERS: dict[str, Callable[[Solid, Joints], None]] = {
    "shovel": _shovel,
    "broom": _broom,
    "phone": _phone,
    "clipboard": _clipboard,
    "box": _box,
    "cone": _cone,
    "bag": _bag,
    "toolbox": _toolbox,
    "torch": _torch,
    "trowel": _trowel,
}
"""Functions that add a prop to the hands, by the name of the prop."""


def add_prop(s: Solid, joints: Joints, name: str) -> None:
    """Add the prop with this name to the hands."""
    saved = s.frame
    PROP_BUILDERS[name](s, joints)
    s.frame = saved
