"""Places: where a task starts, the moves from there to the view that it is about, and how an operator says them."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from scope_ptz.bench.scoring.episode import CameraPosition
from scope_ptz.bench.tasks.task import Aim, FinalPose, Need, ProgramCall
from scope_ptz.geometry import Pose
from scope_ptz.simulator.models import ScenePreset
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.words import degrees, times
from scope_ptz.taskgen.facts.robust import EYES, Sight, sight
from scope_ptz.tools.adjust_ptz import AdjustPtz, requested_pose

_PRESET = (
    "go to the {p} preset", "switch to the {p} view", "move to the preset {p}", "select the {p} preset", "bring up the {p} view",
    "take the camera to the {p} preset", "call up the preset {p}", "change to the {p} view",
)  # fmt: skip
_PAN = ("turn {d} to the {s}", "pan {s} by {d}", "swing {d} {s}", "pan {d} to the {s}", "rotate the camera {d} to the {s}")
_TILT = ("tilt {s} by {d}", "tilt {d} {s}", "aim the camera {d} further {s}", "tip the camera {s} {d}")
_ZOOM_IN = ("zoom in to {t} the magnification", "zoom in {f}x", "zoom in by a factor of {f}", "magnify the view {f} times")
_HOME = ("go home", "return to the home view", "go back to the home position")
_SWEEP = (
    "look all the way round", "scan the whole scene", "do a full sweep", "check everything around the camera",
    "sweep the whole scene", "go over the full surroundings",
)  # fmt: skip


_HARDLY_DEG = 2.5


@dataclass(frozen=True)
class Place:
    """A start preset and the calls that lead to a view. ``swept``: everything around from there is meant."""

    scene: Scene
    start: str
    calls: tuple[ProgramCall, ...]
    at: CameraPosition
    swept: bool = False

    @cached_property
    def sight(self) -> Sight:
        return sight(self.scene, self.at, self.scene.file.start_s, swept=self.swept)

    @property
    def key(self) -> str:
        """The view, however one gets there."""
        pose = self.at.pose
        view = "all" if self.swept else f"{pose.pan_deg:.1f}/{pose.tilt_deg:.1f}/{pose.zoom:.2f}"
        return f"{self.scene.name}:{self.at.viewpoint}:{view}"

    @property
    def stays(self) -> bool:
        return not self.calls and not self.swept

    @property
    def preset(self) -> str | None:
        """The preset that this place is, if going there is all."""
        only = self.calls[0] if len(self.calls) == 1 else None
        return str(only.arguments["name"]) if only is not None and only.tool == "go_to_preset" else None

    @property
    def aim(self) -> Aim:
        pose = self.at.pose
        return Aim(
            viewpoint=str(self.at.viewpoint),
            pan_deg=round(pose.pan_deg, 4),
            tilt_deg=round(pose.tilt_deg, 4),
            zoom=round(pose.zoom, 5),
        )

    @property
    def final(self) -> FinalPose:
        return FinalPose(**self.aim.model_dump())

    @property
    def hfov_deg(self) -> float:
        return round(EYES.optics.hfov_deg(self.at.pose.zoom), 4)

    @property
    def needs(self) -> tuple[Need, ...]:
        found: list[Need] = []
        for call in self.calls:
            if call.tool in ("go_to_preset", "go_home"):
                found.append("preset")
            elif call.arguments.get("pan_deg") or call.arguments.get("tilt_deg"):
                found.append("move")
            if "zoom_factor" in call.arguments:
                found.append("zoom")
        return tuple(dict.fromkeys([*found, *(["sweep"] if self.swept else [])]))  # type: ignore[list-item]

    def said(self, rng: random.Random) -> tuple[str, str]:
        """The moves as an order, without capital or full stop: closed ("turn left and zoom in 2x"), and such that "and ..." may
        follow ("turn left, zoom in 2x")."""
        parts = [phrase for call in self.calls for phrase in say(call, rng)]
        if self.swept:
            parts.append(rng.choice(_SWEEP))
        return joined(parts, rng), ", ".join(parts)


def joined(parts: list[str], rng: random.Random) -> str:
    if len(parts) < 3:
        return rng.choice((" and ", ", then ")).join(parts)
    return f"{', '.join(parts[:-1])}{rng.choice((' and ', ' and then ', ', and then '))}{parts[-1]}"


def say(call: ProgramCall, rng: random.Random) -> list[str]:
    """A move in words, one phrase an axis."""
    arguments = call.arguments
    if call.tool == "go_to_preset":
        return [rng.choice(_PRESET).format(p=arguments["name"])]
    if call.tool == "go_home":
        return [rng.choice(_HOME)]
    said = []
    for axis, forms, names in (("pan_deg", _PAN, ("right", "left")), ("tilt_deg", _TILT, ("up", "down"))):
        amount = arguments.get(axis)
        if isinstance(amount, int | float) and amount:
            said.append(rng.choice(forms).format(d=degrees(abs(amount)), s=names[amount < 0]))
    factor = arguments.get("zoom_factor")
    if isinstance(factor, int | float) and factor > 1:
        said.append(rng.choice(_ZOOM_IN).format(f=f"{factor:g}", t=times(float(factor))))
    elif isinstance(factor, int | float):
        said.append(f"zoom out to {'half' if factor == 0.5 else f'{factor:.0%} of'} the magnification")
    return said


def preset_at(preset: ScenePreset) -> CameraPosition:
    return CameraPosition(preset.viewpoint, EYES.limits.clamp(Pose(preset.pan_deg, preset.tilt_deg, preset.zoom))[0])


def move(at: CameraPosition, call: ProgramCall) -> CameraPosition | None:
    """Where an adjustment leads; None when a limit would cut it."""
    pose, cut = EYES.limits.clamp(requested_pose(at.pose, AdjustPtz.model_validate(call.arguments), EYES.limits))
    return None if cut else CameraPosition(at.viewpoint, pose)


def adjust(pan: float = 0.0, tilt: float = 0.0, factor: float | None = None) -> ProgramCall:
    given = {"pan_deg": float(pan), "tilt_deg": float(tilt), "zoom_factor": factor}
    return ProgramCall(tool="adjust_ptz", arguments={k: v for k, v in given.items() if v})


def go(preset: str) -> ProgramCall:
    return ProgramCall(tool="go_to_preset", arguments={"name": preset})


def elsewhere(one: Place, two: Place) -> Place:
    """A start for what is asked of two presets: the first one's own, unless that is the second and there is a third."""
    names = [p.name for p in one.scene.file.presets]
    others = [name for name in names if name not in (one.preset, two.preset)]
    if one.start == two.preset and others:
        # Any will do, but the same each time, and not the same for all.
        return Place(one.scene, others[sum(map(ord, f"{one.preset}{two.preset}")) % len(others)], (), one.at)
    return Place(one.scene, one.start, (), one.at)


