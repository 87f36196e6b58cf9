"""Tolerances for comparing a pack with live renders."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import mean

from scope_ptz.blender.verify import PoseReport

WIDE_SSIM_MEAN, WIDE_SSIM_MIN = 0.93, 0.88
"""Minimum similarity of whole views at the widest zoom: on average, and for each view."""

TILE_SSIM_MIN, TILE_SHARPNESS_MIN = 0.90, 0.60
"""Minimum similarity and sharpness of zoomed-in views, in the part that tiles cover."""

WIDE_IOU_MEAN, TELE_IOU_MEAN = 0.97, 0.93
"""Minimum mean box IoU for instances with more than 400 pixels, at the widest zoom and zoomed in."""


def missed_tolerances(reports: Sequence[PoseReport]) -> list[str]:
    """Return a sentence for each tolerance that is not met."""
    wide = [r for r in reports if r.pose.zoom == 1.0]
    tiled = [r for r in reports if r.pose.zoom > 1.0 and r.tile_share > 0]
    shortfalls = []
    if wide and (average := mean(r.ssim for r in wide)) < WIDE_SSIM_MEAN:
        shortfalls.append(f"mean SSIM at 1x is {average:.3f}, {WIDE_SSIM_MEAN:g} is required")
    shortfalls += [f"{_describe_view(r)}: SSIM {r.ssim:.3f}, {WIDE_SSIM_MIN:g} is required" for r in wide if r.ssim < WIDE_SSIM_MIN]
    shortfalls += [
        f"{_describe_view(r)}: SSIM {r.ssim:.3f}, {TILE_SSIM_MIN:g} is required in tiles" for r in tiled if r.ssim < TILE_SSIM_MIN
    ]
    shortfalls += [
        f"{_describe_view(r)}: {r.sharpness_ratio:.2f} of the live sharpness, {TILE_SHARPNESS_MIN:g} is required in tiles"
        for r in tiled
        if r.sharpness_ratio < TILE_SHARPNESS_MIN
    ]
    for name, group, required in (("1x", wide, WIDE_IOU_MEAN), ("2x to 5x", tiled, TELE_IOU_MEAN)):
        ious = [r.box_iou for r in group if r.box_iou is not None]
        if ious and mean(ious) < required:
            shortfalls.append(f"mean box IoU at {name} is {mean(ious):.3f}, {required:g} is required")
    return shortfalls


def _describe_view(report: PoseReport) -> str:
    pose = report.pose
    return f"{report.viewpoint} at pan {pose.pan_deg:.1f}, tilt {pose.tilt_deg:.1f}, {pose.zoom:.2f}x"
