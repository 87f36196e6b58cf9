"""Episodes, the form of a run that the checks use: calls with the camera positions before and after, observations, and the outcome.

An episode is built from a recorded trace, or by hand in tests. It contains no ground truth about the scene.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from scope_ptz.agent.records import Called, Decided, RecordedPose
from scope_ptz.agent.trace import Trace
from scope_ptz.camera.base import CameraInfo
from scope_ptz.geometry import AXIS_M5075_G, Equirectangular, Limits, Optics, Perspective, Pose
from scope_ptz.simulator.models import SceneFile
from scope_ptz.tools.sweep import plan_sweep

ObservationKind = Literal["count", "query", "locate", "track", "planner"]
_OBSERVATION_KINDS: dict[str, ObservationKind] = {
    "count_objects": "count",
    "query_answer": "query",
    "zoom_to_object": "locate",
    "track_object": "track",
}
"""The kind of observation that each perception tool makes."""


@dataclass(frozen=True, slots=True)
class CameraPosition:
    """The camera's viewpoint and pose."""

    viewpoint: str | None
    pose: Pose


@dataclass(frozen=True, slots=True)
class Observation:
    """A successful observation by perception, or by a planner that is shown frames.

    Attributes:
        viewpoint: Viewpoint of the camera.
        projection: Projection of the image.
        time_s: Scene time in seconds.
        kind: The kind of perception call; "planner" for a frame that was shown to the planner.
        request: The description or question in the call.
        known: Whether perception knew the answer. Observations without an answer do not cover any evidence.
    """

    viewpoint: str | None
    projection: Perspective | Equirectangular
    time_s: float
    kind: ObservationKind
    request: str = ""
    known: bool = True

    @property
    def is_panorama(self) -> bool:
        """Whether a panorama was observed."""
        return isinstance(self.projection, Equirectangular)


@dataclass(frozen=True, slots=True)
class EpisodeCall:
    """A tool call. ``fault`` is the cause of ``error``, as in the trace. ``observations`` contains only successful observations."""

    name: str
    arguments: Mapping[str, Any]
    before: CameraPosition
    after: CameraPosition
    result: Mapping[str, Any] | None = None
    error: str | None = None
    fault: str | None = None
    time_s: float = 0.0
    observations: tuple[Observation, ...] = ()

    @property
    def succeeded(self) -> bool:
        """Whether the call returned a result."""
        return self.error is None and self.result is not None


@dataclass(frozen=True, slots=True)
class SavedPicture:
    """A picture reported by ``take_image``. ``exists`` states whether the file exists; None if this was not checked."""

    file: str
    exists: bool | None = None


@dataclass(frozen=True, slots=True)
class Episode:
    """A run in the form that the checks use.

    Attributes:
        instruction: The instruction to the agent.
        start: Initial position of the camera.
        calls: The tool calls in order.
        final: Final position of the camera.
        answer: The agent's final answer.
        outcome: How the run ended; None if it was interrupted.
        pictures: The pictures that the agent took.
        planner_views: The frames that were shown to the planner.
        failure: Kind of the planner failure that ended the run; None if there was none.
        aspect: Width of a frame divided by its height.
        optics: The camera's lens.
    """

    instruction: str
    start: CameraPosition
    calls: tuple[EpisodeCall, ...]
    final: CameraPosition
    answer: str
    outcome: str | None
    pictures: tuple[SavedPicture, ...] = ()
    planner_views: tuple[Observation, ...] = ()
    failure: str | None = None
    aspect: float = 16 / 9
    optics: Optics = field(default=AXIS_M5075_G)

    @property
    def observations(self) -> tuple[Observation, ...]:
        """All successful observations, including the frames that were shown to the planner."""
        return (*self.planner_views, *(observation for call in self.calls for observation in call.observations))


@dataclass(frozen=True, slots=True)
class PresetViewpoints:
    """The viewpoints of a scene's presets and of its home position."""

    presets: Mapping[str, str]
    home: str

    @classmethod
    def of(cls, scene: SceneFile) -> PresetViewpoints:
        """Return the viewpoints of a scene's presets."""
        presets = {p.name: p.viewpoint for p in scene.presets}
        return cls(presets, presets[scene.home_preset])


@dataclass(frozen=True, slots=True)
class FrameGeometry:
    """The geometry of a run's frames: the frame size in pixels, and the camera's lens and limits."""

    width: int
    height: int
    optics: Optics = field(default=AXIS_M5075_G)
    limits: Limits = field(default_factory=Limits)

    def view(self, pose: Pose) -> Perspective:
        """Return the projection of a frame at a pose."""
        return Perspective(pose.pan_deg, pose.tilt_deg, self.optics.hfov_deg(pose.zoom), self.width, self.height)

    def sweep(self) -> Equirectangular:
        """Return the projection of a sweep's panorama, which has the same resolution as the frames of the sweep."""
        blocks = plan_sweep(CameraInfo("", self.limits, self.optics, self.width, self.height, simulated=True))
        left, top = blocks[0].left_pan_deg, blocks[0].top_tilt_deg
        span, bottom = max(b.right_pan_deg for b in blocks) - left, min(b.bottom_tilt_deg for b in blocks)
        density = self.view(Pose(0, 0, self.limits.min_zoom)).focal_px * math.pi / 180
        return Equirectangular(left, span, top, bottom, round(span * density), round((top - bottom) * density))


