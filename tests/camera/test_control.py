"""One controller at a time, within a process and between processes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from scope_ptz.camera.control import ControlHeldError, ControlLock
from scope_ptz.errors import OutputError

HOLDER = """
import sys
from pathlib import Path
from scope_ptz.camera.control import ControlLock
lock = ControlLock("yard camera", "10.0.0.7/1", Path(sys.argv[1]))
lock.acquire("console: anna")
print("held", flush=True)
sys.stdin.read()
"""


@pytest.fixture
def other(tmp_path: Path) -> subprocess.Popen[str]:
    """Another process that controls the camera until it is killed."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "held\n"
    return process


def _end(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.communicate()


def test_an_error_names_the_process_that_has_control(other: subprocess.Popen[str], tmp_path: Path) -> None:
    try:
        with pytest.raises(ControlHeldError, match="yard camera is controlled by console: anna") as caught:
            ControlLock("yard camera", "10.0.0.7/1", tmp_path).acquire("bob")
        assert caught.value.holder is not None
        assert str(other.pid) in caught.value.holder.process
        ControlLock("yard camera", "10.0.0.8/1", tmp_path).acquire("bob")
    finally:
        _end(other)


def test_control_ends_with_the_process_that_held_it(other: subprocess.Popen[str], tmp_path: Path) -> None:
    _end(other)
    lock = ControlLock("yard camera", "10.0.0.7/1", tmp_path)
    lock.acquire("bob")
    assert lock.holder is not None
    assert lock.holder.name == "bob"


def test_a_lock_can_be_taken_again_after_its_release(tmp_path: Path) -> None:
    first, second = (ControlLock("camera", "key", tmp_path) for _ in range(2))
    first.acquire("a")
    with pytest.raises(ControlHeldError, match="controlled by a "):
        second.acquire("b")
    first.release()
    first.release()
    second.acquire("b")
    with pytest.raises(ControlHeldError, match="controlled by b "):
        first.acquire("a")


@pytest.mark.parametrize("note", ["", "{", "[]", '{"name": 3}', '{"name": "x"}'])
def test_a_damaged_lock_file_still_gives_the_typed_error(tmp_path: Path, note: str) -> None:
    held = ControlLock("camera", "key", tmp_path)
    held.acquire("a")
    next(tmp_path.glob("*.json")).write_text(note)
    with pytest.raises(ControlHeldError, match="camera is controlled by"):
        ControlLock("camera", "key", tmp_path).acquire("b")


def test_a_folder_that_cannot_be_written_is_a_typed_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written"):
        ControlLock("camera", "key", tmp_path / "file").acquire("a")
