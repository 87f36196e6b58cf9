"""The shipped packs match stored Cycles renders of the same poses. Blender is not needed."""

from __future__ import annotations

from pathlib import Path

import pytest

from scope_ptz.blender.references import references
from scope_ptz.blender.tolerances import missed_tolerances
from scope_ptz.blender.verify import PoseReport, compare
from scope_ptz.simulator.pack import list_scenes, load_scene

FOLDER = Path(__file__).parent.parent / "data" / "references"


@pytest.fixture(scope="module", params=[pytest.param(name, marks=pytest.mark.full) for name in list_scenes()])
def reports(request: pytest.FixtureRequest) -> list[PoseReport]:
    scene = load_scene(request.param)
    return [compare(scene, *reference) for reference in references(FOLDER / scene.name)]


def test_the_packs_match_the_renders(reports: list[PoseReport]) -> None:
    assert sum(r.pose.zoom == 1.0 for r in reports) >= 4
    assert sum(r.pose.zoom > 1.0 and r.tile_share > 0 for r in reports) >= 4
    assert missed_tolerances(reports) == []


@pytest.mark.parametrize("name", list_scenes())
def test_every_viewpoint_is_compared(name: str) -> None:
    compared = {viewpoint for viewpoint, *_ in references(FOLDER / name)}
    assert compared == {v.name for v in load_scene(name).file.viewpoints}
