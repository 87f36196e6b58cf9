"""Road paint and pavement repairs as shader masks in road coordinates. Their edges are sharp at any distance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scope_studio.kit.core.shading import Shader, Value


@dataclass(frozen=True)
class Line:
    """A painted line on each side of the road's centre, ``offset_m`` away from it.

    ``mark_m`` is the length of a dash (0 for a solid line), and ``gap_m`` is the distance between dashes.
    """

    offset_m: float
    width_m: float = 0.15
    mark_m: float = 0.0
    gap_m: float = 0.0


@dataclass(frozen=True)
class Patch:
    """A rectangle of different pavement: ``u`` across the road, ``v`` along it, both in metres.

    ``kind`` is "repair" (old dark patch with sealed joints), "fresh" (new black asphalt), or "milled" (surface removed).
    """

    kind: str
    u0: float
    u1: float
    v0: float
    v1: float


@dataclass(frozen=True)
class Stencil:
    """A painted rectangle, such as a stop line or one bar of a hatched area."""

    u0: float
    u1: float
    v0: float
    v1: float


def paint(s: Shader, u: Value, v: Value, lines: Sequence[Line], stencils: Sequence[Stencil] = ()) -> Value:
    """Return a mask that is 1 where there is paint. Its edges waver by a few millimetres, and it has holes from wear."""
    place = _vector(s, u, v)
    ragged = s.ramp(s.noise(place, 9.0, detail=3.0), 0.3, 0.7, -0.014, 0.014)
    across = s.math("ADD", s.math("ABSOLUTE", u), ragged)
    total: Value = 0.0
    for line in lines:
        mask = s.band(across, line.offset_m - line.width_m / 2, line.offset_m + line.width_m / 2, 0.008)
        if line.mark_m > 0:
            along = s.math("FLOORED_MODULO", s.math("ADD", v, ragged), line.mark_m + line.gap_m)
            mask = s.math("MULTIPLY", mask, s.band(along, 0.02, line.mark_m, 0.01))
        total = s.math("MAXIMUM", total, mask)
    for bar in stencils:
        mask = s.math("MULTIPLY", s.band(u, bar.u0, bar.u1, 0.01), s.band(v, bar.v0, bar.v1, 0.01))
        total = s.math("MAXIMUM", total, mask)
    wear = s.ramp(s.noise(place, 2.2, detail=6.0, roughness=0.72), 0.30, 0.45, 0.35, 1.0)
    return s.math("MULTIPLY", total, wear)


def inside(s: Shader, u: Value, v: Value, patch: Patch, soft_m: float = 0.01, grow_m: float = 0.0) -> Value:
    """Return a mask that is 1 inside the patch, enlarged by ``grow_m`` on all sides and softened over ``soft_m`` at its edges."""
    across = s.band(u, patch.u0 - grow_m, patch.u1 + grow_m, soft_m)
    return s.math("MULTIPLY", across, s.band(v, patch.v0 - grow_m, patch.v1 + grow_m, soft_m))


def _vector(s: Shader, u: Value, v: Value) -> Value:
    """Return u and v as a vector."""
    node = s.node("ShaderNodeCombineXYZ")
    s.set_input(node.inputs[0], u)
    s.set_input(node.inputs[1], v)
    return node.outputs[0]
