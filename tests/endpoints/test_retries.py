"""Retries are bounded and jittered, one deadline covers all attempts, and the breaker protects a dead server."""

from __future__ import annotations

import random
from collections.abc import Awaitable, Callable

import anyio
import pytest

from scope_ptz.endpoints.breaker import Breaker
from scope_ptz.endpoints.endpoint import Endpoint, Timeouts
from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from scope_ptz.endpoints.retries import Caller

pytestmark = pytest.mark.anyio
K = FailureKind
URL = "http://127.0.0.1:1/v1"


def failing(*kinds: FailureKind, status: int | None = None, retry_after_s: float | None = None) -> Callable[[], Awaitable[str]]:
    """Return a function that raises these failures one after the other, then succeeds."""
    left = list(kinds)

    async def attempt() -> str:
        await anyio.lowlevel.checkpoint()
        if left:
            raise ServerFailure(left.pop(0), where=URL, status=status, retry_after_s=retry_after_s)
        return "good"

    return attempt


class RecordedSleeps:
    """A replacement for sleep that only records the durations."""

    def __init__(self) -> None:
        self.slept: list[float] = []

    async def __call__(self, seconds: float) -> None:
        self.slept.append(seconds)


def make(retries: int = 2, total_s: float = 120.0, seed: int = 1, breaker: Breaker | None = None) -> tuple[Caller, RecordedSleeps]:
    naps = RecordedSleeps()
    at = Endpoint(url=URL, retries=retries, timeouts=Timeouts(total_s=total_s, first_byte_s=1.0))
    return Caller(at, sleep=naps, rng=random.Random(seed), breaker=breaker or Breaker(threshold=1000)), naps


async def test_temporary_failures_are_retried_and_recorded() -> None:
    caller, naps = make()
    result, attempts = await caller.call(failing(K.SERVER_ERROR, K.CUT_OFF))
    assert result == "good"
    assert [attempt.kind for attempt in attempts] == [K.SERVER_ERROR, K.CUT_OFF, None]
    assert [attempt.waited_s for attempt in attempts] == [0.0, *naps.slept]


async def test_attempts_are_bounded() -> None:
    caller, naps = make(retries=3)
    with pytest.raises(ServerFailure) as caught:
        await caller.call(failing(*[K.MALFORMED] * 50))
    assert caught.value.attempts == 4
    assert len(naps.slept) == 3
    assert "4 attempts" in str(caught.value)


@pytest.mark.parametrize(
    "kind", [K.UNAUTHORISED, K.NOT_FOUND, K.BAD_REQUEST, K.CONTEXT_OVERFLOW, K.WRONG_CONTENT_TYPE, K.TOO_LARGE, K.TLS]
)
async def test_permanent_failures_are_not_retried(kind: FailureKind) -> None:
    caller, naps = make()
    with pytest.raises(ServerFailure) as caught:
        await caller.call(failing(kind))
    assert (caught.value.kind, caught.value.attempts, naps.slept) == (kind, 1, [])


async def test_pauses_grow_have_full_jitter_and_a_cap() -> None:
    pauses: list[list[float]] = []
    for seed in range(200):
        caller, naps = make(retries=8, total_s=1e6, seed=seed)
        with pytest.raises(ServerFailure):
            await caller.call(failing(*[K.SERVER_ERROR] * 50))
        pauses.append(naps.slept)
    for index, longest in enumerate([0.5, 1, 2, 4, 8, 8, 8, 8]):
        column = [row[index] for row in pauses]
        assert 0.9 * longest < max(column) <= longest
        assert min(column) < 0.1 * longest


async def test_retry_after_is_obeyed_up_to_a_cap() -> None:
    caller, naps = make()
    await caller.call(failing(K.RATE_LIMITED, status=429, retry_after_s=7.0))
    assert 7.0 <= naps.slept[0] <= 7.1
    caller, naps = make()
    with pytest.raises(ServerFailure) as caught:
        await caller.call(failing(K.RATE_LIMITED, status=429, retry_after_s=600.0))
    assert (caught.value.attempts, naps.slept) == (1, [])


async def test_no_pause_goes_beyond_the_deadline() -> None:
    caller, naps = make(total_s=5.0)
    with pytest.raises(ServerFailure) as caught:
        await caller.call(failing(K.RATE_LIMITED, retry_after_s=20.0))
    assert caught.value.kind is K.RATE_LIMITED
    assert naps.slept == []


