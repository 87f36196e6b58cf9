"""The client of the Blender worker: replies, failures, crashes and timeouts."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from scope_ptz.blender.client import BlenderWorker
from scope_ptz.blender.environment import worker_command
from scope_ptz.errors import BlenderError

ECHO = [sys.executable, str(Path(__file__).with_name("echo_worker.py"))]


@pytest.fixture
def worker(tmp_path: Path) -> Iterator[BlenderWorker]:
    with BlenderWorker(ECHO, tmp_path / "worker.log") as started:
        yield started


def test_replies_are_distinguished_from_other_output(worker: BlenderWorker) -> None:
    seen: list[tuple[int, int]] = []
    assert worker.version == "5.0.1"
    assert worker.request("echo", {"a": 1}, progress=lambda done, total: seen.append((done, total))) == {"a": 1}
    assert seen == [(1, 2)]


def test_a_failed_operation_leaves_the_worker_usable(worker: BlenderWorker) -> None:
    with pytest.raises(BlenderError, match="no such thing"):
        worker.request("fail")
    assert worker.request("echo", {"b": 2}) == {"b": 2}


def test_a_crash_shows_the_end_of_the_log(worker: BlenderWorker) -> None:
    with pytest.raises(BlenderError, match="Segmentation fault, so to say"):
        worker.request("crash")
    assert not worker.running
    with pytest.raises(BlenderError, match="not running"):
        worker.request("echo")


def test_a_worker_that_takes_too_long_is_terminated(worker: BlenderWorker) -> None:
    with pytest.raises(BlenderError, match="in time"):
        worker.request("sleep", timeout_s=0.2)
    assert not worker.running


def test_a_command_that_does_not_exist_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(BlenderError, match="could not be started"):
        BlenderWorker([str(tmp_path / "none")], tmp_path / "worker.log").start()


def test_the_command_names_a_missing_program(tmp_path: Path) -> None:
    with pytest.raises(BlenderError, match="no program"):
        worker_command(tmp_path, tmp_path / "blender")


def test_the_blender_program_is_started_in_background_mode(tmp_path: Path) -> None:
    program = tmp_path / "blender"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    command = worker_command(tmp_path, program)
    assert command[0] == str(program)
    assert "--background" in command
    assert command[-1].endswith("worker.py")
