"""Task places: a start preset, the moves from there to the view that the task is about, and phrases for these moves."""

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
from scope_ptz.taskgen.authoring.noun_phrases import angle_words, factor_words
from scope_ptz.taskgen.facts.robust import TASK_CAMERA, RobustTruth, robust_truth
from scope_ptz.tools.adjust_ptz import AdjustPtz, requested_pose

_PRESET_PHRASES = (
    "go to the {p} preset", "switch to the {p} view", "move to the preset {p}", "select the {p} preset", "bring up the {p} view",
    "take the camera to the {p} preset", "call up the preset {p}", "change to the {p} view",
)  # fmt: skip
_PAN_PHRASES = ("turn {d} to the {s}", "pan {s} by {d}", "swing {d} {s}", "pan {d} to the {s}", "rotate the camera {d} to the {s}")
_TILT_PHRASES = ("tilt {s} by {d}", "tilt {d} {s}", "aim the camera {d} further {s}", "tip the camera {s} {d}")
_ZOOM_IN_PHRASES = ("zoom in to {t} the magnification", "zoom in {f}x", "zoom in by a factor of {f}", "magnify the view {f} times")
_HOME_PHRASES = ("go home", "return to the home view", "go back to the home position")
_SWEEP_PHRASES = (
    "look all the way round", "scan the whole scene", "do a full sweep", "check everything around the camera",
    "sweep the whole scene", "go over the full surroundings",
)  # fmt: skip


_MIN_TURN_DEG = 2.5  # smaller turns towards an object are omitted


@dataclass(frozen=True)
class TaskPlace:
    """A start preset and the calls that lead from it to a view.

    Attributes:
        scene: The scene.
        start: The preset at which the task starts.
        calls: The calls that lead to the view.
        at: Viewpoint and pose after these calls.
        swept: Whether the task is about a sweep around the viewpoint instead of a single view.
    """

    scene: Scene
    start: str
    calls: tuple[ProgramCall, ...]
    at: CameraPosition
    swept: bool = False

    @cached_property
    def truth(self) -> RobustTruth:
        """The robust ground truth of the view."""
        return robust_truth(self.scene, self.at, self.scene.file.start_s, swept=self.swept)

    @property
    def key(self) -> str:
        """A key for the view, independent of the calls that lead to it."""
        pose = self.at.pose
        view = "all" if self.swept else f"{pose.pan_deg:.1f}/{pose.tilt_deg:.1f}/{pose.zoom:.2f}"
        return f"{self.scene.name}:{self.at.viewpoint}:{view}"

    @property
    def is_start_view(self) -> bool:
        """Whether the view is the start view, so that no call leads to it."""
        return not self.calls and not self.swept

    @property
    def preset(self) -> str | None:
        """The view's preset if a single preset call leads to the view; otherwise None."""
        only = self.calls[0] if len(self.calls) == 1 else None
        return str(only.arguments["name"]) if only is not None and only.tool == "go_to_preset" else None

    @property
    def aim(self) -> Aim:
        """Viewpoint and pose, with the rounding that stored tasks use."""
        pose = self.at.pose
        return Aim(
            viewpoint=str(self.at.viewpoint),
            pan_deg=round(pose.pan_deg, 4),
            tilt_deg=round(pose.tilt_deg, 4),
            zoom=round(pose.zoom, 5),
        )

    @property
    def final(self) -> FinalPose:
        """The camera position at which a run must end."""
        return FinalPose(**self.aim.model_dump())

    @property
    def hfov_deg(self) -> float:
        """Horizontal field of view in degrees."""
        return round(TASK_CAMERA.optics.hfov_deg(self.at.pose.zoom), 4)

    @property
    def needs(self) -> tuple[Need, ...]:
        """The actions that an agent must take to see the view: change the preset, move, zoom, sweep."""
        needs: list[Need] = []
        for call in self.calls:
            if call.tool in ("go_to_preset", "go_home"):
                needs.append("preset")
            elif call.arguments.get("pan_deg") or call.arguments.get("tilt_deg"):
                needs.append("move")
            if "zoom_factor" in call.arguments:
                needs.append("zoom")
        return tuple(dict.fromkeys([*needs, *(["sweep"] if self.swept else [])]))  # type: ignore[list-item]

    def move_phrases(self, rng: random.Random) -> tuple[str, str]:
        """Return the moves in words, without a capital letter or a full stop.

        Returns:
            A complete phrase ("turn left and zoom in 2x"), and a phrase to which "and ..." can be added ("turn left, zoom in 2x").
        """
        parts = [phrase for call in self.calls for phrase in call_phrases(call, rng)]
        if self.swept:
            parts.append(rng.choice(_SWEEP_PHRASES))
        return join_phrases(parts, rng), ", ".join(parts)


