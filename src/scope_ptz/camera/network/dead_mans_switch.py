"""A dead man's switch for cameras that do not stop on their own."""

from __future__ import annotations

import atexit
import logging
import threading
from collections.abc import Callable
from contextlib import suppress
from time import monotonic

from scope_ptz.camera.network.watchdog_process import WatchdogProcess
from scope_ptz.errors import CameraError

LONGEST_PAUSE_S = 2.0
"""Maximum pause in seconds between attempts to stop a camera."""

_LOG = logging.getLogger(__name__)


class DeadMansSwitch:
    """Stops a driven camera when the drive is not renewed in time or the process exits.

    It runs in a thread and uses a separate connection, so it works even if the event loop is busy, blocked or closed. The thread
    exists only while the camera is being driven. If the process is killed, ``watchdog`` stops the camera. If the machine loses
    power, nothing stops the camera.

    Args:
        name: The camera's name, for the log.
        send_stop: A blocking function that sends the stop command and waits for the acknowledgement. It is called from the thread.
        watchdog: The watchdog process, which stops the camera if the current process is killed; None if there is none.
        retry_s: Seconds before the first retry. The pause doubles with each retry, up to ``LONGEST_PAUSE_S``.
        give_up_s: Seconds after which no further attempt is made.
    """

    def __init__(
        self,
        name: str,
        send_stop: Callable[[], None],
        *,
        watchdog: WatchdogProcess | None = None,
        retry_s: float = 0.25,
        give_up_s: float = 600.0,
    ) -> None:
        self._name, self._send_stop, self._watchdog = name, send_stop, watchdog
        self._retry_s, self._give_up_s = retry_s, give_up_s
        self._condition = threading.Condition()
        self._deadline_s: float | None = None
        self._handed_over = False  # whether the watchdog process alone is still trying to stop the camera
        self._thread: threading.Thread | None = None

    @property
    def is_armed(self) -> bool:
        """Whether the camera may be in a continuous move."""
        return self._deadline_s is not None

    def arm(self, timeout_s: float) -> None:
        """Schedule a stop after the timeout, unless ``arm`` or ``disarm`` is called first. Call this before sending the drive."""
        with self._condition:
            if self._watchdog is not None:
                self._watchdog.arm()
            self._deadline_s = monotonic() + timeout_s
            if self._thread is None:
                self._thread = threading.Thread(target=self._watch, name=f"drive watch {self._name}", daemon=True)
                self._thread.start()
                atexit.register(self._stop_at_exit)
            self._condition.notify_all()

    def disarm(self) -> None:
        """Record that the camera has acknowledged a stop."""
        with self._condition:
            self._record_stop()
            self._condition.notify_all()

    def stop_now(self) -> None:
        """Make the thread send a stop immediately. This call does not wait for the thread."""
        with self._condition:
            if self._deadline_s is not None:
                self._deadline_s = monotonic()
                self._condition.notify_all()

    def join(self, timeout_s: float = 5.0) -> None:
        """Block until the thread has ended, which it does once the camera has stopped."""
        if (thread := self._thread) is not None:
            thread.join(timeout_s)

    def close(self, timeout_s: float = 5.0) -> None:
        """Stop the camera if it is being driven, and release all resources. This call blocks.

        If the camera cannot be reached within the timeout, ``watchdog`` keeps trying.
        """
        self.stop_now()
        self.join(timeout_s)
        if self._watchdog is not None:
            with self._condition:
                self._handed_over = True
                self._condition.notify_all()
            self.join(timeout_s)
            self._watchdog.close()

    def _record_stop(self) -> None:
        self._deadline_s = None
        if self._watchdog is not None:
            self._watchdog.disarm()

    def _watch(self) -> None:
        """Wait for each deadline, and then send stops until one is acknowledged. This runs in the thread."""
        pause_s = self._retry_s
        while True:
            with self._condition:
                while self._deadline_s is not None and (remaining_s := self._deadline_s - monotonic()) > 0:
                    self._condition.wait(remaining_s)
                due_s = self._deadline_s
                if due_s is None or self._handed_over:
                    self._thread = None
                    atexit.unregister(self._stop_at_exit)
                    return
            sent = self._try_to_stop(level=logging.WARNING if pause_s == self._retry_s else logging.DEBUG)
            with self._condition:
                if self._deadline_s != due_s:
                    pause_s = self._retry_s
                    continue  # driven again, or stopped by another call
                if sent:
                    self._record_stop()
                elif monotonic() - due_s > self._give_up_s:
                    _LOG.error("%s has not responded for %g s and may still be moving.", self._name, self._give_up_s)
                    self._deadline_s = None
                else:
                    self._condition.wait(pause_s)
                    pause_s = min(2 * pause_s, max(self._retry_s, LONGEST_PAUSE_S))

    def _try_to_stop(self, level: int) -> bool:
        try:
            self._send_stop()
        except CameraError as error:
            _LOG.log(level, "The stop command for %s failed and will be retried: %s", self._name, error)
            return False
        return True

    def _stop_at_exit(self) -> None:
        if self.is_armed:
            with suppress(CameraError):
                self._send_stop()
                self._record_stop()
