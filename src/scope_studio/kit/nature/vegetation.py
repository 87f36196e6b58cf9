"""Plants: trees of several species, hedges, bushes and rough grass. Meshes are large; place linked copies."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Quaternion, Vector

from scope_studio.kit.core.shading import Shader
from scope_studio.kit.core.stage import Built

Rgb = tuple[float, float, float]


@dataclass(frozen=True)
class Species:
    """Parameters of a tree species.

    ``crown`` is the outline: "round", "column", "cone" or "weeping". ``bare_fraction`` is the fraction of the height below the
    lowest bough. ``leaf_m`` is the size of a leaf, and ``leaf_aspect`` is its width divided by its length. ``dark`` and ``bright``
    are the two colours of the leaves.
    """

    name: str
    height_m: float
    crown_radius_m: float
    bare_fraction: float
    crown: str
    leaf_m: float
    dark: Rgb
    bright: Rgb
    bark: Rgb
    leaf_aspect: float = 0.62


OAK = Species("oak", 11.5, 5.0, 0.20, "round", 0.20, (0.043, 0.084, 0.017), (0.152, 0.217, 0.043), (0.085, 0.068, 0.050))
LIME = Species("lime", 10.0, 3.6, 0.22, "round", 0.18, (0.065, 0.123, 0.020), (0.217, 0.297, 0.058), (0.095, 0.080, 0.062))
BIRCH = Species("birch", 9.5, 2.5, 0.22, "weeping", 0.13, (0.080, 0.131, 0.026), (0.246, 0.304, 0.072), (0.52, 0.50, 0.46))
POPLAR = Species("poplar", 17.0, 1.9, 0.10, "column", 0.17, (0.052, 0.102, 0.022), (0.160, 0.232, 0.052), (0.10, 0.088, 0.07))
PINE = Species("pine", 13.0, 3.0, 0.12, "cone", 0.34, (0.020, 0.049, 0.020), (0.061, 0.109, 0.038), (0.088, 0.056, 0.036), 0.16)
COPPER = Species("copper beech", 10.5, 4.4, 0.18, "round", 0.19, (0.072, 0.029, 0.026), (0.174, 0.075, 0.058), (0.1, 0.09, 0.08))
BUSH = Species("bush", 2.4, 1.7, 0.02, "round", 0.12, (0.052, 0.096, 0.020), (0.174, 0.239, 0.052), (0.08, 0.065, 0.05))


def tree(species: Species, seed: int, *, detail: float = 1.0) -> Built:
    """Build a tree.

    A ``detail`` of 1.0 (about 30,000 leaves) is for trees within about 60 m; 0.15 is enough for distant trees.
    """
    rng = random.Random(f"{species.name}-{seed}")
    limbs, twigs = _grow(species, rng)
    wood = _tubes([limb for limb in limbs if limb[1] > (0.0 if detail > 0.5 else 0.025)], 6 if detail > 0.5 else 4)
    leaves = _leaves(species, twigs, random.Random(f"leaves-{species.name}-{seed}"), detail)
    bark, foliage = bark_material(species), leaf_material(species)
    obj = _combine(f"{species.name} {seed}", [(wood[0], wood[1], bark), (leaves[0], leaves[1], foliage)], leaves[2])
    return Built.of(f"{species.name} {seed}", [obj])


Limb = tuple[list[Vector], float, float]
"""Limb of a tree: centre line, start radius, end radius."""


def _grow(sp: Species, rng: random.Random) -> tuple[list[Limb], list[tuple[Vector, Vector]]]:
    """Return the limbs (trunk, boughs, branches, twigs) and the (start, end) of every twig that has leaves."""
    limbs: list[Limb] = []
    twigs: list[tuple[Vector, Vector]] = []
    girth = 0.020 * sp.height_m + 0.02
    trunk = [Vector((0, 0, -0.1))]
    lean = Vector((rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05), 1))
    top = sp.height_m * (0.97 if sp.crown in ("cone", "column", "weeping") else 0.80)
    for _ in range(8):
        lean += Vector((rng.uniform(-0.06, 0.06), rng.uniform(-0.06, 0.06), 0))
        trunk.append(trunk[-1] + lean.normalized() * (top / 8))
    limbs.append((trunk, girth, girth * 0.18))
    boughs = {"round": 22, "weeping": 24, "column": 28, "cone": 40}[sp.crown]
    azimuth = rng.uniform(0, 6.28)
    for k in range(boughs):
        fraction = (k + 0.5) / boughs
        z_fraction = sp.bare_fraction + (0.93 - sp.bare_fraction) * fraction
        index = z_fraction * sp.height_m / top * 8
        base = _point_along(trunk, min(index, 7.99))
        azimuth += 2.4 + rng.uniform(-0.5, 0.5)
        rise, reach = _bough_shape(sp, fraction)
        reach *= rng.uniform(0.82, 1.12)
        heading = Vector((math.cos(azimuth) * math.cos(rise), math.sin(azimuth) * math.cos(rise), math.sin(rise)))
        bough = _limb(base, heading, reach, rng, 6, 0.20, _bend_per_step(sp))
        radius = max(0.022, girth * (0.42 - 0.26 * fraction))
        limbs.append((bough, radius, radius * 0.3))
        for j in range(7):
            fork_at = 1.2 + 4.7 * (j + rng.random()) / 7
            side = _fork(bough, fork_at, rng, 0.75)
            branch = _limb(_point_along(bough, fork_at), side, reach * rng.uniform(0.26, 0.46), rng, 4, 0.25, _bend_per_step(sp))
            limbs.append((branch, radius * 0.34, 0.007))
            for _ in range(5):
                position = rng.uniform(0.8, 3.99)
                start = _point_along(branch, position)
                end = start + _fork(branch, position, rng, 0.9) * reach * rng.uniform(0.12, 0.24)
                twigs.append((start, end))
            twigs.append((branch[-2], branch[-1]))
        twigs.append((bough[-2], bough[-1]))
    return limbs, twigs


def _bough_shape(sp: Species, fraction: float) -> tuple[float, float]:
    """Return the rise angle (radians) and length (m) of a bough at ``fraction`` of the crown's height."""
    r = sp.crown_radius_m
    if sp.crown == "round":
        return 0.05 + 1.15 * fraction**1.4, r * (
            0.80 + 0.34 * math.sin(math.pi * min(1.0, fraction * 0.95 + 0.12)) - 0.32 * fraction
        )
    if sp.crown == "column":
        return 1.05 + 0.2 * fraction, r * 1.9 * (0.55 + 0.6 * math.sin(math.pi * (0.15 + 0.8 * fraction)))
    if sp.crown == "cone":
        return -0.12 + 0.5 * fraction, r * (1.04 - fraction) ** 0.85
    return 0.75 + 0.25 * fraction, r * (1.15 - 0.75 * fraction)


