"""Cameras with ``blender:`` specs: scenes and .blend files rendered by live Blender."""

from __future__ import annotations

import subprocess
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import numpy as np
import pytest
from anyio import to_thread
from numpy.typing import NDArray

from scope_ptz.blender.environment import ensure_environment
from scope_ptz.blender.parity import ssim
from scope_ptz.camera.base import Camera
from scope_ptz.camera.conformance import CameraConformance
from scope_ptz.errors import BlenderError
from scope_ptz.factory.cameras import OpenCamera, open_camera
from scope_ptz.settings import load_settings

pytestmark = pytest.mark.full

SCENE = Path(__file__).with_name("small_scene.py")
SMALL = "samples=4&width=160&height=90"

# Creates a file with a red box to the north, and with scripts that write to a marker file when they run.
MAKE_FILE = """
import bpy, math, sys
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
world = bpy.data.worlds.new("world")
scene.world = world
world.color = (0.5, 0.5, 0.5)
bpy.ops.mesh.primitive_cube_add(size=2, location=(0, 8, 1))
paint = bpy.data.materials.new("red")
paint.use_nodes = True
paint.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.8, 0.02, 0.02, 1)
box = bpy.context.object
box.data.materials.append(paint)
box.keyframe_insert("location", frame=1)
box.location.z = 40
box.keyframe_insert("location", frame=241)
for k in range(12):
    bpy.ops.mesh.primitive_cone_add(radius1=1, depth=3, location=(14 * math.sin(k / 2 + 0.3), 14 * math.cos(k / 2 + 0.3), 1))
light = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
light.data.energy = 3
light.rotation_euler = (0.8, 0.3, 0)
scene.collection.objects.link(light)
for name, place, turn, lens in (("Main Gate", (0, 0, 2), (90, 0, 0), 30), ("main-gate", (0, 8, 12), (0, 0, 0), 60)):
    camera = bpy.data.objects.new(name, bpy.data.cameras.new(name))
    camera.data.lens = lens
    camera.location, camera.rotation_euler = place, [math.radians(a) for a in turn]
    scene.collection.objects.link(camera)
scene.camera = bpy.data.objects["Main Gate"]
text = bpy.data.texts.new("startup.py")
text.write(f"open({sys.argv[2]!r}, 'a').write('script ')")
text.use_module = True
empty = bpy.data.objects.new("empty", None)
scene.collection.objects.link(empty)
driver = empty.driver_add("scale", 0).driver
driver.type = "SCRIPTED"
driver.expression = f"__import__('io').open({sys.argv[2]!r}, 'a').write('driver ') * 0 + 1"
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[1])
"""
OPEN_WITH_SCRIPTS = "import bpy, sys; bpy.ops.wm.open_mainfile(filepath=sys.argv[1], use_scripts=True)"


@pytest.fixture(scope="module")
def python() -> str:
    settings = load_settings()
    return str(settings.blender_python or ensure_environment(settings.cache_dir))


@pytest.fixture(scope="module")
def marker(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("marker") / "ran.txt"


@pytest.fixture(scope="module")
def blend_file(python: str, marker: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("files") / "My Yard.blend"
    subprocess.run([python, "-c", MAKE_FILE, str(path), str(marker)], check=True, capture_output=True)
    marker.unlink(missing_ok=True)
    return path


def redness(pixels: NDArray[np.uint8]) -> float:
    """Return the share of red pixels."""
    image = pixels.astype(float)
    return float(((image[..., 0] > 60) & (image[..., 0] > 2 * image[..., 1])).mean())


@pytest.mark.anyio
async def test_a_file_opens_at_its_active_camera(blend_file: Path) -> None:
    async with await open_camera(f"blender:{blend_file}?{SMALL}") as handle:
        camera = handle.camera
        assert not handle.has_truth
        assert [(p.name, p.description) for p in await camera.presets()] == [
            ("main-gate", "Main Gate"),
            ("main-gate-2", "main-gate"),
        ]
        frame = await camera.frame()
        assert frame.origin is None
        assert frame.image.shape == (90, 160, 3)
        ahead = redness(frame.image)
        assert ahead > 0.01, "the red box is in front of the active camera"
        start = await camera.pose()
        await camera.move(start.turned(pan_deg=180.0))
        assert redness((await camera.frame()).image) == 0.0
        await camera.go_to_preset("main-gate-2")
        assert (await camera.pose()).tilt_deg == pytest.approx(-90.0)
        assert redness((await camera.frame()).image) > 0.01, "the other camera looks down on the box"
        await camera.go_home()
        assert await camera.pose() == start
        assert redness((await camera.frame()).image) == pytest.approx(ahead, abs=0.005)


@pytest.mark.anyio
async def test_time_moves_the_animation_of_a_file(blend_file: Path) -> None:
    async with await open_camera(f"blender:{blend_file}?{SMALL}", time_s=10.0) as handle:
        assert redness((await handle.camera.frame()).image) == 0.0, "the box has left the picture"


@pytest.mark.anyio
async def test_scripts_in_a_file_do_not_run(python: str, blend_file: Path, marker: Path) -> None:
    async with await open_camera(f"blender:{blend_file}?{SMALL}") as handle:
        await handle.camera.frame()
    await to_thread.run_sync(check_markers, python, blend_file, marker)


def check_markers(python: str, blend_file: Path, marker: Path) -> None:
    """Check that no embedded script has run, and that all run when scripts are enabled."""
    assert not marker.exists()
    subprocess.run([python, "-c", OPEN_WITH_SCRIPTS, str(blend_file)], check=True, capture_output=True)
    assert "script" in marker.read_text()
    marker.unlink()


@pytest.mark.anyio
async def test_a_file_that_is_not_a_blend_file(tmp_path: Path) -> None:
    (tmp_path / "text.blend").write_text("hello")
    with pytest.raises(BlenderError, match=r"text\.blend"):
        await open_camera(f"blender:{tmp_path / 'text.blend'}")


@pytest.mark.anyio
async def test_a_scene_from_code_opens_at_presets_and_viewpoints() -> None:
    async with await open_camera(f"blender:{SCENE}?{SMALL}") as handle:
        assert [p.name for p in await handle.camera.presets()] == ["yard", "sign"]
        assert not handle.has_truth, "no pack of this scene exists"
        first = await handle.camera.frame()
        await handle.camera.go_to_preset("sign")
        other = await handle.camera.frame()
        assert ssim(first.image, other.image) < 0.9
    async with await open_camera(f"blender:{SCENE}?{SMALL}", viewpoint="corner") as handle:
        assert ssim((await handle.camera.frame()).image, other.image) > 0.95


@pytest.mark.anyio
class TestBlendFileCamera(CameraConformance):
    @pytest.fixture(autouse=True)
    async def parts(self, blend_file: Path) -> AsyncIterator[None]:
        async with await open_camera(f"blender:{blend_file}?samples=2&width=160&height=90") as handle:
            self.opened: OpenCamera = handle
            yield

    @asynccontextmanager
    async def camera(self) -> AsyncIterator[Camera]:
        await self.opened.camera.go_home()
        yield self.opened.camera
