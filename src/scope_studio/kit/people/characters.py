"""Road workers and pedestrians of varied height, build, skin and hair, in relaxed poses or walking.

A person stands at the origin facing +y and consists of one object with about 45,000 points. Appearance and small asymmetries are
random and depend on ``seed``; everything else is a parameter. ``phase`` in [0, 1) is the gait phase of the poses "walk" and
"carry". The length of a gait cycle is
``STRIDE_M`` for a person 1.77 m tall, and proportional to the height.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from random import Random

import numpy as np
from mathutils import Matrix, Vector

from scope_studio.kit.core.finishes import paint, rubber
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.core.volumes import SurfaceMesh, normals
from scope_studio.kit.people import clothing, figure, heads
from scope_studio.kit.people.hand_props import PROP_BUILDERS, add_prop
from scope_studio.kit.people.poses import Joints, Pose, named_pose, solve


@dataclass(frozen=True)
class _Appearance:
    """Physical features of a person.

    ``girth`` is the width of the body relative to the standard figure, ``tone`` is an index of ``clothing.SKIN_TONES``, and
    ``style`` is a style of ``heads.hair_cap``.
    """

    height_m: float
    girth: float
    woman: bool
    tone: int
    hair: str | None
    style: str
    stubble: bool


def _random_appearance(random: Random, hair: str | None, woman_share: float) -> _Appearance:
    """Return a random appearance, a woman's with probability ``woman_share``. ``hair`` overrides the random hair colour."""
    woman = random.random() < woman_share
    height = random.gauss(1.67, 0.04) if woman else random.gauss(1.78, 0.045)
    tone = random.choices(range(6), (30, 26, 16, 12, 10, 6))[0]
    hair_colours = ["black"] if tone >= 3 else ["black", "brown", "brown", "light brown", "blond", "ginger", "grey"]
    style = random.choice(["long", "tail", "bun"]) if woman else random.choice(["short", "short", "crop"])
    girth = random.uniform(0.96, 1.10) if woman else random.uniform(0.98, 1.30)
    return _Appearance(
        min(1.90, max(1.60, height)),
        girth,
        woman,
        tone,
        hair or random.choice(hair_colours),
        style,
        not woman and random.random() < 0.45,
    )


def _add_surface(s: Solid, surface: SurfaceMesh, material: object, rest: np.ndarray | None = None) -> None:
    """Add a surface with a material and, optionally, rest coordinates of its points."""
    points, faces = surface
    s.add(points.tolist(), faces, material, None if rest is None else rest.tolist())


def _head(s: Solid, joints: Joints, appearance: _Appearance, covered: bool) -> None:
    """Add head and hair. If ``covered``, the hair is shorter, to fit under a helmet."""
    surface = heads.head_and_neck(woman=appearance.woman, stout=0.9 + 0.12 * (appearance.girth - 0.95) / 0.25)
    _add_surface(
        s,
        heads.to_posed(surface, joints.head),
        clothing.skin(appearance.tone, appearance.hair, stubble=appearance.stubble),
        surface[0],
    )
    if appearance.hair is None or appearance.hair == "bald":
        return
    style = "crop" if covered and appearance.style in ("short", "bun") else appearance.style
    hair = heads.hair_cap(style, 0.004 if style == "crop" else 0.009, appearance.height_m * 10)
    _add_surface(s, heads.to_posed(hair, joints.head), clothing.hair(appearance.hair), hair[0])


