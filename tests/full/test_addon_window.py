"""The add-on in a real window of the ``blender`` program, on an X server without a screen."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest

from scope_ptz.blender.addon_zip import write_addon_zip
from scope_ptz.serve.security.access import Access
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.site.marks import ACCENT
from scope_ptz.serve.site.pairs import DEFAULT_PAIR
from scope_ptz.serve.site.site import SiteOptions
from tests.addon.fake_blender import CAMERA
from tests.full.driven_blender import DrivenBlender, blender_in_window, environment, screenshot, virtual_screen
from tests.serve.serving import Served, serving
from tests.support.misbehaving import MOONDREAM, Misbehaving

pytestmark = pytest.mark.full

VISION_PAIR = "grammar+moondream3"
PREFERENCES = "bpy.context.preferences.addons['scope_addon'].preferences"


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a home folder in which the zip file is installed, as in Blender 3.4."""
    folder = tmp_path_factory.mktemp("home")
    write_addon_zip(folder / "scope.zip")
    code = f"import bpy; bpy.ops.preferences.addon_install(filepath={str(folder / 'scope.zip')!r})"
    command = ["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python-expr", code]
    subprocess.run(command, env=environment(folder), check=True, capture_output=True, timeout=180)
    return folder


@pytest.fixture(scope="module")
def display() -> Iterator[str]:
    with virtual_screen() as name:
        yield name


@pytest.fixture(scope="module")
def site_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """Run a server whose second pair uses a fake Moondream, which always detects one object at the same place."""
    options = SiteOptions(tmp_path_factory.mktemp("served"), pairs=(DEFAULT_PAIR, VISION_PAIR))
    access = Access("127.0.0.1", limits=RateLimits(None))
    with pytest.MonkeyPatch.context() as patch, Misbehaving() as model:
        patch.setenv("SCOPE_PERCEPTION_URL", model.url)
        with serving(options, access, {CAMERA: f"{CAMERA}:"}) as server:
            yield server


@pytest.fixture(scope="module")
def blender(home: Path, display: str, site_server: Served) -> Iterator[DrivenBlender]:
    with blender_in_window(home, display) as blender_process:
        blender_process("[setattr(scene.scope, 'width', 480), setattr(scene.scope, 'height', 270)]")
        blender_process(
            f"[setattr({PREFERENCES}, 'server_mode', 'ADDRESS'), setattr({PREFERENCES}, 'address', {site_server.root!r})]"
        )
        assert blender_process("run('connect')") == ["FINISHED"]
        blender_process.wait_for("session.state == 'connected'")
        blender_process("run('look')")
        yield blender_process
        assert blender_process.end() == {"cameras": ["Main Gate", "roof"], "active": "Main Gate"}


def test_a_question_is_answered_in_the_window(blender: DrivenBlender, display: str, tmp_path: Path) -> None:
    assert blender("scene.scope.source") == "VIEWPORT"
    before = tmp_path / "before.png"
    screenshot(display, before)
    blender("setattr(bpy.context.window_manager.scope, 'question', 'go to the roof preset, then zoom in 2x')")
    assert blender("run('ask')") == ["FINISHED"]
    blender.wait_for("session.run is None")
    assert blender("session.problem") == ""
    assert blender("session.end")[0] == "Answered"
    assert blender("session.executor.picture_count") > 0
    assert blender("cameras.view_through(scene, scene.camera, '')[3]") == pytest.approx(-30.0, abs=0.01)
    blender.wait_for("not session.executor.camera.gliding")
    screenshot(display, tmp_path / "after.png")
    first, second = (np.asarray(cv2.imread(str(path))).astype(int) for path in (before, tmp_path / "after.png"))
    assert abs(first - second)[100:800, 100:1000].mean() > 3.0, "the viewport shows that the camera has moved"