async def test_the_deadline_holds_over_all_attempts() -> None:
    caller, _ = make(total_s=1.0)
    left = [K.CUT_OFF]

    async def attempt() -> None:
        if left:
            raise ServerFailure(left.pop(), where=URL)
        await anyio.sleep(600)

    with pytest.raises(ServerFailure) as caught:
        await caller.call(attempt)
    assert [attempt.kind for attempt in caught.value.history] == [K.CUT_OFF, K.TOTAL_TIMEOUT]


async def test_a_silent_server_is_retried_only_with_enough_time_left() -> None:
    caller, naps = make(total_s=0.9)
    with pytest.raises(ServerFailure) as caught:
        await caller.call(failing(K.FIRST_BYTE_TIMEOUT))
    assert (caught.value.kind, naps.slept) == (K.FIRST_BYTE_TIMEOUT, [])


async def test_bugs_are_not_failures_of_the_server() -> None:
    caller, _ = make()

    async def attempt() -> None:
        raise KeyError("a bug")

    with pytest.raises(KeyError):
        await caller.call(attempt)


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


async def outcome(caller: Caller, attempt: Callable[[], Awaitable[str]]) -> FailureKind | None:
    try:
        await caller.call(attempt)
    except ServerFailure as failure:
        return failure.kind
    return None


async def test_the_breaker_opens_and_then_probes_once() -> None:
    clock = Clock()
    caller, _ = make(retries=0, breaker=Breaker(threshold=3, pause_s=10.0, max_pause_s=15.0, clock=clock))
    asked: list[float] = []

    async def dead() -> str:
        asked.append(clock.now)
        raise ServerFailure(K.CONNECT_TIMEOUT, where=URL)

    assert [await outcome(caller, dead) for _ in range(5)] == [K.CONNECT_TIMEOUT] * 3 + [K.CIRCUIT_OPEN] * 2
    assert len(asked) == 3
    clock.now = 10.0
    assert [await outcome(caller, dead) for _ in range(2)] == [K.CONNECT_TIMEOUT, K.CIRCUIT_OPEN]
    clock.now = 20.0  # the pause has grown to 15 s
    assert await outcome(caller, dead) is K.CIRCUIT_OPEN
    clock.now = 25.0
    assert await outcome(caller, failing()) is None
    assert await outcome(caller, dead) is K.CONNECT_TIMEOUT


async def test_only_one_request_probes() -> None:
    clock = Clock()
    caller, _ = make(retries=0, breaker=Breaker(threshold=1, clock=clock))
    assert await outcome(caller, failing(K.REFUSED)) is K.REFUSED
    clock.now = 100.0
    kinds: list[FailureKind | None] = []

    async def slow() -> str:
        await anyio.sleep(0.01)
        return "good"

    async def one() -> None:
        kinds.append(await outcome(caller, slow))

    async with anyio.create_task_group() as group:
        for _ in range(4):
            group.start_soon(one)
    assert kinds.count(None) == 1
    assert kinds.count(K.CIRCUIT_OPEN) == 3


async def test_a_cancelled_probe_allows_another() -> None:
    clock = Clock()
    caller, _ = make(retries=0, breaker=Breaker(threshold=1, clock=clock))
    assert await outcome(caller, failing(K.REFUSED)) is K.REFUSED
    clock.now = 100.0

    async def endless() -> str:
        await anyio.sleep(60)
        return "never"

    with anyio.move_on_after(0.01):
        await caller.call(endless)
    assert await outcome(caller, failing()) is None


async def test_any_answer_closes_the_breaker() -> None:
    caller, _ = make(retries=0, breaker=Breaker(threshold=2))
    for kind in (K.REFUSED, K.UNAUTHORISED, K.REFUSED, K.EMPTY, K.REFUSED):
        assert await outcome(caller, failing(kind)) is kind


async def test_503_opens_the_circuit_and_500_does_not() -> None:
    for status, last in ((503, K.CIRCUIT_OPEN), (500, K.SERVER_ERROR)):
        caller, _ = make(retries=0, breaker=Breaker(threshold=2))
        assert [await outcome(caller, failing(K.SERVER_ERROR, status=status)) for _ in range(3)][-1] is last
