"""A dead man's switch for cameras that do not stop by themselves."""

from __future__ import annotations

import atexit
import logging
import threading
from collections.abc import Callable
from contextlib import suppress
from time import monotonic

from scope_ptz.errors import CameraError

_LOG = logging.getLogger(__name__)


class DriveWatch:
    """Sends a stop when a drive is not renewed in time, and when the process ends.

    It runs in a thread with a connection of its own, so it works when the event loop is busy, blocked or gone. The thread
    exists only while the camera is driven. Nothing helps against a process that is killed or a machine that loses power.

    Args:
        name: The camera's name, for the log.
        send_stop: Sends the stop and returns when the camera has acknowledged it. It runs in the thread.
        retry_s: Seconds between two attempts while the camera cannot be reached.
        give_up_s: Seconds after which no further attempt is made.
    """

    def __init__(self, name: str, send_stop: Callable[[], None], *, retry_s: float = 0.25, give_up_s: float = 60.0) -> None:
        self._name, self._send_stop = name, send_stop
        self._retry_s, self._give_up_s = retry_s, give_up_s
        self._condition = threading.Condition()
        self._deadline_s: float | None = None
        self._thread: threading.Thread | None = None

    @property
    def armed(self) -> bool:
        """Whether the camera may be moving at a velocity."""
        return self._deadline_s is not None

    def arm(self, timeout_s: float) -> None:
        """Send a stop after the timeout, unless ``arm`` or ``disarm`` is called before. Call it before the drive is sent."""
        with self._condition:
            self._deadline_s = monotonic() + timeout_s
            if self._thread is None:
                self._thread = threading.Thread(target=self._watch, name=f"drive watch {self._name}", daemon=True)
                self._thread.start()
                atexit.register(self._stop_at_exit)
            self._condition.notify_all()

    def disarm(self) -> None:
        """The camera has acknowledged a stop."""
        with self._condition:
            self._deadline_s = None
            self._condition.notify_all()

    def stop_now(self) -> None:
        """Let the thread send a stop at once. The call does not wait for it."""
        with self._condition:
            if self._deadline_s is not None:
                self._deadline_s = monotonic()
                self._condition.notify_all()

    def join(self, timeout_s: float = 5.0) -> None:
        """Wait until the thread has ended, which it does when the camera has stopped. It blocks."""
        if (thread := self._thread) is not None:
            thread.join(timeout_s)

    def _watch(self) -> None:
        while True:
            with self._condition:
                while self._deadline_s is not None and (left_s := self._deadline_s - monotonic()) > 0:
                    self._condition.wait(left_s)
                due_s = self._deadline_s
                if due_s is None:
                    self._thread = None
                    atexit.unregister(self._stop_at_exit)
                    return
            sent = self._try_to_stop()
            with self._condition:
                if self._deadline_s != due_s:
                    continue  # driven again, or stopped by somebody else
                if sent:
                    self._deadline_s = None
                elif monotonic() - due_s > self._give_up_s:
                    _LOG.error("%s does not answer for %g s and may still be moving.", self._name, self._give_up_s)
                    self._deadline_s = None
                else:
                    self._condition.wait(self._retry_s)

    def _try_to_stop(self) -> bool:
        try:
            self._send_stop()
        except CameraError as error:
            _LOG.warning("The stop of %s did not arrive and is sent again: %s", self._name, error)
            return False
        return True

    def _stop_at_exit(self) -> None:
        if self.armed:
            with suppress(CameraError):
                self._send_stop()
