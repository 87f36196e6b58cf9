"""A circuit breaker: a dead server is left alone for a while instead of costing a timeout at every call."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic

from scope_ptz.endpoints.failures import FailureKind, ServerFailure

K = FailureKind
DEAD = frozenset({K.REFUSED, K.DNS, K.TLS, K.CONNECT_TIMEOUT, K.FIRST_BYTE_TIMEOUT, K.TOTAL_TIMEOUT, K.CUT_OFF})
DEAD_STATUS = frozenset({502, 503, 504})


class Breaker:
    """Closed until ``threshold`` attempts in a row found the server dead; then open for ``pause_s``, which doubles up to
    ``longest_pause_s`` each time that the one request let through afterwards fails too.
    """

    def __init__(
        self,
        *,
        threshold: int = 3,
        pause_s: float = 10.0,
        longest_pause_s: float = 60.0,
        clock: Callable[[], float] = monotonic,
    ) -> None:
        self.threshold, self.pause_s, self.longest_pause_s, self.clock = threshold, pause_s, longest_pause_s, clock
        self._failures = 0
        self._open_until: float | None = None
        self._pause_s = pause_s
        self._probing = False
        self._last: ServerFailure | None = None

    @property
    def last(self) -> ServerFailure | None:
        """The failure that was seen last, None after a success."""
        return self._last

    def wait_s(self) -> float | None:
        """None when a request may go out now, which it then must report on; else for how long none may."""
        if self._open_until is None:
            return None
        left = self._open_until - self.clock()
        if left > 0 or self._probing:
            return max(left, 0.0)
        self._probing = True
        return None

    def succeeded(self) -> None:
        self._failures, self._open_until, self._pause_s, self._probing, self._last = 0, None, self.pause_s, False, None

    def failed(self, failure: ServerFailure) -> None:
        """Any answer but a dead server's shows that it lives."""
        if failure.kind not in DEAD and failure.status not in DEAD_STATUS:
            self.succeeded()
            return
        self._last = failure
        self._failures += 1
        if self._probing:
            self._pause_s = min(2 * self._pause_s, self.longest_pause_s)
        if self._probing or self._failures >= self.threshold:
            self._open_until = self.clock() + self._pause_s
        self._probing = False

    def abandoned(self) -> None:
        """The request was cancelled: nothing is known."""
        self._probing = False
