"""A small yard with crates, cones, a sign and a moving cart. It builds quickly and has everything that a test bake needs."""

from __future__ import annotations

import random

import bpy

from scope_studio.kit.core import mesh
from scope_studio.kit.core.lettering import letters
from scope_studio.kit.core.shading import Shader
from scope_studio.kit.core.stage import ActorPath, Built, Stage, TextMark
from scope_studio.kit.light import sky

NAME, TITLE = "small-yard", "Small yard"

COLOURS = {"red": (0.6, 0.03, 0.02), "blue": (0.03, 0.1, 0.5), "white": (0.8, 0.8, 0.78), "green": (0.05, 0.3, 0.07)}


def build(stage: Stage) -> None:
    """Build the yard and fill the stage."""
    sky.setup(bpy.context.scene)
    rng = random.Random(5)
    _ground(stage)
    paints = {name: _paint(name, rgb) for name, rgb in COLOURS.items()}
    for k in range(6):
        colour = list(COLOURS)[k % 4]
        size = rng.uniform(0.6, 2.0)
        crate = Built.of("crate", [mesh.box("crate", (size, size, size), (0, 0, size / 2), paints[colour], bevel_m=0.03)])
        stage.place(
            crate, "crate", f"{colour} crate", (rng.uniform(-9, 9), rng.uniform(6, 22), 0), rng.uniform(0, 90), colour=colour
        )
    for k in range(5):
        profile = [(0.0, 0.72), (0.03, 0.72), (0.17, 0.04), (0.2, 0.04), (0.2, 0.0)]
        cone = Built.of("cone", [mesh.lathe("cone", profile, paints["red"])])
        stage.place(cone, "cone", "red cone", (-6 + 3 * k, 14 - k, 0), colour="red")
    _sign(stage, paints)
    stage.place(Built.of("pole", [mesh.box("pole", (0.12, 0.12, 6), (0, 0, 3), paints["white"])]), "pole", "white pole", (3, -7, 0))
    stage.viewpoint("mast", (0.0, 0.0, 6.0), 20.0, "on the mast")
    stage.viewpoint("corner", (12.0, 2.0, 4.0), -40.0, "at the corner")
    stage.preset("yard", "mast", 0.0, -20.0, 1.0, "the whole yard", home=True)
    stage.preset("sign", "corner", 0.0, -10.0, 3.0, "the sign")
    stage.actors.append(
        ActorPath(
            "cart-90", len(stage.instances) + 1, "cart", "blue cart", lambda phase: _cart(paints),
            [(0.0, -8.0, 11.0, 0.0), (6.0, 8.0, 11.0, 0.0)], 10.0, {"colour": "blue"},
        )
    )  # fmt: skip
    stage.absent.append("dog")
    stage.finish = sky.finish_materials


def _ground(stage: Stage) -> None:
    s = Shader("gravel")
    spots = s.noise(s.position(), 3.0, detail=6.0, roughness=0.7)
    material = s.surface(base_color=s.mix(spots, (0.12, 0.11, 0.1), (0.42, 0.4, 0.36)), roughness=0.9)
    stage.put(Built.of("ground", [mesh.box("ground", (400, 400, 0.2), (0, 0, -0.1), material, bevel_m=0)]), (0, 0, 0))


def _paint(name: str, rgb: tuple[float, float, float]) -> bpy.types.Material:
    return Shader(name).surface(base_color=rgb, roughness=0.5)


def _sign(stage: Stage, paints: dict[str, bpy.types.Material]) -> None:
    points, faces = letters("WORKS ENTRY", 0.22)
    width = max(p[0] for p in points)
    text = mesh.from_data("letters", [(p[0] - width / 2, 0.0, p[1]) for p in points], faces, paints["blue"])
    text.location = (0, -0.035, 1.9)
    board = mesh.box("board", (width + 0.4, 0.06, 0.6), (0, 0, 2.0), paints["white"])
    posts = [mesh.box("post", (0.08, 0.08, 1.8), (x, 0, 0.9), paints["white"]) for x in (-0.7, 0.7)]
    mark = TextMark("WORKS ENTRY", (0, -0.04, 2.01), (1, 0, 0), (0, 0, 1), width, 0.24, 0.22)
    stage.place(Built.of("sign", [board, text, *posts], [mark]), "sign", "works sign", (2.0, 18.0, 0.0), 5.0)


def _cart(paints: dict[str, bpy.types.Material]) -> Built:
    body = mesh.box("cart", (1.2, 2.4, 0.9), (0, 0, 0.75), paints["blue"], bevel_m=0.08)
    cab = mesh.box("cab", (1.0, 0.8, 0.5), (0, 0.5, 1.45), paints["white"], bevel_m=0.08)
    return Built.of("cart", [body, cab])
