"""A motorcycle without a fairing."""

from __future__ import annotations

import math

from scope_studio.kit.core.finishes import lens, paint, rubber, sheet
from scope_studio.kit.core.shading import plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built


def motorcycle(colour: str = "red", *, plate: str = "KM21 BYK") -> Built:
    """Build a motorcycle, 2.1 m long, that faces +y. It stands upright; to lean it, pass ``lean_deg`` to ``Stage.place``."""
    s = Solid(f"{colour} motorcycle")
    finish, black = paint(colour, dirt=0.12, roughness=0.22), paint("black", dirt=0.2)
    chrome, iron = (
        plain("motorcycle chrome", (0.62, 0.62, 0.63), 0.16, 1.0),
        plain("motorcycle alloy", (0.28, 0.285, 0.29), 0.4, 0.7),
    )
    front, rear, r = 0.70, -0.70, 0.315
    for y, width in ((front, 0.115), (rear, 0.17)):
        h = width / 2
        s.lathe(
            [(r * 0.72, -h * 0.8), (r * 0.9, -h), (r, -h * 0.35), (r, h * 0.35), (r * 0.9, h), (r * 0.72, h * 0.8)],
            rubber(),
            (0, y, r),
            "X",
            36,
        )
        s.lathe([(r * 0.74, -h * 0.6), (r * 0.74, h * 0.6)], iron, (0, y, r), "X", 36)
        s.lathe([(0.06, -h * 1.1), (0.06, h * 1.1)], iron, (0, y, r), "X", 18)
        for k in range(5):
            a = 2 * math.pi * k / 5
            s.rod(
                (0, y + 0.05 * math.cos(a), r + 0.05 * math.sin(a)),
                (0, y + 0.22 * math.cos(a), r + 0.22 * math.sin(a)),
                0.016,
                iron,
                sides=6,
            )
        for x in (-h - 0.02, h + 0.02):
            s.lathe([(0.13, -0.003), (0.13, 0.003)], chrome, (x, y, r), "X", 28)
    for x in (-0.10, 0.10):
        s.rod((x, front, r), (x, 0.40, 0.98), 0.026, chrome)
        s.rod((x * 1.1, rear, r), (x * 1.1, -0.15, 0.42), 0.030, iron)
    s.prism(
        [
            (front - 0.30, 0.60),
            (front - 0.05, 0.70),
            (front + 0.22, 0.60),
            (front + 0.20, 0.57),
            (front - 0.05, 0.66),
            (front - 0.28, 0.57),
        ],
        (-0.07, 0.07),
        finish,
        "YZ",
    )
    s.tube([(-0.36, 0.22, 1.07), (-0.22, 0.34, 1.08), (0.0, 0.38, 1.03), (0.22, 0.34, 1.08), (0.36, 0.22, 1.07)], 0.014, black)
    for x in (-0.36, 0.36):
        s.rod((x * 0.92, 0.245, 1.07), (x * 1.05, 0.19, 1.068), 0.020, rubber())
        s.rod((x * 0.6, 0.34, 1.08), (x * 0.78, 0.30, 1.22), 0.006, black)
        s.box((0.13, 0.02, 0.08), (x * 0.82, 0.29, 1.25), black, 0.02)
    s.lathe([(0.03, -0.08), (0.09, -0.04), (0.095, 0.05)], black, (0, 0.50, 0.90), "Y", 24)
    s.lathe([(0.088, 0.045), (0.075, 0.062), (0.03, 0.07)], lens("light grey"), (0, 0.50, 0.90), "Y", 24)
    s.prism([(0.34, 0.82), (0.36, 0.92), (0.20, 1.01), (-0.10, 0.97), (-0.16, 0.84)], (-0.135, 0.135), finish, "YZ")
    s.prism([(0.30, 0.84), (0.30, 0.90), (0.16, 0.97), (-0.06, 0.94), (-0.10, 0.86)], (-0.165, 0.165), finish, "YZ")
    s.prism(
        [(-0.12, 0.86), (-0.14, 0.90), (-0.40, 0.86), (-0.62, 0.93), (-0.86, 0.96), (-0.84, 0.90), (-0.45, 0.80), (-0.15, 0.80)],
        (-0.12, 0.12),
        rubber(),
        "YZ",
    )
    s.prism([(-0.50, 0.80), (-0.90, 0.90), (-0.95, 0.86), (-0.55, 0.70)], (-0.08, 0.08), finish, "YZ")
    s.box((0.14, 0.05, 0.06), (0, -0.95, 0.87), lens("red"), 0.015)
    s.box((0.18, 0.012, 0.14), (0, -0.99, 0.68), sheet("yellow"), 0.002)
    s.rod((0, -0.93, 0.86), (0, -0.985, 0.70), 0.012, black)
    top, _, low = plate.partition(" ")
    for body, z in ((top, 0.712), (low, 0.652)):
        s.text(body, 0.045, (0, -0.9975, z), sheet("black", dirt=0.05), facing="-Y")
    s.box((0.30, 0.34, 0.24), (0, 0.02, 0.42), iron, 0.05)
    for k in range(7):
        s.box((0.26, 0.22, 0.018), (0, 0.10, 0.54 + 0.032 * k), iron, 0.004)
    s.box((0.22, 0.18, 0.12), (0, 0.10, 0.78), black, 0.03)
    for x in (-0.06, 0.06):
        s.tube(
            [(x, 0.22, 0.66), (x * 1.4, 0.34, 0.52), (x * 1.4, 0.28, 0.30), (0.15, 0.0, 0.24), (0.17, -0.35, 0.28)], 0.022, chrome
        )
    s.rod((0.18, -0.32, 0.28), (0.20, -0.92, 0.44), 0.052, chrome, radius_b=0.058, sides=16)
    s.tube([(0.0, 0.36, 0.95), (0.0, 0.18, 0.80), (0.0, -0.10, 0.72), (0.0, -0.14, 0.42)], 0.035, black)
    for x in (-1, 1):
        s.rod((x * 0.12, -0.12, 0.34), (x * 0.26, -0.12, 0.34), 0.016, rubber())
        s.box((0.06, 0.03, 0.04), (x * 0.14, 0.44, 0.80), lens("amber"), 0.012)
        s.box((0.06, 0.03, 0.04), (x * 0.12, -0.94, 0.80), lens("amber"), 0.012)
    s.rod((-0.10, -0.05, 0.28), (-0.26, -0.02, 0.01), 0.014, black)
    return s.built()
