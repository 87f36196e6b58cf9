"""All failures of model servers in tests, each with the kind that the client must report."""

from __future__ import annotations

import gzip
from collections.abc import Callable
from typing import NamedTuple

from scope_ptz.endpoints.endpoint import Timeouts
from scope_ptz.endpoints.failures import FailureKind
from tests.support import misbehaving as m

Kind = FailureKind

LONG_TIMEOUTS = Timeouts(connect_s=5.0, first_byte_s=20.0, total_s=40.0)
SHORT_TIMEOUTS = Timeouts(connect_s=5.0, first_byte_s=0.3, total_s=0.8)
"""For faults that only a timeout reveals."""


class Fault(NamedTuple):
    """A failure of a server. ``kind`` is expected without streaming, and ``streamed`` with streaming."""

    name: str
    make: Callable[[], m.Behaviour]
    kind: FailureKind
    streamed: FailureKind
    chat_only: bool = False
    slow: bool = False

    @property
    def timeouts(self) -> Timeouts:
        return SHORT_TIMEOUTS if self.slow else LONG_TIMEOUTS

    def expected(self, stream: bool) -> FailureKind:
        return self.streamed if stream else self.kind


def _fault(
    name: str, make: Callable[[], m.Behaviour], kind: FailureKind, streamed: FailureKind | None = None, **extra: bool
) -> Fault:
    return Fault(name, make, kind, streamed or kind, **extra)


_BOMB = gzip.compress(b" " * 48 * 2**20, 9)

FAULTS = (
    _fault("401", lambda: m.status(401), Kind.UNAUTHORISED),
    _fault("401 that repeats the key", m.echo_key, Kind.UNAUTHORISED),
    _fault("402", lambda: m.status(402), Kind.UNAUTHORISED),
    _fault("403", lambda: m.status(403), Kind.UNAUTHORISED),
    _fault("404", lambda: m.status(404, "model 'x' not found, try pulling it first"), Kind.NOT_FOUND),
    _fault("307 to elsewhere", lambda: m.redirect("http://127.0.0.1:9/v1"), Kind.NOT_FOUND),
    _fault("429", lambda: m.status(429), Kind.RATE_LIMITED),
    _fault("429 with Retry-After", lambda: m.status(429, headers={"Retry-After": "0"}), Kind.RATE_LIMITED),
    _fault("429 with a long Retry-After", lambda: m.status(429, headers={"Retry-After": "3600"}), Kind.RATE_LIMITED),
    _fault("429 for an exhausted quota", lambda: m.status(429, {"error": {"code": "insufficient_quota"}}), Kind.UNAUTHORISED),
    _fault("400", lambda: m.status(400), Kind.BAD_REQUEST),
    _fault("422 of FastAPI", lambda: m.status(422, {"detail": [{"loc": ["body", "x"], "msg": "extra"}]}), Kind.BAD_REQUEST),
    _fault(
        "overflow in the words of vLLM",
        lambda: m.status(400, "This model's maximum context length is 4096 tokens."),
        Kind.CONTEXT_OVERFLOW,
    ),
    _fault("500", lambda: m.status(500), Kind.SERVER_ERROR),
    _fault("500 without JSON", lambda: m.body("Internal Server Error", "text/plain", 500), Kind.SERVER_ERROR),
    _fault("502 of a proxy", lambda: m.body("<html><h1>Bad Gateway</h1></html>", "text/html", 502), Kind.SERVER_ERROR),
    _fault("503", lambda: m.status(503), Kind.SERVER_ERROR),
    _fault("503 with Retry-After", lambda: m.status(503, headers={"Retry-After": "0"}), Kind.SERVER_ERROR),
    _fault("200 with an error body", m.error_in_success, Kind.ERROR_BODY),
    _fault("connection reset", m.reset, Kind.CUT_OFF),
    _fault("cut off", m.cut_off, Kind.CUT_OFF),
    _fault("ends too early", m.ends_early, Kind.MALFORMED, Kind.CUT_OFF),
    _fault("silent", m.slow_first_byte, Kind.FIRST_BYTE_TIMEOUT, slow=True),
    _fault("silent after its headers", m.slow_after_head, Kind.FIRST_BYTE_TIMEOUT, slow=True),
    _fault("stalls", m.stalls, Kind.CUT_OFF, slow=True),
    _fault("trickles without end", m.trickle, Kind.TOTAL_TIMEOUT, slow=True),
    _fault("no choices", m.empty_choices, Kind.EMPTY, chat_only=True),
    _fault("choices: null", lambda: m.body('{"choices":null}'), Kind.EMPTY, chat_only=True),
    _fault("an empty message", lambda: m.say(""), Kind.EMPTY, chat_only=True),
    _fault("an empty body", lambda: m.body(""), Kind.EMPTY),
    _fault("204", lambda: m.body("", code=204), Kind.EMPTY),
    _fault("a web page", m.wrong_type, Kind.WRONG_CONTENT_TYPE),
    _fault("a picture", lambda: m.body(b"\xff\xd8\xff\xe0", "image/jpeg"), Kind.WRONG_CONTENT_TYPE),
    _fault("invalid JSON", m.malformed, Kind.MALFORMED),
    _fault("a list", lambda: m.body("[1, 2]"), Kind.MALFORMED),
    _fault("a number", lambda: m.body("NaN"), Kind.MALFORMED),
    _fault("a string", lambda: m.body('"hello"'), Kind.MALFORMED),
    _fault("deep nesting", lambda: m.body("[" * 100_000), Kind.MALFORMED),
    _fault("an endless number", lambda: m.body('{"choices": %s}' % ("9" * 10_000)), Kind.MALFORMED),
    _fault("not UTF-8", lambda: m.body(b'{"choices": "\xff\xfe"}'), Kind.MALFORMED),
    _fault("invalid compression", lambda: m.body(b"{}", headers={"Content-Encoding": "gzip"}), Kind.MALFORMED),
    _fault("a compression bomb", lambda: m.body(_BOMB, headers={"Content-Encoding": "gzip"}), Kind.TOO_LARGE),
    _fault(
        "an error with a compression bomb", lambda: m.body(_BOMB, code=500, headers={"Content-Encoding": "gzip"}), Kind.SERVER_ERROR
    ),
    _fault("an oversized error", lambda: m.body(b" " * 9 * 2**20, "text/plain", 500), Kind.TOO_LARGE),
    _fault("two lengths", lambda: m.body(b"{", headers={"Content-Length": "500"}), Kind.MALFORMED),
    _fault("choices of a wrong type", lambda: m.body('{"choices": "none"}'), Kind.MALFORMED, chat_only=True),
    _fault("a choice of a wrong type", lambda: m.body('{"choices": [7]}'), Kind.MALFORMED, chat_only=True),
    _fault("content of a wrong type", lambda: m.body('{"choices": [{"message": {"content": 7}}]}'), Kind.MALFORMED, chat_only=True),
    _fault(
        "tool calls of a wrong type",
        lambda: m.body('{"choices": [{"message": {"tool_calls": [1]}}]}'),
        Kind.MALFORMED,
        chat_only=True,
    ),
    _fault("huge", m.huge, Kind.TOO_LARGE),
    _fault("huge, with its length", lambda: m.huge(stated=True), Kind.TOO_LARGE),
    _fault("another protocol", m.not_http, Kind.CUT_OFF),
)
