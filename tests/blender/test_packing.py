"""From rendered parts to files: the part cache, layer encodings, sprite sheets, and the size limit of a pack."""

import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from scope_ptz.blender import sources
from scope_ptz.blender.band import Panorama
from scope_ptz.blender.keyframes import Keyframe
from scope_ptz.blender.pack_writer import RenderedActor, RenderedTile, RenderedViewpoint, folder_size_bytes, write_pack
from scope_ptz.blender.part_cache import PartCache
from scope_ptz.blender.quality import FAR_M, NEAR_M, QUALITIES
from scope_ptz.blender.sheets import make_sheet
from scope_ptz.blender.sources import scene_key
from scope_ptz.errors import BlenderError, PackError
from scope_ptz.geometry import Perspective
from scope_ptz.simulator.layers import decode_depth, encode_depth, read_colour, read_ids, write_colour, write_ids
from scope_ptz.simulator.models import Band, Extent, SceneFile, ScenePreset, SceneViewpoint
from scope_ptz.simulator.pack import Scene

HERE = SceneViewpoint(name="mast", position_m=(0, 0, 6), pan0_bearing_deg=0)
SCENE = SceneFile(
    name="yard", title="Yard", version="1", blender_version="5", viewpoints=[HERE], instances=[], texts=[],
    presets=[ScenePreset(name="home", viewpoint="mast", pan_deg=0, tilt_deg=0, zoom=1)], home_preset="home",
)  # fmt: skip


def silent(part: str, done: int, total: int, seconds: float) -> None:
    """A progress callback that does nothing."""


def smooth_noise(height: int, width: int) -> NDArray[np.uint8]:
    grain = np.random.default_rng(1).normal(0, 1, (height, width, 3)).cumsum(axis=0).cumsum(axis=1)
    return np.asarray(128 + 100 * np.sin(grain / 40), dtype=np.uint8)


@pytest.mark.parametrize("suffix", [".png", ".webp"])
def test_instance_ids_are_stored_exactly(tmp_path: Path, suffix: str) -> None:
    numbers = np.random.default_rng(1).integers(0, 65536, (40, 60)).astype(np.uint16)
    path = tmp_path / f"ids{suffix}"
    write_ids(path, numbers)
    assert np.array_equal(read_ids(path), numbers)
    assert read_ids(path).dtype == np.uint16


@pytest.mark.parametrize("suffix", [".png", ".webp", ".avif"])
@pytest.mark.parametrize("channels", [3, 4])
def test_colours_are_stored_approximately(tmp_path: Path, suffix: str, channels: int) -> None:
    picture = smooth_noise(64, 80)
    if channels == 4:
        picture = np.dstack([picture, np.full((64, 80), 130, dtype=np.uint8)])
        picture[:8, :, 3] = 0
    path = tmp_path / f"colour{suffix}"
    write_colour(path, picture, 90)
    back = read_colour(path)
    assert back.shape == picture.shape
    shown = picture[8:].astype(int)
    assert np.abs(back[8:].astype(int) - shown).mean() < 6


def test_distances_have_a_bounded_relative_error_and_sky_is_kept() -> None:
    metres = np.array([[0.0, np.inf, 0.31, 7.0, 500.0, 19999.0]])
    for step in (1, 48):
        codes = encode_depth(metres, NEAR_M, FAR_M, step)
        back = decode_depth(codes, NEAR_M, FAR_M)
        assert list(codes[0, :2]) == [0, 0] and np.isinf(back[0, :2]).all()
        assert np.abs(back[0, 2:] / metres[0, 2:] - 1).max() < 1e-4 * step


def test_an_invalid_picture_is_a_pack_error(tmp_path: Path) -> None:
    (tmp_path / "base.webp").write_bytes(b"not at all")
    with pytest.raises(PackError, match="decoded"):
        read_colour(tmp_path / "base.webp")
    with pytest.raises(PackError, match="unsupported format"):
        read_ids(tmp_path / "ids.tiff")


@pytest.mark.parametrize("suffix", [".png", ".webp"])
@pytest.mark.parametrize("share", [0.0, 0.02, 0.5])
def test_truncated_instance_ids_are_a_pack_error(tmp_path: Path, suffix: str, share: float) -> None:
    numbers = np.random.default_rng(1).integers(0, 65536, (40, 60)).astype(np.uint16)
    path = tmp_path / f"ids{suffix}"
    write_ids(path, numbers)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(PackError, match="cannot be decoded"):
        read_ids(path)


def test_missing_instance_ids_are_a_pack_error(tmp_path: Path) -> None:
    for name in ("ids.png", "ids.webp"):
        with pytest.raises(PackError, match="cannot be decoded"):
            read_ids(tmp_path / name)


def test_a_finished_part_is_not_rendered_again(tmp_path: Path) -> None:
    made: list[Path] = []

    def produce(path: Path) -> None:
        made.append(path)
        path.write_text("x")

    for parameters in ({"n": 1}, {"n": 1}, {"n": 2}):
        assert PartCache(tmp_path, "yard-1", silent).part("mast/base", ".txt", parameters, produce).read_text() == "x"
    assert len(made) == 2


def test_an_incomplete_part_does_not_count(tmp_path: Path) -> None:
    def cut_off(path: Path) -> None:
        path.write_text("half")
        raise KeyboardInterrupt

    cache = PartCache(tmp_path, "yard-1", silent)
    with pytest.raises(KeyboardInterrupt):
        cache.part("base", ".txt", {}, cut_off)

    def finish(path: Path) -> None:
        path.write_text("whole")

    assert cache.part("base", ".txt", {}, finish).read_text() == "whole"


