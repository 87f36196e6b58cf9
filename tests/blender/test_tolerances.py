"""Tolerances of a comparison: each is reported if it is exceeded, and only then."""

from __future__ import annotations

from dataclasses import replace

import pytest

from scope_ptz.blender.tolerances import missed_tolerances
from scope_ptz.blender.verify import PoseReport
from scope_ptz.geometry import Pose

WIDE = PoseReport("mast", Pose(10.0, -5.0, 1.0), ssim=0.95, sharpness_ratio=0.4, box_iou=0.98, tile_share=0.2)
TELE = PoseReport("mast", Pose(10.0, -5.0, 4.0), ssim=0.92, sharpness_ratio=0.7, box_iou=0.94, tile_share=0.6)


def test_packs_within_all_tolerances_have_no_shortcomings() -> None:
    assert missed_tolerances([WIDE, TELE, replace(WIDE, box_iou=None)]) == []


@pytest.mark.parametrize(
    ("report", "words"),
    [
        (replace(WIDE, ssim=0.87), "SSIM 0.870, 0.88 is required"),
        (replace(WIDE, ssim=0.90), "mean SSIM at 1x is 0.900"),
        (replace(WIDE, box_iou=0.96), "mean box IoU at 1x is 0.960"),
        (replace(TELE, ssim=0.89), "SSIM 0.890, 0.9 is required in tiles"),
        (replace(TELE, sharpness_ratio=0.5), "0.50 of the live sharpness"),
        (replace(TELE, box_iou=0.9), "mean box IoU at 2x to 5x is 0.900"),
    ],
)
def test_every_tolerance_is_enforced(report: PoseReport, words: str) -> None:
    assert words in " / ".join(missed_tolerances([report]))


def test_zoomed_views_outside_tiles_are_not_compared() -> None:
    assert missed_tolerances([replace(TELE, tile_share=0.0, ssim=0.5, sharpness_ratio=0.1)]) == []
