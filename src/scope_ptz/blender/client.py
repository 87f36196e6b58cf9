"""The client for a Blender worker process."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from scope_ptz.errors import BlenderError

REPLY_PREFIX = "@scope "  # prefix of reply lines in the worker's output
START_TIMEOUT_S = 120.0
QUIT_TIMEOUT_S = 10.0
Progress = Callable[[int, int], None]
"""A callback that receives the number of finished steps and the total."""


class BlenderWorker:
    """A Blender worker process. It carries out one request at a time.

    Args:
        command: The command that starts the process.
        log_file: The file for Blender's messages.
    """

    def __init__(self, command: Sequence[str], log_file: Path) -> None:
        self._command = list(command)
        self._log_file = log_file
        self._lock = threading.Lock()
        self._replies: queue.Queue[dict[str, Any] | None] = queue.Queue()
        self._process: subprocess.Popen[str] | None = None
        self._listener: threading.Thread | None = None
        self._requests = 0
        self.version = ""

    def __enter__(self) -> BlenderWorker:
        self.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    @property
    def running(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def start(self) -> None:
        """Start the process and wait until Blender is ready.

        Raises:
            BlenderError: The process does not start in time.
        """
        self._log_file.parent.mkdir(parents=True, exist_ok=True)
        environment = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "VIRTUAL_ENV"))}
        try:
            with self._log_file.open("w") as log:
                self._process = subprocess.Popen(
                    self._command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, text=True, env=environment
                )
        except OSError as error:
            raise BlenderError(f"Blender could not be started with `{' '.join(self._command)}`: {error}.") from error
        if self._process.stdout is not None:
            self._listener = threading.Thread(target=self._listen, args=(self._process.stdout,), daemon=True)
            self._listener.start()
        self.version = str(self._next_reply(time.monotonic() + START_TIMEOUT_S, "start").get("hello", ""))

    def request(
        self, op: str, params: dict[str, Any] | None = None, *, timeout_s: float = 3600.0, progress: Progress | None = None
    ) -> Any:
        """Run an operation and return its result.

        Args:
            op: Name of the operation in ``scope_studio.operations``.
            params: The operation's arguments, as JSON data.
            timeout_s: Seconds after which the worker is killed.
            progress: Called with the number of finished steps and the total.

        Raises:
            BlenderError: The operation fails, or the worker crashes or does not answer in time.
        """
        with self._lock:
            if self._process is None or self._process.stdin is None:
                raise BlenderError("The Blender worker is not running.")
            self._requests += 1
            message = {"id": self._requests, "op": op, "params": params or {}}
            try:
                self._process.stdin.write(json.dumps(message) + "\n")
                self._process.stdin.flush()
            except OSError as error:
                raise self._exit_error(op) from error
            deadline = time.monotonic() + timeout_s
            while True:
                reply = self._next_reply(deadline, op)
                if "progress" in reply:
                    if progress is not None:
                        progress(*reply["progress"])
                elif "error" in reply:
                    raise BlenderError(f"The Blender worker could not execute '{op}': {reply['error']}")
                else:
                    return reply["result"]

    def close(self) -> None:
        """Ask the worker to quit. Kill it if it is busy or does not quit."""
        process = self._process
        if process is not None and process.poll() is None and process.stdin is not None and not self._lock.locked():
            with suppress(OSError, subprocess.TimeoutExpired):
                process.stdin.write(json.dumps({"id": 0, "op": "quit"}) + "\n")
                process.stdin.flush()
                process.wait(QUIT_TIMEOUT_S)
        self._kill()

    def _listen(self, pipe: IO[str]) -> None:
        for line in pipe:
            if line.startswith(REPLY_PREFIX):
                self._replies.put(json.loads(line[len(REPLY_PREFIX) :]))
        self._replies.put(None)

    def _next_reply(self, deadline: float, op: str) -> dict[str, Any]:
        try:
            reply = self._replies.get(timeout=max(0.0, deadline - time.monotonic()))
        except queue.Empty:
            self._kill()
            raise BlenderError(f"Blender did not finish '{op}' in time and was stopped. {self._log_tail()}") from None
        if reply is None:
            raise self._exit_error(op)
        return reply

    def _exit_error(self, op: str) -> BlenderError:
        self._kill()
        return BlenderError(f"Blender exited during '{op}'. {self._log_tail()}")

    def _kill(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        process.kill()
        process.wait()
        if self._listener is not None:
            self._listener.join(QUIT_TIMEOUT_S)
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                with suppress(OSError):
                    pipe.close()

    def _log_tail(self) -> str:
        lines = self._log_file.read_text(errors="replace").strip().splitlines()[-6:]
        return f"The end of its log ({self._log_file}):\n" + "\n".join(lines)