def test_the_key_depends_on_the_code_of_the_scene(tmp_path: Path) -> None:
    source = tmp_path / "my_yard.py"
    source.write_text("a = 1\n")
    before = scene_key(str(source))
    assert before.startswith("my-yard-") and before == scene_key(str(source))
    source.write_text("a = 2\n")
    assert scene_key(str(source)) != before


def test_the_key_depends_only_on_modules_that_the_scene_imports(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    studio = tmp_path / "studio"
    (studio / "kit").mkdir(parents=True)
    (studio / "scenes").mkdir()
    (studio / "kit" / "cones.py").write_text("from scope_studio.kit import plastic\n")
    (studio / "kit" / "plastic.py").write_text("colour = 'red'\n")
    (studio / "kit" / "boats.py").write_text("length_m = 7\n")
    (studio / "scenes" / "my_road.py").write_text("from scope_studio.kit.cones import cone\n")
    monkeypatch.setattr(sources, "studio_folder", lambda: studio)
    before = scene_key("my-road")
    (studio / "kit" / "boats.py").write_text("length_m = 8\n")
    assert scene_key("my-road") == before
    (studio / "kit" / "plastic.py").write_text("colour = 'blue'\n")
    assert scene_key("my-road") != before


def test_the_modelling_package_is_found_without_importing_it() -> None:
    assert (sources.studio_folder() / "worker.py").is_file()
    assert "scope_studio" not in sys.modules
    assert "highway-works" in sources.scene_names()


def test_a_missing_modelling_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(BlenderError, match="scope-studio is not installed"):
        sources.scene_names()


def sprite_frames(folder: Path) -> list[Keyframe]:
    frames = []
    for k in range(3):
        view = Perspective(10.0 * k, -10.0, 4.0, 60 + 20 * k, 40)
        picture = np.zeros((40, view.width, 4), dtype=np.uint8)
        picture[10:30, 10:40] = (200, 40, 40, 255)
        picture[30:34, 10:50] = (0, 0, 0, 140)
        metres = np.where(picture[..., 0] > 0, 25.0, 0.0).astype(np.float32)
        write_colour(folder / f"{k:03d}.png", picture, 0)
        np.savez(folder / f"{k:03d}.npz", depth=metres)
        frames.append(Keyframe(float(k), 0.0, (0.0, 20.0, 0.0), view))
    return frames


def test_a_sprite_sheet_has_bodies_and_shadows_side_by_side(tmp_path: Path) -> None:
    sheet = make_sheet(sprite_frames(tmp_path), tmp_path)
    assert sheet.colour.shape == (40, 240, 4) and sheet.depth.shape == (40, 240)
    for sprite in sheet.sprites:
        own = sheet.colour[sprite.top : sprite.top + sprite.height, sprite.left : sprite.left + sprite.width]
        codes = sheet.depth[sprite.top : sprite.top + sprite.height, sprite.left : sprite.left + sprite.width]
        assert tuple(own[20, 20]) == (200, 40, 40, 255)
        assert 0 < own[32, 25, 3] < 140, "light that passes a shadow counts for more on display values"
        assert decode_depth(codes, NEAR_M, FAR_M)[20, 20] == pytest.approx(25, rel=0.01)
        assert codes[32, 25] == 0


def rendered(tmp_path: Path, tiles: int) -> RenderedViewpoint:
    panorama = Panorama.of(360, Band(top_tilt_deg=59, bottom_tilt_deg=-90))
    ids = np.zeros((panorama.height, 360), dtype=np.uint16)
    view = Perspective(10, -5, 8, 300, 200)
    return RenderedViewpoint(
        panorama=panorama,
        base=smooth_noise(panorama.height, 360),
        ids=ids,
        depth=ids,
        tiles=[RenderedTile(view, smooth_noise(200, 300), np.ones((200, 300), dtype=np.uint16)) for _ in range(tiles)],
        actors=[RenderedActor(60, make_sheet(sprite_frames(tmp_path), tmp_path), None)],
        extents=[Extent(number=1, solid_angle_sr=0.1, hull=[(0, 0), (1, 0), (0, 1)], distance_m=4)],
    )


def test_a_written_pack_can_be_read(tmp_path: Path) -> None:
    folder = tmp_path / "yard" / "mast"
    folder.parent.mkdir()
    manifest = write_pack(folder, SCENE, HERE, rendered(tmp_path, 2), QUALITIES["draft"], 2_000_000, lambda: None)
    (folder.parent / "scene.json").write_text(SCENE.model_dump_json())
    here = Scene(folder.parent).viewpoint("mast")
    assert here.manifest == manifest
    assert here.pictures.colour(manifest.base).shape == (149, 360, 3)
    assert here.pictures.numbers(manifest.tiles[1].ids).min() == 1
    assert here.pictures.colour(manifest.actors[0].colour).shape[2] == 4
    assert not list(folder.parent.glob(".*"))


@pytest.mark.full
def test_tiles_are_encoded_at_lower_quality_only_until_the_pack_fits(tmp_path: Path) -> None:
    parts = rendered(tmp_path, 6)
    sizes = []
    for k, limit in enumerate((2_000_000, 290_000)):
        folder = tmp_path / f"pack-{k}"
        write_pack(folder, SCENE, HERE, parts, QUALITIES["standard"], limit, lambda: None)
        sizes.append(folder_size_bytes(folder))
    assert sizes[1] < sizes[0]
    with pytest.raises(BlenderError, match="lowest quality"):
        write_pack(tmp_path / "pack-3", SCENE, HERE, parts, QUALITIES["standard"], 20_000, lambda: None)
    assert not (tmp_path / "pack-3").exists()
