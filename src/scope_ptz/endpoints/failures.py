"""The kinds of model server failures, with a message and a remedy for each."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from enum import StrEnum

from pydantic import BaseModel, ConfigDict

from scope_ptz.errors import ScopeError

MAX_DETAIL_CHARS = 300
MIN_SCRUBBED_CHARS = 6
"""Shorter keys ("none", "EMPTY") are not removed from texts: they are placeholders, and may be ordinary words."""


class FailureKind(StrEnum):
    """A kind of failure. Traces store the values, so they must not change."""

    REFUSED = "refused"
    DNS = "dns"
    TLS = "tls"
    CONNECT_TIMEOUT = "connect-timeout"
    FIRST_BYTE_TIMEOUT = "first-byte-timeout"
    TOTAL_TIMEOUT = "total-timeout"
    UNAUTHORISED = "unauthorised"
    NOT_FOUND = "not-found"
    RATE_LIMITED = "rate-limited"
    BAD_REQUEST = "bad-request"
    CONTEXT_OVERFLOW = "context-overflow"
    SERVER_ERROR = "server-error"
    ERROR_BODY = "error-body"
    CUT_OFF = "cut-off"
    EMPTY = "empty"
    WRONG_CONTENT_TYPE = "wrong-content-type"
    MALFORMED = "malformed"
    TOO_LARGE = "too-large"
    CIRCUIT_OPEN = "circuit-open"


K = FailureKind

_MESSAGES: dict[FailureKind, tuple[str, str]] = {
    K.REFUSED: ("cannot be reached", "Start it, or check the address."),
    K.DNS: ("has an unknown host name", "Check the address."),
    K.TLS: ("has no certificate that this machine trusts", "Check the address and the certificate."),
    K.CONNECT_TIMEOUT: ("did not accept the connection in time", "Check the address and the network."),
    K.FIRST_BYTE_TIMEOUT: (
        "sent nothing for too long",
        "It may be busy or loading. Allow more time, or use a smaller model.",
    ),
    K.TOTAL_TIMEOUT: ("did not finish in time", "Allow more time, or use a smaller model."),
    K.UNAUTHORISED: ("refused the key", "Set the key of this server, and check its permissions."),
    K.NOT_FOUND: ("does not know this path or model", "Check the address (most servers need /v1 at the end) and the model's name."),
    K.RATE_LIMITED: ("limits the rate of requests", "Wait, or ask for a higher limit."),
    K.BAD_REQUEST: ("refused the request", "Check the model's name and what the server supports."),
    K.CONTEXT_OVERFLOW: ("reports that the conversation exceeds the model's context", "Serve the model with a longer context."),
    K.SERVER_ERROR: ("had an internal error", "Check its log."),
    K.ERROR_BODY: ("sent an error message", "Check its log."),
    K.CUT_OFF: ("did not complete its reply", "Check its log; it may have crashed."),
    K.EMPTY: ("sent an empty reply", "Check that the model is the right one for this use."),
    K.WRONG_CONTENT_TYPE: ("sent a reply of the wrong content type", "Check that the address is that of a model server."),
    K.MALFORMED: ("sent an unreadable reply", "Check that the address is that of a model server."),
    K.TOO_LARGE: ("sent a reply that is too large", "Check that the address is that of a model server."),
    K.CIRCUIT_OPEN: ("failed repeatedly, so no request is sent for a while", "Start it, or check the address."),
}


class Attempt(BaseModel):
    """One request to a model server. A call may need several requests.

    Attributes:
        kind: How it failed; None if it succeeded.
        waited_s: The pause before the request, in seconds.
        input_tokens: Input tokens of a reply that was unusable; usable replies carry their own counts.
        output_tokens: Output tokens of a reply that was unusable.
    """

    model_config = ConfigDict(frozen=True)

    kind: FailureKind | None = None
    status: int | None = None
    seconds: float = 0.0
    waited_s: float = 0.0
    input_tokens: int = 0
    output_tokens: int = 0


class ServerFailure(ScopeError):  # noqa: N818 - named like the kinds in this package
    """A model server gave no usable reply.

    Attributes:
        where: The server's address.
        detail: The server's message, truncated and without keys.
        history: All attempts of the call.
        tokens: Input and output tokens of an empty reply.
    """

    def __init__(
        self,
        kind: FailureKind,
        *,
        where: str,
        status: int | None = None,
        retry_after_s: float | None = None,
        detail: str = "",
        history: tuple[Attempt, ...] = (),
        tokens: tuple[int, int] = (0, 0),
    ) -> None:
        self.kind, self.where, self.status, self.retry_after_s, self.detail = kind, where, status, retry_after_s, detail
        self.history, self.tokens = history, tokens
        what, remedy = _MESSAGES[kind]
        facts = [f"HTTP {status}"] if status is not None and status != 200 else []
        facts += [f"{len(history)} attempts"] if len(history) > 1 else []
        aside = f" ({', '.join(facts)})" if facts else ""
        message = f": {detail.rstrip('. ')}" if detail else ""
        super().__init__(f"The model server at {where} {what}{aside}{message}. {remedy}")

    @property
    def attempts(self) -> int:
        """Number of requests to the server."""
        return len(self.history)

    def with_history(self, history: Iterable[Attempt]) -> ServerFailure:
        """Return the same failure with another history."""
        return ServerFailure(
            self.kind,
            where=self.where,
            status=self.status,
            retry_after_s=self.retry_after_s,
            detail=self.detail,
            history=tuple(history),
            tokens=self.tokens,
        )


def count_failures(attempts: Iterable[Attempt]) -> dict[str, int]:
    """Return how often each kind of failure occurred, including failures before a successful retry."""
    return dict(Counter(attempt.kind.value for attempt in attempts if attempt.kind is not None))


def scrub(text: str, secret: str) -> str:
    """Return a server's message without the key, which some servers echo."""
    if len(secret) >= MIN_SCRUBBED_CHARS and secret in text:
        return text.replace(secret, "***")
    return text


_BEARER = re.compile(r"\b(Bearer\s+|sk-)[\w.~+/=-]{6,}", re.IGNORECASE)


def in_brief(text: str, secret: str) -> str:
    """Return a server's message on one line, truncated, without anything that looks like a key."""
    line = " ".join("".join(c if c.isprintable() else " " for c in text[:4000]).split())
    line = _BEARER.sub(r"\1***", scrub(line, secret))
    return line if len(line) <= MAX_DETAIL_CHARS else line[: MAX_DETAIL_CHARS - 1] + "…"
