"""A process that stops a driven camera if this program is killed.

A killed program (``kill -9``, out of memory) runs no more code, and a device whose protocol has no timeout would keep moving. So
another process reads from a pipe, which the operating system closes when this program ends for any reason.
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
"""A module-level function that stops a device. It blocks, and raises ``CameraError`` if the command did not reach the device."""

GIVE_UP_S = 600.0
"""Seconds after which the process gives up trying to reach a camera."""

_LONGEST_PAUSE_S = 2.0
_ARMED, _SAFE = b"armed\n", b"safe\n"


class StopProcess:
    """The watchdog process of one camera. It is started when the camera is first driven.

    Args:
        http: The HTTP connection to the device.
        stop: The function that stops the device.
        details: The values that ``stop`` needs in addition to the connection. They must be JSON-serialisable.
    """

    def __init__(self, http: DeviceHttp, stop: StopFunction, details: Mapping[str, Any]) -> None:
        self._http, self._stop, self._details = http, stop, details
        self._process: subprocess.Popen[bytes] | None = None
        self._armed = False

    def arm(self) -> None:
        """Make the process stop the camera when this program ends."""
        if self._process is None:
            self._process = self._started()
        self._say(_ARMED)
        self._armed = True

    def disarm(self) -> None:
        """Record that the camera is stationary, so that it does not have to be stopped when this program ends."""
        if self._armed:
            self._armed = False
            self._say(_SAFE)

    def close(self) -> None:
        """End the process. If the camera may still be moving, the process keeps trying to stop it and then ends."""
        process, self._process = self._process, None
        if process is None:
            return
        with suppress(OSError):
            assert process.stdin is not None  # noqa: S101 - it is a pipe
            process.stdin.close()
        if self._armed:
            threading.Thread(target=process.wait, name="stop process", daemon=True).start()
        else:
            process.kill()
            process.wait()

    def _started(self) -> subprocess.Popen[bytes]:
        # The order contains the password, so it is sent through the pipe, because other users can read command lines.
        order = {
            "device": self._http.described(),
            "function": [self._stop.__module__, self._stop.__qualname__],
            "details": dict(self._details),
        }
        process = subprocess.Popen(
            [sys.executable, "-m", __name__],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            # Ctrl-C and a closed terminal reach all processes of a session, and this one must outlive them.
            start_new_session=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)},
        )
        self._process = process
        self._say(json.dumps(order).encode() + b"\n")
        return process

    def _say(self, line: bytes) -> None:
        # If someone has ended the process, the camera is no less safe than without it.
        with suppress(OSError):
            assert self._process is not None  # noqa: S101 - started before
            assert self._process.stdin is not None  # noqa: S101 - it is a pipe
            self._process.stdin.write(line)
            self._process.stdin.flush()


def main() -> None:
    """Read an order, wait for the end of the program, and stop the camera if it may be moving."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    line = sys.stdin.buffer.readline()
    armed = False
    for state in sys.stdin.buffer:
        armed = state == _ARMED
    if armed:
        carry_out(json.loads(line))


def carry_out(order: Mapping[str, Any], *, give_up_s: float = GIVE_UP_S) -> bool:
    """Stop a camera, and retry until the command reaches it. Return whether it did within ``give_up_s`` seconds."""
    from scope_ptz.camera.network.http import DeviceHttp

    module, name = order["function"]
    stop: StopFunction = getattr(importlib.import_module(module), name)
    http = DeviceHttp.from_description(order["device"])
    end_time_s, pause_s = time.monotonic() + give_up_s, 0.25
    while True:
        try:
            stop(http, order["details"])
        except CameraError:
            if time.monotonic() + pause_s > end_time_s:
                return False
            time.sleep(pause_s)
            pause_s = min(2 * pause_s, _LONGEST_PAUSE_S)
        else:
            return True


if __name__ == "__main__":
    main()
