"""Cars and vans: saloon, hatchback, SUV, panel van and pickup."""

from __future__ import annotations

import math

from scope_studio.kit.core import shading
from scope_studio.kit.core.parts import Parts
from scope_studio.kit.core.stage import Built
from scope_studio.kit.vehicles import bodywork as bw
from scope_studio.kit.vehicles import fittings as shared
from scope_studio.kit.vehicles import paintwork as pw
from scope_studio.kit.vehicles import wheels
from scope_studio.kit.vehicles.car_models import HATCHBACK, PICKUP, SALOON, SUV, VAN, Cabin, CarModel


def _body(model: CarModel) -> Parts:
    """Return the parts that all cars of a model share: shell, wheels, interior and fittings."""
    radius = model.wheel_radius
    cutters = bw.arch_cutters(model.axles, radius + 0.055, model.track_x - model.tyre_width / 2 - 0.10)
    for size, centre in model.extra_cutters:
        cutters.box(size, centre, shading.plain("pickup bed liner", (0.055, 0.056, 0.058), 0.75), bevel_m=0.0)
    shell = bw.shell(model.stations, model.panes, creases=model.creases, bulge=model.bulge, cutters=cutters)
    parts = Parts()
    parts.mesh(shell)
    surface = bw.Surface(shell)
    for y in model.axles:
        for sign in (-1, 1):
            centre = (sign * model.track_x, y, radius)
            if model.steel_wheels:
                wheels.steel_wheel(parts, centre, radius, sign, width=model.tyre_width)
            else:
                wheels.car_wheel(parts, centre, radius, sign, width=model.tyre_width, spokes=model.spokes)
            _arch_lip(parts, surface, y, radius, sign, flared=model.arch_trim)
    for sign in (-1, 1):
        for y, z in model.handles:
            x = surface.side_x(y, z)
            parts.box((0.022, 0.20, 0.030), (sign * (x + 0.012), y, z), pw.paint_slot(), bevel_m=0.008)
            parts.box((0.006, 0.10, 0.045), (sign * (x + 0.001), y + 0.01, z - 0.004), pw.black_trim(), bevel_m=0.002)
        _mirror(parts, surface, *model.mirror, sign)
        for y, width in model.pillars:
            _pillar(parts, surface, y, width, model.cabin.belt_z, sign)
    for size, centre in model.extra_cutters:
        for k in range(7):
            rib = (-size[0] / 2 + size[0] * (k + 0.5) / 7, centre[1], centre[2] - size[2] / 2 + 0.01)
            parts.box((0.10, size[1], 0.03), rib, shading.plain("pickup bed liner", (0.055, 0.056, 0.058), 0.75), bevel_m=0.01)
    _interior(parts, model.cabin)
    return parts


def _pillar(parts: Parts, surface: bw.Surface, y: float, width: float, belt_z: float, sign: int) -> None:
    """Add a black door pillar over the side glass."""
    heights = [belt_z + 0.05 + 0.055 * k for k in range(14)]
    edge = [(surface.side_x(y, z) + 0.005, z) for z in heights]
    edge = [e for e in edge if e[0] > 0.62]
    points = [(sign * x, y + s * width / 2 - 0.06 * (z - belt_z), z) for x, z in edge for s in (-1, 1)]
    faces = [(2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2)[::-sign] for k in range(len(edge) - 1)]
    parts.add(points, faces, pw.black_trim(), smooth=True)


