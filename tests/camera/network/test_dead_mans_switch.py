"""The dead man's switch stops a camera in time, again and again until it arrives, and leaves no thread."""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path

from scope_ptz.camera.network.dead_mans_switch import DeadMansSwitch
from scope_ptz.errors import CameraError


class _Camera:
    def __init__(self, failures: int = 0) -> None:
        self.failures, self.attempts = failures, 0
        self.stopped = threading.Event()

    def stop(self) -> None:
        self.attempts += 1
        if self.attempts <= self.failures:
            raise CameraError("no link")
        self.stopped.set()


def test_it_stops_after_the_timeout() -> None:
    camera = _Camera()
    watch = DeadMansSwitch("test", camera.stop)
    watch.arm(0.05)
    assert watch.is_armed
    assert camera.stopped.wait(5)
    watch.join()
    assert not watch.is_armed
    assert camera.attempts == 1


def test_it_does_not_stop_a_camera_that_was_stopped() -> None:
    camera = _Camera()
    watch = DeadMansSwitch("test", camera.stop)
    watch.arm(0.1)
    watch.disarm()
    watch.join()
    assert not camera.stopped.wait(0.2)


def test_it_tries_until_the_stop_arrives() -> None:
    camera = _Camera(failures=3)
    watch = DeadMansSwitch("test", camera.stop, retry_s=0.01)
    watch.arm(0.01)
    assert camera.stopped.wait(5)
    assert camera.attempts == 4


def test_it_gives_up_in_the_end() -> None:
    camera = _Camera(failures=10**6)
    watch = DeadMansSwitch("test", camera.stop, retry_s=0.01, give_up_s=1.0)
    watch.arm(0.01)
    watch.join()
    assert not watch.is_armed
    assert camera.attempts > 1


def test_a_renewed_drive_moves_the_deadline() -> None:
    camera = _Camera()
    watch = DeadMansSwitch("test", camera.stop)
    for _ in range(10):
        watch.arm(0.5)
        assert not camera.stopped.wait(0.05)
    watch.arm(60.0)
    watch.stop_now()
    assert camera.stopped.wait(5)


def test_it_stops_at_the_end_of_the_process(tmp_path: Path) -> None:
    code = (
        "import sys; from pathlib import Path; from scope_ptz.camera.network.dead_mans_switch import DeadMansSwitch\n"
        "watch = DeadMansSwitch('test', lambda: Path(sys.argv[1]).write_text('stopped'))\n"
        "watch.arm(10.0)\n"
        "raise RuntimeError('the program breaks')\n"
    )
    note = tmp_path / "note"
    subprocess.run([sys.executable, "-c", code, str(note)], check=False, capture_output=True, timeout=30)
    assert note.read_text() == "stopped"
