"""Camera specs: parsing, invalid specs, and opening cameras."""

from __future__ import annotations

from pathlib import Path

import pytest

from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.errors import InputError, UnknownNameError
from scope_ptz.factory.cameras import CameraSpec, camera_names, open_camera, parse_camera
from scope_ptz.factory.models import ResolvedPerception, make_perception
from scope_ptz.geometry import Pose

SCENE = "analytic-yard"


@pytest.fixture(autouse=True)
def scenes(analytic_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_SCENES_DIR", str(analytic_folder.parent))


def test_a_bare_name_is_a_simulated_scene() -> None:
    assert parse_camera(f" {SCENE} ") == parse_camera(f"sim:{SCENE}") == CameraSpec("sim", SCENE)


def test_schemes_are_case_insensitive_and_options_follow_a_question_mark() -> None:
    spec = parse_camera("SIM:yard?width=640&height=360")
    assert (spec.scheme, spec.address, spec.options) == ("sim", "yard", {"width": "640", "height": "360"})
    assert parse_camera(str(spec)) == spec


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "The camera spec does not name a scene"),
        ("sim:", "The camera spec does not name a scene"),
        ("rtsp://10.0.0.7", "There is no camera scheme 'rtsp'. Known: axis, blender, blender-window, onvif, sim"),
        ("axis://", "user@host"),
        ("axis://op@host:0", "port"),
        ("axis://op@host?stream=hls", "mjpeg or rtsp; got 'hls'"),
        ("axis://op@host?channel=0", "whole number from 1 to 64"),
        ("axis://op@host?password=x", "There is no camera option 'password'"),
        ("axis://op@host?hfov_wide=60", "both hfov_wide and hfov_tele"),
        ("axis://op@host?hfov_wide=60&hfov_tele=61", "hfov_wide must be the larger angle"),
        ("yard.blend", "Use blender:yard.blend"),
        ("C:\\yard.blend", r"Use blender:C:\\yard.blend"),
        ("blender:missing.blend", "The file missing.blend does not exist"),
        ("blender:no-such-scene", "There is no scene that Blender can build 'no-such-scene'"),
        ("sim:yard?samples=3", "There is no camera option 'samples'"),
        ("sim:yard?width=wide", "The camera option width must be a whole number from 1 to 10000; got 'wide'"),
        ("sim:yard?width=0", "whole number from 1"),
    ],
)
def test_errors_of_wrong_specs(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        parse_camera(text)


@pytest.mark.parametrize(
    "text",
    [
        "axis://root:hunter2@10.0.0.7",
        "rtsp://root:hun@ter2@cam/live",
        "root:hunter2@10.0.0.7",
        "onvif:root:hunter2@cam?x=1",
        "sim://a:hunter2@b",
    ],
)
def test_passwords_are_refused_and_not_repeated(text: str) -> None:
    with pytest.raises(InputError) as excinfo:
        parse_camera(text)
    assert "ter2" not in str(excinfo.value)


def test_a_mistyped_scheme_does_not_repeat_its_address() -> None:
    with pytest.raises(InputError) as excinfo:
        parse_camera("axi://10.0.0.7/hunter2")
    assert "hunter2" not in str(excinfo.value)


def test_available_cameras_are_listed() -> None:
    names = camera_names()
    assert SCENE in names
    assert "blender:highway-works" in names
    assert "blender:FILE.blend" in names


@pytest.mark.anyio
async def test_a_simulated_camera_opens_with_its_truth() -> None:
    async with await open_camera(SCENE, time_s=3.0) as handle:
        assert isinstance(handle.camera, SimulatedCamera)
        assert handle.has_truth
        assert handle.scene is not None
        assert handle.scenes is not None
        assert handle.scenes(SCENE) is handle.scene
        assert handle.clock.now_s() == 3.0
        perception = make_perception(ResolvedPerception("ground-truth"), handle.scenes, 0)
        assert (await perception.detect(await handle.camera.frame(), "box")).source == "ground-truth"


@pytest.mark.anyio
async def test_the_size_of_frames_is_an_option() -> None:
    async with await open_camera(f"sim:{SCENE}?width=64&height=36") as handle:
        assert (await handle.camera.frame()).image.shape == (36, 64, 3)


@pytest.mark.anyio
async def test_a_camera_starts_at_a_preset() -> None:
    async with await open_camera(SCENE) as handle:
        preset = (await handle.camera.presets())[-1].name
    async with await open_camera(SCENE, preset=preset) as handle:
        preset_pose = await handle.camera.pose()
        assert (await handle.camera.go_to_preset(preset)).pose == preset_pose
        assert preset_pose != Pose()


@pytest.mark.anyio
async def test_invalid_start_presets() -> None:
    with pytest.raises(InputError, match="--viewpoint or --preset, not both"):
        await open_camera(SCENE, viewpoint="mast", preset="home")
    with pytest.raises(UnknownNameError, match="preset"):
        await open_camera(SCENE, preset="nowhere")
    with pytest.raises(UnknownNameError, match="viewpoint"):
        await open_camera(SCENE, viewpoint="nowhere")
    with pytest.raises(UnknownNameError, match="scene"):
        await open_camera("nowhere")


@pytest.mark.parametrize("name", ["ground-truth", "noisy"])
def test_ground_truth_needs_a_scene(name: str) -> None:
    with pytest.raises(InputError, match=f"'{name}' uses the ground truth of a simulated scene, but this camera has none"):
        make_perception(ResolvedPerception(name), None, 0)