def episode_of(
    trace: Trace, preset_viewpoints: PresetViewpoints, *, planner_sees: bool = False, keeps_files: bool = True
) -> Episode:
    """Build an episode from a trace.

    Args:
        trace: The recorded run.
        preset_viewpoints: The viewpoints of the scene's presets.
        planner_sees: Whether the planner was shown frames.
        keeps_files: Whether pictures are kept in the run folder, so that their existence can be checked.
    """
    started = trace.started
    geometry = FrameGeometry(started.frame_width, started.frame_height)
    position = start = CameraPosition(started.viewpoint, started.pose.pose())
    home = started.labels.home_viewpoint or preset_viewpoints.home
    calls, planner_views, states = list[EpisodeCall](), list[Observation](), {0: start}
    for called in trace.calls:
        call = _episode_call(called, position, preset_viewpoints, home, geometry)
        position = states[called.step] = call.after
        calls.append(call)
    if planner_sees:
        planner_views = list(_planner_views(trace.decisions, trace.calls, states, geometry, started.scene_time_s))
    files = [str(c.result["file"]) for c in calls if c.name == "take_image" and c.succeeded and c.result and "file" in c.result]
    ended = trace.ended
    return Episode(
        instruction=started.instruction,
        start=start,
        calls=tuple(calls),
        final=CameraPosition(position.viewpoint, ended.pose.pose() if ended else position.pose),
        answer=ended.text if ended else "",
        outcome=ended.outcome if ended else None,
        pictures=tuple(SavedPicture(name, (trace.folder / name).is_file() if keeps_files else None) for name in files),
        planner_views=tuple(planner_views),
        failure=ended.kind if ended else None,
        aspect=started.frame_width / started.frame_height,
    )


def _episode_call(
    called: Called, before: CameraPosition, preset_viewpoints: PresetViewpoints, home: str, geometry: FrameGeometry
) -> EpisodeCall:
    outcome = called.outcome
    succeeded = outcome.error is None
    viewpoint = before.viewpoint
    if succeeded and outcome.call.name == "go_to_preset":
        viewpoint = preset_viewpoints.presets.get(str(outcome.call.arguments.get("name")), viewpoint)
    elif succeeded and outcome.call.name == "go_home":
        viewpoint = home
    after = CameraPosition(viewpoint, called.pose.pose())
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
    observations = observations_of(call, geometry) if call.succeeded else ()
    return EpisodeCall(
        **{name: getattr(call, name) for name in EpisodeCall.__slots__ if name != "observations"}, observations=observations
    )


def observations_of(call: EpisodeCall, geometry: FrameGeometry) -> tuple[Observation, ...]:
    """Return the observations of a successful call.

    For ``zoom_to_object``, only the first observation is returned, because later ones are not recorded. For ``track_object``, there
    is one observation for each pose on the path.
    """
    kind, result = _OBSERVATION_KINDS.get(call.name), call.result or {}
    if kind is None:
        return ()
    request = str(call.arguments.get("description", call.arguments.get("question", "")))
    place = call.before.viewpoint
    if kind == "track":
        path = result.get("path") or [{"time_s": 0.0, "pose": RecordedPose.of(call.before.pose).model_dump()}]
        return tuple(
            Observation(place, geometry.view(Pose(**point["pose"])), call.time_s + float(point["time_s"]), kind, request)
            for point in path
        )
    is_panorama = kind in ("count", "query") and call.arguments.get("view", "current") == "full"
    known = kind != "query" or result.get("known") is not False
    return (
        Observation(place, geometry.sweep() if is_panorama else geometry.view(call.before.pose), call.time_s, kind, request, known),
    )


def _planner_views(
    decisions: tuple[Decided, ...],
    calls: tuple[Called, ...],
    states: Mapping[int, CameraPosition],
    geometry: FrameGeometry,
    start_s: float,
) -> Iterator[Observation]:
    """Yield the frames that were shown to the planner before its decisions."""
    for decided in decisions:
        if decided.decision.opened is False:
            continue
        step = max(s for s in states if s < decided.step)
        times = [c.scene_time_s for c in calls if c.step <= step]
        state = states[step]
        yield Observation(state.viewpoint, geometry.view(state.pose), max(times, default=start_s), "planner")
