"""Twenty- and forty-foot shipping containers: corrugated walls, corner castings, doors with lock rods, codes and liveries.

A container extends along y, its doors face +y, and it stands on z = 0.
"""

from __future__ import annotations

import bpy

from scope_studio.kit.core.finishes import PALETTE, steel, timber, with_dirt
from scope_studio.kit.core.shading import Shader, plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built

WIDTH_M, HEIGHT_M = 2.438, 2.591
"""Width and height in metres."""
LENGTH_M = {20: 6.058, 40: 12.192}
"""Length in metres, by nominal length in feet."""

RUST = (0.105, 0.040, 0.018)


def container_paint(colour: str) -> bpy.types.Material:
    """Return the material of weathered container paint: faded, scraped, with rust around chips."""
    name = f"container paint {colour}"
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    s = Shader(name)
    shifted = s.node("ShaderNodeVectorMath", operation="ADD")
    s.set_input(shifted.inputs[0], s.object_coords())
    s.set_input(shifted.inputs[1], s.math("MULTIPLY", s.random(), 53.0))
    p = shifted.outputs[0]
    base = s.mix(s.ramp(s.noise(p, 1.1, 6.0), 0.3, 0.7, 0.0, 0.28), PALETTE[colour], (0.35, 0.34, 0.32))
    dirty = with_dirt(s, base, 0.34, 0.30)
    chips = s.ramp(s.noise(p, 2.6, 8.0, 0.72), 0.615, 0.655)
    runs = s.ramp(s.noise(s.scaled(p, (5.0, 5.0, 0.35)), 1.0, 5.0, 0.6), 0.60, 0.74, 0.0, 0.7)
    rusty = s.mix(s.math("MAXIMUM", chips, runs), dirty, RUST)
    return s.surface(base_color=rusty, roughness=s.ramp(chips, 0, 1, 0.50, 0.85, smooth=False))


def _ink(colour: str) -> bpy.types.Material:
    dark = colour in ("white", "cream", "yellow", "light grey", "silver", "beige", "amber")
    return plain(
        "container letters dark" if dark else "container letters light", (0.02, 0.025, 0.04) if dark else (0.62, 0.62, 0.60), 0.6
    )


def _corrugated_wall(s: Solid, length: float, x: float, z0: float, z1: float, finish: bpy.types.Material) -> None:
    """Add a side wall at ``x`` with trapezoidal corrugations, 36 mm deep, along y."""
    side = 1 if x > 0 else -1
    count = round((length - 0.24) / 0.278)
    step = (length - 0.24) / count
    outer = []
    for k in range(count):
        y = -length / 2 + 0.12 + step * k
        outer += [(0.0, y), (0.0, y + step * 0.26), (-0.036, y + step * 0.50), (-0.036, y + step * 0.76)]
    outer.append((0.0, length / 2 - 0.12))
    inner = [(u - 0.012, y) for u, y in outer[::-1]]
    s.prism([(x + side * u, y) for u, y in [*outer, *inner]], (z0, z1), finish, "XY")


def container(
    colour: str,
    code: str,
    *,
    feet: int = 20,
    livery: str | None = None,
    doors: str = "closed",
    load: str | None = None,
) -> Built:
    """Build a container.

    Args:
        code: Owner letters, serial number and check digit. They are on the doors, on both sides and on the end without doors.
        livery: The owner's name, in large letters along the sides.
        doors: "closed" or "open" (turned back along the sides).
        load: "cartons" or None.
    """
    s = Solid(f"{colour} container")
    finish, ink, iron = container_paint(colour), _ink(colour), steel(dark=True)
    length = LENGTH_M[feet]
    w, d, h = WIDTH_M / 2, length / 2, HEIGHT_M
    for x in (-w + 0.014, w - 0.014):
        _corrugated_wall(s, length, x, 0.16, h - 0.10, finish)
    for x in (-w + 0.06, w - 0.06):
        for y in (-d + 0.06, d - 0.06):
            s.box((0.12, 0.12, h - 0.2), (x, y, h / 2), finish, 0.012)
            for z in (0.06, h - 0.06):
                s.box((0.17, 0.18, 0.118), (x * 0.985, y * 0.995, z), finish, 0.01)
                s.box((0.176, 0.07, 0.05), (x * 0.985, y * 0.995, z), plain("casting hole", (0.008, 0.008, 0.008), 0.9), 0.01)
        s.box((0.07, length - 0.2, 0.13), (x * 1.012, 0, 0.11), finish, 0.008)
        s.box((0.06, length - 0.2, 0.07), (x * 1.015, 0, h - 0.05), finish, 0.008)
    for y in (-d + 0.05, d - 0.05):
        s.box((WIDTH_M - 0.3, 0.09, 0.13), (0, y, 0.10), finish, 0.008)
        s.box((WIDTH_M - 0.3, 0.09, 0.11), (0, y, h - 0.07), finish, 0.008)
    ribs = []
    count = 9
    for k in range(count):
        x = -w + 0.12 + (WIDTH_M - 0.24) * k / count
        step = (WIDTH_M - 0.24) / count
        ribs += [(x, 0.0), (x + step * 0.3, 0.0), (x + step * 0.5, 0.036), (x + step * 0.8, 0.036)]
    ribs += [(w - 0.12, 0.0), (w - 0.12, 0.05), (-w + 0.12, 0.05)]
    s.prism([(x, -d + 0.02 + y) for x, y in ribs], (0.14, h - 0.08), finish, "XY")
    roof = []
    bumps = round(length / 0.60)
    for k in range(bumps):
        y = -d + 0.10 + (length - 0.2) * k / bumps
        step = (length - 0.2) / bumps
        roof += [(y, h - 0.03), (y + step * 0.35, h - 0.03), (y + step * 0.5, h - 0.012), (y + step * 0.85, h - 0.012)]
    roof += [(d - 0.10, h - 0.03), (d - 0.10, h - 0.06), (-d + 0.10, h - 0.06)]
    s.prism(roof, (-w + 0.05, w - 0.05), finish, "YZ")
    s.box((WIDTH_M - 0.16, length - 0.14, 0.05), (0, 0, 0.15), timber(fresh=False), 0.0)
    _doors(s, w, d, h, finish, iron, ink, code, is_open=doors == "open")
    if load == "cartons":
        _cartons(s, w, d)
    for facing, side in (("+X", 1), ("-X", -1)):
        edge = -side * (d - 0.35)  # the right-hand end of the side, as seen by a viewer
        s.text(code, 0.17, (side * (w + 0.006), -edge * 0.98, h - 0.30), ink, facing=facing, align="RIGHT")
        if livery:
            cap = min(0.82, (length - 1.2) / (0.95 * len(livery)))
            s.text(livery, cap, (side * (w + 0.006), 0, 1.22), ink, facing=facing)
    s.text(code, 0.14, (w - 0.2, -d - 0.006, h - 0.30), ink, facing="-Y", align="RIGHT")
    return s.built()


