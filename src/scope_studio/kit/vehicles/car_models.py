"""Shapes of the car models: cross-sections, windows, and details drawn on the paint.

Lengths are in metres. y increases towards the front, and the wheelbase is centred on y = 0.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from scope_studio.kit.core.parts import Point
from scope_studio.kit.vehicles import paintwork as pw
from scope_studio.kit.vehicles import printed_details
from scope_studio.kit.vehicles.bodywork import Pane, Station
from scope_studio.kit.vehicles.paintwork import AMBER, GAP, REAR_LAMP, TRIM, Patch


@dataclass(frozen=True)
class Cabin:
    """The interior that is visible through the windows, between ``front_y`` (dashboard) and ``rear_y`` and below ``belt_z``.

    ``shelf_m`` is the depth of the parcel shelf behind the rear seats, or 0 for none.
    """

    front_y: float
    rear_y: float
    belt_z: float
    half_width: float
    floor_z: float
    seat_rows: tuple[float, ...]
    shelf_m: float = 0.0


@dataclass(frozen=True)
class CarModel:
    """The shape and the parts of one car model.

    ``stations``, ``panes``, ``creases`` and ``bulge`` are arguments of ``bodywork.shell``. ``axles`` contains y coordinates, and
    the wheels are at ``track_x`` on both sides. ``handles`` and ``mirror`` are positions (y, z) on the side, and
    ``plate_z`` contains the heights of the front and rear number plates. ``pillars`` lists the (y, width) of door pillars.
    ``arch_trim`` adds black flares to the wheel arches. ``extra_cutters`` lists the (size, centre) of boxes to subtract from
    the body for a load bed.
    """

    name: str
    stations: list[Station]
    panes: list[Pane]
    axles: tuple[float, float]
    track_x: float
    wheel_radius: float
    bulge: tuple[float, float]
    creases: list[tuple[int, float, int, int]]
    patches: list[Patch]
    handles: list[tuple[float, float]]
    mirror: tuple[float, float]
    plate_z: tuple[float, float]
    cabin: Cabin
    pillars: list[tuple[float, float]] = field(default_factory=list)
    steel_wheels: bool = False
    arch_trim: bool = False
    tyre_width: float = 0.21
    extra_cutters: list[tuple[Point, Point]] = field(default_factory=list)
    spokes: int = 5


def _lower(width: float, floor: float = 0.19) -> list[tuple[float, float]]:
    """Return the section points below the waist of a car."""
    return [(0.0, floor), (width - 0.14, floor), (width - 0.01, floor + 0.13), (width, 0.60)]


SALOON = CarModel(
    name="saloon",
    stations=[
        Station(2.30, [(0, 0.24), (0.60, 0.23), (0.72, 0.32), (0.76, 0.50), (0.72, 0.62), (0.62, 0.665),
            (0.40, 0.69), (0, 0.70)], {1: -0.1}),
        Station(2.12, [(0, 0.18), (0.70, 0.19), (0.85, 0.31), (0.875, 0.52), (0.84, 0.68), (0.73, 0.745),
            (0.45, 0.775), (0, 0.79)]),
        Station(1.45, [*_lower(0.915), (0.895, 0.80), (0.80, 0.86), (0.50, 0.90), (0, 0.915)]),
        Station(0.92, [*_lower(0.915), (0.90, 0.865), (0.83, 0.91), (0.70, 0.935), (0, 0.985)], {7: 0.14, 6: 0.03}),
        Station(0.10, [*_lower(0.915), (0.905, 0.885), (0.845, 0.93), (0.60, 1.355), (0, 1.43)], {7: 0.10}),
        Station(-0.38, [*_lower(0.915), (0.905, 0.895), (0.845, 0.94), (0.61, 1.385), (0, 1.46)]),
        Station(-1.12, [*_lower(0.915), (0.905, 0.91), (0.845, 0.955), (0.585, 1.335), (0, 1.415)]),
        Station(-1.80, [*_lower(0.91), (0.89, 0.925), (0.81, 0.97), (0.66, 1.00), (0, 1.045)], {7: -0.10}),
        Station(-2.22, [(0, 0.22), (0.70, 0.22), (0.85, 0.34), (0.88, 0.62), (0.85, 0.90), (0.76, 0.965),
            (0.50, 1.00), (0, 1.015)]),
        Station(-2.42, [(0, 0.28), (0.58, 0.27), (0.72, 0.36), (0.78, 0.62), (0.77, 0.86), (0.70, 0.935),
            (0.45, 0.965), (0, 0.98)]),
    ],
    panes=[Pane((3, 6), (5, 6), frame_m=0.03), Pane((3, 4), (6, 7), across=True, frame_m=0.035), Pane((6, 7), (6, 7),
        across=True, frame_m=0.035)],
    pillars=[(-0.37, 0.10)],
    cabin=Cabin(0.78, -1.45, 0.90, 0.74, 0.30, (-0.05, -0.92), 0.40),
    axles=(1.42, -1.40),
    track_x=0.785,
    wheel_radius=0.325,
    bulge=(0.10, 0.07),
    creases=[(4, 0.7, 0, 99), (2, 0.35, 0, 99), (3, 0.2, 0, 99), (6, 0.85, 3, 7)],
    patches=[
        *printed_details.door_patches([0.98, -0.36, -1.30], 0.30, 0.93, -0.03),
        Patch(GAP, x=(0.742, 0.752), y=(1.05, 2.02), z=(0.7, 1.2), roughness=0.9),
        Patch(GAP, x=(0.0, 0.745), y=(2.11, 2.12), z=(0.6, 1.0), y_per_x=-0.06, roughness=0.9),
        Patch(GAP, x=(0.0, 0.70), y=(-9, -2.2), z=(0.655, 0.664), roughness=0.9),
        Patch(GAP, x=(0.70, 0.709), y=(-9, -1.95), z=(0.66, 1.2), roughness=0.9),
        *printed_details.grille(0.40, 2.0, (0.50, 0.63), 3),
        *printed_details.intake(0.46, 2.0, (0.24, 0.35)),
        *printed_details.headlamp((0.45, 0.78), 1.90, (0.54, 0.645), 0.05),
        *printed_details.rear_lamp((0.42, 0.80), -2.08, (0.72, 0.88)),
        Patch((0.45, 0.45, 0.46), y=(-9, -2.2), x=(-1, 0.40), z=(0.80, 0.815), roughness=0.2),
        Patch(TRIM, y=(-9, -2.1), z=(0.0, 0.40), roughness=0.6),
        Patch(TRIM, y=(0.98, 1.05), x=(-1, 0.66), z=(0.9, 1.1), roughness=0.6, y_per_x=-0.17),
        Patch(TRIM, z=(0.0, 0.265), roughness=0.7),
    ],
    handles=[(-0.20, 0.80), (-1.08, 0.81)],
    mirror=(0.74, 0.99),
    plate_z=(0.43, 0.60),
)  # fmt: skip

HATCHBACK = CarModel(
    name="hatchback",
    stations=[
        Station(2.00, [(0, 0.24), (0.58, 0.23), (0.70, 0.32), (0.74, 0.50), (0.71, 0.66), (0.61, 0.71),
            (0.40, 0.735), (0, 0.745)], {1: -0.1}),
        Station(1.82, [(0, 0.18), (0.68, 0.19), (0.82, 0.31), (0.85, 0.53), (0.82, 0.73), (0.72, 0.80), (0.45, 0.83),
            (0, 0.845)]),
        Station(1.25, [*_lower(0.89), (0.875, 0.84), (0.79, 0.90), (0.50, 0.945), (0, 0.965)]),
        Station(0.86, [*_lower(0.89), (0.88, 0.90), (0.82, 0.95), (0.70, 0.975), (0, 1.03)], {7: 0.14, 6: 0.03}),
        Station(0.06, [*_lower(0.89), (0.885, 0.92), (0.83, 0.965), (0.605, 1.40), (0, 1.475)], {7: 0.10}),
        Station(-0.34, [*_lower(0.89), (0.885, 0.935), (0.83, 0.98), (0.615, 1.43), (0, 1.505)]),
        Station(-1.02, [*_lower(0.89), (0.885, 0.955), (0.83, 1.00), (0.595, 1.40), (0, 1.485)]),
        Station(-1.62, [*_lower(0.89), (0.885, 0.965), (0.82, 1.01), (0.565, 1.345), (0, 1.435)], {7: -0.06}),
        Station(-1.86, [*_lower(0.87), (0.85, 0.96), (0.78, 1.00), (0.62, 1.02), (0, 1.03)], {7: -0.07, 6: -0.02}),
        Station(-1.99, [(0, 0.28), (0.58, 0.27), (0.72, 0.36), (0.78, 0.62), (0.77, 0.80), (0.70, 0.86),
            (0.45, 0.885), (0, 0.895)]),
    ],
    panes=[
        Pane((3, 6), (5, 6), frame_m=0.03), Pane((3, 4), (6, 7), across=True, frame_m=0.035),
        Pane((7, 8), (6, 7), across=True, frame_m=0.04, tinted=True),
    ],
    pillars=[(-0.33, 0.10)],
    cabin=Cabin(0.72, -1.62, 0.93, 0.72, 0.30, (-0.05, -0.88), 0.12),
    axles=(1.28, -1.28),
    track_x=0.765,
    wheel_radius=0.315,
    bulge=(0.10, 0.06),
    creases=[(4, 0.7, 0, 99), (2, 0.35, 0, 99), (3, 0.2, 0, 99), (6, 0.85, 3, 7)],
    patches=[
        *printed_details.door_patches([0.90, -0.32, -1.16], 0.30, 0.97, -0.03),
        Patch(GAP, x=(0.722, 0.732), y=(1.0, 1.75), z=(0.7, 1.2), roughness=0.9),
        Patch(GAP, x=(0.0, 0.72), y=(1.86, 1.869), z=(0.6, 1.0), y_per_x=-0.06, roughness=0.9),
        Patch(GAP, x=(0.0, 0.70), y=(-9, -1.7), z=(0.50, 0.509), roughness=0.9),
        Patch(GAP, x=(0.70, 0.709), y=(-9, -1.6), z=(0.5, 1.0), roughness=0.9),
        *printed_details.grille(0.40, 1.7, (0.57, 0.66), 2),
        *printed_details.intake(0.42, 1.7, (0.25, 0.38)),
        *printed_details.headlamp((0.45, 0.76), 1.58, (0.56, 0.69), 0.06),
        *printed_details.rear_lamp((0.58, 0.80), -1.70, (0.66, 0.96)),
        Patch(TRIM, y=(-9, -1.8), z=(0.0, 0.40), roughness=0.6),
        Patch(TRIM, z=(0.0, 0.265), roughness=0.7),
    ],
    handles=[(-0.18, 0.84), (-0.98, 0.85)],
    mirror=(0.68, 1.03),
    plate_z=(0.46, 0.62),
    spokes=6,
)  # fmt: skip

SUV = CarModel(
    name="suv",
    stations=[
        Station(2.18, [(0, 0.34), (0.62, 0.33), (0.76, 0.42), (0.80, 0.64), (0.78, 0.86), (0.70, 0.92), (0.42, 0.95),
            (0, 0.96)], {1: -0.1}),
        Station(2.02, [(0, 0.27), (0.74, 0.27), (0.88, 0.40), (0.91, 0.66), (0.88, 0.92), (0.78, 1.00), (0.46, 1.03),
            (0, 1.045)]),
        Station(1.40, [*_lower(0.945, 0.26), (0.93, 1.00), (0.84, 1.06), (0.52, 1.095), (0, 1.11)]),
        Station(0.92, [*_lower(0.945, 0.26), (0.935, 1.04), (0.87, 1.09), (0.75, 1.115),
            (0, 1.16)], {7: 0.12, 6: 0.03}),
        Station(0.20, [*_lower(0.945, 0.26), (0.935, 1.055), (0.875, 1.105), (0.66, 1.60), (0, 1.69)], {7: 0.09}),
        Station(-0.30, [*_lower(0.945, 0.26), (0.935, 1.065), (0.875, 1.115), (0.67, 1.64), (0, 1.73)]),
        Station(-1.08, [*_lower(0.945, 0.26), (0.935, 1.075), (0.875, 1.125), (0.665, 1.635), (0, 1.725)]),
        Station(-1.95, [*_lower(0.945, 0.26), (0.93, 1.08), (0.87, 1.13), (0.635, 1.60), (0, 1.69)], {7: -0.05}),
        Station(-2.16, [*_lower(0.915, 0.28), (0.895, 1.06), (0.83, 1.10), (0.68, 1.12),
            (0, 1.13)], {7: -0.06, 6: -0.02}),
        Station(-2.27, [(0, 0.36), (0.60, 0.35), (0.76, 0.44), (0.84, 0.66), (0.83, 0.90), (0.76, 0.96),
            (0.48, 0.985), (0, 0.995)]),
    ],
    panes=[
        Pane((3, 7), (5, 6), frame_m=0.03), Pane((3, 4), (6, 7), across=True, frame_m=0.035),
        Pane((7, 8), (6, 7), across=True, frame_m=0.04, tinted=True),
    ],
    pillars=[(-0.29, 0.11), (-1.13, 0.10)],
    cabin=Cabin(0.80, -1.95, 1.08, 0.76, 0.42, (0.0, -0.95)),
    axles=(1.36, -1.34),
    track_x=0.81,
    wheel_radius=0.37,
    bulge=(0.08, 0.05),
    creases=[(4, 0.75, 0, 99), (2, 0.4, 0, 99), (3, 0.25, 0, 99), (6, 0.85, 3, 7)],
    patches=[
        *printed_details.door_patches([0.96, -0.28, -1.22], 0.42, 1.08, -0.02),
        Patch(GAP, x=(0.782, 0.792), y=(1.05, 1.95), z=(0.9, 1.3), roughness=0.9),
        Patch(GAP, x=(0.0, 0.78), y=(2.05, 2.06), z=(0.8, 1.2), y_per_x=-0.05, roughness=0.9),
        Patch(GAP, x=(0.0, 0.76), y=(-9, -2.0), z=(0.58, 0.589), roughness=0.9),
        Patch(GAP, x=(0.76, 0.769), y=(-9, -1.9), z=(0.58, 1.1), roughness=0.9),
        *printed_details.grille(0.44, 1.9, (0.68, 0.90), 4),
        *printed_details.headlamp((0.50, 0.84), 1.74, (0.74, 0.87), 0.03),
        *printed_details.rear_lamp((0.64, 0.86), -2.0, (0.76, 1.06)),
        Patch(TRIM, y=(1.8, 9), z=(0.0, 0.52), roughness=0.6),
        Patch(TRIM, y=(-9, -1.85), z=(0.0, 0.56), roughness=0.6),
        Patch((0.35, 0.35, 0.35), y=(1.9, 9), x=(0.0, 0.5), z=(0.34, 0.40), roughness=0.3),
        Patch(TRIM, z=(0.0, 0.40), roughness=0.7),
    ],
    handles=[(-0.14, 0.94), (-1.02, 0.95)],
    mirror=(0.76, 1.17),
    plate_z=(0.60, 0.72),
    arch_trim=True,
    tyre_width=0.235,
)  # fmt: skip


def _van_side(width: float, belt: float, base: float) -> list[tuple[float, float]]:
    """Return the section points of a van's side."""
    return [(0.0, 0.24), (width - 0.12, 0.24), (width - 0.01, 0.36), (width, 0.75), (width, belt), (width - 0.02, base)]


