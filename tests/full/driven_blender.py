"""A Blender process that ``addon_driver.py`` drives, with or without a window."""

from __future__ import annotations

import json
import os
import queue
import shutil
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from scope_ptz.blender.addon_zip import addon_folder
from scope_ptz.blender.environment import ensure_environment
from scope_ptz.settings import load_settings

DRIVER = Path(__file__).with_name("addon_driver.py")
START_TIMEOUT_S = 180.0
REPLY_TIMEOUT_S = 50.0  # shorter than the add-on's own timeouts, so that a main thread that waits for the network fails the test


class DrivenBlender:
    """A Blender process with the add-on.

    Args:
        command: The command that starts it.
        environment: Its environment variables.
    """

    def __init__(self, command: list[str], environment: dict[str, str]) -> None:
        self._process = subprocess.Popen(
            command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        self._lines: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._output: list[str] = []
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()
        self.version = self._reply("reply", START_TIMEOUT_S)["value"]

    def __call__(self, expression: str) -> Any:
        """Evaluate an expression in Blender, and return its value."""
        assert self._process.stdin is not None
        self._process.stdin.write(expression + "\n")
        self._process.stdin.flush()
        reply = self._reply("reply", REPLY_TIMEOUT_S)
        assert "error" not in reply, f"{expression}: {reply['error']}"
        return reply["value"]

    def wait_for(self, expression: str) -> None:
        """Wait until an expression is true in Blender."""
        deadline_s = time.monotonic() + 120.0
        while not self(expression):
            assert time.monotonic() < deadline_s, f"not true within 120 s: {expression}; {self('(session.state, session.problem)')}"
            time.sleep(0.05)

    def ask(self, instruction: str) -> Any:
        """Run an instruction, and return its outcome."""
        self(f"session.ask({instruction!r}, '')")
        self.wait_for("session.run is None")
        return self("session.end")

    def end(self) -> Any:
        """Let Blender remove the add-on and quit, and return what the driver reports."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        report = self._reply("end", REPLY_TIMEOUT_S)
        self._process.wait(60)
        self._listener.join(60)
        return report

    def kill(self) -> None:
        """Kill the process if it is still running."""
        self._process.kill()
        self._process.wait()
        self._listener.join(60)
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()

    def _listen(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._output.append(line)
            if line.startswith("@"):
                self._lines.put(line)

    def _reply(self, kind: str, timeout_s: float) -> Any:
        try:
            line = self._lines.get(timeout=timeout_s)
        except queue.Empty:
            raise AssertionError(f"Blender does not answer:\n{''.join(self._output)[-3000:]}") from None
        found, _, content = line.partition(" ")
        assert found == f"@{kind}", line
        return json.loads(content)


def environment(home: Path, **others: str) -> dict[str, str]:
    """Return environment variables for a Blender that shares no settings with the user's."""
    inherited = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "BLENDER", "SCOPE"))}
    return {**inherited, "HOME": str(home), "BLENDER_USER_RESOURCES": str(home / "blender"), "PYTHONUNBUFFERED": "1", **others}


def worker_python() -> Path:
    """Return the Python with the ``bpy`` module."""
    return ensure_environment(load_settings().cache_dir)


@contextmanager
def blender_without_window(home: Path) -> Iterator[DrivenBlender]:
    """Start the ``bpy`` module with the add-on."""
    blender = DrivenBlender([str(worker_python()), str(DRIVER), "--", str(addon_folder().parent)], environment(home))
    try:
        yield blender
    finally:
        blender.kill()


@contextmanager
def virtual_screen(size: str = "1500x900") -> Iterator[str]:
    """Start a virtual X server, and yield its display name. The server chooses a free number."""
    program = shutil.which("Xvfb")
    assert program is not None, "install xvfb"
    reading, writing = os.pipe()
    command = [program, "-displayfd", str(writing), "-screen", "0", f"{size}x24", "-nolisten", "tcp"]
    server = subprocess.Popen(command, stderr=subprocess.DEVNULL, pass_fds=(writing,))
    os.close(writing)
    try:
        with os.fdopen(reading) as numbers:
            number = numbers.readline().strip()  # empty if the server ends
        assert number, "the X server did not start"
        yield f":{number}"
    finally:
        server.terminate()
        server.wait(30)


@contextmanager
def blender_in_window(home: Path, display: str, *options: str, folder: Path | None = None) -> Iterator[DrivenBlender]:
    """Start the ``blender`` program in a window, with the add-on from a folder, or with the installed one."""
    program = shutil.which("blender")
    assert program is not None, "install blender"
    geometry = ["--window-geometry", "0", "0", "1500", "900"]
    folders = [] if folder is None else [str(folder)]
    command = [program, "--factory-startup", *options, *geometry, "--python", str(DRIVER), "--", *folders]
    blender = DrivenBlender(command, environment(home, DISPLAY=display, LIBGL_ALWAYS_SOFTWARE="1"))
    try:
        yield blender
    finally:
        blender.kill()


def screenshot(display: str, path: Path, size: str = "1500x900") -> None:
    """Save a screenshot of a display."""
    program = shutil.which("ffmpeg")
    assert program is not None, "install ffmpeg"
    grab = ["-f", "x11grab", "-video_size", size, "-i", display, "-frames:v", "1"]
    subprocess.run([program, "-y", "-loglevel", "error", *grab, str(path)], check=True, timeout=120)
