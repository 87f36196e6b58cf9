"""Lamps, grilles and door gaps as patches on a car's paint. They have no geometry and are sharp at any zoom."""

from __future__ import annotations

from scope_studio.kit.vehicles import paintwork as pw
from scope_studio.kit.vehicles.paintwork import AMBER, TRIM, Patch


def headlamp(x: tuple[float, float], y: float, z: tuple[float, float], rise: float = 0.0) -> list[Patch]:
    """Return a headlamp that extends around the corner, from ``x`` outwards and from ``y`` forwards.

    The headlamp has a dark housing, two lenses, a daytime running light and an indicator.
    """
    (x0, x1), (z0, z1) = x, z
    size = (z1 - z0) * 0.78
    low = z0 + rise * x0 + (z1 - z0 - size) * 0.7
    lenses = []
    for centre in (x0 + 0.30 * (x1 - x0), x0 + 0.72 * (x1 - x0)):
        span, lift = (centre - size * 0.55, centre + size * 0.55), rise * (centre - x0)
        lenses.append(
            Patch(
                (0.85, 0.88, 0.90),
                x=span,
                y=(y, 9),
                z=(low + lift, low + size + lift),
                round=True,
                roughness=0.05,
                emission=0.30,
            )
        )
    return [
        Patch(TRIM, x=(x0 - 0.03, 9), y=(y - 0.03, 9), z=(z0 - 0.015, z1 + 0.015), z_per_x=rise, roughness=0.1),
        Patch((0.30, 0.32, 0.34), x=(x0, 9), y=(y, 9), z=z, z_per_x=rise, roughness=0.08),
        *lenses,
        Patch((0.9, 0.92, 0.95), x=(x0, 9), y=(y + 0.02, 9), z=(z0, z0 + 0.018), z_per_x=rise, roughness=0.1, emission=0.8),
        Patch(AMBER, x=(x0, 9), y=(y, y + 0.06), z=z, z_per_x=rise, roughness=0.1),
    ]


def rear_lamp(x: tuple[float, float], y: float, z: tuple[float, float]) -> list[Patch]:
    """Return a rear lamp that extends around the corner: a dark red cover, lit strips, a reversing lamp and an indicator."""
    (x0, x1), (z0, z1) = x, z
    third = (z1 - z0) / 3
    return [
        Patch(TRIM, x=(x0 - 0.02, 9), y=(-9, y + 0.025), z=(z0 - 0.015, z1 + 0.015), roughness=0.1),
        Patch((0.30, 0.004, 0.006), x=(x0, 9), y=(-9, y), z=z, roughness=0.06, emission=0.10),
        Patch(
            (0.85, 0.012, 0.012),
            x=(x0 + 0.015, 9),
            y=(-9, y - 0.01),
            z=(z1 - third * 0.75, z1 - third * 0.2),
            roughness=0.06,
            emission=0.55,
        ),
        Patch(
            (0.72, 0.72, 0.72),
            x=(x0 + 0.02, x0 + 0.02 + (x1 - x0) * 0.4),
            y=(-9, y - 0.01),
            z=(z0 + third * 0.3, z0 + third * 1.1),
            roughness=0.08,
        ),
        Patch(
            AMBER,
            x=(x0 + 0.03 + (x1 - x0) * 0.4, 9),
            y=(-9, y - 0.01),
            z=(z0 + third * 0.3, z0 + third * 1.1),
            roughness=0.08,
            emission=0.1,
        ),
    ]


def grille(x: float, y: float, z: tuple[float, float], bars: int) -> list[Patch]:
    """Return a grille: a black opening of half width ``x`` with bright bars and a badge."""
    z0, z1 = z
    step = (z1 - z0) / (bars + 1)
    bright = [
        Patch(
            (0.35, 0.35, 0.36),
            x=(0.0, x - 0.02),
            y=(y, 9),
            z=(z0 + step * k - 0.006, z0 + step * k + 0.006),
            roughness=0.2,
        )
        for k in range(1, bars + 1)
    ]
    middle = (z0 + z1) / 2
    badge = Patch((0.70, 0.70, 0.72), x=(-0.05, 0.05), y=(y, 9), z=(middle - 0.045, middle + 0.045), round=True, roughness=0.12)
    return [Patch(TRIM, x=(-1, x), y=(y, 9), z=z, roughness=0.6), *bright, badge]


def intake(x: float, y: float, z: tuple[float, float]) -> list[Patch]:
    """Return the air intake in the bumper, with round fog lamps on both sides."""
    fog = (z[0] + 0.01, z[0] + 0.10)
    return [
        Patch(TRIM, x=(-1, x), y=(y, 9), z=z, roughness=0.7),
        Patch(TRIM, x=(x + 0.05, x + 0.22), y=(y - 0.2, 9), z=(fog[0] - 0.02, fog[1] + 0.03), roughness=0.6),
        Patch((0.75, 0.76, 0.78), x=(x + 0.09, x + 0.18), y=(y - 0.2, 9), z=fog, round=True, roughness=0.1),
    ]


def door_patches(doors: list[float], bottom: float, top: float, slant: float = 0.0) -> list[Patch]:
    """Return the gaps around the doors."""
    lines = [pw.upright_gap(y, (bottom, top), y_per_z=slant) for y in doors]
    lines.append(pw.level_gap(bottom, (doors[-1], doors[0])))
    return lines
