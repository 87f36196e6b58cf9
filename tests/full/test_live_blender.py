"""Live Blender and the packs baked from it show the same picture, boxes and actors at the same pose."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path

import numpy as np
import pytest

from scope_ptz.blender.bake import bake, scene_file
from scope_ptz.blender.client import BlenderWorker
from scope_ptz.blender.environment import worker_command
from scope_ptz.blender.parity import box_ious, ssim
from scope_ptz.blender.quality import Quality
from scope_ptz.blender.requests import panorama_request, perspective_request
from scope_ptz.blender.verify import draw_poses, verify
from scope_ptz.camera.base import Camera
from scope_ptz.camera.blender import BlenderCamera
from scope_ptz.camera.conformance import CameraConformance
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.geometry import Equirectangular, Perspective, Pose
from scope_ptz.settings import load_settings
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.models import SceneFile
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.views import instance_ids

pytestmark = pytest.mark.full

SCENE = str(Path(__file__).with_name("small_scene.py"))
TINY = Quality("tiny", 2048, 6, 2048, 1024, 6, 24.0, 3, 6, 10, 90, 90, check_samples=8, check_width=320)


def silent(part: str, done: int, total: int, seconds: float) -> None:
    """A progress callback that does nothing."""


@pytest.fixture(scope="module")
def command() -> list[str]:
    settings = load_settings()
    return worker_command(settings.cache_dir, settings.blender_python)


@pytest.fixture(scope="module")
def worker(command: list[str], tmp_path_factory: pytest.TempPathFactory) -> Iterator[BlenderWorker]:
    with BlenderWorker(command, tmp_path_factory.mktemp("blender") / "blender.log") as blender:
        blender.request("load_scene", {"source": SCENE})
        yield blender


@pytest.fixture(scope="module")
def live_scene(worker: BlenderWorker) -> SceneFile:
    return scene_file(worker.request("describe"), "1")


@pytest.fixture(scope="module")
def baked_scene(command: list[str], tmp_path_factory: pytest.TempPathFactory) -> Scene:
    folder = tmp_path_factory.mktemp("scenes") / "small-yard"
    cache = tmp_path_factory.mktemp("cache")
    bake_result = bake(SCENE, folder, quality=TINY, command=command, cache_dir=cache, viewpoints=["mast"], progress=silent)
    assert 1 <= bake_result.packs[0].tiles <= TINY.max_cells
    assert {r.viewpoint for r in bake_result.reports} == {"mast"}, "the finished pack is compared with live renders"
    file = folder / "scene.json"
    scene = SceneFile.model_validate_json(file.read_text())
    assert [v.name for v in scene.viewpoints] == ["mast", "corner"]
    return Scene(folder)


def test_the_description_has_boxes_and_texts_in_the_world(live_scene: SceneFile) -> None:
    crates = [i for i in live_scene.instances if i.category == "crate"]
    assert len(crates) == 6
    assert all(i.box_min_m[2] == pytest.approx(0, abs=0.01) and i.box_max_m[2] > 0.5 for i in crates)
    text = live_scene.texts[0]
    assert (text.text, text.parent) == ("WORKS ENTRY", "sign-01")
    assert text.cap_height_m == pytest.approx(0.22)
    assert np.cross(text.right, text.up) == pytest.approx((-0.087, -0.996, 0), abs=0.01)
    assert live_scene.actors[0].size_m == pytest.approx((1.2, 2.4, 1.7), abs=0.01)


def test_panorama_and_perspective_see_the_same_world(worker: BlenderWorker, tmp_path: Path) -> None:
    view, sphere = Perspective(12, -15, 60, 320, 180), Equirectangular(-180, 360, 30, -60, 2048, 512)
    found = {}
    for name, request in (("view", perspective_request(view)), ("sphere", panorama_request(sphere))):
        worker.request("truth", {"viewpoint": "mast", "projection": request, "out": str(tmp_path / "t.npz")})
        with np.load(tmp_path / "t.npz") as file:
            found[name] = file["ids"], file["depth"]
    x, y = np.meshgrid((np.arange(320) + 0.5) / 320, (np.arange(180) + 0.5) / 180)
    points = sphere.points(view.directions(np.stack([x, y], axis=-1)))
    columns, rows = (points[..., 0] * 2048).astype(int), (points[..., 1] * 512).astype(int)
    ids, depth = found["sphere"][0][rows, columns], found["sphere"][1][rows, columns]
    same = ids == found["view"][0]
    assert same.mean() > 0.985
    visible = same & (depth > 0) & (found["view"][1] > 0)
    assert np.median(depth[visible] / found["view"][1][visible]) == pytest.approx(1.0, abs=0.002)


def test_the_pack_looks_like_live_renders(worker: BlenderWorker, baked_scene: Scene) -> None:
    poses = draw_poses(baked_scene, 5, 4, 2, ["mast"])
    reports = verify(baked_scene, worker, poses, silent, samples=8, width=320, height=180)
    assert len(reports) == len(poses) > 0
    assert all(r.ssim > 0.85 for r in reports), reports
    assert all(r.box_iou is None or r.box_iou > 0.85 for r in reports), reports


def test_actors_have_the_same_position_in_the_pack_and_in_live_blender(
    worker: BlenderWorker, baked_scene: Scene, tmp_path: Path
) -> None:
    view = Perspective(-25, -20, 40, 320, 180)
    for time_s in (2.3, 3.1):
        request = {"viewpoint": "mast", "projection": perspective_request(view), "out": str(tmp_path / "t.npz"), "time_s": time_s}
        worker.request("truth", request)
        with np.load(tmp_path / "t.npz") as file:
            live = file["ids"]
        stored = instance_ids(baked_scene, "mast", view, time_s)
        number = baked_scene.file.actors[0].number
        assert box_ious(stored, live, 100)[number] > 0.85


@pytest.mark.anyio
async def test_both_cameras_give_the_same_picture(worker: BlenderWorker, live_scene: SceneFile, baked_scene: Scene) -> None:
    live = BlenderCamera(worker, live_scene, samples=8, clock=SceneClock(2.3), width=320, height=180)
    stored = SimulatedCamera(baked_scene, viewpoint="mast", clock=SceneClock(2.3), width=320, height=180)
    assert await live.presets() == await stored.presets()
    frames = []
    for camera in (live, stored):
        await camera.move(Pose(-25, -20, 1.0))
        with camera.hold_time():
            frames.append(await camera.frame())
    assert frames[0].hfov_deg == frames[1].hfov_deg
    assert ssim(frames[0].image, frames[1].image) > 0.85


@pytest.mark.anyio
class TestBlenderCamera(CameraConformance):
    @pytest.fixture(autouse=True)
    def parts(self, worker: BlenderWorker, live_scene: SceneFile) -> None:
        self.worker, self.scene = worker, live_scene

    @asynccontextmanager
    async def camera(self) -> AsyncIterator[Camera]:
        yield BlenderCamera(self.worker, self.scene, samples=2, width=160, height=90)