def _helmet(s: Solid, joints: Joints, colour: str) -> None:
    """Add a safety helmet with a ridge, a short brim, a long peak in front, and a badge."""
    shell = paint(colour, dirt=0.16, roughness=0.30)
    saved = s.frame
    s.frame = (
        saved @ joints.head @ Matrix.Translation(Vector(heads.CENTRE) + Vector((0, -0.014, 0.055))) @ Matrix.Rotation(0.15, 4, "X")
    )
    rows = [(1.00, 0.0), (0.99, 0.026), (0.94, 0.053), (0.82, 0.078), (0.62, 0.097), (0.36, 0.108), (0.10, 0.112)]
    points, faces, n = [], [], 40
    angles = np.linspace(0, 2 * np.pi, n, endpoint=False)
    for scale, z in rows:
        for a in angles:
            ridge = 0.007 * np.exp(-((np.cos(a) * scale / 0.16) ** 2)) * (z > 0.04)
            points.append((0.102 * scale * np.cos(a), 0.126 * scale * np.sin(a), z + ridge))
    for reach, z in ((0.006, -0.004), (0.016, -0.010), (0.015, -0.014), (-0.004, -0.010)):
        for a in angles:
            peak = 0.040 * max(0.0, np.sin(a)) ** 3 * (reach > 0)
            points.append(((0.102 + reach) * np.cos(a), (0.126 + reach + peak) * np.sin(a), z - peak * 0.30))
    order = [10, 9, 8, 7, *range(7)]
    for low, high in itertools.pairwise(order):
        faces += [(low * n + k, low * n + (k + 1) % n, high * n + (k + 1) % n, high * n + k) for k in range(n)]
    faces.append(tuple(range(6 * n, 7 * n)))
    s.add([tuple(float(c) for c in p) for p in points], faces, shell)
    s.box((0.045, 0.006, 0.022), (0, 0.1225, 0.045), paint("navy" if colour != "blue" else "white"), 0.002)
    s.frame = saved


@dataclass(frozen=True)
class _Outfit:
    """Clothes of a person. Only workers have a ``vest`` and a ``helmet``.

    ``top``, ``legs``, ``inner`` (a shirt under a jacket), ``glove``, ``vest`` and ``helmet`` are colours. ``style`` is the style of
    the top, as in ``clothing.top``, and ``neck`` is its neckline, as in ``figure.trunk``.
    """

    top: str
    legs: str
    style: str
    inner: str
    neck: str
    glove: str | None
    vest: str | None
    helmet: str | None


def _add_body(
    s: Solid, joints: Joints, random: Random, appearance: _Appearance, outfit: _Outfit, curls: tuple[float, float]
) -> None:
    """Add the clothed body and the hands."""
    seed = random.uniform(0, 50)
    vest = outfit.vest
    loose = random.uniform(0.004, 0.012)
    low = 0.87 if vest else round(random.uniform(0.87, 0.92), 2)
    body, rest = figure.trunk(
        joints,
        swell=-0.012 if vest else loose * 0.6,
        low=low,
        girth=appearance.girth,
        woman=appearance.woman,
        neck=outfit.neck,
        seed=seed,
    )
    _add_surface(s, body, clothing.top(outfit.top, outfit.style, outfit.inner, low), rest)
    sleeve, along = figure.sleeves(joints, loose=0.008 if vest else loose * 0.7, seed=seed + 4)
    bands = (0.17, 0.40) if outfit.top.startswith("hi-vis") else ()
    _add_surface(s, sleeve, clothing.cloth(outfit.top, bands=bands), _limb_coords(along))
    if vest:
        vest_surface, rest = figure.trunk(
            joints, swell=0.024, low=0.835, girth=appearance.girth, woman=appearance.woman, flare=0.007, seed=seed + 1
        )
        _add_surface(s, vest_surface, clothing.vest(vest, outfit.top), rest)
    trousers, along = figure.trousers(joints, loose=0.008 if vest else 0.002, girth=appearance.girth, seed=seed + 2)
    bands = (0.27, 0.40) if outfit.legs.startswith("hi-vis") else ()
    _add_surface(s, trousers, clothing.cloth(outfit.legs, bands=bands), _limb_coords(along))
    shoe = vest is None
    upper = paint("black" if shoe else random.choice(["brown", "black", "dark grey"]), dirt=0.38, roughness=0.6)
    _add_surface(s, figure.boots(joints, shoe=shoe), upper)
    for i, side in enumerate((-1, 1)):
        low, high = figure.sole_outline(joints.feet[i], side, 0.0, 0.026)
        n = len(low)
        s.add(
            [*low, *high],
            [
                tuple(range(n))[::-1],
                tuple(range(n, 2 * n)),
                *((k, (k + 1) % n, n + (k + 1) % n, n + k) for k in range(n)),
            ],
            rubber(),
        )
    hands = figure.hands(joints, curls, glove=outfit.glove is not None)
    if outfit.glove:
        _add_surface(s, hands, paint(outfit.glove, dirt=0.5, roughness=0.8))
    else:
        _add_surface(
            s, hands, clothing.skin(appearance.tone, appearance.hair, stubble=False), np.full_like(hands[0], 5.0) + normals(hands)
        )


