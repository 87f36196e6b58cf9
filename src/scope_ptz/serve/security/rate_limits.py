"""Limits on how many requests a client may send per second."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from time import monotonic
from typing import Literal

from scope_ptz.serve.site.errors import TooManyRequestsError

RequestKind = Literal["read", "command", "run", "sign_in"]

MAX_CLIENTS = 10_000
"""Maximum number of counters. Beyond it, the counter of the least recently active client is dropped."""

NAME_FACTOR = 10
"""The limit that all clients with the same name share, as a multiple of one client's limit."""


@dataclass(frozen=True, slots=True)
class Rate:
    """The allowed average number of requests per second, and the allowed burst after a pause."""

    per_s: float
    burst: int


DEFAULT_RATES: Mapping[RequestKind, Rate] = {
    "read": Rate(50.0, 200),
    "command": Rate(25.0, 60),
    "run": Rate(1.0, 20),
    "sign_in": Rate(0.2, 10),
}


class RateLimits:
    """Limits each client's requests, separately for each kind of request.

    Requests to stop a camera or a run are never counted. All clients with the same name, such as a user's browser tabs, also share
    a limit. Otherwise, a program could evade the limit by pretending to be many clients.

    Args:
        rates: The limit for each kind of request; None for no limits.
    """

    def __init__(self, rates: Mapping[RequestKind, Rate] | None = DEFAULT_RATES) -> None:
        self._rates = rates or {}
        self._remaining: OrderedDict[tuple[str, RequestKind], tuple[float, float]] = OrderedDict()

    def count(self, client: str, kind: RequestKind, name: str | None = None) -> None:
        """Count a request from a client, and refuse it if the client exceeds a limit.

        Args:
            client: The client's key, or its address if it has not signed in.
            kind: The kind of request.
            name: The name that the client may share with others; None for no shared limit.

        Raises:
            TooManyRequestsError: The client sent too many requests. The error states after how many seconds the client may retry.
        """
        rate = self._rates.get(kind)
        if rate is None:
            return
        if name is not None:
            self._count(f"all of {name}", kind, Rate(NAME_FACTOR * rate.per_s, NAME_FACTOR * rate.burst))
        self._count(client, kind, rate)

    def _count(self, client: str, kind: RequestKind, rate: Rate) -> None:
        now_s = monotonic()
        remaining, counted_s = self._remaining.pop((client, kind), (float(rate.burst), now_s))
        remaining = min(float(rate.burst), remaining + (now_s - counted_s) * rate.per_s)
        allowed = remaining >= 1.0
        self._remaining[client, kind] = (remaining - 1.0 if allowed else remaining, now_s)
        if len(self._remaining) > MAX_CLIENTS:
            self._remaining.popitem(last=False)
        if not allowed:
            raise TooManyRequestsError(max(1.0, (1.0 - remaining) / rate.per_s))
