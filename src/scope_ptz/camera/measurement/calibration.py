"""Calibrate a camera from its own pictures: pan and tilt signs and scales, fields of view, latency and settling times."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from time import monotonic
from typing import TYPE_CHECKING

from anyio import to_thread

from scope_ptz.camera.measurement import registration
from scope_ptz.camera.measurement.calibration_plan import (
    LARGE_TURN,
    PAN_OFFSETS_DEG,
    SMALL_TURN,
    TIMED_TURN_DEG,
    base_pose,
    vertical_turn_deg,
    zoom_levels,
)
from scope_ptz.camera.measurement.registration import Matches, RegistrationError
from scope_ptz.camera.network.settling import moving_fraction
from scope_ptz.errors import CameraError
from scope_ptz.geometry import Pose, wrap_pan_deg

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.camera.base import Camera

ANGLE_TOLERANCE, FIELD_TOLERANCE = 0.03, 0.05
"""Maximum relative differences between measured and reported values, for turns and for fields of view.

A larger difference is reported as a contradiction.
"""

TILT_ZERO_TOLERANCE_DEG = 3.0
"""Maximum difference in degrees between the horizon in the pictures and a reported tilt of 0."""

_TIMED_PICTURES, _TIMED_MOVES = 5, 3  # number of pictures and of moves to time

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class AxisResponse:
    """An axis's response to a commanded turn, as seen in the pictures.

    Attributes:
        scale: Actual degrees per reported degree; negative if the camera turns in the opposite direction.
        inverted: Whether the camera turns in the opposite direction.
    """

    scale: float

    @property
    def inverted(self) -> bool:
        return self.scale < 0


@dataclass(frozen=True, slots=True)
class FieldOfView:
    """The field of view at a zoom level.

    Attributes:
        zoom: Reported magnification.
        position: Position in the zoom range, from 0 (widest) to 1 (closest).
        stated_deg: Horizontal field of view in degrees according to the camera's own table.
        measured_deg: Horizontal field of view in degrees measured from the pictures.
    """

    zoom: float
    position: float
    stated_deg: float
    measured_deg: float


@dataclass(frozen=True, slots=True)
class Calibration:
    """The results of a calibration.

    Attributes:
        pan: Response of the pan axis.
        tilt: Response of the tilt axis.
        tilt_offset_deg: The actual tilt in degrees at a reported tilt of 0.
        fields: Fields of view, widest first.
        snapshot_s: Median seconds to take a picture.
        move_s: Median seconds from the start of a 20-degree move until the driver reports arrival.
        settling_s: Median seconds from the reported arrival until the picture has settled.
        residual_px: Mean registration error in pixels.
        contradictions: Descriptions of reported values that the pictures contradict.
    """

    pan: AxisResponse
    tilt: AxisResponse
    tilt_offset_deg: float
    fields: tuple[FieldOfView, ...]
    snapshot_s: float
    move_s: float
    settling_s: float
    residual_px: float
    contradictions: tuple[str, ...] = field(default=())


async def calibrate(
    camera: Camera, *, zooms: int = 6, assumed: tuple[str, ...] = (), progress: Progress = lambda _: None
) -> Calibration:
    """Calibrate a camera, and return it to its initial pose.

    Moving objects do not affect the results as long as most of the picture is static. A simulated scene is paused while angles are
    measured.

    Args:
        camera: The camera. Nobody else may move it.
        zooms: Number of zoom levels at which the field of view is measured.
        assumed: Values that the driver only assumes: "pan range", "tilt range" or "field of view". Measurements replace them, so
            differences are not reported as contradictions.
        progress: Called with a description of each step.

    Raises:
        RegistrationError: No direction shows enough detail.
        CameraError: The camera failed.
    """
    start = await camera.pose()
    try:
        return await _calibrate(camera, start, zooms, assumed, progress)
    finally:
        with suppress(CameraError):
            await camera.move(start)


async def _calibrate(camera: Camera, start: Pose, zooms: int, assumed: tuple[str, ...], progress: Progress) -> Calibration:
    snapshot_s = await _measure_snapshot_s(camera)
    failure = RegistrationError("The camera has no room to turn.")
    for offset_deg in PAN_OFFSETS_DEG:
        base = base_pose(camera.info.limits, start, offset_deg)
        progress(f"Looking for detail at pan {base.pan_deg:.0f}.")
        try:
            with camera.hold_time():
                response = await _measure_response(camera, base, progress)
                fields = await _measure_fields(camera, base, response, zooms, progress)
        except RegistrationError as error:
            failure = error
            continue
        progress("Timing moves.")
        move_s, settling_s = await _measure_settling(camera, base)
        pan, tilt = AxisResponse(response.pan), AxisResponse(response.tilt)
        contradictions = _find_contradictions(pan, tilt, response.tilt_offset_deg, fields, assumed)
        return Calibration(
            pan, tilt, response.tilt_offset_deg, fields, snapshot_s, move_s, settling_s, response.residual_px, contradictions
        )
    raise failure


@dataclass(frozen=True, slots=True)
class _Response:
    """The pan and tilt scales (as in ``AxisResponse``), the tilt offset, and the focal length at the widest zoom."""

    pan: float
    tilt: float
    tilt_offset_deg: float
    focal_px: float
    residual_px: float


async def _measure_response(camera: Camera, base: Pose, progress: Progress) -> _Response:
    """Measure the actual turn per reported degree at the widest zoom. The focal length is computed from the pictures alone."""
    stated_deg = camera.info.optics.hfov_deg(base.zoom)
    centre, reported = await _move_and_take(camera, base)
    focal = registration.focal_px(stated_deg, centre.shape[1])
    approximate_scales = []
    for pan_deg, tilt_deg in (
        (SMALL_TURN * stated_deg, 0.0),
        (0.0, vertical_turn_deg(camera.info.limits, base, SMALL_TURN * stated_deg / 2)),
    ):
        pair, turned = await _turn_and_match(camera, base, centre, reported, pan_deg, tilt_deg)
        turn_result = registration.rotation(pair, focal)
        approximate_scales.append(turn_result.angle_deg / (abs(turned) or 1.0))
    # Choose the large turns so that the pictures overlap well, however far the camera actually turns per commanded degree.
    pan_deg = min(LARGE_TURN * stated_deg / max(approximate_scales[0], 0.05), 3 * LARGE_TURN * stated_deg)
    tilt_deg = vertical_turn_deg(
        camera.info.limits, base, min(LARGE_TURN * stated_deg * 0.5 / max(approximate_scales[1], 0.05), 60.0)
    )
    pairs = [
        await _turn_and_match(camera, base, centre, reported, *turn) for turn in ((pan_deg, 0.0), (-pan_deg, 0.0), (0.0, tilt_deg))
    ]
    focal = await to_thread.run_sync(registration.focal_from, [pair for pair, _ in pairs])
    right, left, up = (registration.rotation(pair, focal) for pair, _ in pairs)
    pan = statistics.mean(math.copysign(turn.angle_deg, turn.right_deg) / pairs[k][1] for k, turn in enumerate((right, left)))
    tilt = math.copysign(up.angle_deg, up.up_deg) / pairs[2][1]
    # If the camera is tilted up or down, panning also rolls the picture. The ratio of roll to turn gives the actual tilt.
    actual_tilt_deg = math.degrees(math.atan2(right.roll_deg - left.roll_deg, right.right_deg - left.right_deg))
    if pan <= 0:
        actual_tilt_deg = math.degrees(math.atan2(left.roll_deg - right.roll_deg, left.right_deg - right.right_deg))
    progress(f"The camera pans {pan:+.3f} degrees and tilts {tilt:+.3f} degrees per reported degree.")
    residual = statistics.mean(turn.residual_px for turn in (right, left, up))
    return _Response(pan, tilt, actual_tilt_deg - tilt * reported.tilt_deg, focal, residual)


async def _measure_fields(
    camera: Camera, base: Pose, response: _Response, zooms: int, progress: Progress
) -> tuple[FieldOfView, ...]:
    """Measure the field of view at zoom levels from the widest to the closest by turning through known angles."""
    limits, optics = camera.info.limits, camera.info.optics
    width = camera.info.frame_width
    fields = [FieldOfView(limits.min_zoom, 0.0, optics.hfov_deg(limits.min_zoom), registration.hfov_deg(response.focal_px, width))]
    correction = fields[0].measured_deg / fields[0].stated_deg
    for zoom in zoom_levels(limits, zooms)[1:]:
        stated_deg = optics.hfov_deg(zoom)
        expected_deg = min(stated_deg * correction, fields[-1].measured_deg)
        pose = Pose(base.pan_deg, base.tilt_deg, zoom)
        for fraction in (0.25, 0.06):  # the second, smaller turn is for very inaccurate zoom tables
            try:
                centre, reported = await _move_and_take(camera, pose)
                pair, turned = await _turn_and_match(
                    camera, pose, centre, reported, fraction * expected_deg / abs(response.pan), 0.0
                )
                focal = registration.focal_for_angle(pair, turned * response.pan)
                break
            except RegistrationError:
                if fraction < 0.1:
                    raise
        measured_deg = registration.hfov_deg(focal, width)
        correction = measured_deg / stated_deg
        fields.append(FieldOfView(zoom, (zoom - limits.min_zoom) / (limits.max_zoom - limits.min_zoom), stated_deg, measured_deg))
        progress(f"At {zoom:.2f}x the picture is {measured_deg:.2f} degrees wide; the camera reports {stated_deg:.2f}.")
    return tuple(fields)


async def _measure_snapshot_s(camera: Camera) -> float:
    times = []
    for _ in range(_TIMED_PICTURES):
        started_s = monotonic()
        await camera.frame()
        times.append(monotonic() - started_s)
    return statistics.median(times)


async def _measure_settling(camera: Camera, base: Pose) -> tuple[float, float]:
    """Return the median seconds for a move, and the median seconds from the reported arrival until the picture has settled."""
    move_times_s, settling_times_s = [], []
    for run in range(_TIMED_MOVES):
        started_s = camera.clock.now_s()
        await camera.move(Pose(base.pan_deg + (TIMED_TURN_DEG if run % 2 == 0 else 0.0), base.tilt_deg, base.zoom))
        arrived_s = camera.clock.now_s()
        move_times_s.append(arrived_s - started_s)
        last_motion_s, before = arrived_s, (await camera.frame()).image
        for _ in range(20):
            frame = await camera.frame()
            fraction = moving_fraction(before, frame.image)
            if fraction is None or fraction < 0.5:
                break
            last_motion_s, before = camera.clock.now_s(), frame.image
        settling_times_s.append(last_motion_s - arrived_s)
    return statistics.median(move_times_s), statistics.median(settling_times_s)


async def _move_and_take(camera: Camera, pose: Pose) -> tuple[NDArray[np.uint8], Pose]:
    """Move, take a picture, and return it with the reported pose."""
    arrival = await camera.move(pose)
    return (await camera.frame()).image, arrival.pose


async def _turn_and_match(
    camera: Camera, base: Pose, centre: NDArray[np.uint8], reported: Pose, pan_deg: float, tilt_deg: float
) -> tuple[Matches, float]:
    """Turn from the base pose along one axis. Return the matches with the picture at the base, and the reported turn in degrees."""
    image, reached = await _move_and_take(camera, Pose(base.pan_deg + pan_deg, base.tilt_deg + tilt_deg, base.zoom))
    turned = wrap_pan_deg(reached.pan_deg - reported.pan_deg) if pan_deg else reached.tilt_deg - reported.tilt_deg
    if abs(turned) < 0.2 * abs(pan_deg or tilt_deg):
        raise CameraError(f"{camera.info.name} was commanded to turn but reports that it did not. Its motor may be blocked.")
    return await to_thread.run_sync(registration.match, centre, image), turned


def _find_contradictions(
    pan: AxisResponse, tilt: AxisResponse, tilt_offset_deg: float, fields: tuple[FieldOfView, ...], assumed: tuple[str, ...]
) -> tuple[str, ...]:
    sentences = []
    for name, words, response in (("pan", ("right", "left"), pan), ("tilt", ("up", "down"), tilt)):
        if response.inverted:
            sentences.append(
                f"{name.capitalize()} is inverted: the camera was commanded to turn {words[0]}, but the view turned {words[1]}. "
                f"Correct the direction in the camera's settings, and check whether the camera is mounted upside down."
            )
        elif f"{name} range" not in assumed and abs(response.scale - 1) > ANGLE_TOLERANCE:
            sentences.append(f"The camera {name}s {response.scale:.3f} degrees for each degree that it reports.")
    if "tilt range" not in assumed and not tilt.inverted and abs(tilt_offset_deg) > TILT_ZERO_TOLERANCE_DEG:
        sentences.append(
            f"When the camera reports a tilt of 0, it points {tilt_offset_deg:+.1f} degrees from the horizon. "
            "Level the camera or its mount."
        )
    if "field of view" not in assumed:
        worst = max(fields, key=lambda field_of_view: abs(field_of_view.measured_deg / field_of_view.stated_deg - 1))
        if abs(worst.measured_deg / worst.stated_deg - 1) > FIELD_TOLERANCE:
            sentences.append(
                f"The zoom table is wrong: at {worst.zoom:.2f}x the picture is {worst.measured_deg:.1f} degrees wide, "
                f"but the camera reports {worst.stated_deg:.1f}."
            )
    return tuple(sentences)
