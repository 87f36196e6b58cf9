"""Sweep the camera: take frames of the full scene at the widest zoom, and stitch them into a panorama.

A PTZ camera rotates about its optical centre, so overlapping frames differ only by a re-projection. Each block of the panorama
is copied from the frame whose centre is nearest. Frames are not blended, so that no object appears twice.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from anyio import to_thread
from numpy.typing import NDArray

from scope_ptz.camera.base import Camera, CameraInfo, Frame
from scope_ptz.errors import CameraError
from scope_ptz.geometry import Equirectangular, Limits, Perspective, Pose, wrap_pan_deg

_GRID_PX = 8  # spacing of the grid on which the projection is computed exactly; interpolation errors are below 0.02 px


@dataclass(frozen=True, slots=True)
class Block:
    """A rectangle of the panorama in degrees, and the pose of the frame that fills it."""

    pose: Pose
    left_pan_deg: float
    right_pan_deg: float
    top_tilt_deg: float
    bottom_tilt_deg: float


def plan_sweep(info: CameraInfo) -> list[Block]:
    """Return the blocks of a sweep over all directions in the camera's range, row by row from the top, left to right."""
    limits, hfov = info.limits, info.optics.hfov_deg(info.limits.min_zoom)
    half_height = math.tan(math.radians(hfov) / 2) * info.frame_height / info.frame_width
    columns = math.ceil(_pan_span_deg(limits) / (hfov * 0.85))
    step = _pan_span_deg(limits) / columns
    # Frames cover less height towards their sides, so use half the height at a column's edge, minus 1 degree for tilted frames.
    half_height_at_edge = math.degrees(math.atan(half_height * math.cos(math.radians(step / 2)))) - 1.0
    top = min(limits.max_tilt_deg + half_height_at_edge, 30.0)
    low, high = limits.min_tilt_deg, min(limits.max_tilt_deg, top - half_height_at_edge)
    rows = max(1, math.ceil((high - low) / (2 * half_height_at_edge - 3.0)) + 1)
    tilts = [high - (high - low) * k / (rows - 1) for k in range(rows)] if rows > 1 else [high]
    first = limits.min_pan_deg if not limits.pan_endless else -180.0
    blocks = []
    for row, tilt in enumerate(tilts):
        upper = top if row == 0 else (tilts[row - 1] + tilt) / 2
        lower = max(tilt - half_height_at_edge + 1.0, -88.0) if row == rows - 1 else (tilt + tilts[row + 1]) / 2
        for column in range(columns):
            left = first + column * step
            blocks.append(Block(Pose(left + step / 2, tilt, limits.min_zoom), left, left + step, upper, lower))
    return blocks


def _pan_span_deg(limits: Limits) -> float:
    span = limits.max_pan_deg - limits.min_pan_deg
    # With stops at +-179 degrees, for example, the frames also cover the two degrees between the stops.
    return 360.0 if limits.pan_endless or span >= 340.0 else span


async def sweep(camera: Camera) -> Frame:
    """Take the frames of a sweep at one instant of scene time, and stitch them. The camera always returns to its initial pose.

    In a dry run, the moves are reported, and the result is a frame of the initial view.
    """
    start = await camera.pose()
    blocks = plan_sweep(camera.info)
    frames: list[Frame] = []
    with camera.hold_time():
        try:
            for block in blocks:
                arrival = await camera.move(block.pose)
                if arrival.clamped and not arrival.limited_by:
                    raise CameraError(
                        f"The camera cannot reach a pose of the sweep: {block.pose} was requested; it stopped at {arrival.pose}."
                    )
                if not (frames and camera.info.dry_run):
                    frames.append(await camera.frame())
        finally:
            await camera.move(start)
    return frames[0] if camera.info.dry_run else await to_thread.run_sync(stitch, blocks, frames, start)


def stitch(blocks: list[Block], frames: list[Frame], pose: Pose) -> Frame:
    """Stitch the frames of a sweep into an equirectangular frame, at the pixel density in the centre of the frames."""
    first = frames[0]
    if any((f.width, f.height) != (first.width, first.height) for f in frames):
        raise CameraError("The camera changed its picture size during the sweep.")
    density = Perspective(0, 0, first.hfov_deg, first.width, first.height).focal_px * math.pi / 180
    left, top = blocks[0].left_pan_deg, blocks[0].top_tilt_deg
    span = max(b.right_pan_deg for b in blocks) - left
    bottom = min(b.bottom_tilt_deg for b in blocks)
    width, height = round(span * density), round((top - bottom) * density)
    projection = Equirectangular(left, span, top, bottom, width, height)
    if all(frame.image.strides == (0, 0, 0) and frame.image[0, 0, 0] == first.image[0, 0, 0] for frame in frames):
        # Rendering is off: each image repeats a single value, and so does the panorama, which saves memory and time.
        return Frame(np.broadcast_to(first.image[:1, :1], (height, width, 3)), pose, span, first.time_s, projection, first.origin)
    panorama = np.empty((height, width, 3), np.uint8)
    for block, frame in zip(blocks, frames, strict=True):
        x0, x1 = (round((p - left) / span * width) for p in (block.left_pan_deg, block.right_pan_deg))
        y0, y1 = (round((top - t) / (top - bottom) * height) for t in (block.top_tilt_deg, block.bottom_tilt_deg))
        if not isinstance(frame.projection, Perspective):
            raise CameraError("A sweep supports only perspective frames.")
        map_x, map_y = _block_maps(projection, frame.projection, x0, y0, x1, y1)
        # A site's rules may prevent the camera from aiming at a block. Pixels that its frame does not cover stay black.
        border = cv2.BORDER_REPLICATE if _aims_at(frame, block) else cv2.BORDER_CONSTANT
        panorama[y0:y1, x0:x1] = cv2.remap(frame.image, map_x, map_y, cv2.INTER_LINEAR, borderMode=border)
    return Frame(panorama, pose, span, first.time_s, projection, first.origin)


def _aims_at(frame: Frame, block: Block) -> bool:
    return abs(wrap_pan_deg(frame.pose.pan_deg - block.pose.pan_deg)) < 2.0 and abs(frame.pose.tilt_deg - block.pose.tilt_deg) < 2.0


@lru_cache(maxsize=64)
def _block_maps(
    panorama: Equirectangular, view: Perspective, x0: int, y0: int, x1: int, y1: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the source coordinates for each pixel in a block of the panorama, interpolated from a coarse grid."""
    columns, rows = (x1 - x0) // _GRID_PX + 2, (y1 - y0) // _GRID_PX + 2
    xs = (x0 + 0.5 + np.arange(columns) * _GRID_PX) / panorama.width
    ys = (y0 + 0.5 + np.arange(rows) * _GRID_PX) / panorama.height
    points = view.points(panorama.directions(np.stack(np.meshgrid(xs, ys), axis=-1)))
    coarse = (points * [view.width, view.height] - 0.5).astype(np.float32)
    grid_x, grid_y = np.meshgrid(np.arange(x1 - x0, dtype=np.float32) / _GRID_PX, np.arange(y1 - y0, dtype=np.float32) / _GRID_PX)
    interpolated = cv2.remap(coarse, grid_x, grid_y, cv2.INTER_LINEAR)
    return np.ascontiguousarray(interpolated[..., 0]), np.ascontiguousarray(interpolated[..., 1])
