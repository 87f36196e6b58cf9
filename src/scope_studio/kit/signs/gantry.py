"""A motorway gantry: a box truss on two braced legs, with a walkway, rails, lamps, suspended panels and lane signals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scope_studio.kit.core.finishes import concrete, glow, lens, paint, steel
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import Panel, panel_face

TRUSS_SIZE_M = (1.1, 1.3)
"""Depth (along the road) and height of the truss in metres."""


@dataclass(frozen=True)
class LaneSignal:
    """A matrix lane signal: a black box with a lit figure ("50") or a red "X"."""

    text: str


def gantry(
    span_m: float,
    panels: Sequence[tuple[float, Panel]] = (),
    clearance_m: float = 5.8,
    *,
    signals: Sequence[tuple[float, LaneSignal]] = (),
    facing: str = "-Y",
) -> Built:
    """Build a gantry along x. Its legs are at x = -``span_m`` / 2 and x = ``span_m`` / 2.

    ``panels`` and ``signals`` hang at the given x coordinates; their lower edges are ``clearance_m`` above the road. ``facing`` is
    the direction that they face: "-Y" for drivers who travel towards +y, "+Y" for drivers in the other direction.
    """
    s = Solid("gantry")
    depth, height = TRUSS_SIZE_M
    base = clearance_m + 0.35
    _truss(s, span_m, base)
    for sign in (-1, 1):
        _leg(s, sign * span_m / 2, base + height)
    flip = 180.0 if facing == "-Y" else 0.0
    front = -1.0 if facing == "-Y" else 1.0
    _walkway(s, span_m, base, -front)
    for x, spec in panels:
        with s.at(x, front * (depth / 2 + 0.34), clearance_m + spec.height / 2, turn=flip):
            panel_face(s, spec)
            for u in (-spec.width * 0.38, 0.0, spec.width * 0.38):
                s.box((0.10, 0.06, spec.height * 0.98), (u, -0.072, 0), steel(), 0.006)
                for z in (0.0, height):
                    low = clearance_m + spec.height / 2
                    if abs(base + z - low) < spec.height / 2:
                        s.rod((u, -0.09, base + z - low), (u, -0.36, base + z - low), 0.035, steel())
            for u in (-spec.width * 0.3, spec.width * 0.3):
                s.rod((u, -0.10, -spec.height / 2 + 0.05), (u, 0.62, -spec.height / 2 - 0.10), 0.018, steel())
                s.box((0.34, 0.14, 0.09), (u, 0.66, -spec.height / 2 - 0.08), paint("dark grey"), 0.015)
    for x, signal in signals:
        with s.at(x, front * (depth / 2 + 0.30), clearance_m + 0.62, turn=flip):
            _signal(s, signal)
    return s.built()


def _truss(s: Solid, span: float, base: float) -> None:
    depth, height = TRUSS_SIZE_M
    bays = max(4, round(span / 1.7))
    step = span / bays
    paintwork = steel()
    for y in (-depth / 2, depth / 2):
        for z in (base, base + height):
            s.box((span + 0.5, 0.13, 0.13), (0, y, z), paintwork, 0.012)
        for i in range(bays + 1):
            x = -span / 2 + i * step
            s.rod((x, y, base), (x, y, base + height), 0.04, paintwork)
            if i < bays:
                ends = (base, base + height) if i % 2 == 0 else (base + height, base)
                s.rod((x, y, ends[0]), (x + step, y, ends[1]), 0.036, paintwork)
    for z in (base, base + height):
        for i in range(bays + 1):
            x = -span / 2 + i * step
            s.rod((x, -depth / 2, z), (x, depth / 2, z), 0.035, paintwork)
            if i < bays:
                a, b = (-depth / 2, depth / 2) if i % 2 == 0 else (depth / 2, -depth / 2)
                s.rod((x, a, z), (x + step, b, z), 0.026, paintwork)


def _leg(s: Solid, x: float, top: float) -> None:
    depth, _ = TRUSS_SIZE_M
    for y in (-depth / 2, depth / 2):
        s.box((0.30, 0.30, top + 0.05), (x, y, (top + 0.05) / 2), steel(), 0.02)
        s.box((0.62, 0.62, 0.06), (x, y, 0.43), steel(dark=True), 0.01)
        for dx in (-0.24, 0.24):
            for dy in (-0.24, 0.24):
                s.lathe([(0.025, 0.0), (0.025, 0.06)], steel(dark=True), (x + dx, y + dy, 0.46), steps=6)
    s.box((1.1, depth + 1.1, 0.40), (x, 0, 0.20), concrete(), 0.03)
    levels = 4
    for i in range(levels):
        low, high = 0.9 + (top - 2.2) * i / levels, 0.9 + (top - 2.2) * (i + 1) / levels
        a, b = (-depth / 2, depth / 2) if i % 2 == 0 else (depth / 2, -depth / 2)
        s.rod((x, a, low), (x, b, high), 0.04, steel())
        s.rod((x, -depth / 2, high), (x, depth / 2, high), 0.035, steel())
    s.box((0.45, 0.28, 0.9), (x + (0.40 if x < 0 else -0.40), 0, 1.05), paint("light grey", dirt=0.35), 0.01)
    if x > 0:
        for y in (-0.2, 0.2):
            s.rod((x + 0.30, y, 2.4), (x + 0.30, y, top + 1.0), 0.018, steel())
        for i in range(int((top - 2.4) / 0.28)):
            s.rod((x + 0.30, -0.2, 2.5 + 0.28 * i), (x + 0.30, 0.2, 2.5 + 0.28 * i), 0.012, steel())


def _walkway(s: Solid, span: float, base: float, side: float) -> None:
    depth, height = TRUSS_SIZE_M
    s.box((span, depth - 0.2, 0.04), (0, 0, base + 0.09), steel(dark=True), 0.005)
    y = side * (depth / 2)
    top = base + height
    count = round(span / 1.8)
    for i in range(count + 1):
        x = -span / 2 + span * i / count
        for yy in (-y, y):
            s.rod((x, yy, top), (x, yy, top + 0.55), 0.02, steel())
    for yy in (-y, y):
        for z in (0.28, 0.55):
            s.rod((-span / 2, yy, top + z), (span / 2, yy, top + z), 0.02, steel())
    s.tube([(-span / 2, y, base + 0.16), (span / 2, y, base + 0.16)], 0.04, paint("black"), sides=6)


def _signal(s: Solid, signal: LaneSignal) -> None:
    s.box((1.15, 0.30, 1.15), (0, -0.16, 0), paint("dark grey", dirt=0.3), 0.02)
    s.box((1.05, 0.02, 1.05), (0, -0.006, 0), lens("black"), 0.004)
    s.box((1.2, 0.20, 0.03), (0, 0.06, 0.57), paint("dark grey"), 0.004)
    for x in (-0.35, 0.35):
        s.rod((x, -0.28, 0.2), (x, -0.50, 0.2), 0.03, steel())
    if signal.text.upper() == "X":
        for a, b in (((-0.3, -0.3), (0.3, 0.3)), ((-0.3, 0.3), (0.3, -0.3))):
            for k in range(13):
                t = k / 12
                x, z = a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t
                s.lathe([(0.026, 0.006), (0.020, 0.014)], glow("red", 5.0), (x, 0.0, z), "Y", 8)
        return
    ring = 28
    for k in range(ring):
        with s.at(0, 0, 0, roll=360.0 * k / ring):
            s.lathe([(0.022, 0.006), (0.016, 0.014)], glow("red", 4.0), (0.43, 0, 0), "Y", 8)
    cap = min(0.40, 0.58 / extent(signal.text, 1.0))
    s.text(signal.text, cap, (0, 0.012, 0), glow("white", 3.0))
