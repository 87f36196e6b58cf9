"""The process that stops a driven camera after the death of its program: when it acts, when not, and what it is told."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scope_ptz.camera.network.address import DeviceAddress
from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.network.http import DeviceHttp
from scope_ptz.camera.network.watchdog_process import WatchdogProcess, stop_with_retries
from scope_ptz.errors import CameraError

SECRET = "pass through the pipe"


def write_note(http: DeviceHttp, details: Mapping[str, Any]) -> None:
    """Stand in for a stop. It runs in the process, and fails as often as the details say."""
    attempts = Path(details["attempts"])
    done = int(attempts.read_text()) if attempts.is_file() else 0
    attempts.write_text(str(done + 1))
    if done < details["failures"]:
        raise CameraError("no link")
    Path(details["note"]).write_text(f"{http.address} {http.credentials.user} {http.credentials.password}")


def _process(folder: Path, failures: int = 0) -> WatchdogProcess:
    http = DeviceHttp(DeviceAddress("camera", 8080), Credentials("operator", SECRET))
    details = {"note": str(folder / "note"), "attempts": str(folder / "attempts"), "failures": failures}
    return WatchdogProcess(http, write_note, details)


def _wait_for(path: Path) -> str:
    for _ in range(600):
        if path.is_file() and path.read_text():
            return path.read_text()
        time.sleep(0.05)
    raise AssertionError(f"{path.name} was not written")


def test_it_stops_a_camera_that_may_be_moving(tmp_path: Path) -> None:
    process = _process(tmp_path)
    process.arm()
    started = process._process
    assert started is not None
    assert SECRET not in Path(f"/proc/{started.pid}/cmdline").read_text()
    assert SECRET not in Path(f"/proc/{started.pid}/environ").read_text()
    process.close()
    assert _wait_for(tmp_path / "note") == f"camera:8080 operator {SECRET}"


def test_it_does_nothing_to_a_camera_that_stands(tmp_path: Path) -> None:
    process = _process(tmp_path)
    process.arm()
    process.disarm()
    started = process._process
    process.close()
    assert started is not None
    assert started.returncode is not None
    assert not (tmp_path / "attempts").exists()


def test_it_is_not_started_for_a_camera_that_is_never_driven(tmp_path: Path) -> None:
    process = _process(tmp_path)
    process.disarm()
    assert process._process is None
    process.close()


def test_it_tries_again_and_gives_up_in_the_end(tmp_path: Path) -> None:
    device = DeviceHttp(DeviceAddress("camera", 80), Credentials("operator", SECRET)).description()
    details = {"note": str(tmp_path / "note"), "attempts": str(tmp_path / "attempts"), "failures": 2}
    order = {"device": device, "function": [__name__, "write_note"], "details": details}
    assert not stop_with_retries(order, give_up_s=0.0)
    assert stop_with_retries(order, give_up_s=5.0)
    assert (tmp_path / "attempts").read_text() == "3"


def test_it_acts_when_the_program_is_killed(tmp_path: Path) -> None:
    code = (
        "import os, signal, sys; from pathlib import Path\n"
        "from tests.camera.network.test_watchdog_process import _process\n"
        "process = _process(Path(sys.argv[1])); process.arm()\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    root = Path(__file__).parents[3]
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], cwd=root, check=False, timeout=60)
    assert SECRET in _wait_for(tmp_path / "note")
