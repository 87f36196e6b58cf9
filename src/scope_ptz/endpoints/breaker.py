"""A circuit breaker, which makes calls to an unavailable server fail immediately instead of waiting for a timeout."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic

from scope_ptz.endpoints.failures import FailureKind, ServerFailure

UNAVAILABLE = frozenset(
    {
        FailureKind.REFUSED,
        FailureKind.DNS,
        FailureKind.TLS,
        FailureKind.CONNECT_TIMEOUT,
        FailureKind.FIRST_BYTE_TIMEOUT,
        FailureKind.TOTAL_TIMEOUT,
        FailureKind.CUT_OFF,
    }
)
UNAVAILABLE_STATUS = frozenset({502, 503, 504})
"""Status codes that, like the failures in ``UNAVAILABLE``, show that the server or the connection to it is not working."""


class Breaker:
    """A circuit breaker, which opens after ``threshold`` consecutive server failures and then blocks requests.

    After ``pause_s`` seconds, it permits one request as a probe. If the probe fails too, the pause doubles, up to ``max_pause_s``.
    """

    def __init__(
        self,
        *,
        threshold: int = 3,
        pause_s: float = 10.0,
        max_pause_s: float = 60.0,
        clock: Callable[[], float] = monotonic,
    ) -> None:
        self.threshold, self.pause_s, self.max_pause_s, self.clock = threshold, pause_s, max_pause_s, clock
        self._failures = 0
        self._open_until: float | None = None
        self._pause_s = pause_s
        self._probing = False
        self._last: ServerFailure | None = None

    @property
    def last_failure(self) -> ServerFailure | None:
        """The last failure; None after a success."""
        return self._last

    def admit(self) -> float | None:
        """Admit a request and return None, or return the number of seconds until a request may be sent.

        If the request is admitted, the caller must report its outcome with ``record_success``, ``record_failure`` or
        ``record_cancellation``.
        """
        if self._open_until is None:
            return None
        left = self._open_until - self.clock()
        if left > 0 or self._probing:
            return max(left, 0.0)
        self._probing = True
        return None

    def record_success(self) -> None:
        """Record a successful request."""
        self._failures, self._open_until, self._pause_s, self._probing, self._last = 0, None, self.pause_s, False, None

    def record_failure(self, failure: ServerFailure) -> None:
        """Record a failed request. A failure that shows that the server is running counts as a success."""
        if failure.kind not in UNAVAILABLE and failure.status not in UNAVAILABLE_STATUS:
            self.record_success()
            return
        self._last = failure
        self._failures += 1
        if self._probing:
            self._pause_s = min(2 * self._pause_s, self.max_pause_s)
        if self._probing or self._failures >= self.threshold:
            self._open_until = self.clock() + self._pause_s
        self._probing = False

    def record_cancellation(self) -> None:
        """Record a cancelled request, which says nothing about the state of the server."""
        self._probing = False
