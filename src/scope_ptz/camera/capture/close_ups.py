"""Choose poses for close-ups where the wide pictures show fine detail, such as signs and small distant objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.base import CameraInfo
from scope_ptz.camera.capture.hidden_parts import hidden_mask
from scope_ptz.camera.capture.session import CaptureSession
from scope_ptz.geometry import Perspective, Pose

CELL_DEG = 1.0
"""Size in degrees of the cells in which detail is measured."""

STRONG_EDGE = 24.0
"""Minimum local contrast of detail, on a scale of 0 to 255. Noise and fine texture have less contrast."""

HORIZON_DEG, FALLOFF_DEG = -4.0, 22.0
"""Centre and width of the bell curve by which detail is weighted, in degrees of tilt.

It favours directions near the horizon, where objects are distant and look small.
"""

Floats = NDArray[np.float64]


def choose_close_ups(session: CaptureSession, info: CameraInfo, candidates: Sequence[Pose], limit: int) -> list[Pose]:
    """Return the candidates that show the most detail, at most ``limit`` of them, in their original order.

    Args:
        session: The capture, with its wide frames.
        info: The camera.
        candidates: Possible close-up poses.
        limit: Maximum number of poses.
    """
    detail = _detail_map(session)
    scores = [_detail_in(detail, replace(_view(info, pose), width=64, height=36)) for pose in candidates]
    best = sorted(range(len(scores)), key=lambda k: (-scores[k], k))[:limit]
    return [candidates[k] for k in sorted(best) if scores[k] > 0]


def _view(info: CameraInfo, pose: Pose) -> Perspective:
    return Perspective(pose.pan_deg, pose.tilt_deg, info.optics.hfov_deg(pose.zoom), info.frame_width, info.frame_height)


def _detail_map(session: CaptureSession) -> NDArray[np.float32]:
    """Return the weighted fraction of strong, fine edges in each one-degree cell.

    The shape is (180, 360). Rows start at the zenith, and columns at pan -180.
    """
    sums, counts = np.zeros((180, 360)), np.zeros((180, 360))
    widest = max((shot.hfov_deg for shot in session.shots), default=0.0)
    for shot in session.shots:
        if shot.hfov_deg < 0.9 * widest:
            continue
        grey = cv2.cvtColor(session.image(shot), cv2.COLOR_RGB2GRAY).astype(np.float32)
        fine = np.abs(grey - cv2.GaussianBlur(grey, (0, 0), 2.0))
        height, width = grey.shape
        hidden = hidden_mask(session.settings, shot, session.image(shot))
        if hidden is not None:
            fine[hidden] = 0.0
        cells = max(8, round(width / shot.hfov_deg / CELL_DEG))
        small = cv2.resize(
            (fine > STRONG_EDGE).astype(np.float32), (2 * width // cells, 2 * height // cells), interpolation=cv2.INTER_AREA
        )
        view = Perspective(shot.pan_deg, shot.tilt_deg, shot.hfov_deg, width, height)
        xs, ys = ((np.arange(n) + 0.5) / n for n in small.shape[::-1])
        rays = view.directions(np.stack(np.meshgrid(xs, ys), axis=-1))
        rows, columns = _cell_indices(rays)
        np.add.at(sums, (rows, columns), small)
        np.add.at(counts, (rows, columns), 1.0)
    tilts = 89.5 - np.arange(180)
    horizon_weights = np.exp(-(((tilts - HORIZON_DEG) / FALLOFF_DEG) ** 2))
    return np.asarray(sums / np.maximum(counts, 1.0) * horizon_weights[:, None], np.float32)


def _detail_in(detail: NDArray[np.float32], view: Perspective) -> float:
    """Return the mean detail in a view."""
    xs, ys = ((np.arange(n) + 0.5) / n for n in (16, 9))
    rows, columns = _cell_indices(view.directions(np.stack(np.meshgrid(xs, ys), axis=-1)))
    return float(detail[rows, columns].mean())


def _cell_indices(rays: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the row and column indices of the cells that contain the given directions."""
    pan = np.degrees(np.arctan2(rays[..., 0], rays[..., 1]))
    tilt = np.degrees(np.arcsin(np.clip(rays[..., 2], -1.0, 1.0)))
    return np.clip((90.0 - tilt).astype(np.int64), 0, 179), (pan + 180.0).astype(np.int64) % 360