VAN = CarModel(
    name="van",
    stations=[
        Station(2.58, [(0, 0.32), (0.70, 0.31), (0.84, 0.38), (0.88, 0.66), (0.86, 0.92), (0.76, 1.00), (0.62, 1.03),
            (0.40, 1.05), (0, 1.06)], {1: -0.1}),
        Station(2.40, [(0, 0.26), (0.80, 0.27), (0.95, 0.38), (0.965, 0.72), (0.95, 1.02), (0.86, 1.10),
            (0.70, 1.14), (0.42, 1.16), (0, 1.17)]),
        Station(1.86, [*_van_side(0.985, 1.14, 1.20), (0.82, 1.30), (0.60, 1.335), (0, 1.36)], {8: 0.16, 7: 0.08}),
        Station(1.06, [*_van_side(0.99, 1.17, 1.25), (0.88, 1.98), (0.70, 2.10), (0, 2.14)], {8: 0.12, 7: 0.04}),
        Station(0.78, [*_van_side(0.99, 1.17, 1.25), (0.905, 2.02), (0.78, 2.34), (0, 2.44)], {8: 0.03}),
        Station(0.36, [*_van_side(0.99, 1.17, 1.25), (0.93, 2.03), (0.82, 2.42), (0, 2.52)]),
        Station(0.22, [*_van_side(0.99, 1.17, 1.25), (0.945, 2.03), (0.83, 2.43), (0, 2.53)]),
        Station(-1.2, [*_van_side(0.99, 1.17, 1.25), (0.955, 2.03), (0.84, 2.44), (0, 2.54)]),
        Station(-2.50, [*_van_side(0.99, 1.17, 1.25), (0.95, 2.03), (0.83, 2.42), (0, 2.52)]),
        Station(-2.80, [*_van_side(0.975, 1.17, 1.25), (0.925, 2.02), (0.80, 2.36), (0, 2.45)]),
        Station(-2.86, [(0, 0.40), (0.80, 0.40), (0.93, 0.50), (0.955, 0.80), (0.955, 1.17), (0.94, 1.25),
            (0.88, 2.0), (0.74, 2.28), (0, 2.36)]),
    ],
    panes=[Pane((2, 5), (5, 6), frame_m=0.05), Pane((2, 3), (6, 8), across=True, frame_m=0.03)],
    cabin=Cabin(1.55, 0.22, 1.18, 0.84, 0.75, (0.62,)),
    axles=(1.72, -1.62),
    track_x=0.86,
    wheel_radius=0.345,
    bulge=(0.09, 0.01),
    creases=[(4, 0.4, 0, 99), (2, 0.35, 0, 99), (7, 0.2, 0, 99)],
    patches=[
        pw.upright_gap(1.30, (0.42, 1.20)), pw.upright_gap(0.30, (0.42, 2.1)), pw.level_gap(0.42, (0.30, 1.30)),
        pw.upright_gap(0.24, (0.40, 2.12)), pw.upright_gap(-1.02, (0.40, 2.12)), pw.level_gap(0.40, (-1.02, 0.24)),
            pw.level_gap(2.12, (-1.02, 0.24)),
        pw.level_gap(1.20, (-2.62, -1.0), width=0.022),
        Patch(GAP, x=(-1, 0.006), y=(-9, -2.7), z=(0.50, 2.38), roughness=0.9),
        Patch(GAP, x=(0.885, 0.893), y=(-9, -2.7), z=(0.50, 2.2), roughness=0.9),
        Patch(GAP, x=(0, 0.90), y=(-9, -2.7), z=(0.50, 0.508), roughness=0.9),
        Patch((0.012, 0.015, 0.017), x=(0.10, 0.78), y=(-9, -2.7), z=(1.38, 1.98), roughness=0.03),
        Patch(GAP, x=(0.79, 0.80), y=(1.9, 2.40), z=(0.9, 1.4), roughness=0.9),
        *printed_details.grille(0.56, 2.3, (0.80, 0.98), 3),
        *printed_details.headlamp((0.60, 0.92), 2.16, (0.80, 0.99), 0.06),
        Patch(TRIM, y=(2.1, 9), z=(0, 0.68), roughness=0.65),
        Patch(TRIM, x=(0.9, 2), y=(-2.7, 2.2), z=(0.60, 0.74), roughness=0.65),
        Patch(REAR_LAMP, y=(-9, -2.72), x=(0.90, 2), z=(0.90, 1.50), roughness=0.08, emission=0.3),
        Patch(AMBER, y=(-9, -2.72), x=(0.90, 2), z=(1.36, 1.50), roughness=0.08),
        Patch((0.7, 0.7, 0.7), y=(-9, -2.72), x=(0.90, 2), z=(0.90, 1.02), roughness=0.08),
        Patch(TRIM, y=(-9, -2.6), z=(0, 0.48), roughness=0.65),
    ],
    handles=[(0.42, 1.08), (-0.90, 1.08)],
    mirror=(1.40, 1.38),
    plate_z=(0.52, 0.78),
    steel_wheels=True,
    tyre_width=0.225,
)  # fmt: skip

