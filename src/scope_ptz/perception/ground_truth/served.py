"""Ground truth for frames that a virtual camera sent over the network. It works only in simulation.

A virtual camera that is served with ``--truth`` reports the pose and time of its pictures to programs on the same machine. Network
camera drivers can thus be tested without a vision model's errors.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from time import perf_counter, time
from typing import Protocol, TypeVar

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from scope_ptz.builtin_names import SERVED_TRUTH
from scope_ptz.camera.base import Frame, FrameOrigin
from scope_ptz.camera.clocks import Clock
from scope_ptz.camera.network.errors import CameraReplyError
from scope_ptz.camera.network.http import DeviceHttp
from scope_ptz.errors import CameraError, InputError, PerceptionError
from scope_ptz.geometry import Perspective, Pose, wrap_pan_deg
from scope_ptz.perception.base import Answer, Caption, Detections, Points
from scope_ptz.perception.ground_truth.backend import GroundTruthPerception, TruthReader
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import view_truth

_Reply = TypeVar("_Reply", Caption, Answer, Detections, Points)

TRUTH_PATH = "/virtual/truth"
MAX_TIME_ERROR_S = 1.0
"""Maximum error of the exposure time that a driver reports, in seconds. The error is usually some tens of milliseconds."""

MAX_TURN_DEG, MAX_ZOOM_DIFFERENCE = 2.0, 0.1
"""Maximum angle difference (degrees) and relative zoom difference between a frame's pose and the pose at its exposure."""


class ServedPose(BaseModel):
    """A pose in a virtual camera's reply."""

    model_config = ConfigDict(frozen=True)

    pan_deg: FiniteFloat
    tilt_deg: FiniteFloat
    zoom: FiniteFloat = Field(gt=0)


class ServedOrigin(BaseModel):
    """A virtual camera's reply, which states the origin of a picture.

    Attributes:
        scene: Name of the scene or variation.
        viewpoint: Name of the viewpoint.
        pose: The pose that the camera's encoders reported at the exposure.
        hfov_deg: Horizontal field of view in degrees.
        time_s: Scene time of the exposure.
    """

    model_config = ConfigDict(frozen=True)

    scene: str = Field(max_length=200)
    viewpoint: str = Field(max_length=200)
    pose: ServedPose
    hfov_deg: float = Field(gt=0, lt=180)
    time_s: FiniteFloat


class TruthSource(Protocol):
    """A source that supplies origins for frames that have none."""

    async def origin(self, frame: Frame) -> ServedOrigin:
        """Return a frame's origin, or raise ``PerceptionError``."""
        ...

    async def close(self) -> None:
        """Release the source's resources."""
        ...


class ServedTruth:
    """A source that requests frame origins from a virtual camera on this machine.

    Args:
        http: The connection to the camera, which is closed with this object.
        clock: The driver's clock, to which frame times refer. It follows the wall clock.

    Raises:
        InputError: The camera is not on this machine.
    """

    def __init__(self, http: DeviceHttp, clock: Clock) -> None:
        if not http.address.is_loopback:
            raise InputError(
                f"'{SERVED_TRUTH}' works only with virtual cameras on this machine, and {http.address} is not on this machine. "
                "Choose a vision model with --perception."
            )
        self._http, self._clock = http, clock

    async def origin(self, frame: Frame) -> ServedOrigin:
        """Return a frame's origin.

        Raises:
            PerceptionError: The camera offers no ground truth, or has stored no exposure at that time and pose.
        """
        taken_s = time() - self._clock.now_s() + frame.time_s
        query = {"taken": repr(taken_s), "within": f"{MAX_TIME_ERROR_S:g}"}
        try:
            reply = await self._http.get(TRUTH_PATH, query, accept=(403, 404))
        except CameraReplyError:
            raise _not_offered_error(self._http) from None
        except CameraError as error:
            raise PerceptionError(f"The ground truth cannot be read: {error}") from error
        if reply.status != 200:
            if reply.content_type == "application/json":
                raise PerceptionError("The virtual camera has not stored a frame of that time. Take a new picture.")
            raise _not_offered_error(self._http)
        try:
            origin = ServedOrigin.model_validate_json(reply.body)
        except ValidationError:
            raise _not_offered_error(self._http) from None
        if isinstance(frame.projection, Perspective) and not _is_close(frame.pose, origin.pose):
            raise PerceptionError(
                f"The served frame nearest to this one in time was taken at pan {origin.pose.pan_deg:.1f}, tilt "
                f"{origin.pose.tilt_deg:.1f}, zoom {origin.pose.zoom:.2f}x, which is not the pose that the driver reports. Check "
                "that no other program moves the camera."
            )
        return origin

    async def close(self) -> None:
        """Close the connection."""
        await self._http.close()


class ServedTruthPerception(GroundTruthPerception):
    """Ground-truth perception for frames from a virtual camera on the network. Simulation only: real cameras have no ground truth.

    It uses the pose and field of view at the exposure, even if the driver assumes different values. For a panorama, it uses the
    whole sphere at the time of the first frame.

    Args:
        source: The source of the frames' origins.
        open_scene: A function that returns a scene by name.
        read_truth: A function that computes the ground truth of a view.
    """

    name = SERVED_TRUTH

    def __init__(
        self, source: TruthSource, open_scene: Callable[[str], Scene], read_truth: TruthReader = view_truth
    ) -> None:  # fmt: skip
        super().__init__(open_scene, read_truth)
        self._source = source

    async def caption(self, frame: Frame) -> Caption:
        began = perf_counter()
        return _add_total_latency(began, await super().caption(await self._add_origin(frame)))

    async def query(self, frame: Frame, question: str) -> Answer:
        began = perf_counter()
        return _add_total_latency(began, await super().query(await self._add_origin(frame), question))

    async def detect(self, frame: Frame, description: str) -> Detections:
        began = perf_counter()
        return _add_total_latency(began, await super().detect(await self._add_origin(frame), description))

    async def point(self, frame: Frame, description: str) -> Points:
        began = perf_counter()
        return _add_total_latency(began, await super().point(await self._add_origin(frame), description))

    async def close(self) -> None:
        await self._source.close()

    async def _add_origin(self, frame: Frame) -> Frame:
        origin = await self._source.origin(frame)
        pose = Pose(origin.pose.pan_deg, origin.pose.tilt_deg, origin.pose.zoom)
        projection = frame.projection
        if isinstance(projection, Perspective):
            projection = Perspective(pose.pan_deg, pose.tilt_deg, origin.hfov_deg, frame.width, frame.height)
        return replace(frame, projection=projection, origin=FrameOrigin(origin.scene, origin.viewpoint, pose, origin.time_s))


def _add_total_latency(began: float, reply: _Reply) -> _Reply:
    """Return a reply whose latency includes the request for the ground truth."""
    return reply.model_copy(update={"latency_s": perf_counter() - began})


def _is_close(pose: Pose, other: ServedPose) -> bool:
    return (
        abs(wrap_pan_deg(pose.pan_deg - other.pan_deg)) <= MAX_TURN_DEG
        and abs(pose.tilt_deg - other.tilt_deg) <= MAX_TURN_DEG
        and abs(pose.zoom / other.zoom - 1) <= MAX_ZOOM_DIFFERENCE
    )


def _not_offered_error(http: DeviceHttp) -> PerceptionError:
    return PerceptionError(
        f"The camera at {http.address} offers no ground truth. '{SERVED_TRUTH}' works only with virtual cameras. Start one with "
        "`scope camera serve --truth`, or choose a vision model with --perception."
    )
