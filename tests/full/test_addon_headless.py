"""The add-on in Blender's Python module, without a window."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path

import cv2
import numpy as np
import pytest

from scope_ptz.blender.addon_zip import addon_folder, write_addon_zip
from scope_ptz.camera.base import Camera
from scope_ptz.camera.conformance import CameraConformance
from scope_ptz.serve.security.access import Access
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.site.site import SiteOptions
from tests.addon.fake_blender import CAMERA, window_camera
from tests.addon.test_protocol import replying
from tests.full.driven_blender import DrivenBlender, blender_without_window, environment, worker_python
from tests.serve.serving import Served, serving

pytestmark = pytest.mark.full


@pytest.fixture(scope="module")
def blender(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DrivenBlender]:
    with blender_without_window(tmp_path_factory.mktemp("home")) as blender_process:
        blender_process("[setattr(scene.render, 'engine', 'BLENDER_WORKBENCH'), setattr(scene.scope, 'width', 160)]")
        blender_process("setattr(scene.scope, 'height', 90)")
        yield blender_process
        assert blender_process.end() == {"cameras": ["Main Gate", "roof"], "active": "Main Gate"}, "the scene must be restored"


@pytest.fixture
def site_server(blender: DrivenBlender, tmp_path: Path) -> Iterator[Served]:
    options = SiteOptions(tmp_path / "runs")
    with serving(options, Access("127.0.0.1", limits=RateLimits(None)), {CAMERA: f"{CAMERA}:"}) as server:
        blender(f"session.connect({server.root!r}, '', {CAMERA!r})")
        blender.wait_for("session.state == 'connected'")
        yield server
        blender("session.disconnect()")


@pytest.mark.anyio
class TestBlenderWindowCamera(CameraConformance):
    """The conformance suite of cameras, with pictures from Blender."""

    @pytest.fixture(autouse=True)
    def _parts(self, blender: DrivenBlender, tmp_path: Path) -> None:
        self.blender, self.folder = blender, tmp_path

    @asynccontextmanager
    async def camera(self) -> AsyncIterator[Camera]:
        connect = f"session.connect({{!r}}, '', {CAMERA!r})"
        async with window_camera(lambda url: self.blender(connect.format(url)), self.folder) as (camera, _):
            yield camera


def test_a_question_moves_the_camera_in_the_open_scene(blender: DrivenBlender, site_server: Served) -> None:
    outcome, text, timings = blender.ask("go to the roof preset, then pan right 20 degrees and zoom in 2x")
    assert (outcome, "roof" in text) == ("Answered", True)
    assert [part for part, _ in timings][-1] == "total"
    assert [step[0].partition("(")[0] for step in blender("session.steps")] == ["go_to_preset", "adjust_ptz"]
    assert blender("scene.camera.name") == "SCOPE camera"
    assert blender("cameras.view_through(scene, scene.camera, '')[2:4]") == pytest.approx([20.0, -30.0], abs=0.01)
    assert blender("bpy.data.images['SCOPE frame'].size[0]") == 160


def test_pictures_show_the_scene(blender: DrivenBlender, site_server: Served) -> None:
    with site_server.client() as client:
        client.post(f"/cameras/{CAMERA}/home")
        data = client.get(f"/cameras/{CAMERA}/frame", params={"format": "png"}).content
    picture = np.asarray(cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)).astype(int)
    middle, corner = picture[55, 80], picture[10, 10]
    assert middle[2] > 1.5 * max(middle[0], middle[1]), "the red box is straight ahead"
    assert abs(corner - corner.mean()).max() < 30, "the background is grey"


def test_the_users_settings_are_restored(blender: DrivenBlender, site_server: Served) -> None:
    settings = "[scene.render.resolution_x, scene.render.filepath, scene.render.image_settings.file_format, scene.render.engine]"
    before = blender(settings)
    assert before[0] != 160
    with site_server.client() as client:
        assert client.get(f"/cameras/{CAMERA}/frame").status_code == 200
    assert blender(settings) == before


def test_only_a_changed_scene_is_drawn_again(blender: DrivenBlender, site_server: Served) -> None:
    with site_server.client() as client:

        def take() -> bytes:
            return client.get(f"/cameras/{CAMERA}/frame", params={"format": "png"}).content

        first = take()
        picture_count = blender("session.executor.picture_count")
        assert take() == first
        assert blender("session.executor.picture_count") == picture_count
        blender("bpy.data.objects['box'].location.__setattr__('z', 3.0)")
        blender("bpy.context.view_layer.update()")
        assert take() != first
        blender("bpy.data.objects['box'].location.__setattr__('z', 1.0)")
        blender("bpy.context.view_layer.update()")


def test_presets_are_cameras_of_the_scene(blender: DrivenBlender, site_server: Served, tmp_path: Path) -> None:
    blender.wait_for("session.presets == ['main-gate', 'roof']")
    with site_server.client() as client:
        client.post(f"/cameras/{CAMERA}/move", json={"pan_deg": 25.0, "tilt_deg": -7.0, "zoom": 2.0})
        assert client.put(f"/cameras/{CAMERA}/presets/The box", json={"description": "close"}).status_code == 200
        client.post(f"/cameras/{CAMERA}/home")
        arrival = client.post(f"/cameras/{CAMERA}/presets/The box/go").json()
        assert arrival["pose"] == pytest.approx({"pan_deg": 25.0, "tilt_deg": -7.0, "zoom": 2.0}, abs=0.01)
    path = tmp_path / "saved.blend"
    blender(f"bpy.ops.wm.save_as_mainfile(filepath={str(path)!r}, copy=True) and None")
    script = "import bpy; bpy.ops.wm.open_mainfile(filepath={!r}); s = bpy.context.scene; "
    script += "print('found', sorted(o.name for o in s.objects if o.type == 'CAMERA'), s.camera.name)"
    result = subprocess.run(
        [str(worker_python()), "-c", script.format(str(path))], capture_output=True, text=True, check=True, timeout=120
    )
    assert "found ['Main Gate', 'The box', 'roof'] Main Gate" in result.stdout, "the saved file must keep its own active camera"
    assert blender("scene.camera.name") == "SCOPE camera", "SCOPE's camera must be active again after saving"
    with site_server.client() as client:
        assert client.delete(f"/cameras/{CAMERA}/presets/The box").status_code == 204
        assert client.delete(f"/cameras/{CAMERA}/presets/roof").json()["error"]["code"] == "refused_by_camera"
    assert blender("[o.name for o in scene.objects if 'box' in o.name]") == ["box"]


def test_the_camera_works_with_another_file(blender: DrivenBlender, site_server: Served, tmp_path: Path) -> None:
    path = str(tmp_path / "other.blend")
    blender(f"bpy.ops.wm.save_as_mainfile(filepath={path!r}, copy=True) and None")
    with site_server.client() as client:
        client.post(f"/cameras/{CAMERA}/presets/roof/go")
        before = client.get(f"/cameras/{CAMERA}/frame", params={"format": "png"}).content
        blender(f"bpy.ops.wm.open_mainfile(filepath={path!r}) and None")
        blender.wait_for("session.state == 'connected'")
        state = client.get(f"/cameras/{CAMERA}").json()
        assert state["title"].startswith("camera in other.blend")
        client.post(f"/cameras/{CAMERA}/presets/roof/go")
        assert client.get(f"/cameras/{CAMERA}/frame", params={"format": "png"}).content == before
    assert blender("sorted(o.name for o in scene.objects if o.type == 'CAMERA')") == ["Main Gate", "SCOPE camera", "roof"]


def test_the_token_is_not_stored(tmp_path: Path) -> None:
    with blender_without_window(tmp_path) as blender:
        preferences = "bpy.context.preferences.addons['scope_addon'].preferences"
        blender(f"setattr({preferences}, 'token', 'a-secret-token')")
        assert blender(f"{preferences}.token") == "a-secret-token"
        blender("bpy.ops.wm.save_userpref() and None")
        blender(f"bpy.ops.wm.save_as_mainfile(filepath={str(tmp_path / 'a.blend')!r}, compress=False) and None")
        files = [path for path in tmp_path.rglob("*") if path.is_file()]
        assert any(path.name == "userpref.blend" for path in files)
        assert not any(b"a-secret-token" in path.read_bytes() for path in files)
        blender.end()


def test_a_silent_server_does_not_stop_blender(blender: DrivenBlender) -> None:
    with replying(b"") as url:
        blender(f"session.connect({url!r}, '', {CAMERA!r})")
        assert blender("session.state") == "connecting", "Blender still answers"
        assert blender("session.disconnect()") is None
        assert blender("session.state") == "off"


def test_problems_are_reported_in_words(blender: DrivenBlender) -> None:
    blender("session.connect('http://127.0.0.1:9', '', 'blender-window')")
    blender.wait_for("session.state == 'off'")
    assert "No server is running" in blender("session.problem")
    assert blender("scene.camera.name") == "Main Gate"


@pytest.fixture
def program(tmp_path: Path) -> Path:
    """Return a ``scope`` program that runs the sources under test instead of an installed package."""
    path = tmp_path / "scope"
    start = f"import sys\nsys.path.insert(0, {str(addon_folder().parent)!r})\nfrom scope_ptz.cli import main\nmain()\n"
    path.write_text(f"#!{sys.executable}\n{start}")
    path.chmod(0o755)
    return path


def test_a_server_that_cannot_start_is_explained(blender: DrivenBlender, tmp_path: Path) -> None:
    path = tmp_path / "scope"
    path.write_text("#!/bin/sh\necho 'error: There are no cameras.' >&2\nexit 2\n")
    path.chmod(0o755)
    blender(f"session.start_server({str(path)!r}, [])")
    blender.wait_for("session.state == 'off'")
    assert blender("session.problem") == "The server ended. error: There are no cameras."


def test_the_add_on_starts_and_ends_a_server(blender: DrivenBlender, program: Path) -> None:
    blender(f"session.start_server({str(program)!r}, [])")
    blender.wait_for("session.state == 'connected'")
    assert blender.ask("pan left 10 degrees")[0] == "Answered"
    process = "session._server._process"
    pid = blender(f"{process}.pid")
    blender("session.disconnect()")
    blender.wait_for("session.state == 'off'")
    blender.wait_for(f"not __import__('os').path.exists('/proc/{pid}/cmdline') or not open('/proc/{pid}/cmdline').read()")


def test_the_file_installs_as_an_extension(tmp_path: Path) -> None:
    path = tmp_path / "scope.zip"
    write_addon_zip(path)
    code = f"""
import bpy
bpy.ops.preferences.addon_enable(module="bl_pkg")
bpy.ops.extensions.package_install_files(filepath={str(path)!r}, repo="user_default", enable_on_install=True)
print("enabled", "bl_ext.user_default.scope_addon" in bpy.context.preferences.addons, hasattr(bpy.types, "SCOPE_PT_ask"))
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.scope_addon")
print("disabled", not hasattr(bpy.types, "SCOPE_PT_ask"), not hasattr(bpy.types.Scene, "scope"))
"""
    result = subprocess.run(
        [str(worker_python()), "-c", code], env=environment(tmp_path), capture_output=True, text=True, timeout=180, check=False
    )
    assert "enabled True True" in result.stdout, result.stdout + result.stderr
    assert "disabled True True" in result.stdout
