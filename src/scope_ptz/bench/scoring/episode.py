"""A run as checks see it: calls with poses before and after, what perception looked at, and how it ended.

It is made from a recorded trace, or by hand in tests, and knows nothing of any scene's truth.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from scope_ptz.agent.records import Called, Decided, Place
from scope_ptz.agent.trace import Trace
from scope_ptz.camera.base import CameraInfo
from scope_ptz.geometry import AXIS_M5075_G, Equirectangular, Limits, Optics, Perspective, Pose
from scope_ptz.simulator.models import SceneFile
from scope_ptz.tools.sweep import plan_sweep

How = Literal["count", "query", "locate", "track", "planner"]
_HOW: dict[str, How] = {"count_objects": "count", "query_answer": "query", "zoom_to_object": "locate", "track_object": "track"}


@dataclass(frozen=True, slots=True)
class CameraState:
    """Where the camera is: optical centre and pose."""

    viewpoint: str | None
    pose: Pose


@dataclass(frozen=True, slots=True)
class Observation:
    """One successful look of perception (or of a planner that sees): from where, at what, when, and what it was asked.

    ``known``: what was asked could be told; a look that brought no answer covers nothing.
    """

    viewpoint: str | None
    projection: Perspective | Equirectangular
    time_s: float
    how: How
    asked: str = ""
    known: bool = True

    @property
    def swept(self) -> bool:
        return isinstance(self.projection, Equirectangular)


@dataclass(frozen=True, slots=True)
class EpisodeCall:
    """A tool call. ``fault`` says whose doing an ``error`` was, as in the trace; ``looks`` are those that succeeded."""

    name: str
    arguments: Mapping[str, Any]
    before: CameraState
    after: CameraState
    result: Mapping[str, Any] | None = None
    error: str | None = None
    fault: str | None = None
    time_s: float = 0.0
    looks: tuple[Observation, ...] = ()

    @property
    def succeeded(self) -> bool:
        return self.error is None and self.result is not None


@dataclass(frozen=True, slots=True)
class SavedPicture:
    """A file that ``take_image`` reported. ``exists``: None where nothing was kept on purpose."""

    file: str
    exists: bool | None = None


@dataclass(frozen=True, slots=True)
class Episode:
    """A run. ``outcome`` is None when it was cut off; ``failure`` is how a planner's server failed, if one did."""

    instruction: str
    start: CameraState
    calls: tuple[EpisodeCall, ...]
    final: CameraState
    text: str
    outcome: str | None
    pictures: tuple[SavedPicture, ...] = ()
    seen: tuple[Observation, ...] = ()
    failure: str | None = None
    aspect: float = 16 / 9
    optics: Optics = field(default=AXIS_M5075_G)

    @property
    def looks(self) -> tuple[Observation, ...]:
        """Every successful look, those of a seeing planner included."""
        return (*self.seen, *(look for call in self.calls for look in call.looks))


@dataclass(frozen=True, slots=True)
class PresetViewpoints:
    """Which optical centre each preset and home belong to, as the scene says it."""

    presets: Mapping[str, str]
    home: str

    @classmethod
    def of(cls, scene: SceneFile) -> PresetViewpoints:
        presets = {p.name: p.viewpoint for p in scene.presets}
        return cls(presets, presets[scene.home_preset])


@dataclass(frozen=True, slots=True)
class FrameGeometry:
    """What frames of a run look like: lens, limits and size in pixels."""

    width: int
    height: int
    optics: Optics = field(default=AXIS_M5075_G)
    limits: Limits = field(default_factory=Limits)

    def view(self, pose: Pose) -> Perspective:
        return Perspective(pose.pan_deg, pose.tilt_deg, self.optics.hfov_deg(pose.zoom), self.width, self.height)

    def sweep(self) -> Equirectangular:
        """The panorama of a sweep, at the density of the frames that it is made of."""
        blocks = plan_sweep(CameraInfo("", self.limits, self.optics, self.width, self.height, simulated=True))
        left, top = blocks[0].left_pan_deg, blocks[0].top_tilt_deg
        span, bottom = max(b.right_pan_deg for b in blocks) - left, min(b.bottom_tilt_deg for b in blocks)
        density = self.view(Pose(0, 0, self.limits.min_zoom)).focal_px * math.pi / 180
        return Equirectangular(left, span, top, bottom, round(span * density), round((top - bottom) * density))