def _limb_coords(along: np.ndarray) -> np.ndarray:
    """Return the rest coordinates of a limb. Only the position along the limb matters."""
    return np.column_stack([np.zeros((len(along), 2)), along])


DEFAULT_PROP = {"shovel": "shovel", "phone": "phone", "clipboard": "clipboard", "carry": "box", "kneel": "trowel"}
"""Name of the default prop, by pose. Other poses have no prop."""


def _person(
    name: str,
    pose: str,
    phase: float,
    random: Random,
    appearance: _Appearance,
    outfit: _Outfit,
    holding: str | None,
    custom_pose: Pose | None = None,
) -> Built:
    """Build a person in a pose, with clothes and a prop."""
    if holding is not None and holding not in PROP_BUILDERS:
        raise ValueError(f"'holding' must be one of {sorted(PROP_BUILDERS)}, not {holding!r}")
    stance = custom_pose or named_pose(pose, phase, random)
    joints = solve(stance)
    s = Solid(name)
    scale = appearance.height_m / 1.77
    s.frame = Matrix.Diagonal((scale * (0.93 if appearance.woman else 1.0), scale, scale, 1.0))
    _add_body(s, joints, random, appearance, outfit, (stance.arms[0].curl, stance.arms[1].curl))
    _head(s, joints, appearance, outfit.helmet is not None)
    if outfit.helmet:
        _helmet(s, joints, outfit.helmet)
    prop = holding or DEFAULT_PROP.get(pose)
    if prop:
        add_prop(s, joints, prop)
    return s.built()


def worker(
    *,
    vest: str = "orange",
    helmet: str | None = "white",
    trousers: str | None = None,
    pose: str = "stand",
    phase: float = 0.0,
    holding: str | None = None,
    stance: Pose | None = None,
    seed: int = 0,
) -> Built:
    """Build a road worker in a high-visibility vest ("orange" or "yellow").

    Args:
        helmet: Colour of the helmet, or None for no helmet.
        pose: "stand", "walk", "point", "carry", "kneel", "shovel", "phone" or "clipboard".
        holding: Prop that replaces the default prop of the pose; a key of ``PROP_BUILDERS``.
        stance: A pose that replaces ``pose``.
    """
    random = Random(f"worker {seed}")
    appearance = _random_appearance(random, None, 0.15)
    legs = trousers or random.choice(["navy", "dark grey", f"hi-vis {vest}", "khaki", "navy"])
    top = random.choice(["navy", "dark grey", "grey", f"hi-vis {vest}", "navy"])
    glove = random.choice(["dark grey", "hi-vis orange", "black", None])
    if pose in ("phone", "clipboard"):
        glove = None
    outfit = _Outfit(top, legs, "shirt", "white", "collar", glove, vest, helmet)
    return _person(f"worker in {vest}", pose, phase, random, appearance, outfit, holding, stance)


def pedestrian(
    *,
    top: str | None = None,
    trousers: str | None = None,
    hair: str | None = None,
    pose: str = "stand",
    phase: float = 0.0,
    holding: str | None = None,
    stance: Pose | None = None,
    seed: int = 0,
) -> Built:
    """Build a pedestrian in everyday clothes.

    Colours are names; None means a random colour, determined by ``seed``. ``stance`` is a pose that replaces ``pose``.
    """
    random = Random(f"pedestrian {seed}")
    appearance = _random_appearance(random, hair, 0.5)
    upper = top or random.choice(["dark red", "navy", "grey", "green", "beige", "light blue", "black", "purple", "yellow"])
    choices = ["denim", "denim", "black", "dark grey", "beige", "khaki"]
    legs = trousers or random.choice([c for c in choices if c != upper])
    style, neck = random.choice(
        [("jacket", "collar"), ("jacket", "hood"), ("jumper", "hood"), ("jumper", "collar"), ("shirt", "collar")]
    )
    inner = random.choice([c for c in ("white", "light grey", "black", "light blue") if c != upper])
    outfit = _Outfit(upper, legs, style, inner, neck, None, None, None)
    return _person(f"pedestrian in {upper}", pose, phase, random, appearance, outfit, holding, stance)
