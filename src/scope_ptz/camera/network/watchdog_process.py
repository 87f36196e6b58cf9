"""A watchdog process that stops a driven camera if the driver's process is killed.

A process that is killed (``kill -9``, out of memory) cannot send a stop command, and a device whose protocol has no timeout would
keep moving. The watchdog therefore reads from a pipe, which the operating system closes when the driver's process ends for any
reason.
"""

from __future__ import annotations

import importlib
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from scope_ptz.errors import CameraError

if TYPE_CHECKING:
    from scope_ptz.camera.network.http import DeviceHttp

StopFunction = Callable[["DeviceHttp", Mapping[str, Any]], None]
"""A blocking, module-level function that stops a device, and raises ``CameraError`` if the command did not reach it."""

GIVE_UP_S = 600.0
"""Seconds after which the watchdog stops trying to reach a camera."""

_LONGEST_PAUSE_S = 2.0
_ARMED, _SAFE = b"armed\n", b"safe\n"


class WatchdogProcess:
    """A camera's watchdog process, which is started when the camera is first driven.

    Args:
        http: The HTTP connection to the device.
        stop: The function that stops the device.
        details: JSON-serialisable values that are passed to ``stop`` in addition to the connection.
    """

    def __init__(self, http: DeviceHttp, stop: StopFunction, details: Mapping[str, Any]) -> None:
        self._http, self._stop, self._details = http, stop, details
        self._process: subprocess.Popen[bytes] | None = None
        self._armed = False

    def arm(self) -> None:
        """Make the watchdog stop the camera if the driver's process ends."""
        if self._process is None:
            self._process = self._start()
        self._send(_ARMED)
        self._armed = True

    def disarm(self) -> None:
        """Record that the camera is stationary, so that the watchdog does not have to stop it."""
        if self._armed:
            self._armed = False
            self._send(_SAFE)

    def close(self) -> None:
        """End the watchdog process. If the camera may still be moving, the watchdog stops it before exiting."""
        process, self._process = self._process, None
        if process is None:
            return
        with suppress(OSError):
            assert process.stdin is not None  # noqa: S101 - it is a pipe
            process.stdin.close()
        if self._armed:
            threading.Thread(target=process.wait, name="watchdog process", daemon=True).start()
        else:
            process.kill()
            process.wait()

    def _start(self) -> subprocess.Popen[bytes]:
        # The request contains the password. It is sent through the pipe, because other users can read command lines.
        request = {
            "device": self._http.description(),
            "function": [self._stop.__module__, self._stop.__qualname__],
            "details": dict(self._details),
        }
        process = subprocess.Popen(
            [sys.executable, "-m", __name__],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            # Ctrl-C and closing the terminal signal all processes in the session; the watchdog must survive both.
            start_new_session=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)},
        )
        self._process = process
        self._send(json.dumps(request).encode() + b"\n")
        return process

    def _send(self, line: bytes) -> None:
        # If the watchdog has died, the camera is only as safe as it would be without one.
        with suppress(OSError):
            assert self._process is not None  # noqa: S101 - already started
            assert self._process.stdin is not None  # noqa: S101 - it is a pipe
            self._process.stdin.write(line)
            self._process.stdin.flush()


def main() -> None:
    """Read a stop request, wait until the parent process ends, and stop the camera if it may be moving."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    line = sys.stdin.buffer.readline()
    armed = False
    for state in sys.stdin.buffer:
        armed = state == _ARMED
    if armed:
        stop_with_retries(json.loads(line))


def stop_with_retries(request: Mapping[str, Any], *, give_up_s: float = GIVE_UP_S) -> bool:
    """Stop a camera, retrying until the command reaches it. Return False if it does not within ``give_up_s`` seconds."""
    from scope_ptz.camera.network.http import DeviceHttp

    module, name = request["function"]
    stop: StopFunction = getattr(importlib.import_module(module), name)
    http = DeviceHttp.from_description(request["device"])
    end_time_s, pause_s = time.monotonic() + give_up_s, 0.25
    while True:
        try:
            stop(http, request["details"])
        except CameraError:
            if time.monotonic() + pause_s > end_time_s:
                return False
            time.sleep(pause_s)
            pause_s = min(2 * pause_s, _LONGEST_PAUSE_S)
        else:
            return True


if __name__ == "__main__":
    main()