def episode_of(trace: Trace, places: PresetViewpoints, *, planner_sees: bool = False, keeps_files: bool = True) -> Episode:
    """The run of a trace. ``planner_sees``: its planner was shown frames; ``keeps_files``: pictures are kept in the run folder."""
    started = trace.started
    eyes = FrameGeometry(started.frame_width, started.frame_height)
    at = start = CameraState(started.viewpoint, started.pose.pose())
    home = started.labels.home_viewpoint or places.home
    calls, seen, stands = list[EpisodeCall](), list[Observation](), {0: start}
    for called in trace.calls:
        call = _call(called, at, places, home, eyes)
        at = stands[called.step] = call.after
        calls.append(call)
    if planner_sees:
        seen = list(_views(trace.decisions, trace.calls, stands, eyes, started.scene_time_s))
    files = [str(c.result["file"]) for c in calls if c.name == "take_image" and c.succeeded and c.result and "file" in c.result]
    ended = trace.ended
    return Episode(
        instruction=started.instruction,
        start=start,
        calls=tuple(calls),
        final=CameraState(at.viewpoint, ended.pose.pose() if ended else at.pose),
        text=ended.text if ended else "",
        outcome=ended.outcome if ended else None,
        pictures=tuple(SavedPicture(name, (trace.folder / name).is_file() if keeps_files else None) for name in files),
        seen=tuple(seen),
        failure=ended.kind if ended else None,
        aspect=started.frame_width / started.frame_height,
    )


def _call(called: Called, before: CameraState, places: PresetViewpoints, home: str, eyes: FrameGeometry) -> EpisodeCall:
    outcome = called.outcome
    done = outcome.error is None
    viewpoint = before.viewpoint
    if done and outcome.call.name == "go_to_preset":
        viewpoint = places.presets.get(str(outcome.call.arguments.get("name")), viewpoint)
    elif done and outcome.call.name == "go_home":
        viewpoint = home
    after = CameraState(viewpoint, called.pose.pose())
    call = EpisodeCall(
        name=outcome.call.name,
        arguments=outcome.call.arguments,
        before=before,
        after=after,
        result=outcome.result,
        error=outcome.error,
        fault=called.fault,
        time_s=called.scene_time_s,
    )
    looks = observations_of(call, eyes) if call.succeeded else ()
    return EpisodeCall(**{name: getattr(call, name) for name in EpisodeCall.__slots__ if name != "looks"}, looks=looks)


def observations_of(call: EpisodeCall, eyes: FrameGeometry) -> tuple[Observation, ...]:
    """What perception looked at in a call that succeeded: of a zoom only the first look is sure, of a track all of its path."""
    how, result = _HOW.get(call.name), call.result or {}
    if how is None:
        return ()
    asked = str(call.arguments.get("description", call.arguments.get("question", "")))
    place = call.before.viewpoint
    if how == "track":
        path = result.get("path") or [{"time_s": 0.0, "pose": Place.of(call.before.pose).model_dump()}]
        return tuple(
            Observation(place, eyes.view(Pose(**point["pose"])), call.time_s + float(point["time_s"]), how, asked) for point in path
        )
    swept = how in ("count", "query") and call.arguments.get("view", "current") == "full"
    known = how != "query" or result.get("known") is not False
    return (Observation(place, eyes.sweep() if swept else eyes.view(call.before.pose), call.time_s, how, asked, known),)


def _views(
    decisions: tuple[Decided, ...],
    calls: tuple[Called, ...],
    stands: Mapping[int, CameraState],
    eyes: FrameGeometry,
    start_s: float,
) -> Iterator[Observation]:
    """What a seeing planner was shown before each of its decisions."""
    for decided in decisions:
        if decided.decision.opened is False:
            continue
        step = max(s for s in stands if s < decided.step)
        times = [c.scene_time_s for c in calls if c.step <= step]
        stand = stands[step]
        yield Observation(stand.viewpoint, eyes.view(stand.pose), max(times, default=start_s), "planner")