def test_the_viewports_picture_has_no_overlays(blender: DrivenBlender, site_server: Served) -> None:
    with site_server.client() as client:
        client.post(f"/cameras/{CAMERA}/home")
        viewport_png = client.get(f"/cameras/{CAMERA}/frame", params={"format": "png"}).content
        blender("setattr(scene.scope, 'source', 'RENDER')")
        blender("setattr(scene.render, 'engine', 'BLENDER_WORKBENCH')")
        render_png = client.get(f"/cameras/{CAMERA}/frame", params={"format": "png"}).content
        blender("setattr(scene.scope, 'source', 'VIEWPORT')")
    viewport, render = (cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) for data in (viewport_png, render_png))
    edges = [cv2.dilate(cv2.Canny(picture, 60, 120), np.ones((5, 5))) > 0 for picture in (viewport, render)]
    overlap = (edges[0] & edges[1]).sum() / (edges[0] | edges[1]).sum()
    assert overlap > 0.6, f"the viewport and the render engine show the same outlines, but only {overlap:.2f} agree"


def test_a_preset_is_created_from_the_viewport(blender: DrivenBlender) -> None:
    region = "next(a for a in bpy.context.window_manager.windows[0].screen.areas if a.type == 'VIEW_3D').spaces.active.region_3d"
    blender(f"setattr({region}, 'view_perspective', 'PERSP')")
    blender("setattr(bpy.context.window_manager.scope, 'preset', 'From above')")
    assert blender("run('preset_add')") == ["FINISHED"]
    blender.wait_for("'From above' in session.presets")
    blender("run('look')")
    assert blender("run('preset_go', name='From above')") == ["FINISHED"]
    expected = "(cameras.find_preset(scene, 'From above').matrix_world.translation - scene.camera.matrix_world.translation).length"
    blender.wait_for(f"{expected} < 0.001")
    assert blender("run('preset_remove', name='From above')") == ["FINISHED"]
    blender.wait_for("'From above' not in session.presets")


def test_the_picture_opens_in_an_image_editor(blender: DrivenBlender) -> None:
    assert blender("run('picture')") == ["FINISHED"]
    image_names = (
        "[a.spaces.active.image.name for a in bpy.context.window_manager.windows[0].screen.areas if a.type == 'IMAGE_EDITOR']"
    )
    assert blender(image_names) == ["SCOPE frame"]


def test_detections_are_marked_in_the_image_editor(blender: DrivenBlender, display: str, tmp_path: Path) -> None:
    assert blender("run('picture')") == ["FINISHED"]
    blender("setattr(bpy.context.window_manager.scope, 'question', 'how many cones are there?')")
    blender(f"setattr(bpy.context.window_manager.scope, 'pair', {VISION_PAIR!r})")
    assert blender("run('ask')") == ["FINISHED"]
    blender.wait_for("session.run is None")
    assert blender("session.end")[0] == "Answered", blender("session.end")
    assert "1" in blender("session.end")[1]
    # The middle row of the picture, which the left and the right side of the box cross.
    row = "[round(255 * value) for value in bpy.data.images['SCOPE frame'].pixels[480 * 4 * 135 : 480 * 4 * 136]]"
    left, right = (round(480 * MOONDREAM["detect"]["objects"][0][side]) for side in ("x_min", "x_max"))

    def marked_columns() -> list[int]:
        pixels = np.array(blender(row)).reshape(480, 4)[:, :3]
        return np.flatnonzero(abs(pixels - ACCENT).max(axis=1) < 40).tolist()

    deadline_s = time.monotonic() + 60.0
    while not (found := marked_columns()):
        assert time.monotonic() < deadline_s, "the picture has no marks"
        time.sleep(0.1)
    screenshot(display, tmp_path / "marked.png")
    assert {min(abs(column - side) for side in (left, right)) <= 3 for column in found} == {True}
    assert {abs(column - left) <= 3 for column in found} == {True, False}, "both sides are drawn"


def test_an_instruction_can_be_cancelled_and_blender_responds_meanwhile(blender: DrivenBlender) -> None:
    blender(f"session.ask({', then '.join(['pan right 1 degree', 'pan left 1 degree'] * 12)!r}, '')")
    blender.wait_for("len(session.steps) > 0")
    assert blender("session.run is not None"), "Blender answers while the instruction is in progress"
    assert blender("run('cancel')") == ["FINISHED"]
    blender.wait_for("session.run is None")
    assert blender("session.end")[0] == "Cancelled"
    assert blender("len(session.steps)") < 24
