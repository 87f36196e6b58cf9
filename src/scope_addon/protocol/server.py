"""A ``scope`` server that the add-on starts and stops."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import threading
from contextlib import suppress
from pathlib import Path

from .errors import AddOnError

CAMERA = "blender-window"
"""The name of the camera on a server that the add-on starts."""

EXIT_TIMEOUT_S = 10.0
"""Seconds that the server has to exit before it is killed."""


class ServerProcess:
    """A server on a free port of this machine. It stops when Blender exits.

    Args:
        program: The ``scope`` program: its name or path.
        pairs: The pairs of models to offer, the default first; empty for the built-in pair.
        runs_dir: The folder for the runs.

    Raises:
        AddOnError: The program does not exist or cannot be started.
    """

    def __init__(self, program: str, pairs: list[str], runs_dir: Path) -> None:
        executable = shutil.which(str(Path(program).expanduser()))
        if executable is None:
            raise AddOnError(
                f"The program '{program}' was not found. Install it with pip install 'scope-ptz[serve]', and set its path in the "
                "preferences of the add-on."
            )
        command = [executable, "serve", "--camera", CAMERA, "--port", "0", "--json", "--until-eof", "--runs-dir", str(runs_dir)]
        for pair in pairs:
            command += ["--pair", pair]
        # Blender's own Python settings must not reach the program, which runs a different Python.
        environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        self._errors: list[str] = []
        self.url = ""
        """The address; empty until the server is ready."""
        self.problem = ""
        """Why the server stopped; empty while it runs."""
        try:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                env=environment,
                text=True,
                encoding="utf-8",
                errors="replace",
            )
        except OSError as error:
            raise AddOnError(f"The server cannot be started with {executable}: {error.strerror}.") from error
        self._threads = [
            threading.Thread(target=self._read_output, name="scope-server", daemon=True),
            threading.Thread(target=self._read_errors, name="scope-server-errors", daemon=True),
        ]
        for thread in reversed(self._threads):  # _read_output joins the errors thread, which must therefore start first
            thread.start()

    @property
    def running(self) -> bool:
        """Whether the process is running."""
        return self._process.poll() is None

    def stop(self) -> None:
        """Stop the server by closing its input, which also closes if Blender crashes."""
        self.problem = self.problem or "stopped"
        if self._process.stdin is not None:
            with suppress(OSError):
                self._process.stdin.close()

    def wait(self) -> None:
        """Wait until the server has exited; kill it after ``EXIT_TIMEOUT_S`` seconds."""
        try:
            self._process.wait(EXIT_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        for thread in self._threads:
            thread.join(EXIT_TIMEOUT_S)

    def _read_output(self) -> None:
        assert self._process.stdout is not None
        with self._process.stdout as output:
            for line in output:
                try:
                    self.url = str(json.loads(line)["url"])
                except (ValueError, KeyError, TypeError):
                    continue
        self._process.wait()
        self._threads[1].join(EXIT_TIMEOUT_S)
        texts = [line.strip(" │╭╮╰╯─\r\n") for line in self._errors]
        last = next((text for text in reversed(texts) if text), "")
        self.problem = self.problem or f"The server ended. {last[:400]}".strip()

    def _read_errors(self) -> None:
        assert self._process.stderr is not None
        with self._process.stderr as errors:
            for line in errors:
                self._errors = [*self._errors[-20:], line]