def join_phrases(parts: list[str], rng: random.Random) -> str:
    """Join move phrases into one."""
    if len(parts) < 3:
        return rng.choice((" and ", ", then ")).join(parts)
    return f"{', '.join(parts[:-1])}{rng.choice((' and ', ' and then ', ', and then '))}{parts[-1]}"


def call_phrases(call: ProgramCall, rng: random.Random) -> list[str]:
    """Return phrases for a call that moves the camera, one for each axis."""
    arguments = call.arguments
    if call.tool == "go_to_preset":
        return [rng.choice(_PRESET_PHRASES).format(p=arguments["name"])]
    if call.tool == "go_home":
        return [rng.choice(_HOME_PHRASES)]
    phrases = []
    for axis, forms, names in (("pan_deg", _PAN_PHRASES, ("right", "left")), ("tilt_deg", _TILT_PHRASES, ("up", "down"))):
        amount = arguments.get(axis)
        if isinstance(amount, int | float) and amount:
            phrases.append(rng.choice(forms).format(d=angle_words(abs(amount)), s=names[amount < 0]))
    factor = arguments.get("zoom_factor")
    if isinstance(factor, int | float) and factor > 1:
        phrases.append(rng.choice(_ZOOM_IN_PHRASES).format(f=f"{factor:g}", t=factor_words(float(factor))))
    elif isinstance(factor, int | float):
        phrases.append(f"zoom out to {'half' if factor == 0.5 else f'{factor:.0%} of'} the magnification")
    return phrases


def preset_position(preset: ScenePreset) -> CameraPosition:
    """Return the viewpoint and pose of a preset, clamped to the limits of the camera."""
    return CameraPosition(preset.viewpoint, TASK_CAMERA.limits.clamp(Pose(preset.pan_deg, preset.tilt_deg, preset.zoom))[0])


def apply_adjustment(at: CameraPosition, call: ProgramCall) -> CameraPosition | None:
    """Return the camera position after an adjustment; None if a limit of the camera would clamp it."""
    pose, clamped = TASK_CAMERA.limits.clamp(requested_pose(at.pose, AdjustPtz.model_validate(call.arguments), TASK_CAMERA.limits))
    return None if clamped else CameraPosition(at.viewpoint, pose)


def adjust_call(pan: float = 0.0, tilt: float = 0.0, factor: float | None = None) -> ProgramCall:
    """Return a call that turns and zooms. Arguments of zero are omitted."""
    values = {"pan_deg": float(pan), "tilt_deg": float(tilt), "zoom_factor": factor}
    return ProgramCall(tool="adjust_ptz", arguments={k: v for k, v in values.items() if v})


def preset_call(preset: str) -> ProgramCall:
    """Return a call that goes to a preset."""
    return ProgramCall(tool="go_to_preset", arguments={"name": preset})


def comparison_start(one: TaskPlace, two: TaskPlace) -> TaskPlace:
    """Return the place at which a task about two presets starts.

    This is the start of the first place. If the first place starts at the second preset, the task starts at a third preset instead
    (if the scene has one), so that the start view is neither of the two that the task is about.
    """
    names = [p.name for p in one.scene.file.presets]
    others = [name for name in names if name not in (one.preset, two.preset)]
    if one.start == two.preset and others:
        # The choice among the other presets must be the same in every build, and vary between pairs.
        return TaskPlace(one.scene, others[sum(map(ord, f"{one.preset}{two.preset}")) % len(others)], (), one.at)
    return TaskPlace(one.scene, one.start, (), one.at)


