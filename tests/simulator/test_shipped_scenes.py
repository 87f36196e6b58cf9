"""Requirements for every shipped scene, checked on the packs."""

from __future__ import annotations

from pathlib import Path

import anyio
import numpy as np
import pytest

from scope_ptz.blender.quality import PACK_BYTES
from scope_ptz.blender.tiles import covers, targets
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.geometry import AXIS_M5075_G, Equirectangular, Limits, Perspective, Pose
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.simulator.pack import Scene, list_scenes, load_scene
from scope_ptz.simulator.truth import view_truth

FAST = "highway-works"  # views of the other scenes are taken in the full tier


@pytest.fixture(scope="module", params=list_scenes())
def scene(request: pytest.FixtureRequest) -> Scene:
    return load_scene(request.param)


@pytest.fixture(
    scope="module", params=[pytest.param(name, marks=() if name == FAST else pytest.mark.full) for name in list_scenes()]
)
def viewed(request: pytest.FixtureRequest) -> Scene:
    return load_scene(request.param)


def test_the_first_scene_is_shipped() -> None:
    assert "highway-works" in list_scenes()


def test_scenes_have_enough_objects(scene: Scene) -> None:
    file = scene.file
    assert len(file.instances) >= 150
    assert len({i.category for i in file.instances}) >= 20
    assert all(2 <= sum(p.viewpoint == v.name for p in file.presets) <= 4 for v in file.viewpoints)
    assert len(file.viewpoints) >= 2
    assert file.absent
    assert len(file.actors) >= 2
    categories = {i.category for i in file.instances} | {a.category for a in file.actors}
    assert not categories & set(file.absent)


@pytest.mark.full
def test_packs_are_small_and_undamaged(scene: Scene) -> None:
    for place in scene.file.viewpoints:
        viewpoint = scene.viewpoint(place.name)
        assert sum(f.stat().st_size for f in viewpoint.folder.rglob("*") if f.is_file()) <= PACK_BYTES
        manifest = viewpoint.manifest
        viewpoint.pictures.colour(manifest.base)
        viewpoint.pictures.numbers(manifest.ids)
        viewpoint.pictures.numbers(manifest.depth)
        for tile in manifest.tiles:
            viewpoint.pictures.colour(tile.colour)
            viewpoint.pictures.numbers(tile.ids)
        for sheet in manifest.actors:
            viewpoint.sprites.colour(sheet, sheet.sprites[0])


def test_presets_are_within_the_limits_of_the_camera(scene: Scene) -> None:
    limits = Limits()
    for preset in scene.file.presets:
        assert limits.clamp(Pose(preset.pan_deg, preset.tilt_deg, preset.zoom))[1] == ()


@pytest.mark.full
def test_texts_and_small_objects_are_in_tiles(scene: Scene) -> None:
    for place in scene.file.viewpoints:
        viewpoint = scene.viewpoint(place.name)
        layer, band = viewpoint.manifest.ids, viewpoint.manifest.band
        whole = Equirectangular(-180.0, 360.0, band.top_tilt_deg, band.bottom_tilt_deg, layer.width, layer.height)
        wanted = targets(scene.file, place, viewpoint.pictures.numbers(layer), whole)
        closest = Perspective(0.0, 0.0, AXIS_M5075_G.hfov_deg(Limits().max_zoom), 1280, 720)
        views = [tile.view for tile in viewpoint.manifest.tiles if tile.suits(closest)]
        assert [t.name for t in wanted if not covers(views, t)] == []


def legible_at(scene: Scene, zoom: float) -> set[str]:
    """Return the texts that are legible when the camera points at them."""
    found = set()
    for place in scene.file.viewpoints:
        viewpoint = scene.viewpoint(place.name)
        for text in scene.file.texts:
            x, y, z = viewpoint.offset(np.array(text.centre_m))
            pan, tilt = np.degrees(np.arctan2(x, y)), np.degrees(np.arctan2(z, np.hypot(x, y)))
            pose, _ = Limits().clamp(Pose(float(pan), float(tilt), zoom))
            view = Perspective(pose.pan_deg, pose.tilt_deg, AXIS_M5075_G.hfov_deg(zoom), 1280, 720)
            truth = view_truth(scene, place.name, view, 0.0)
            found |= {t.text.id for t in truth.legible if t.text.id == text.id}
    return found


@pytest.mark.full
def test_some_texts_are_legible_only_when_zoomed_in(scene: Scene) -> None:
    close, wide = legible_at(scene, 5.0), legible_at(scene, 2.5)
    assert len(close) >= 12
    assert len(close - wide) >= 3


@pytest.mark.full
def test_partial_occlusions(viewed: Scene) -> None:
    shares = []
    for preset in viewed.file.presets:
        view = Perspective(preset.pan_deg, preset.tilt_deg, AXIS_M5075_G.hfov_deg(preset.zoom), 1280, 720)
        shares += [s.visible_fraction for s in view_truth(viewed, preset.viewpoint, view, 0.0).visible if s.occluded and not s.cut]
    assert any(share < 0.6 for share in shares)
    assert any(0.6 <= share < 0.9 for share in shares)


def test_the_same_pose_and_time_give_the_same_bytes(viewed: Scene) -> None:
    async def look(order: list[float]) -> dict[float, bytes]:
        camera = SimulatedCamera(viewed)
        with camera.hold_time():
            shots = {}
            for pan in order:
                await camera.move(Pose(pan, -8, 3))
                shots[pan] = (await camera.frame()).image.tobytes()
            return shots

    assert anyio.run(look, [-30.0, 10.0, 60.0]) == anyio.run(look, [60.0, -30.0, 10.0])


@pytest.mark.full
def test_the_demo_counts_two_four_seven() -> None:
    async def counts() -> list[int]:
        scene = load_scene("highway-works")
        camera, eyes = SimulatedCamera(scene), GroundTruthPerception(load_scene)
        await camera.go_to_preset("highway")
        found = []
        for _ in range(3):
            frame = await camera.frame()
            found.append(len((await eyes.detect(frame, "cones")).boxes))
            pose = await camera.pose()
            await camera.move(pose.turned(pan_deg=15))
        return found

    assert anyio.run(counts) == [2, 4, 7]


def test_the_package_stays_small() -> None:
    folder = Path(load_scene("highway-works").folder).parent
    assert sum(f.stat().st_size for f in folder.rglob("*") if f.is_file()) < 60e6