def _bend_per_step(sp: Species) -> float:
    """Return how much limbs bend at each step: upwards if positive, downwards if negative."""
    return {"round": -0.03, "column": 0.12, "cone": -0.06, "weeping": -0.22}[sp.crown]


def _limb(
    start: Vector, heading: Vector, length: float, rng: random.Random, steps: int, wander: float, lift: float
) -> list[Vector]:
    """Return a random path that starts at ``start`` in direction ``heading``, bent upwards by ``lift`` at each step."""
    points, direction = [start.copy()], heading.copy()
    for _ in range(steps):
        direction += Vector((rng.uniform(-wander, wander), rng.uniform(-wander, wander), rng.uniform(-wander, wander) + lift))
        direction.normalize()
        points.append(points[-1] + direction * (length / steps))
    return points


def _point_along(points: Sequence[Vector], index: float) -> Vector:
    """Return the point on a path at a fractional index."""
    low = min(int(index), len(points) - 2)
    return points[low].lerp(points[low + 1], index - low)


def _fork(points: Sequence[Vector], index: float, rng: random.Random, angle: float) -> Vector:
    """Return a random direction that branches off a path at about ``angle`` radians."""
    low = min(int(index), len(points) - 2)
    ahead = (points[low + 1] - points[low]).normalized()
    turned = ahead.orthogonal().normalized()
    turned.rotate(Quaternion(ahead, rng.uniform(0, 2 * math.pi)))
    spread = angle * rng.uniform(0.7, 1.3)
    out = ahead * math.cos(spread) + turned * math.sin(spread)
    out.z += 0.18
    return out.normalized()


