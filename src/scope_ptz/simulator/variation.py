"""Variations of a scene: different positions of moving objects and different presets, derived deterministically from a number.

The baked layers are unchanged. The same code composites moving objects into pictures and into the ground truth, so
pictures and ground truth agree in every variation.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from string import ascii_lowercase

import numpy as np

from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, direction
from scope_ptz.simulator.models import Attribute, Extent, SceneActor, SceneFile, SceneInstance, ScenePreset, SceneViewpoint

MAX_START_S = 120.0  # latest scene time at which a variation starts, in seconds
CLEARANCE_M = 3.0
"""Minimum distance in metres between a held object and the path of a moving one."""

_HOLD_ATTEMPTS = 16  # number of random positions to try for held objects, which must be clear of all paths
_PERIOD_FACTORS = (1.0, 1.5, 2.0)
_ZOOMS = (1.0, 1.2, 1.5, 1.8, 2.2, 2.6)
_CLOSE_ZOOM, _FAR_TILT_DEG, _LOW_TILT_DEG = 2.0, -7.5, -17.5  # thresholds for the names of presets
_POSES = 14  # number of random poses from which each new preset is chosen
_WIDTH, _HEIGHT = 1280, 720
_MIN_OBJECT_PX = 900.0  # minimum area, in pixels, for an object to be counted in a preset
_DIRECTIONS = ("north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west")


@dataclass(frozen=True, slots=True)
class HeldObject:
    """A moving object that stands still where it would be at the scene time ``time_s``."""

    actor: SceneActor
    time_s: float


@dataclass(frozen=True, slots=True)
class Variation:
    """A modified scene file. It lists the objects in ``held`` as instances instead of actors."""

    file: SceneFile
    held: tuple[HeldObject, ...]


def vary(file: SceneFile, number: int, extents: Mapping[str, Sequence[Extent]]) -> Variation:
    """Return variation ``number`` of a scene. The same number always gives the same variation.

    Args:
        file: The scene.
        number: Number of the variation.
        extents: Silhouettes of the visible objects, by viewpoint.
    """
    rng = random.Random(f"{file.name}:{number}")
    start_s = round(rng.uniform(0.0, MAX_START_S), 1)
    moving, held = _vary_actors(file.actors, rng)
    presets = list(_presets(file, extents, rng))
    home = next(p.viewpoint for p in file.presets if p.name == file.home_preset)
    varied = file.model_copy(
        update={
            "start_s": start_s,
            "actors": moving,
            "instances": [*file.instances, *map(_to_instance, held)],
            "presets": presets,
            "home_preset": next(p.name for p in presets if p.viewpoint == home),
        }
    )
    return Variation(SceneFile.model_validate(varied.model_dump()), tuple(held))


def companions(actors: Sequence[SceneActor]) -> list[list[SceneActor]]:
    """Group the actors that move together, such as a dog and its owner: those with the same period and waypoint times."""
    groups: dict[tuple[float, ...], list[SceneActor]] = {}
    for actor in actors:
        groups.setdefault((actor.period_s, *(round(w[0], 3) for w in actor.waypoints)), []).append(actor)
    return list(groups.values())


def _vary_actors(actors: Sequence[SceneActor], rng: random.Random) -> tuple[list[SceneActor], list[HeldObject]]:
    """Randomly delay each group of companions, hold it at one point on its path, or remove it."""
    moving, held = list[SceneActor](), list[HeldObject]()
    for group in companions(actors):
        treatment = rng.choices(("delayed", "held", "removed"), (4, 4, 2))[0]
        if treatment == "held":
            others = [a for a in actors if a not in group]
            placements = (_hold_group(group, rng) for _ in range(_HOLD_ATTEMPTS))
            accepted = next((s for s in placements if all(_is_clear_of(h, others) for h in s)), None)
            if accepted is not None:
                held += accepted
                continue
        if treatment != "removed":
            period_s = _period(group[0], rng)
            delay_s = round(period_s * rng.uniform(0.15, 0.85), 1)
            moving += [a.model_copy(update={"delay_s": a.delay_s + delay_s, "period_s": period_s}) for a in group]
    return moving, held


def _period(actor: SceneActor, rng: random.Random) -> float:
    """Return a random period, at least as long as the original one. Actors that never leave the scene keep their period."""
    absence_s = actor.period_s - (actor.waypoints[-1][0] - actor.waypoints[0][0])
    factor = rng.choice(_PERIOD_FACTORS)
    return actor.period_s if absence_s < 0.1 else round(actor.period_s * factor, 3)


def _hold_group(group: Sequence[SceneActor], rng: random.Random) -> list[HeldObject]:
    fraction = rng.uniform(0.15, 0.85)
    return [
        HeldObject(a, round(a.delay_s + a.waypoints[0][0] + fraction * (a.waypoints[-1][0] - a.waypoints[0][0]), 2)) for a in group
    ]


def _position_and_heading(held: HeldObject) -> tuple[float, float, float, float]:
    """Return the ground point (x, y, z) in metres and the heading in radians (0 along y) of a held object."""
    path = np.array(held.actor.waypoints)
    path_s = held.time_s - held.actor.delay_s
    x, y, z = (float(np.interp(path_s, path[:, 0], path[:, axis])) for axis in (1, 2, 3))
    one, two = next((a, b) for a, b in pairwise(held.actor.waypoints) if path_s <= b[0])
    return x, y, z, math.atan2(two[1] - one[1], two[2] - one[2])


def _is_clear_of(held: HeldObject, others: Sequence[SceneActor]) -> bool:
    """Return whether a held object is far enough from the paths of all other objects."""
    x, y, _, _ = _position_and_heading(held)
    reach = CLEARANCE_M + max(held.actor.size_m[:2]) / 2
    return all(_distance(x, y, one, two) > reach for other in others for one, two in pairwise(other.waypoints))


def _distance(x: float, y: float, one: Sequence[float], two: Sequence[float]) -> float:
    """Return the ground distance, in metres, from a point to the segment between two waypoints."""
    start, along = np.array(one[1:3]), np.array(two[1:3]) - np.array(one[1:3])
    length = float(along @ along)
    fraction = 0.0 if length == 0.0 else min(max(float((np.array([x, y]) - start) @ along) / length, 0.0), 1.0)
    return float(np.linalg.norm(np.array([x, y]) - start - fraction * along))


def _to_instance(held: HeldObject) -> SceneInstance:
    """Return a held object as a scene instance, without its ``state``, because its sprite still shows it in motion."""
    actor, (x, y, z, heading) = held.actor, _position_and_heading(held)
    width, length, height = actor.size_m
    c, s = abs(math.cos(heading)), abs(math.sin(heading))
    half_x, half_y = (width * c + length * s) / 2, (width * s + length * c) / 2
    attributes: dict[str, Attribute] = {k: v for k, v in actor.attributes.items() if k != "state"}
    return SceneInstance(
        id=actor.id,
        number=actor.number,
        category=actor.category,
        name=actor.name.removeprefix("walking ").removeprefix("moving "),
        attributes=attributes,
        box_min_m=(x - half_x, y - half_y, z),
        box_max_m=(x + half_x, y + half_y, z + height),
    )


def _presets(file: SceneFile, extents: Mapping[str, Sequence[Extent]], rng: random.Random) -> Iterator[ScenePreset]:
    """Yield one new preset for each old one, at the same viewpoint: the one of several random views that shows the most objects."""
    places = {place.name: place for place in file.viewpoints}
    used_names = {preset.name for preset in file.presets}
    presets = list(file.presets)
    for old in file.presets:
        candidates = [_name_preset(_pose(old, rng), places[old.viewpoint]) for _ in range(_POSES)]
        apart = [c for c in candidates if all(_is_apart(c, p) for p in presets if p.viewpoint == old.viewpoint)] or candidates
        free = [c for c in apart if c.name not in used_names] or apart
        best = max(free, key=lambda c: _objects_in(c, extents[old.viewpoint]))
        name = next(n for n in (best.name, *(f"{best.name}-{letter}" for letter in ascii_lowercase)) if n not in used_names)
        used_names.add(name)
        presets.append(best.model_copy(update={"name": name}))
        yield presets[-1]


def _pose(old: ScenePreset, rng: random.Random) -> ScenePreset:
    limits = Limits()
    pan = (old.pan_deg + rng.choice((-1, 1)) * rng.uniform(10, 80) + 180) % 360 - 180
    tilt = min(max(old.tilt_deg + rng.uniform(-5, 4), -35.0), 0.0)
    pan = min(max(round(pan), limits.min_pan_deg), limits.max_pan_deg)
    return old.model_copy(update={"pan_deg": float(pan), "tilt_deg": float(round(tilt)), "zoom": rng.choice(_ZOOMS)})


def _is_apart(one: ScenePreset, two: ScenePreset) -> bool:
    pan_difference_deg = abs((one.pan_deg - two.pan_deg + 180) % 360 - 180)
    return (
        pan_difference_deg > 12 or abs(one.tilt_deg - two.tilt_deg) > 8 or max(one.zoom, two.zoom) > 1.6 * min(one.zoom, two.zoom)
    )


def _objects_in(preset: ScenePreset, extents: Sequence[Extent]) -> int:
    """Count the sufficiently large outlines whose centre is well inside the view. Occlusion is ignored."""
    view = Perspective(preset.pan_deg, preset.tilt_deg, AXIS_M5075_G.hfov_deg(preset.zoom), _WIDTH, _HEIGHT)
    large = [e for e in extents if e.hull and e.solid_angle_sr * view.focal_px**2 > _MIN_OBJECT_PX]
    if not large:
        return 0
    centres = np.array([np.mean(direction(*np.array(e.hull, dtype=np.float64).T), axis=0) for e in large])
    points = view.points(centres)
    with np.errstate(invalid="ignore"):
        return int(np.all((points > 0.05) & (points < 0.95), axis=-1).sum())


def _name_preset(preset: ScenePreset, place: SceneViewpoint) -> ScenePreset:
    """Name a preset after its viewpoint and direction, such as ``mast-south-east-close``, and describe it in words."""
    compass_direction = _DIRECTIONS[round((place.pan0_bearing_deg + preset.pan_deg) / 45) % 8]
    close, far, low = preset.zoom >= _CLOSE_ZOOM, preset.tilt_deg > _FAR_TILT_DEG, preset.tilt_deg < _LOW_TILT_DEG
    suffix = "-close" if close else "-far" if far else "-low" if low else ""
    words = {"-close": ", close up", "-far": ", far off", "-low": ", at what is near", "": ""}[suffix]
    description = f"looking {compass_direction} from the {place.name}{words}"
    return preset.model_copy(update={"name": f"{place.name}-{compass_direction}{suffix}", "description": description})
