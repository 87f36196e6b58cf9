"""The frozen packs against live Cycles renders of the same poses, kept as files: no Blender is needed to check them."""

from __future__ import annotations

from pathlib import Path
from statistics import mean

import pytest

from scope_ptz.blender.references import references
from scope_ptz.blender.verify import PoseReport, compare
from scope_ptz.world.pack import list_scenes, load_scene

FOLDER = Path(__file__).parent.parent / "data" / "references"


@pytest.fixture(scope="module", params=list_scenes())
def reports(request: pytest.FixtureRequest) -> list[PoseReport]:
    scene = load_scene(request.param)
    return [compare(scene, *reference) for reference in references(FOLDER / scene.name)]


def test_the_wide_end_looks_as_rendered(reports: list[PoseReport]) -> None:
    wide = [r.ssim for r in reports if r.pose.zoom == 1.0]
    assert len(wide) >= 4
    assert mean(wide) >= 0.93
    assert min(wide) >= 0.88


def test_tiles_are_sharp(reports: list[PoseReport]) -> None:
    zoomed = [r for r in reports if r.pose.zoom > 1.0]
    assert len(zoomed) >= 4
    for report in zoomed:
        assert report.ssim >= 0.90, report
        assert report.sharpness_ratio >= 0.6, report


def test_boxes_agree_with_the_rendered_instance_pass(reports: list[PoseReport]) -> None:
    wide = [r.box_iou for r in reports if r.pose.zoom == 1.0 and r.box_iou is not None]
    zoomed = [r.box_iou for r in reports if r.pose.zoom > 1.0 and r.box_iou is not None]
    assert mean(wide) >= 0.97
    assert mean(zoomed) >= 0.93


@pytest.mark.parametrize("name", list_scenes())
def test_every_viewpoint_is_compared(name: str) -> None:
    compared = {viewpoint for viewpoint, *_ in references(FOLDER / name)}
    assert compared == {v.name for v in load_scene(name).file.viewpoints}
