"""Finding scenes, and clear errors for every kind of damage."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from scope_ptz.errors import PackError, UnknownNameError
from scope_ptz.geometry import Perspective
from scope_ptz.simulator.pack import Scene, list_scenes, load_scene
from scope_ptz.simulator.reproject import colour_view, depth_view, id_view
from scope_ptz.simulator.views import picture

VIEW = Perspective(0.0, -8.0, 71.0, 64, 36)


@pytest.fixture
def copy(analytic_folder: Path, tmp_path: Path) -> Path:
    """A scene folder that a test may damage. Its files are links to the originals: replace them, never write to them."""
    return Path(shutil.copytree(analytic_folder, tmp_path / analytic_folder.name, copy_function=os.link))


def _replace(path: Path, content: bytes) -> None:
    path.unlink()
    path.write_bytes(content)


def _edit(path: Path, change: Callable[[Any], None]) -> None:
    content = json.loads(path.read_text())
    change(content)
    _replace(path, json.dumps(content).encode())


def test_scenes_are_found_by_name(analytic_folder: Path) -> None:
    assert "analytic-yard" in list_scenes([analytic_folder.parent])
    assert load_scene("analytic-yard", [analytic_folder.parent]).name == "analytic-yard"


def test_other_folders_are_ignored(tmp_path: Path) -> None:
    (tmp_path / "notes").mkdir()
    (tmp_path / "file.txt").write_text("x")
    assert "notes" not in list_scenes([tmp_path, tmp_path / "nowhere"])


def test_unknown_scene_names_the_known_ones(analytic_folder: Path) -> None:
    with pytest.raises(UnknownNameError, match=r"no scene 'analytic-yrad'. Did you mean 'analytic-yard'\?"):
        load_scene("analytic-yrad", [analytic_folder.parent])


def test_unknown_viewpoint(analytic_scene: Scene) -> None:
    with pytest.raises(UnknownNameError, match=r"viewpoint 'cellar'.*Known: mast, roof"):
        analytic_scene.viewpoint("cellar")


def test_opening_a_scene_reads_no_picture(copy: Path) -> None:
    for picture_file in copy.rglob("*.png"):
        picture_file.unlink()
    scene = Scene(copy)
    assert scene.viewpoint("mast").manifest.viewpoint == "mast"


@pytest.mark.parametrize(
    ("file", "look", "message"),
    [
        ("base.png", colour_view, "missing"),
        ("ids.png", id_view, "missing"),
        ("depth.png", depth_view, "missing"),
    ],
)
def test_a_missing_layer(copy: Path, file: str, look: Callable[..., Any], message: str) -> None:
    (copy / "mast" / file).unlink()
    with pytest.raises(PackError, match=rf"{file} is {message}.*[Bb]ake"):
        look(Scene(copy).viewpoint("mast"), VIEW)


def test_a_damaged_layer(copy: Path) -> None:
    path = copy / "mast" / "base.png"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    _replace(path, bytes(content))
    with pytest.raises(PackError, match=r"base.png is damaged: its checksum"):
        colour_view(Scene(copy).viewpoint("mast"), VIEW)


def test_a_layer_that_is_not_an_image(copy: Path) -> None:
    path = copy / "mast" / "base.png"
    _replace(path, b"this is no picture")
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    _edit(copy / "mast" / "manifest.json", lambda m: m["base"].update(sha256=digest))
    with pytest.raises(PackError, match="cannot be decoded"):
        colour_view(Scene(copy).viewpoint("mast"), VIEW)


def test_a_layer_of_the_wrong_size(copy: Path) -> None:
    path = copy / "mast" / "base.png"
    path.unlink()
    Image.fromarray(np.zeros((10, 20, 3), dtype=np.uint8)).save(path)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    _edit(copy / "mast" / "manifest.json", lambda m: m["base"].update(sha256=digest))
    with pytest.raises(PackError, match=r"20x10 pixels, but its manifest states 2304x"):
        colour_view(Scene(copy).viewpoint("mast"), VIEW)


@pytest.mark.parametrize("name", ["a/../../secret.png", "a/../../../etc/passwd"])
def test_a_path_out_of_the_folder(copy: Path, name: str) -> None:
    shutil.copy(copy / "mast" / "base.png", copy / "secret.png")
    _edit(copy / "mast" / "manifest.json", lambda m: m["base"].update(file=name))
    with pytest.raises(PackError, match="outside its folder"):
        colour_view(Scene(copy).viewpoint("mast"), VIEW)


@pytest.mark.parametrize("name", ["../base.png", "/etc/passwd", "..", "C:\\x"])
def test_a_name_that_is_not_a_file_name(copy: Path, name: str) -> None:
    _edit(copy / "mast" / "manifest.json", lambda m: m["base"].update(file=name))
    with pytest.raises(PackError, match=r"manifest.json is invalid at base.file"):
        Scene(copy).viewpoint("mast")


def test_a_link_out_of_the_folder(copy: Path) -> None:
    path = copy / "mast" / "base.png"
    path.rename(copy / "elsewhere.png")
    path.symlink_to(copy / "elsewhere.png")
    with pytest.raises(PackError, match="outside its folder"):
        colour_view(Scene(copy).viewpoint("mast"), VIEW)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: s.update(format=2), "format 2, but this program supports formats up to 1. Install a newer scope-ptz"),
        (lambda s: s.update(format="x"), "scene.json is invalid at format"),
        (lambda s: s.update(extra=1), "scene.json is invalid at extra"),
        (lambda s: s.pop("instances"), "scene.json is invalid at instances"),
        (lambda s: s.update(name="other"), "Rename the folder to the scene's name"),
        (lambda s: s.update(home_preset="nowhere"), "the home preset is 'nowhere', which does not exist"),
        (lambda s: s["presets"][0].update(viewpoint="cellar"), "preset 'yard' names the viewpoint 'cellar'"),
        (lambda s: s["texts"][0].update(parent="ghost"), "text 'board-text' names the instance 'ghost'"),
        (lambda s: s["instances"][0].update(parent="ghost"), "instance 'ball-01' names the parent 'ghost'"),
        (lambda s: s["instances"][0].update(number=2), "uses an id or a number more than once"),
        (lambda s: s["presets"][0].update(pan_deg=float("nan")), "presets.0.pan_deg"),
    ],
)
def test_a_damaged_scene_file(copy: Path, change: Callable[[Any], None], message: str) -> None:
    _edit(copy / "scene.json", change)
    with pytest.raises(PackError) as caught:
        Scene(copy)
    assert message in str(caught.value)


@pytest.mark.parametrize("content", ["", "{", "[]", "null", "\x00\xff"])
def test_a_scene_file_with_other_content(copy: Path, content: str) -> None:
    _replace(copy / "scene.json", content.encode())
    with pytest.raises(PackError, match=r"scene.json is (not valid JSON|invalid at the top level)"):
        Scene(copy)


def test_a_viewpoint_of_another_version_of_the_scene(copy: Path) -> None:
    _edit(copy / "mast" / "manifest.json", lambda m: m.update(scene_version="2"))
    with pytest.raises(
        PackError, match=r"baked for viewpoint 'mast' .* version 2, but the folder is that of .* version 1. Bake it again"
    ):
        Scene(copy).viewpoint("mast")


def test_an_instance_that_the_scene_does_not_know(copy: Path) -> None:
    from scope_ptz.simulator.truth import view_truth

    _edit(copy / "scene.json", lambda s: s["instances"].pop(0))
    with pytest.raises(PackError, match=r"shows instance 1, which scene\.json does not contain"):
        view_truth(Scene(copy), "mast", VIEW, 0.0)


def test_threads_share_one_scene(analytic_folder: Path) -> None:
    scene = Scene(analytic_folder)
    views = [Perspective(pan, -5.0, hfov, 96, 54) for pan in (-16.0, 0.0, 10.0, 18.0) for hfov in (14.0, 30.0, 71.0)] * 3
    with ThreadPoolExecutor(6) as pool:
        together = list(pool.map(lambda view: picture(scene, "mast", view, 3.0).tobytes(), views))
    alone = Scene(analytic_folder)
    assert together == [picture(alone, "mast", view, 3.0).tobytes() for view in views]


def test_layers_are_read_only(analytic_scene: Scene) -> None:
    viewpoint = analytic_scene.viewpoint("mast")
    layer = viewpoint.pictures.colour(viewpoint.manifest.base)
    with pytest.raises(ValueError, match="read-only"):
        layer[0, 0] = 0


def test_objects_with_a_common_parent_are_one_family(copy: Path) -> None:
    def parents(scene: Any) -> None:
        scene["instances"][0]["parent"] = "ball-02"
        scene["instances"][1]["parent"] = "block-03"

    _edit(copy / "scene.json", parents)
    scene = Scene(copy)
    assert scene.families["ball-01"] == scene.families["block-03"] == {1, 2, 3}
    assert scene.families["block-04"] == {4}
    assert scene.by_id["roller-50"] is scene.by_number[50]