class ScenePlaces:
    """The task places in one scene. Random choices use the generator ``rng``, so its seed determines the places."""

    def __init__(self, scene: Scene, rng: random.Random) -> None:
        self.scene, self.presets = scene, {p.name: p for p in scene.file.presets}
        self._rng = rng

    def place_from_other_preset(self, name: str) -> TaskPlace:
        """Return the view of a preset, reached from another preset at which the task starts."""
        others = [p for p in self.presets if p != name] or [name]
        return TaskPlace(self.scene, self._rng.choice(others), (preset_call(name),), preset_position(self.presets[name]))

    def place_at_preset(self, name: str) -> TaskPlace:
        """Return the view of a preset at which the task starts."""
        return TaskPlace(self.scene, name, (), preset_position(self.presets[name]))

    def sweeps(self) -> list[TaskPlace]:
        """Return sweeps at every preset, some of which are reached from another preset."""
        places = []
        for name, preset in self.presets.items():
            places.append(TaskPlace(self.scene, name, (), preset_position(preset), swept=True))
            if (start := places[-1].start) and self._rng.random() < 0.3:
                origin = next((p for p in self.presets if p != start), start)
                places.append(TaskPlace(self.scene, origin, (preset_call(name),), preset_position(preset), swept=True))
        self._rng.shuffle(places)
        return places

    def off_preset_views(self) -> Iterator[TaskPlace]:
        """Yield views away from the presets, from up to 3000 random moves. Some of them begin with a change of preset."""
        names = list(self.presets)
        for attempt in range(3000):
            name = names[attempt % len(names)]
            call = self._random_adjustment()
            at = preset_position(self.presets[name])
            destination = apply_adjustment(at, call)
            if destination is None:
                continue
            if self._rng.random() < 0.45:
                start = self._rng.choice([p for p in names if p != name] or [name])
                yield TaskPlace(self.scene, start, (preset_call(name), call), destination)
            else:
                yield TaskPlace(self.scene, name, (call,), destination)

    def _random_adjustment(self) -> ProgramCall:
        rng = self._rng
        pan = rng.choice((-1, 1)) * rng.choice((10, 12, 15, 18, 20, 25, 30, 35, 40, 45, 50, 60, 75, 90, 120))
        tilt = rng.choice((-15, -12, -10, -8, -5, 4, 5, 8, 10))
        factor = rng.choice((1.5, 2.0, 2.5, 3.0))
        draw = rng.random()
        if draw < 0.4:
            return adjust_call(pan)
        if draw < 0.5:
            return adjust_call(0, tilt)
        if draw < 0.65:
            return adjust_call(factor=factor)
        if draw < 0.85:
            return adjust_call(rng.choice((-1, 1)) * rng.choice((10, 15, 20, 25, 30)), 0, factor)
        return adjust_call(pan, tilt)

    def place_towards(self, viewpoint: str, pan_deg: float, tilt_deg: float, zoom: float) -> TaskPlace | None:
        """Return a view in a given direction, reached by turning whole degrees and zooming in from the viewpoint's nearest preset.

        Args:
            viewpoint: Name of the viewpoint.
            pan_deg: Pan of the direction, in degrees.
            tilt_deg: Tilt of the direction, in degrees.
            zoom: Minimum zoom of the view.

        Returns:
            The place; None if the viewpoint has no preset, if a factor of up to 4 does not reach the zoom, or if a limit of the
            camera prevents the move.
        """
        viewpoint_presets = [p for p in self.presets.values() if p.viewpoint == viewpoint]
        if not viewpoint_presets:
            return None
        preset = min(viewpoint_presets, key=lambda p: abs((pan_deg - p.pan_deg + 180) % 360 - 180))
        at = preset_position(preset)
        pan, tilt = (pan_deg - at.pose.pan_deg + 180) % 360 - 180, tilt_deg - at.pose.tilt_deg
        factor = next((f for f in (1.5, 2.0, 2.5, 3.0, 4.0) if at.pose.zoom * f >= zoom), None)
        if factor is None or at.pose.zoom * factor > TASK_CAMERA.limits.max_zoom:
            return None
        # A turn by one or two degrees would sound unnatural, because the object is in view without it.
        pan, tilt = (round(angle) if abs(angle) > _MIN_TURN_DEG else 0 for angle in (pan, tilt))
        call = adjust_call(pan, tilt, factor)
        destination = apply_adjustment(at, call)
        if destination is None:
            return None
        if self._rng.random() < 0.4:
            start = self._rng.choice([p for p in self.presets if p != preset.name] or [preset.name])
            return TaskPlace(self.scene, start, (preset_call(preset.name), call), destination)
        return TaskPlace(self.scene, preset.name, (call,), destination)
