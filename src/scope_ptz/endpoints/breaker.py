"""A circuit breaker: a dead server is not asked for a while, instead of causing a timeout in every call."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic

from scope_ptz.endpoints.failures import FailureKind, ServerFailure

K = FailureKind
DEAD = frozenset({K.REFUSED, K.DNS, K.TLS, K.CONNECT_TIMEOUT, K.FIRST_BYTE_TIMEOUT, K.TOTAL_TIMEOUT, K.CUT_OFF})
DEAD_STATUS = frozenset({502, 503, 504})


class Breaker:
    """Opens when ``threshold`` consecutive attempts found the server dead.

    It stays open for ``pause_s``, then lets one request through. Each time that this request fails, too, the pause doubles, up to
    ``longest_pause_s``.
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
        """The last failure, None after a success."""
        return self._last

    def wait_s(self) -> float | None:
        """Return how many seconds no request may be sent; None if one may be sent now. Its outcome must then be reported."""
        if self._open_until is None:
            return None
        left = self._open_until - self.clock()
        if left > 0 or self._probing:
            return max(left, 0.0)
        self._probing = True
        return None

    def succeeded(self) -> None:
        """Report a successful request."""
        self._failures, self._open_until, self._pause_s, self._probing, self._last = 0, None, self.pause_s, False, None

    def failed(self, failure: ServerFailure) -> None:
        """Report a failed request. A failure that only a living server can cause counts as a success."""
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
        """Report a cancelled request, which shows nothing about the server."""
        self._probing = False