def _doors(
    s: Solid,
    w: float,
    d: float,
    h: float,
    finish: bpy.types.Material,
    iron: bpy.types.Material,
    ink: bpy.types.Material,
    code: str,
    *,
    is_open: bool,
) -> None:
    """Add the two leaves of the doors, with four lock rods. The code is on the right-hand leaf."""
    width, height = w - 0.13, h - 0.36
    for side in (-1, 1):
        turn = side * (-252.0 if is_open else 0.0)
        with s.at(side * (w + 0.02 if is_open else w - 0.09), d - 0.035, 0.19 + height / 2, turn=turn):
            cx = -side * width / 2
            s.box((width, 0.05, height), (cx, 0, 0), finish, 0.008)
            for k in range(3):
                s.box((width - 0.10, 0.012, 0.42), (cx, 0.029, -height / 2 + 0.38 + 0.76 * k), finish, 0.012)
            for x in (cx - 0.30, cx + 0.30):
                s.rod((x, 0.065, -height / 2 - 0.10), (x, 0.065, height / 2 + 0.10), 0.017, iron)
                for z in (-height * 0.42, -height * 0.15, height * 0.18, height * 0.42):
                    s.box((0.09, 0.04, 0.07), (x, 0.055, z), iron, 0.006)
                s.box((0.36, 0.022, 0.05), (x - 0.12 * side, 0.085, -0.22 + 0.1 * (x > cx)), iron, 0.006)
            for k in range(4):
                s.box((0.06, 0.07, 0.13), (-0.01 * side, 0.0, -height * 0.4 + height * 0.27 * k), iron, 0.01)
            if side < 0:  # the right-hand leaf, as seen by a viewer
                owner, serial, digit = code.split()
                s.text(f"{owner} {serial}", 0.115, (cx, 0.037, height / 2 - 0.20), ink, facing="+Y")
                s.text(digit, 0.115, (cx, 0.037, height / 2 - 0.40), ink, facing="+Y")
            else:
                s.box((0.30, 0.004, 0.20), (cx, 0.038, height * 0.30), plain("container placard", (0.55, 0.50, 0.10), 0.5), 0.0)


def _cartons(s: Solid, w: float, d: float) -> None:
    """Add stacked cartons up to the doors, with two missing from the top."""
    board = plain("carton board", (0.36, 0.235, 0.125), 0.85)
    tape = plain("carton tape", (0.46, 0.34, 0.20), 0.35)
    for row in range(4):
        for column in range(4):
            if row == 3 and column in (1, 3):
                continue
            x, z = -w + 0.38 + 0.56 * column, 0.18 + 0.28 + 0.56 * row
            y = d - 0.62 - 0.05 * ((row * 3 + column * 5) % 4)
            s.box((0.54, 0.70, 0.545), (x, y, z), board, 0.012)
            s.box((0.06, 0.704, 0.55), (x, y, z), tape, 0.004)
            s.box((0.16, 0.004, 0.11), (x + 0.12, y + 0.352, z - 0.08), plain("carton label", (0.6, 0.6, 0.57), 0.5), 0.0)
    s.box((2 * w - 0.2, 0.6, 2.2), (0, d - 1.4, 1.25), plain("carton shade", (0.16, 0.10, 0.055), 0.9), 0.01)