def _interior(parts: Parts, cabin: Cabin) -> None:
    """Add a floor, door linings, a dashboard, a steering wheel on the right, and seats with headrests."""
    lining = shading.plain("vehicle lining", (0.035, 0.035, 0.036), 0.9)
    cloth = shading.plain("vehicle seat cloth", (0.12, 0.12, 0.125), 0.9)
    length, middle = cabin.front_y - cabin.rear_y, (cabin.front_y + cabin.rear_y) / 2
    parts.box((2 * cabin.half_width, length, 0.03), (0, middle, cabin.floor_z), lining, bevel_m=0.0)
    height = cabin.belt_z - 0.02 - cabin.floor_z
    for sign in (-1, 1):
        parts.box((0.03, length, height), (sign * cabin.half_width, middle, cabin.floor_z + height / 2), lining, bevel_m=0.0)
    for y in (cabin.front_y, cabin.rear_y):
        parts.box((2 * cabin.half_width, 0.03, height), (0, y, cabin.floor_z + height / 2), lining, bevel_m=0.0)
    parts.box((2 * cabin.half_width, 0.42, 0.20), (0, cabin.front_y - 0.14, cabin.belt_z - 0.10), lining, bevel_m=0.06)
    ring = [
        (0.36 + 0.18 * math.cos(a), cabin.front_y - 0.46 - 0.06 * math.sin(a), cabin.belt_z - 0.06 + 0.17 * math.sin(a))
        for a in (math.pi * k / 9 for k in range(18))
    ]
    parts.tube(ring, 0.016, pw.black_trim(), sides=6, closed=True)
    if cabin.shelf_m:
        shelf_y = cabin.rear_y - cabin.shelf_m / 2 + 0.15
        parts.box((2 * cabin.half_width - 0.06, cabin.shelf_m + 0.3, 0.03), (0, shelf_y, cabin.belt_z), lining, bevel_m=0.0)
    top = cabin.belt_z - 0.04
    for number, y in enumerate(cabin.seat_rows):
        for x in (-0.36, 0.36) if number == 0 else (-0.40, 0.0, 0.40):
            width = 0.50 if number == 0 else 0.40
            parts.box((width, 0.50, 0.16), (x, y + 0.12, top - 0.42), cloth, bevel_m=0.06)
            parts.prism(
                [(y - 0.06, top - 0.45), (y + 0.06, top - 0.40), (y - 0.08, top + 0.10), (y - 0.20, top + 0.10)],
                x - width / 2,
                x + width / 2,
                cloth,
                bevel_m=0.04,
            )
            parts.box((0.24, 0.10, 0.16), (x, y - 0.16, top + 0.21), cloth, bevel_m=0.045)


def _arch_lip(parts: Parts, surface: bw.Surface, y: float, radius: float, sign: int, *, flared: bool) -> None:
    """Add the rolled edge of a wheel arch, or a black flare over it."""
    reach = radius + (0.085 if flared else 0.060)
    path = []
    for k in range(25):
        a = -0.12 * math.pi + 1.24 * math.pi * k / 24
        py, pz = y + reach * math.cos(a), radius * (0.9 if flared else 0.86) + reach * math.sin(a)
        x = surface.side_x(py, pz)
        if pz > 0.2 and x > 0.5:
            path.append((sign * (x + 0.002 if flared else x - 0.006), py, pz))
    if flared:
        parts.tube(path, 0.038, pw.black_trim(), sides=6)
    else:
        parts.tube(path, 0.014, pw.paint_slot(), sides=6)


def _mirror(parts: Parts, surface: bw.Surface, y: float, z: float, sign: int) -> None:
    """Add a door mirror."""
    x = surface.side_x(y - 0.05, z - 0.03)
    parts.tube([(sign * (x - 0.03), y, z - 0.03), (sign * (x + 0.09), y + 0.01, z)], 0.022, pw.black_trim(), sides=6)
    outline = [
        (x + 0.05, z - 0.06),
        (x + 0.21, z - 0.04),
        (x + 0.235, z + 0.06),
        (x + 0.20, z + 0.10),
        (x + 0.07, z + 0.09),
    ]
    parts.prism(
        [(sign * a, b) for a, b in outline],
        y - 0.06,
        y + 0.06,
        pw.paint_slot(),
        axis="Y",
        bevel_m=0.025,
        segments=2,
        smooth=True,
    )
    parts.box((0.14, 0.01, 0.11), (sign * (x + 0.14), y - 0.058, z + 0.02), pw.glass(), bevel_m=0.004)