def _tubes(limbs: Sequence[Limb], sides: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the points and quads of tapered tubes around the limbs."""
    points, faces, base = [], [], 0
    ring = [(math.cos(2 * math.pi * k / sides), math.sin(2 * math.pi * k / sides)) for k in range(sides)]
    for line, r0, r1 in limbs:
        for i, p in enumerate(line):
            ahead = (line[min(i + 1, len(line) - 1)] - line[max(i - 1, 0)]).normalized()
            a = ahead.orthogonal().normalized()
            b = ahead.cross(a)
            flare = 1.6 if r0 > 0.1 and i == 0 else 1.0
            r = (r0 + (r1 - r0) * i / (len(line) - 1)) * flare
            points += [p + a * (c * r) + b * (s * r) for c, s in ring]
        for i in range(len(line) - 1):
            o = base + i * sides
            faces += [(o + k, o + (k + 1) % sides, o + sides + (k + 1) % sides, o + sides + k) for k in range(sides)]
        base += len(line) * sides
    return np.array([tuple(p) for p in points]), np.array(faces)


def _leaves(
    sp: Species, twigs: Sequence[tuple[Vector, Vector]], rng: random.Random, detail: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the points, quads and tints of leaves around the twigs. A lower ``detail`` gives fewer and larger leaves."""
    gen = np.random.default_rng(rng.randrange(2**31))
    leaves_per_twig = max(5, round(42 * detail))
    size = sp.leaf_m * detail**-0.42
    starts, ends = np.array([tuple(a) for a, _ in twigs]), np.array([tuple(b) for _, b in twigs])
    twig_index = np.repeat(np.arange(len(twigs)), leaves_per_twig)
    fraction = gen.random(len(twig_index))[:, None]
    centres = starts[twig_index] * (1 - fraction) + ends[twig_index] * fraction
    spread = np.linalg.norm(ends - starts, axis=1)[twig_index][:, None] * 0.26 + sp.leaf_m * 0.8
    centres = centres + gen.normal(size=centres.shape) * spread * np.array([1, 1, 0.75])
    outward = (ends - starts)[twig_index]
    outward /= np.linalg.norm(outward, axis=1, keepdims=True) + 1e-9
    return leaf_cards(gen, centres, outward, size, sp.leaf_aspect)


def leaf_cards(
    gen: np.random.Generator, centres: np.ndarray, outward: np.ndarray, size_m: float, leaf_aspect: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return diamond-shaped leaves at ``centres`` (n, 3) that point roughly in the directions ``outward``.

    ``leaf_aspect`` is the width of a leaf divided by its length.

    Returns:
        Points (4n, 3), quads (n, 4) and tints (4n,).
    """
    n = len(centres)
    axis = outward * 0.8 + gen.normal(size=(n, 3)) * 0.8 + np.array([0, 0, -0.12])
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    side = np.cross(axis, gen.normal(size=(n, 3)) * 0.8 + np.array([0, 0, 1.0]))
    side /= np.linalg.norm(side, axis=1, keepdims=True) + 1e-9
    length = size_m * gen.uniform(0.65, 1.25, size=(n, 1))
    lift = np.cross(side, axis) * length * 0.12
    quad = np.stack(
        [
            centres,
            centres + axis * length * 0.5 + side * length * leaf_aspect / 2 + lift,
            centres + axis * length,
            centres + axis * length * 0.5 - side * length * leaf_aspect / 2 + lift,
        ],
        axis=1,
    )
    return quad.reshape(-1, 3), np.arange(4 * n).reshape(n, 4), np.repeat(gen.random(n), 4)


Part = tuple[np.ndarray, np.ndarray, bpy.types.Material]


def _combine(name: str, parts: Sequence[Part], tints: np.ndarray) -> bpy.types.Object:
    """Create one mesh from groups of quads with one material each. ``tints`` has a value for each point of the last group."""
    mesh = bpy.data.meshes.new(name)
    points = np.concatenate([p for p, _, _ in parts]).astype(np.float32)
    offsets = np.cumsum([0] + [len(p) for p, _, _ in parts])
    quads = np.concatenate([f + offsets[i] for i, (_, f, _) in enumerate(parts)]).astype(np.int32)
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", points.ravel())
    mesh.loops.add(quads.size)
    mesh.loops.foreach_set("vertex_index", quads.ravel())
    mesh.polygons.add(len(quads))
    mesh.polygons.foreach_set("loop_start", np.arange(0, quads.size, 4, dtype=np.int32))
    mesh.polygons.foreach_set("material_index", np.repeat(np.arange(len(parts)), [len(f) for _, f, _ in parts]).astype(np.int32))
    smooth = np.repeat([i < len(parts) - 1 for i in range(len(parts))], [len(f) for _, f, _ in parts])
    mesh.update(calc_edges=True)
    mesh.polygons.foreach_set("use_smooth", smooth)
    tint = mesh.attributes.new("tint", "FLOAT", "POINT")
    tint.data.foreach_set("value", np.concatenate([np.zeros(offsets[-2]), tints]).astype(np.float32))
    for _, _, material in parts:
        mesh.materials.append(material)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def leaf_material(sp: Species) -> bpy.types.Material:
    """Return the material of leaves: two tones, paler in patches, with a third of the light passing through."""
    existing = bpy.data.materials.get(f"{sp.name} leaves")
    if existing is not None:
        return existing
    s = Shader(f"{sp.name} leaves")
    tint = s.node("ShaderNodeAttribute", attribute_name="tint").outputs["Fac"]
    clump = s.noise(s.object_coords(), 0.55, detail=2.0)
    index = s.math("ADD", s.math("MULTIPLY", tint, 0.6), s.ramp(clump, 0.35, 0.65, 0.0, 0.4))
    colour = s.mix(index, sp.dark, sp.bright)
    yellow = tuple(c * k for c, k in zip(sp.bright, (1.35, 1.05, 0.8), strict=True))
    colour = s.mix(s.math("MULTIPLY", s.random(), 0.45), colour, yellow)
    s.surface(base_color=colour, roughness=0.55, specular_ior_level=0.25)
    translucent = s.node("ShaderNodeBsdfTranslucent")
    s.set_input(translucent.inputs["Color"], s.mix(0.5, colour, yellow))
    mixed = s.node("ShaderNodeMixShader")
    mixed.inputs[0].default_value = 0.34
    s.set_input(mixed.inputs[1], s.bsdf.outputs[0])
    s.set_input(mixed.inputs[2], translucent.outputs[0])
    output = next(n for n in s.tree.nodes if n.type == "OUTPUT_MATERIAL")
    s.set_input(output.inputs["Surface"], mixed.outputs[0])
    return s.material


def bark_material(sp: Species) -> bpy.types.Material:
    """Return the material of a species' bark."""
    existing = bpy.data.materials.get(f"{sp.name} bark")
    if existing is not None:
        return existing
    s = Shader(f"{sp.name} bark")
    p = s.object_coords()
    ridges = s.noise(s.scaled(p, (9, 9, 1.6)), 2.0, detail=5.0, roughness=0.65)
    dark = tuple(c * 0.38 for c in sp.bark)
    colour = s.mix(s.ramp(ridges, 0.36, 0.60), dark, sp.bark)
    moss = s.ramp(s.noise(p, 1.1), 0.52, 0.66, 0.0, 0.5)
    colour = s.mix(moss, colour, (0.055, 0.070, 0.030))
    return s.surface(base_color=colour, roughness=0.9, normal=s.bump(ridges, 0.5, 0.02))


HAWTHORN = Species("hawthorn", 1.9, 0.7, 0.0, "round", 0.085, (0.049, 0.087, 0.020), (0.160, 0.217, 0.052), (0.05, 0.04, 0.03), 0.7)


def hedge(length_m: float, *, height_m: float = 1.9, depth_m: float = 1.2, seed: int = 0, detail: float = 1.0) -> Built:
    """Build a field hedge along x: leaves over an uneven dark core."""
    gen = np.random.default_rng(7919 + seed)
    count = int(900 * length_m * detail)
    along = gen.uniform(-length_m / 2, length_m / 2, count)
    around = gen.uniform(0.0, math.pi, count)
    ripple = 1 + 0.13 * np.sin(along * 1.9 + seed) + 0.09 * np.sin(along * 4.7 + 2 * seed)
    depth = gen.uniform(0.80, 1.06, count) * ripple
    y = np.cos(around) * depth_m / 2 * depth * (1.0 + 0.25 * np.sin(around * 2) ** 2)
    z = np.sin(around) ** 0.55 * height_m * depth
    outward = np.stack([gen.normal(size=count) * 0.3, np.cos(around), np.sin(around) + 0.2], axis=1)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    leaf = leaf_cards(gen, np.stack([along, y, z], axis=1), outward, HAWTHORN.leaf_m * detail**-0.45, 0.7)
    core_points, core_faces = [], []
    stations = max(2, int(length_m))
    outline = [(-0.38, 0.0), (-0.40, 0.55), (-0.26, 0.80), (0.26, 0.80), (0.40, 0.55), (0.38, 0.0)]
    for i in range(stations + 1):
        x = -length_m / 2 + length_m * i / stations
        core_points += [(x, yy * depth_m, zz * height_m) for yy, zz in outline]
    for i in range(stations):
        core_faces += [(6 * i + k, 6 * i + k + 1, 6 * i + k + 7, 6 * i + k + 6) for k in range(5)]
    core = Shader("hedge core").surface(base_color=(0.012, 0.018, 0.007), roughness=1.0)
    parts = [(np.array(core_points), np.array(core_faces), core), (leaf[0], leaf[1], leaf_material(HAWTHORN))]
    return Built.of("hedge", [_combine("hedge", parts, leaf[2])])


def grass_patch(size_m: float, *, blades: int, height_m: float, seed: int, flowers: int = 0) -> Built:
    """Build a square of uneven grass tufts with some flower heads. Place linked copies of it to cover an area."""
    gen = np.random.default_rng(104729 + seed)
    tufts = gen.uniform(-size_m / 2, size_m / 2, size=(max(1, blades // 7), 2))
    roots = tufts[gen.integers(len(tufts), size=blades)] + gen.normal(size=(blades, 2)) * 0.075
    height = height_m * gen.uniform(0.45, 1.15, size=(blades, 1)) * gen.choice([0.7, 1.0, 1.25], size=(blades, 1))
    lean = gen.normal(size=(blades, 2)) * 0.42 * height
    facing = gen.uniform(0, math.pi, size=blades)
    half = np.stack([np.cos(facing), np.sin(facing)], axis=1) * 0.0055
    zero = np.full((blades, 1), -0.02)
    quad = np.stack(
        [
            np.concatenate([roots - half, zero], axis=1),
            np.concatenate([roots + half, zero], axis=1),
            np.concatenate([roots + lean * 0.45 + half * 0.8, height * 0.62], axis=1),
            np.concatenate([roots + lean, height], axis=1),
        ],
        axis=1,
    ).reshape(-1, 3)
    parts: list[Part] = []
    if flowers:
        heads = np.concatenate(
            [gen.uniform(-size_m / 2, size_m / 2, size=(flowers, 2)), np.full((flowers, 1), height_m * 0.9)], axis=1
        )
        petals = np.repeat(heads, 4, axis=0)
        up = np.repeat([[0.0, 0.0, 0.6]], len(petals), axis=0)
        points, faces, _ = leaf_cards(gen, petals, up, 0.035, 0.8)
        petal = Shader("dandelion").surface(base_color=(0.75, 0.55, 0.03), roughness=0.7)
        parts.append((points, faces, petal))
    parts.append((quad, np.arange(4 * blades).reshape(blades, 4), grass_material()))
    return Built.of("grass", [_combine("grass", parts, np.repeat(gen.random(blades), 4))])


def grass_material() -> bpy.types.Material:
    """Return the material of grass blades."""
    existing = bpy.data.materials.get("grass blades")
    if existing is not None:
        return existing
    s = Shader("grass blades")
    tint = s.node("ShaderNodeAttribute", attribute_name="tint").outputs["Fac"]
    place = s.noise(s.position(), 0.5, detail=3.0)
    colour = s.mix(tint, (0.135, 0.178, 0.045), (0.270, 0.305, 0.100))
    dry = s.math("MULTIPLY", s.ramp(place, 0.45, 0.68), s.ramp(tint, 0.2, 0.9))
    colour = s.mix(dry, colour, (0.30, 0.26, 0.13))
    return s.surface(base_color=colour, roughness=0.6, specular_ior_level=0.2)