PICKUP = CarModel(
    name="pickup",
    stations=[
        Station(2.50, [(0, 0.38), (0.64, 0.37), (0.78, 0.46), (0.82, 0.68), (0.80, 0.92), (0.72, 0.98), (0.42, 1.01),
            (0, 1.02)], {1: -0.1}),
        Station(2.34, [(0, 0.32), (0.74, 0.32), (0.88, 0.45), (0.905, 0.70), (0.88, 0.97), (0.78, 1.05),
            (0.46, 1.08), (0, 1.095)]),
        Station(1.70, [*_lower(0.925, 0.32), (0.91, 1.03), (0.83, 1.09), (0.52, 1.12), (0, 1.135)]),
        Station(1.24, [*_lower(0.925, 0.32), (0.915, 1.07), (0.86, 1.12), (0.74, 1.14), (0, 1.18)], {7: 0.12, 6: 0.03}),
        Station(0.56, [*_lower(0.925, 0.32), (0.915, 1.08), (0.86, 1.13), (0.66, 1.66), (0, 1.74)], {7: 0.09}),
        Station(0.06, [*_lower(0.925, 0.32), (0.915, 1.08), (0.86, 1.13), (0.67, 1.70), (0, 1.78)]),
        Station(-0.62, [*_lower(0.925, 0.32), (0.915, 1.08), (0.86, 1.13), (0.665, 1.66), (0, 1.745)], {7: -0.03}),
        Station(-0.86, [*_lower(0.925, 0.32), (0.915, 1.08), (0.875, 1.12), (0.80, 1.135), (0, 1.14)]),
        Station(-1.30, [*_lower(0.925, 0.32), (0.915, 1.08), (0.875, 1.12), (0.80, 1.13), (0, 1.13)]),
        Station(-2.52, [*_lower(0.925, 0.36), (0.915, 1.08), (0.875, 1.12), (0.80, 1.13), (0, 1.13)]),
        Station(-2.60, [(0, 0.46), (0.70, 0.46), (0.84, 0.52), (0.89, 0.70), (0.89, 1.05), (0.86, 1.09),
            (0.78, 1.11), (0, 1.11)]),
    ],
    panes=[
        Pane((3, 6), (5, 6), frame_m=0.035), Pane((3, 4), (6, 7), across=True, frame_m=0.035),
        Pane((6, 7), (6, 7), across=True, frame_m=0.06),
    ],
    pillars=[(0.07, 0.10)],
    cabin=Cabin(1.08, -0.70, 1.09, 0.74, 0.46, (0.30, -0.42)),
    axles=(1.60, -1.58),
    track_x=0.80,
    wheel_radius=0.385,
    bulge=(0.08, 0.0),
    creases=[(4, 0.75, 0, 99), (2, 0.4, 0, 99), (3, 0.25, 0, 99), (5, 0.4, 0, 99), (6, 0.85, 3, 7)],
    patches=[
        *printed_details.door_patches([1.26, 0.08, -0.72], 0.46, 1.09),
        pw.upright_gap(-0.94, (0.4, 1.3), width=0.03),
        Patch(GAP, x=(0.79, 0.80), y=(1.35, 2.25), z=(0.9, 1.3), roughness=0.9),
        Patch(GAP, x=(0.0, 0.79), y=(2.37, 2.38), z=(0.8, 1.2), y_per_x=-0.05, roughness=0.9),
        Patch(GAP, x=(0.0, 0.74), y=(-9, -2.5), z=(0.60, 0.609), roughness=0.9),
        Patch(GAP, x=(0.74, 0.749), y=(-9, -2.5), z=(0.60, 1.2), roughness=0.9),
        Patch(TRIM, x=(0, 0.12), y=(-9, -2.5), z=(0.98, 1.06), roughness=0.5),
        *printed_details.grille(0.46, 2.2, (0.70, 0.96), 3),
        *printed_details.headlamp((0.52, 0.86), 2.08, (0.76, 0.92), 0.0),
        *printed_details.rear_lamp((0.78, 0.90), -2.47, (0.70, 1.04)),
        Patch(TRIM, y=(2.1, 9), z=(0.0, 0.58), roughness=0.6),
        Patch(TRIM, y=(-9, -2.45), z=(0.0, 0.56), roughness=0.6),
        Patch(TRIM, z=(0.0, 0.44), roughness=0.7),
    ],
    handles=[(0.22, 0.98), (-0.54, 0.98)],
    mirror=(1.08, 1.19),
    plate_z=(0.55, 0.52),
    arch_trim=True,
    tyre_width=0.245,
    extra_cutters=[((1.56, 1.50, 1.0), (0.0, -1.73, 1.19))],
    spokes=6,
)  # fmt: skip
