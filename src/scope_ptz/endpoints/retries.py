"""Call a model server with bounded retries, full jitter, a deadline for all attempts together, and a circuit breaker."""

from __future__ import annotations

import random
from collections.abc import Awaitable, Callable
from time import perf_counter
from typing import TypeVar

import anyio

from scope_ptz.endpoints.breaker import Breaker
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import Attempt, FailureKind, ServerFailure
from scope_ptz.endpoints.translate import as_failure

T = TypeVar("T")

RETRYABLE = frozenset(
    {
        FailureKind.REFUSED,
        FailureKind.DNS,
        FailureKind.CONNECT_TIMEOUT,
        FailureKind.FIRST_BYTE_TIMEOUT,
        FailureKind.RATE_LIMITED,
        FailureKind.SERVER_ERROR,
        FailureKind.ERROR_BODY,
        FailureKind.CUT_OFF,
        FailureKind.EMPTY,
        FailureKind.MALFORMED,
    }
)
"""Failure kinds after which a call is retried. With a wrong key, path, request or content type, a retry would fail again."""

FIRST_PAUSE_S = 0.5  # upper bound of the random pause before the first retry; doubles with each further retry
MAX_PAUSE_S = 8.0  # maximum value of that bound
MAX_RETRY_AFTER_S = 30.0
"""Maximum pause in seconds that a server may request. If it requests a longer pause, the call fails."""


class Caller:
    """Calls an endpoint with retries. All calls to an endpoint, including concurrent calls, should share one caller."""

    def __init__(
        self,
        endpoint: Endpoint,
        *,
        sleep: Callable[[float], Awaitable[None]] = anyio.sleep,
        rng: random.Random | None = None,
        breaker: Breaker | None = None,
    ) -> None:
        self.endpoint, self.sleep = endpoint, sleep
        self.rng, self.breaker = rng or random.Random(), breaker or Breaker()

    async def call(self, attempt: Callable[[], Awaitable[T]]) -> tuple[T, tuple[Attempt, ...]]:
        """Run ``attempt``, and retry it after retryable failures. Return its result and all attempts.

        Raises:
            ServerFailure: No attempt succeeded. ``history`` lists the attempts.
        """
        attempts_made: list[Attempt] = []
        deadline = perf_counter() + self.endpoint.timeouts.total_s
        waited_s = 0.0
        while True:
            result = await self._try(attempt, deadline, waited_s, attempts_made)
            if not isinstance(result, ServerFailure):
                return result, tuple(attempts_made)
            pause_s = self._pause_s(result, len(attempts_made))
            if pause_s is None or perf_counter() + pause_s + self._retry_time_s(result) >= deadline:
                raise result.with_history(attempts_made)
            await self.sleep(pause_s)
            waited_s = pause_s

    async def _try(
        self, attempt: Callable[[], Awaitable[T]], deadline: float, waited_s: float, attempts_made: list[Attempt]
    ) -> T | ServerFailure:
        """Make and record an attempt.

        A failure is returned instead of raised, so that no library exception, which may quote a key, is chained to it.
        """
        open_for_s = self.breaker.admit()
        if open_for_s is not None:
            attempts_made.append(Attempt(kind=FailureKind.CIRCUIT_OPEN, waited_s=waited_s))
            return self._circuit_open(open_for_s)
        began = perf_counter()
        failure: ServerFailure | None = None
        reported = False
        try:
            with anyio.move_on_after(deadline - began) as limit:
                try:
                    result = await attempt()
                except Exception as error:
                    failure = as_failure(error, self.endpoint)
                    if failure is None:
                        raise
                else:
                    self.breaker.record_success()
                    reported = True
                    attempts_made.append(Attempt(seconds=perf_counter() - began, waited_s=waited_s))
                    return result
            if limit.cancelled_caught:
                detail = f"the limit is {self.endpoint.timeouts.total_s:g} s"
                failure = ServerFailure(FailureKind.TOTAL_TIMEOUT, where=self.endpoint.url, detail=detail)
            assert failure is not None  # noqa: S101 - the scope ends with a result, a failure or its deadline
            self.breaker.record_failure(failure)
            reported = True
        finally:
            if not reported:
                self.breaker.record_cancellation()
        tokens_in, tokens_out = failure.tokens
        attempts_made.append(
            Attempt(
                kind=failure.kind,
                status=failure.status,
                seconds=perf_counter() - began,
                waited_s=waited_s,
                input_tokens=tokens_in,
                output_tokens=tokens_out,
            )
        )
        return failure

    def _pause_s(self, failure: ServerFailure, attempts: int) -> float | None:
        """Return the pause in seconds before the next attempt; None if the call must not be retried."""
        if failure.kind not in RETRYABLE or attempts > self.endpoint.retries:
            return None
        jitter_s = self.rng.uniform(0.0, min(MAX_PAUSE_S, FIRST_PAUSE_S * 2.0 ** (attempts - 1)))
        requested_s = failure.retry_after_s
        if requested_s is None:
            return jitter_s
        return requested_s + 0.1 * jitter_s if requested_s <= MAX_RETRY_AFTER_S else None

    def _retry_time_s(self, failure: ServerFailure) -> float:
        """Return the time in seconds to reserve for another attempt. A server that sent nothing may take the full timeout again."""
        return self.endpoint.timeouts.first_byte_s if failure.kind is FailureKind.FIRST_BYTE_TIMEOUT else 0.0

    def _circuit_open(self, wait_s: float) -> ServerFailure:
        last = self.breaker.last_failure
        reason = f"last failure: {last.kind.value}; " if last is not None else ""
        return ServerFailure(
            FailureKind.CIRCUIT_OPEN, where=self.endpoint.url, detail=f"{reason}the next request is possible in {wait_s:.0f} s"
        )
