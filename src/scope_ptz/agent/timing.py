"""Timing of runs: wrappers around a camera and a perception backend that measure every call."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Iterable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict

from scope_ptz.camera.base import Arrival, Camera, Frame, PresetInfo
from scope_ptz.camera.guard.wrapper import CameraWrapper
from scope_ptz.camera.lens import DEFAULT_STEP, FocusAction, IrisAction, LensState
from scope_ptz.endpoints.failures import Attempt, count_failures
from scope_ptz.errors import PerceptionError, PlannerError, TraceError
from scope_ptz.geometry import Pose
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points
from scope_ptz.planner.base import Usage

TimedPart = Literal["planner", "perception", "camera", "render"]
PerceptionMethod = Literal["caption", "query", "detect", "point"]
Observation = Caption | Answer | Detections | Points
_PerceptionResult = TypeVar("_PerceptionResult", Caption, Answer, Detections, Points)


class Timings(BaseModel):
    """Wall-clock seconds spent in each part of the system. Overlapping calls to one part are counted once.

    Attributes:
        planner_s: Time spent on the planner's decisions.
        perception_s: Time spent on perception calls.
        camera_s: Time spent on moves, and on frames from a real camera.
        render_s: Time spent on frames from a simulated camera.
        total_s: Duration of the whole run, including the loop and the tools.
        first_token_s: The part of ``planner_s`` before the first token of each reply, if the planner's server streams.
    """

    model_config = ConfigDict(frozen=True)

    planner_s: float = 0.0
    perception_s: float = 0.0
    camera_s: float = 0.0
    render_s: float = 0.0
    total_s: float = 0.0
    first_token_s: float = 0.0

    @property
    def capture_s(self) -> float:
        """Seconds spent on camera calls: moves and frames, including simulated frames."""
        return self.camera_s + self.render_s

    @property
    def own_s(self) -> float:
        """Seconds spent outside camera calls: in the planner, in perception, and in the loop and the tools."""
        return max(self.planner_s + self.perception_s, self.total_s - self.capture_s)

    @property
    def tools_s(self) -> float:
        """Seconds spent in the loop and the tools themselves, for example to stitch a panorama or write pictures."""
        return self.own_s - self.planner_s - self.perception_s

    def __sub__(self, earlier: Timings) -> Timings:
        return Timings(**{name: round(getattr(self, name) - getattr(earlier, name), 6) for name in Timings.model_fields})


class Stopwatch:
    """A stopwatch that adds up wall-clock time for each part of the system. Overlapping calls to one part are counted once."""

    def __init__(self) -> None:
        self._began = perf_counter()
        self._part_times_s: dict[TimedPart, float] = {"planner": 0.0, "perception": 0.0, "camera": 0.0, "render": 0.0}
        self._active: dict[TimedPart, int] = dict.fromkeys(self._part_times_s, 0)
        self._part_starts_s: dict[TimedPart, float] = dict.fromkeys(self._part_times_s, 0.0)
        self._first_tokens_s = 0.0

    @contextmanager
    def measure(self, part: TimedPart) -> Iterator[None]:
        """Add the time spent inside the ``with`` block to a part's total."""
        if not self._active[part]:
            self._part_starts_s[part] = perf_counter()
        self._active[part] += 1
        try:
            yield
        finally:
            self._active[part] -= 1
            if not self._active[part]:
                self._part_times_s[part] += perf_counter() - self._part_starts_s[part]

    def add_first_token_wait(self, seconds: float) -> None:
        """Add time that passed before the first token of a streamed reply."""
        self._first_tokens_s += seconds

    def read(self) -> Timings:
        """Return the times so far, including measurements in progress."""
        now = perf_counter()
        part_times = {
            f"{part}_s": round(seconds + (now - self._part_starts_s[part] if self._active[part] else 0.0), 6)
            for part, seconds in self._part_times_s.items()
        }
        return Timings(**part_times, total_s=round(now - self._began, 6), first_token_s=round(self._first_tokens_s, 6))


