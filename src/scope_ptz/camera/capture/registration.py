"""Register the frames of a capture: determine their poses, fields of view and gains from the pictures."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scope_ptz.camera.capture.adjustment import Adjustment, adjust, rotation_angle_deg
from scope_ptz.camera.capture.hidden_parts import hidden_mask
from scope_ptz.camera.capture.matching import Features, find_features, match_frames, overlapping_pairs
from scope_ptz.camera.capture.placed_frames import PlacedFrame
from scope_ptz.camera.capture.progress import Progress
from scope_ptz.camera.capture.session import CaptureSession, Shot
from scope_ptz.camera.capture.tone import cell_means, gains
from scope_ptz.geometry import Optics, Perspective
from scope_ptz.geometry.sphere import camera_axes


@dataclass(frozen=True, slots=True)
class Registration:
    """The registered frames of a capture.

    Attributes:
        shots: The frames.
        placed: Each frame with its adjusted orientation and focal length.
        gains: The gain for each frame and colour channel, ``(n, 3)``.
        registered: Whether each frame has enough matches to determine its pose; if not, the pose is based on the reported one.
        corrections_deg: Angle between the reported and the adjusted orientation of each frame.
        residual_px: Root mean square error of the matches in pixels; None if there are no matches.
        matches: Number of matches.
    """

    shots: tuple[Shot, ...]
    placed: tuple[PlacedFrame, ...]
    gains: NDArray[np.float64]
    registered: tuple[bool, ...]
    corrections_deg: tuple[float, ...]
    residual_px: float | None
    matches: int

    @property
    def focal_factors(self) -> list[tuple[float, float]]:
        """The magnification, and the ratio of measured to reported focal length, for each registered frame."""
        return [
            (shot.zoom, placed_frame.focal_px / _focal_px(shot, placed_frame.width))
            for shot, placed_frame, is_registered in zip(self.shots, self.placed, self.registered, strict=True)
            if is_registered
        ]


def register(session: CaptureSession, progress: Progress) -> Registration:
    """Register the frames of a capture.

    Args:
        session: The capture.
        progress: Called with the name of a phase, the number of finished steps, and the total number of steps.

    Raises:
        OutputError: A stored frame is missing or damaged.
    """
    shots, settings = session.shots, session.settings
    size = settings.frame_width, settings.frame_height
    views = [Perspective(shot.pan_deg, shot.tilt_deg, shot.hfov_deg, *size) for shot in shots]
    features: list[Features] = []
    cells = []
    for number, shot in enumerate(shots):
        image = session.image(shot)
        hidden = hidden_mask(settings, shot, image)
        features.append(find_features(image, hidden))
        cells.append(cell_means(image, hidden))
        progress("Features", number + 1, len(shots))
    matches = match_frames(views, features.__getitem__, lambda done, total: progress("Matches", done, total))
    adjustment = adjust(views, matches, [shot.taken_s for shot in shots])
    placed = tuple(PlacedFrame(axes, focal, *size) for axes, focal in zip(adjustment.axes, adjustment.focal_px, strict=True))
    return Registration(
        shots=shots,
        placed=placed,
        gains=gains(placed, cells, overlapping_pairs([place.upright for place in placed])),
        registered=adjustment.registered,
        corrections_deg=_corrections_deg(views, adjustment),
        residual_px=adjustment.residual_px,
        matches=adjustment.matches,
    )


def measured_optics(optics: Optics, factors: list[tuple[float, float]]) -> Optics:
    """Return the optics with the zoom table corrected by the measured focal lengths.

    Args:
        optics: The reported optics.
        factors: Pairs of a magnification and the ratio of measured to reported focal length; empty if nothing was measured.
    """
    if not factors:
        return optics
    zooms = sorted({zoom for zoom, _ in factors})
    means = [float(np.mean([factor for other, factor in factors if other == zoom])) for zoom in zooms]
    focals = [optics.focal(zoom) * float(np.interp(zoom, zooms, means)) for zoom, _ in optics.table]
    if sorted(set(focals)) != focals:
        return optics  # the measurements at neighbouring zoom levels contradict each other
    table = [
        (zoom, math.degrees(2 * math.atan(1 / focal))) for (zoom, _), focal in zip(optics.table, focals, strict=True)
    ]  # fmt: skip
    return Optics(tuple(table))


def _focal_px(shot: Shot, width: int) -> float:
    return width / 2 / math.tan(math.radians(shot.hfov_deg) / 2)


def _corrections_deg(views: list[Perspective], adjustment: Adjustment) -> tuple[float, ...]:
    return tuple(
        rotation_angle_deg(camera_axes(v.pan_deg, v.tilt_deg), axes) for v, axes in zip(views, adjustment.axes, strict=True)
    )
