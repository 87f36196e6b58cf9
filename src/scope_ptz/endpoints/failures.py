"""Model server failures: their kinds, with a message and a remedy for each."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from enum import StrEnum

from pydantic import BaseModel, ConfigDict

from scope_ptz.errors import ScopeError

MAX_DETAIL_CHARS = 300  # longer server messages are truncated
MIN_SCRUBBED_CHARS = 6
"""Minimum length of a key that is masked. Shorter keys, such as "none" or "EMPTY", are placeholders and may be ordinary words."""


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


_MESSAGES: dict[FailureKind, tuple[str, str]] = {
    FailureKind.REFUSED: ("cannot be reached", "Start it, or check its URL."),
    FailureKind.DNS: ("has an unknown host name", "Check the URL."),
    FailureKind.TLS: ("did not present a certificate that this machine trusts", "Check the URL and the certificate."),
    FailureKind.CONNECT_TIMEOUT: ("did not accept the connection in time", "Check the URL and the network."),
    FailureKind.FIRST_BYTE_TIMEOUT: (
        "sent no data in time",
        "It may be busy or loading. Allow more time, or use a smaller model.",
    ),
    FailureKind.TOTAL_TIMEOUT: ("did not finish in time", "Allow more time, or use a smaller model."),
    FailureKind.UNAUTHORISED: ("rejected the API key", "Set the key for this server, and check the key's permissions."),
    FailureKind.NOT_FOUND: (
        "does not know this path or model",
        "Check the URL (most servers require /v1 at the end) and the model's name.",
    ),
    FailureKind.RATE_LIMITED: ("is limiting the request rate", "Wait, or ask for a higher limit."),
    FailureKind.BAD_REQUEST: ("rejected the request", "Check the model's name and what the server supports."),
    FailureKind.CONTEXT_OVERFLOW: (
        "reports that the conversation exceeds the model's context",
        "Serve the model with a longer context.",
    ),
    FailureKind.SERVER_ERROR: ("had an internal error", "Check its log."),
    FailureKind.ERROR_BODY: ("sent an error message", "Check its log."),
    FailureKind.CUT_OFF: ("did not complete its reply", "Check its log; it may have crashed."),
    FailureKind.EMPTY: ("sent an empty reply", "Check that the model is suitable for this use."),
    FailureKind.WRONG_CONTENT_TYPE: ("sent a reply with the wrong content type", "Check that the URL is that of a model server."),
    FailureKind.MALFORMED: ("sent an unreadable reply", "Check that the URL is that of a model server."),
    FailureKind.TOO_LARGE: ("sent a reply that is too large", "Check that the URL is that of a model server."),
    FailureKind.CIRCUIT_OPEN: ("failed repeatedly, so requests to it are paused", "Start it, or check its URL."),
}


class Attempt(BaseModel):
    """A request to a model server. A call may take several attempts.

    Attributes:
        kind: The kind of the failure; None if the request succeeded.
        waited_s: The pause before the request in seconds.
        input_tokens: Input tokens of an unusable reply; usable replies contain their own token counts.
        output_tokens: Output tokens of an unusable reply.
    """

    model_config = ConfigDict(frozen=True)

    kind: FailureKind | None = None
    status: int | None = None
    seconds: float = 0.0
    waited_s: float = 0.0
    input_tokens: int = 0
    output_tokens: int = 0


class ServerFailure(ScopeError):  # noqa: N818 - the name matches FailureKind
    """A model server did not return a usable reply.

    Attributes:
        where: The server's URL.
        detail: The server's message, truncated and with keys masked.
        history: All attempts made in the call.
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
        problem, remedy = _MESSAGES[kind]
        remarks = [f"HTTP {status}"] if status is not None and status != 200 else []
        remarks += [f"{len(history)} attempts"] if len(history) > 1 else []
        aside = f" ({', '.join(remarks)})" if remarks else ""
        message = f": {detail.rstrip('. ')}" if detail else ""
        super().__init__(f"The model server at {where} {problem}{aside}{message}. {remedy}")

    @property
    def attempts(self) -> int:
        """Number of requests to the server."""
        return len(self.history)

    def with_history(self, history: Iterable[Attempt]) -> ServerFailure:
        """Return a copy of the failure with a different history."""
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
    """Return the number of failures of each kind, including those after which a retry succeeded."""
    return dict(Counter(attempt.kind.value for attempt in attempts if attempt.kind is not None))


def scrub(text: str, secret: str) -> str:
    """Mask the key in a server's message, because some servers echo it."""
    if len(secret) >= MIN_SCRUBBED_CHARS and secret in text:
        return text.replace(secret, "***")
    return text


_API_KEY = re.compile(r"\b(Bearer\s+|sk-)[\w.~+/=-]{6,}", re.IGNORECASE)


def one_line_excerpt(text: str, secret: str) -> str:
    """Return a server's message as a single line, truncated and with everything that looks like a key masked."""
    line = " ".join("".join(c if c.isprintable() else " " for c in text[:4000]).split())
    line = _API_KEY.sub(r"\1***", scrub(line, secret))
    return line if len(line) <= MAX_DETAIL_CHARS else line[: MAX_DETAIL_CHARS - 1] + "…"