class TimedCamera(CameraWrapper):
    """A camera whose calls are timed. Frames from a simulated camera count as rendering, everything else as camera time."""

    def __init__(self, camera: Camera, watch: Stopwatch) -> None:
        super().__init__(camera)
        self._watch = watch
        self._frame_part: TimedPart = "render" if camera.info.simulated else "camera"

    async def pose(self) -> Pose:
        with self._watch.measure("camera"):
            return await super().pose()

    async def move(self, pose: Pose) -> Arrival:
        with self._watch.measure("camera"):
            return await super().move(pose)

    async def presets(self) -> list[PresetInfo]:
        with self._watch.measure("camera"):
            return await super().presets()

    async def go_to_preset(self, name: str) -> Arrival:
        with self._watch.measure("camera"):
            return await super().go_to_preset(name)

    async def go_home(self) -> Arrival:
        with self._watch.measure("camera"):
            return await super().go_home()

    async def frame(self) -> Frame:
        with self._watch.measure(self._frame_part):
            return await super().frame()

    async def stop(self) -> None:
        with self._watch.measure("camera"):
            await super().stop()

    async def drive(self, pan_dps: float = 0.0, tilt_dps: float = 0.0, zoom_rate: float = 0.0, *, timeout_s: float = 0.5) -> None:
        with self._watch.measure("camera"):
            await super().drive(pan_dps, tilt_dps, zoom_rate, timeout_s=timeout_s)

    async def save_preset(self, name: str, description: str = "") -> PresetInfo:
        with self._watch.measure("camera"):
            return await super().save_preset(name, description)

    async def remove_preset(self, name: str) -> None:
        with self._watch.measure("camera"):
            await super().remove_preset(name)

    async def lens(self) -> LensState:
        with self._watch.measure("camera"):
            return await super().lens()

    async def set_focus(self, action: FocusAction, *, step: float = DEFAULT_STEP) -> LensState:
        with self._watch.measure("camera"):
            return await super().set_focus(action, step=step)

    async def set_iris(self, action: IrisAction, *, step: float = DEFAULT_STEP) -> LensState:
        with self._watch.measure("camera"):
            return await super().set_iris(action, step=step)


class PerceptionReply(BaseModel):
    """A perception call and its reply. Either ``result`` or ``error`` is set.

    Attributes:
        kind: The method that was called.
        asked: The question or description; empty for captions.
        frame_time_s: Scene time of the frame.
        wall_s: Wall-clock seconds of the call.
        server_events: Number of failed requests to the model server by failure kind, including those that a retry recovered.
    """

    model_config = ConfigDict(frozen=True)

    kind: PerceptionMethod
    asked: str = ""
    result: dict[str, Any] | None = None
    error: str | None = None
    frame_time_s: float
    wall_s: float
    server_events: dict[str, int] = {}

    def restore(self, as_type: type[_PerceptionResult]) -> _PerceptionResult:
        """Return the typed result.

        Raises:
            PerceptionError: The recorded call failed.
            TraceError: The recorded result is damaged.
        """
        if self.error is not None or self.result is None:
            raise PerceptionError(self.error or "The recorded reply is empty.")
        try:
            return as_type.model_validate(self.result)
        except ValueError as error:
            raise TraceError(f"A recorded reply to '{self.kind}' is damaged: {error}") from error


class TimedPerception(Perception):
    """A perception backend whose calls are timed. It keeps the replies for the trace until ``drain`` is called."""

    def __init__(self, perception: Perception, watch: Stopwatch) -> None:
        self._perception, self._watch = perception, watch
        self.name = perception.name
        self._replies: list[PerceptionReply] = []

    def drain(self) -> tuple[PerceptionReply, ...]:
        """Return the replies since the last call to this method, oldest first."""
        replies, self._replies = tuple(self._replies), []
        return replies

    async def caption(self, frame: Frame) -> Caption:
        return await self._ask("caption", "", frame, lambda: self._perception.caption(frame))

    async def query(self, frame: Frame, question: str) -> Answer:
        return await self._ask("query", question, frame, lambda: self._perception.query(frame, question))

    async def detect(self, frame: Frame, description: str) -> Detections:
        return await self._ask("detect", description, frame, lambda: self._perception.detect(frame, description))

    async def point(self, frame: Frame, description: str) -> Points:
        return await self._ask("point", description, frame, lambda: self._perception.point(frame, description))

    async def _ask(
        self, kind: PerceptionMethod, asked: str, frame: Frame, call: Callable[[], Awaitable[_PerceptionResult]]
    ) -> _PerceptionResult:
        began, result, error, events = perf_counter(), None, None, dict[str, int]()
        try:
            with self._watch.measure("perception"):
                observation = await call()
            result = observation.model_dump(mode="json")
            events = count_failures(observation.attempts)
        except PerceptionError as failure:
            error, events = str(failure), failures_of(failure)
            raise
        finally:
            if result is not None or error is not None:
                wall_s = round(perf_counter() - began, 6)
                self._replies.append(
                    PerceptionReply(
                        kind=kind,
                        asked=asked,
                        result=result,
                        error=error,
                        frame_time_s=frame.time_s,
                        wall_s=wall_s,
                        server_events=events,
                    )
                )
        return observation


def usage_of_failures(attempts: Iterable[object]) -> Usage:
    """Return the token usage of failed requests to model servers."""
    server_attempts = [a for a in attempts if isinstance(a, Attempt)]
    return Usage(
        input_tokens=sum(a.input_tokens for a in server_attempts), output_tokens=sum(a.output_tokens for a in server_attempts)
    )


def failures_of(error: PerceptionError | PlannerError) -> dict[str, int]:
    """Return the number of failed requests that led to an error, by failure kind. An unusable reply counts as a failure."""
    events = count_failures(a for a in error.attempts if isinstance(a, Attempt))
    return events if error.kind is None or error.kind in events else {**events, str(error.kind): 1}
