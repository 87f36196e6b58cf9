"""Decoded pictures on disk: the same pixels without decoding, and nothing cached where that is unsafe."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from scope_ptz.errors import PackError
from scope_ptz.geometry import Perspective
from scope_ptz.simulator import layers
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.sheets import picture_cache
from scope_ptz.simulator.sheets.picture_cache import PictureCache
from scope_ptz.simulator.truth import view_truth
from scope_ptz.simulator.views import picture

pytestmark = pytest.mark.skipif(os.name == "nt", reason="nothing is kept on Windows")

VIEWS = [Perspective(0.0, -8.0, 71.0, 96, 54), Perspective(170.0, -5.0, 60.0, 96, 54), Perspective(2.0, -6.0, 8.0, 320, 180)]
SHAPE, COUNT = (64, 40), 64 * 40


@pytest.fixture
def copy(analytic_folder: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(analytic_folder, tmp_path / analytic_folder.name))


@pytest.fixture
def pictures(tmp_path: Path) -> PictureCache:
    return PictureCache(tmp_path / "pictures", "1")


@pytest.fixture
def undecodable(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Every attempt to decode a picture fails."""

    def refuse(path: Path) -> None:
        raise AssertionError(f"{path} was decoded")

    for name in ("read_colour", "read_ids", "read_coded_numbers"):
        monkeypatch.setattr(layers, name, refuse)
    yield


def seen(scene: Scene) -> list[bytes]:
    return [picture(scene, "mast", view, 3.0).tobytes() for view in VIEWS]


def digest(views: list[bytes]) -> str:
    return hashlib.sha256(b"".join(views)).hexdigest()


def test_the_next_scene_shows_the_same_pixels_and_decodes_nothing(
    copy: Path, pictures: PictureCache, request: pytest.FixtureRequest
) -> None:
    wanted = seen(Scene(copy))
    truth = view_truth(Scene(copy), "mast", VIEWS[0], 3.0)
    first = Scene(copy, picture_cache=pictures)
    assert seen(first) == wanted
    assert view_truth(first, "mast", VIEWS[0], 3.0) == truth
    request.getfixturevalue("undecodable")
    second = Scene(copy, picture_cache=pictures)
    assert seen(second) == wanted
    assert view_truth(second, "mast", VIEWS[0], 3.0) == truth


def test_a_damaged_file_is_reported_although_its_pixels_are_kept(copy: Path, pictures: PictureCache) -> None:
    seen(Scene(copy, picture_cache=pictures))
    base = next(copy.glob("mast/base.*"))
    base.write_bytes(base.read_bytes()[:-1] + b"x")
    with pytest.raises(PackError, match="damaged"):
        seen(Scene(copy, picture_cache=pictures))


def test_another_version_or_manifest_decodes_again(copy: Path, tmp_path: Path, pictures: PictureCache) -> None:
    seen(Scene(copy, picture_cache=pictures))
    files = set((tmp_path / "pictures").iterdir())
    seen(Scene(copy, picture_cache=PictureCache(tmp_path / "pictures", "2")))
    more = set((tmp_path / "pictures").iterdir())
    assert len(more) == 2 * len(files)
    manifest = copy / "mast" / "manifest.json"
    manifest.write_text(manifest.read_text() + "\n")
    seen(Scene(copy, picture_cache=pictures))
    assert set((tmp_path / "pictures").iterdir()) > more


def test_a_limit_on_memory_keeps_no_colour(copy: Path, tmp_path: Path, pictures: PictureCache) -> None:
    assert seen(Scene(copy, tile_bytes=1, picture_cache=pictures)) == seen(Scene(copy))
    unlimited = PictureCache(tmp_path / "others", "1")
    seen(Scene(copy, picture_cache=unlimited))
    sheets = [len(list((tmp_path / name).glob("*.sheet"))) for name in ("pictures", "others")]
    assert sheets[0] == sheets[1] - 1


@pytest.mark.parametrize("hindrance", ["a file in the way", "no room", "no locks"])
def test_nothing_is_cached_in_an_unusable_folder(
    hindrance: str, copy: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "pictures"
    if hindrance == "a file in the way":
        folder.write_text("")
    elif hindrance == "no room":
        monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=picture_cache.SPARE_BYTES))
    else:
        monkeypatch.setattr(picture_cache, "fcntl", None)
    assert seen(Scene(copy, picture_cache=PictureCache(folder, "1"))) == seen(Scene(copy))
    assert not folder.is_dir() or not list(folder.iterdir())


def test_incomplete_pictures_are_filled_again(copy: Path, tmp_path: Path, pictures: PictureCache) -> None:
    wanted = seen(Scene(copy, picture_cache=pictures))
    for listed in (tmp_path / "pictures").glob("*.list"):
        listed.write_text("")
    for blob in (tmp_path / "pictures").glob("*.blob"):
        blob.write_bytes(blob.read_bytes()[:-1])
    for sheet in list((tmp_path / "pictures").glob("*.sheet"))[:1]:
        os.truncate(sheet, 10)
    assert seen(Scene(copy, picture_cache=pictures)) == wanted


def test_a_sheet_of_another_size_loses_its_list(pictures: PictureCache, tmp_path: Path) -> None:
    sheet = pictures.sheet("a", SHAPE, np.uint8)
    assert sheet is not None
    with sheet.lock_for_filling():
        sheet.array[...] = 7
        sheet.mark_complete(0, 2)
    again = pictures.sheet("a", SHAPE, np.uint8)
    assert again is not None
    assert again.complete_pictures() == {(0, 2)}
    assert (again.array == 7).all()
    other = pictures.sheet("a", (SHAPE[0] * 2, SHAPE[1]), np.uint8)
    assert other is not None
    assert other.complete_pictures() == set()


def test_the_oldest_files_are_removed_first(pictures: PictureCache, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for age, name in enumerate(("new", "old", "older")):
        sheet = pictures.sheet(name, SHAPE, np.uint8)
        assert sheet is not None
        with sheet.lock_for_filling():
            sheet.array[...] = 1
            sheet.mark_complete(0, 0)
        os.utime(tmp_path / "pictures" / f"{name}.sheet", (1e9 - age, 1e9 - age))
    used = (tmp_path / "pictures" / "new.sheet").stat().st_blocks * 512
    monkeypatch.setattr(picture_cache, "MAX_BYTES", used)
    pictures.store_blob("more", b"x")
    assert {path.name for path in (tmp_path / "pictures").iterdir()} == {"new.sheet", "new.list", "more.blob"}


def test_threads_and_programs_fill_one_sheet_together(copy: Path, tmp_path: Path, pictures: PictureCache) -> None:
    wanted = seen(Scene(copy))
    program = """
import sys
from pathlib import Path
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.sheets.picture_cache import PictureCache
from tests.simulator.test_picture_cache import digest, seen
print(digest(seen(Scene(Path(sys.argv[1]), picture_cache=PictureCache(Path(sys.argv[2]), "1")))))
"""
    command = [sys.executable, "-c", program, str(copy), str(tmp_path / "pictures")]
    other = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=Path(__file__).parents[2])
    with ThreadPoolExecutor(3) as pool:
        results = list(pool.map(lambda _: seen(Scene(copy, picture_cache=pictures)), range(3)))
    out, _ = other.communicate(timeout=60)
    assert results == [wanted] * 3
    assert out.strip() == digest(wanted)