class Places:
    """The places of a scene in a seeded order: viewpoints in turn, presets first, then views off them."""

    def __init__(self, scene: Scene, rng: random.Random) -> None:
        self.scene, self.presets = scene, {p.name: p for p in scene.file.presets}
        self._rng = rng

    def direct(self, name: str) -> Place:
        """A preset, come to from another one."""
        others = [p for p in self.presets if p != name] or [name]
        return Place(self.scene, self._rng.choice(others), (go(name),), preset_at(self.presets[name]))

    def stay(self, name: str) -> Place:
        return Place(self.scene, name, (), preset_at(self.presets[name]))

    def around(self) -> list[Place]:
        """Sweeps, one a viewpoint and start."""
        places = []
        for name, preset in self.presets.items():
            places.append(Place(self.scene, name, (), preset_at(preset), swept=True))
            if (start := places[-1].start) and self._rng.random() < 0.3:
                origin = next((p for p in self.presets if p != start), start)
                places.append(Place(self.scene, origin, (go(name),), preset_at(preset), swept=True))
        self._rng.shuffle(places)
        return places

    def off(self) -> Iterator[Place]:
        """Views off the presets, without end: turned, tilted, zoomed, also after a change of preset."""
        names, tried = list(self.presets), 0
        while tried < 3000:
            name = names[tried % len(names)]
            tried += 1
            call = self._adjustment()
            at = preset_at(self.presets[name])
            there = move(at, call)
            if there is None:
                continue
            if self._rng.random() < 0.45:
                start = self._rng.choice([p for p in names if p != name] or [name])
                yield Place(self.scene, start, (go(name), call), there)
            else:
                yield Place(self.scene, name, (call,), there)

    def _adjustment(self) -> ProgramCall:
        rng = self._rng
        pan = rng.choice((-1, 1)) * rng.choice((10, 12, 15, 18, 20, 25, 30, 35, 40, 45, 50, 60, 75, 90, 120))
        tilt = rng.choice((-15, -12, -10, -8, -5, 4, 5, 8, 10))
        factor = rng.choice((1.5, 2.0, 2.5, 3.0))
        shape = rng.random()
        if shape < 0.4:
            return adjust(pan)
        if shape < 0.5:
            return adjust(0, tilt)
        if shape < 0.65:
            return adjust(factor=factor)
        if shape < 0.85:
            return adjust(rng.choice((-1, 1)) * rng.choice((10, 15, 20, 25, 30)), 0, factor)
        return adjust(pan, tilt)

    def towards(self, viewpoint: str, pan_deg: float, tilt_deg: float, zoom: float) -> Place | None:
        """A view of a direction, whole degrees off the nearest preset of that viewpoint; None without one, or when a limit cuts."""
        near = [p for p in self.presets.values() if p.viewpoint == viewpoint]
        if not near:
            return None
        preset = min(near, key=lambda p: abs((pan_deg - p.pan_deg + 180) % 360 - 180))
        at = preset_at(preset)
        pan, tilt = (pan_deg - at.pose.pan_deg + 180) % 360 - 180, tilt_deg - at.pose.tilt_deg
        factor = next((f for f in (1.5, 2.0, 2.5, 3.0, 4.0) if at.pose.zoom * f >= zoom), None)
        if factor is None or at.pose.zoom * factor > EYES.limits.max_zoom:
            return None
        # Nobody turns a camera by a degree or two for what is in view anyway.
        pan, tilt = (round(angle) if abs(angle) > _HARDLY_DEG else 0 for angle in (pan, tilt))
        call = adjust(pan, tilt, factor)
        there = move(at, call)
        if there is None:
            return None
        if self._rng.random() < 0.4:
            start = self._rng.choice([p for p in self.presets if p != preset.name] or [preset.name])
            return Place(self.scene, start, (go(preset.name), call), there)
        return Place(self.scene, preset.name, (call,), there)
