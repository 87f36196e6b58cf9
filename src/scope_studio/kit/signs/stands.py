"""Supports for signs: galvanised posts, and temporary frames with sandbags."""

from __future__ import annotations

from scope_studio.kit.core.finishes import concrete, paint, steel
from scope_studio.kit.core.solid import Solid


def add_posts(s: Solid, spread: float, top: float, radius: float, y: float = -0.10) -> None:
    """Add galvanised posts in small concrete footings: one post if ``spread`` is 0, otherwise two posts."""
    for x in sorted({-spread, spread}):
        s.lathe([(radius, -0.02), (radius, top), (radius * 0.6, top + 0.012)], steel(), (x, y, 0), steps=16)
        s.lathe(
            [(radius * 3.2, 0.0), (radius * 3.0, 0.035), (radius * 1.2, 0.05)],
            concrete(light=False),
            (x, y, 0),
            steps=16,
        )


def frame_stand(s: Solid, width: float, low: float) -> None:
    """Add a temporary steel stand, weighted with sandbags, for signs on the road."""
    for x in (-width * 0.28, width * 0.28):
        s.rod((x, -0.035, low + 0.5), (x, -0.035, 0.02), 0.016, steel(dark=True))
        s.rod((x, -0.03, low + 0.5), (x, -0.46, 0.02), 0.016, steel(dark=True))
        s.rod((x, 0.18, 0.02), (x, -0.50, 0.02), 0.016, steel(dark=True))
    for y in (0.10, -0.40):
        s.rod((-width * 0.32, y, 0.035), (width * 0.32, y, 0.035), 0.014, steel(dark=True))
    for x in (-0.16, 0.17):
        s.lathe(
            [(0.03, -0.24), (0.085, -0.19), (0.105, 0.0), (0.085, 0.19), (0.03, 0.24)],
            paint("khaki", roughness=0.95),
            (x, -0.40, 0.085),
            "X",
            14,
        )