def _car(
    model: CarModel,
    colour: str,
    plate: str,
    *,
    letters: list[bw.Lettering] | None = None,
    fittings: Parts | None = None,
) -> Built:
    """Build a car of the given model and paint colour, with number plates."""
    mesh = bw.body_mesh(model.name, lambda: _body(model))
    surface = bw.Surface(mesh)
    front = max(surface.end_y(x, model.plate_z[0], True) for x in (0.0, 0.24)) + 0.008
    rear = min(surface.end_y(x, model.plate_z[1], False) for x in (0.0, 0.24)) - 0.008
    plate_parts, plate_letters = bw.number_plates(plate, (front, model.plate_z[0]), (rear, model.plate_z[1]))
    if fittings is not None:
        plate_parts.mesh(fittings.build("fittings"))
    return bw.finish(
        model.name, mesh, [pw.paint(model.name, colour, model.patches)], [*plate_letters, *(letters or [])], plate_parts
    )


def saloon(colour: str, *, plate: str) -> Built:
    """Build a four-door saloon, 4.8 m long."""
    return _car(SALOON, colour, plate)


def hatchback(colour: str, *, plate: str) -> Built:
    """Build a five-door hatchback, 4.1 m long."""
    return _car(HATCHBACK, colour, plate)


def suv(colour: str, *, plate: str) -> Built:
    """Build a tall five-door SUV with black wheel arches and roof rails, 4.5 m long."""
    rails = Parts()
    for sign in (-1, 1):
        path = [
            (sign * 0.60, 0.12, 1.645),
            (sign * 0.61, 0.02, 1.72),
            (sign * 0.62, -0.5, 1.745),
            (sign * 0.61, -1.1, 1.74),
            (sign * 0.59, -1.75, 1.71),
            (sign * 0.58, -1.85, 1.63),
        ]
        rails.tube(path, 0.018, wheels.alloy(), sides=6)
    return _car(SUV, colour, plate, fittings=rails)


def van(colour: str, *, plate: str, lettering: str | None, roof_beacon: bool = False) -> Built:
    """Build a high-roof panel van, 5.5 m long, with ``lettering`` (lines separated by newlines) on both sides."""
    surface = bw.Surface(bw.body_mesh(VAN.name, lambda: _body(VAN)))
    letters: list[bw.Lettering] = []
    if lettering:
        tint = shared.lettering_colour(colour)
        for k, line in enumerate(lettering.split("\n")):
            letters += bw.text_on_both_sides(line, 0.22, -1.28, 1.72 - 0.34 * k, tint, width_m=2.2, onto=surface)
    fittings = _light_bar(0.5, surface.top_z(0.0, 0.5), 1.1) if roof_beacon else None
    return _car(VAN, colour, plate, letters=letters, fittings=fittings)


def _light_bar(y: float, z: float, width: float) -> Parts:
    """Return an orange light bar for a roof."""
    parts = Parts()
    parts.box((width, 0.22, 0.035), (0, y, z + 0.02), pw.black_trim())
    for sign in (-1, 1):
        parts.box((width * 0.34, 0.20, 0.10), (sign * width * 0.31, y, z + 0.085), pw.lamp("beacon"), bevel_m=0.025)
    parts.box((width * 0.26, 0.18, 0.08), (0, y, z + 0.075), pw.lamp("white"), bevel_m=0.02)
    return parts


def pickup(colour: str, *, plate: str, beacon: bool = False) -> Built:
    """Build a double-cab pickup with an open load bed, 5.2 m long. ``beacon`` adds an orange light bar on the roof."""
    surface = bw.Surface(bw.body_mesh(PICKUP.name, lambda: _body(PICKUP)))
    return _car(PICKUP, colour, plate, fittings=_light_bar(-0.1, surface.top_z(0.0, -0.1), 1.0) if beacon else None)
