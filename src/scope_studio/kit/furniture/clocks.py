"""Clocks: a large dial for a wall or gable, and a double-faced clock on an ornate post."""

from __future__ import annotations

import math

from scope_studio.kit.core.finishes import lens, paint
from scope_studio.kit.core.shading import plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built


def dial(s: Solid, radius: float, hour: int, minute: int, *, rim: str = "black", lift: float = 0.0) -> None:
    """Add a clock face in the plane y = ``lift``, facing +y.

    It has a minute track, hour batons, four numerals, and hands at the given time.
    """
    face, ink = plain("clock face", (0.78, 0.77, 0.72), 0.4), paint("black", dirt=0.0)
    s.lathe([(radius * 1.08, lift - 0.10), (radius * 1.10, lift + 0.02), (radius * 1.02, lift + 0.035), (radius, lift - 0.004)],
            paint(rim, dirt=0.12, roughness=0.3), (0, 0, 0), "Y", 48)  # fmt: skip
    s.lathe([(radius * 1.01, lift - 0.02), (radius * 1.01, lift)], face, (0, 0, 0), "Y", 48)
    for k in range(60):
        a = 2 * math.pi * k / 60
        length, width = (0.12, 0.030) if k % 5 == 0 else (0.045, 0.012)
        if k % 15 == 0:
            length, width = 0.06, 0.05
        with s.at(roll=math.degrees(a)):
            s.box((radius * width, 0.004, radius * length), (0, lift + 0.003, radius * (0.95 - length / 2)), ink, 0.0)
    for text, a in (("12", 0), ("3", 90), ("6", 180), ("9", 270)):
        u, v = -math.sin(math.radians(a)) * radius * 0.72, math.cos(math.radians(a)) * radius * 0.72
        s.text(text, radius * 0.20, (u, lift + 0.003, v), ink, mark=False)
    minutes = 6.0 * minute
    hours = 30.0 * (hour % 12) + minute / 2
    for angle, length, width, y in ((hours, 0.54, 0.075, lift + 0.012), (minutes, 0.84, 0.048, lift + 0.020)):
        with s.at(roll=-angle):
            shape = [
                (-width * 0.5, -0.16),
                (width * 0.5, -0.16),
                (width * 0.62, length * 0.6),
                (0.0, length),
                (-width * 0.62, length * 0.6),
            ]
            s.prism([(u * radius, v * radius) for u, v in shape], (y, y + 0.005), ink, "XZ")
    s.lathe([(radius * 0.06, lift), (radius * 0.06, lift + 0.03)], lens("black"), (0, 0, 0), "Y", 16)


def wall_clock(radius: float, hour: int, minute: int, *, rim: str = "black") -> Built:
    """Build a wall clock centred on the origin. Its dial faces +y and is 0.1 m in front of the plane y = 0."""
    s = Solid("wall clock")
    dial(s, radius, hour, minute, rim=rim, lift=0.10)
    return s.built()


def post_clock(hour: int, minute: int, *, colour: str = "dark green", height: float = 3.6) -> Built:
    """Build a street clock on a fluted column. It is 0.84 m wide and has faces towards +y and -y.

    ``height`` is the height of the clock's centre in metres.
    """
    s = Solid("post clock")
    body = paint(colour, dirt=0.2, roughness=0.35)
    gold = paint("yellow", dirt=0.1, roughness=0.3)
    s.lathe([(0.30, 0.0), (0.30, 0.10), (0.24, 0.14), (0.22, 0.55), (0.26, 0.60), (0.26, 0.66), (0.12, 0.80), (0.10, 0.95),
             (0.085, height - 1.0), (0.12, height - 0.95), (0.12, height - 0.88), (0.07, height - 0.80), (0.06, height - 0.50)],
            body, steps=32)  # fmt: skip
    for k in range(12):
        a = 2 * math.pi * k / 12
        s.rod(
            (0.085 * math.cos(a), 0.085 * math.sin(a), 0.95), (0.076 * math.cos(a), 0.076 * math.sin(a), height - 1.0), 0.014, body
        )
    for z in (0.63, height - 0.91):
        s.lathe([(0.27 if z < 1 else 0.125, z - 0.015), (0.27 if z < 1 else 0.125, z + 0.015)], gold, steps=32)
    s.lathe([(0.46, -0.15), (0.49, -0.12), (0.49, 0.12), (0.46, 0.15)], body, (0, 0, height), "Y", 48)
    s.lathe([(0.14, 0.0), (0.05, 0.10), (0.06, 0.16), (0.01, 0.30)], gold, (0, 0, height + 0.48), steps=20)
    for side in (0.0, 180.0):
        with s.at(0, 0, height, turn=side):
            dial(s, 0.40, hour, minute, rim=colour, lift=0.155)
    return s.built()
