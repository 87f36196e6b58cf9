"""Every way in which a model server misbehaves in tests, with the kind that it must be told as."""

from __future__ import annotations

import gzip
from collections.abc import Callable
from typing import NamedTuple

from scope_ptz.endpoints.endpoint import Timeouts
from scope_ptz.endpoints.failures import FailureKind
from tests.support import misbehaving as m

K = FailureKind

PATIENT = Timeouts(connect_s=5.0, first_byte_s=20.0, total_s=40.0)
HURRIED = Timeouts(connect_s=5.0, first_byte_s=0.3, total_s=0.8)
"""For faults that are only seen by running out of patience."""


class Fault(NamedTuple):
    """``kind``: when a whole reply is wanted, ``streamed``: when a stream is."""

    name: str
    make: Callable[[], m.Behaviour]
    kind: FailureKind
    streamed: FailureKind
    chat_only: bool = False
    slow: bool = False

    @property
    def timeouts(self) -> Timeouts:
        return HURRIED if self.slow else PATIENT

    def expected(self, stream: bool) -> FailureKind:
        return self.streamed if stream else self.kind


def _fault(
    name: str, make: Callable[[], m.Behaviour], kind: FailureKind, streamed: FailureKind | None = None, **more: bool
) -> Fault:
    return Fault(name, make, kind, streamed or kind, **more)


_BOMB = gzip.compress(b" " * 48 * 2**20, 9)

FAULTS = (
    _fault("401", lambda: m.status(401), K.UNAUTHORISED),
    _fault("401 that repeats the key", m.echo_key, K.UNAUTHORISED),
    _fault("402", lambda: m.status(402), K.UNAUTHORISED),
    _fault("403", lambda: m.status(403), K.UNAUTHORISED),
    _fault("404", lambda: m.status(404, "model 'x' not found, try pulling it first"), K.NOT_FOUND),
    _fault("307 to elsewhere", lambda: m.redirect("http://127.0.0.1:9/v1"), K.NOT_FOUND),
    _fault("429", lambda: m.status(429), K.RATE_LIMITED),
    _fault("429 with Retry-After", lambda: m.status(429, headers={"Retry-After": "0"}), K.RATE_LIMITED),
    _fault("429 with a long Retry-After", lambda: m.status(429, headers={"Retry-After": "3600"}), K.RATE_LIMITED),
    _fault("429 as a spent quota", lambda: m.status(429, {"error": {"code": "insufficient_quota"}}), K.UNAUTHORISED),
    _fault("400", lambda: m.status(400), K.BAD_REQUEST),
    _fault("422 of FastAPI", lambda: m.status(422, {"detail": [{"loc": ["body", "x"], "msg": "extra"}]}), K.BAD_REQUEST),
    _fault(
        "overflow as vLLM says it", lambda: m.status(400, "This model's maximum context length is 4096 tokens."), K.CONTEXT_OVERFLOW
    ),
    _fault("500", lambda: m.status(500), K.SERVER_ERROR),
    _fault("500 without JSON", lambda: m.body("Internal Server Error", "text/plain", 500), K.SERVER_ERROR),
    _fault("502 of a proxy", lambda: m.body("<html><h1>Bad Gateway</h1></html>", "text/html", 502), K.SERVER_ERROR),
    _fault("503", lambda: m.status(503), K.SERVER_ERROR),
    _fault("503 with Retry-After", lambda: m.status(503, headers={"Retry-After": "0"}), K.SERVER_ERROR),
    _fault("200 with an error body", m.error_in_success, K.ERROR_BODY),
    _fault("connection reset", m.reset, K.CUT_OFF),
    _fault("cut off", m.cut_off, K.CUT_OFF),
    _fault("ends too early", m.ends_early, K.MALFORMED, K.CUT_OFF),
    _fault("silent", m.slow_first_byte, K.FIRST_BYTE_TIMEOUT, slow=True),
    _fault("silent after its headers", m.slow_after_head, K.FIRST_BYTE_TIMEOUT, slow=True),
    _fault("stalls", m.stalls, K.CUT_OFF, slow=True),
    _fault("trickles without end", m.trickle, K.TOTAL_TIMEOUT, slow=True),
    _fault("no choices", m.empty_choices, K.EMPTY, chat_only=True),
    _fault("choices: null", lambda: m.body('{"choices":null}'), K.EMPTY, chat_only=True),
    _fault("an empty message", lambda: m.say(""), K.EMPTY, chat_only=True),
    _fault("an empty body", lambda: m.body(""), K.EMPTY),
    _fault("204", lambda: m.body("", code=204), K.EMPTY),
    _fault("a web page", m.wrong_type, K.WRONG_CONTENT_TYPE),
    _fault("a picture", lambda: m.body(b"\xff\xd8\xff\xe0", "image/jpeg"), K.WRONG_CONTENT_TYPE),
    _fault("no JSON", m.malformed, K.MALFORMED),
    _fault("a list", lambda: m.body("[1, 2]"), K.MALFORMED),
    _fault("a number", lambda: m.body("NaN"), K.MALFORMED),
    _fault("a string", lambda: m.body('"hello"'), K.MALFORMED),
    _fault("an abyss", lambda: m.body("[" * 100_000), K.MALFORMED),
    _fault("an endless number", lambda: m.body('{"choices": %s}' % ("9" * 10_000)), K.MALFORMED),
    _fault("not UTF-8", lambda: m.body(b'{"choices": "\xff\xfe"}'), K.MALFORMED),
    _fault("false compression", lambda: m.body(b"{}", headers={"Content-Encoding": "gzip"}), K.MALFORMED),
    _fault("a bomb", lambda: m.body(_BOMB, headers={"Content-Encoding": "gzip"}), K.TOO_LARGE),
    _fault("a refusal with a bomb", lambda: m.body(_BOMB, code=500, headers={"Content-Encoding": "gzip"}), K.SERVER_ERROR),
    _fault("a refusal without end", lambda: m.body(b" " * 9 * 2**20, "text/plain", 500), K.TOO_LARGE),
    _fault("two lengths", lambda: m.body(b"{", headers={"Content-Length": "500"}), K.MALFORMED),
    _fault("choices of a wrong type", lambda: m.body('{"choices": "none"}'), K.MALFORMED, chat_only=True),
    _fault("a choice of a wrong type", lambda: m.body('{"choices": [7]}'), K.MALFORMED, chat_only=True),
    _fault("content of a wrong type", lambda: m.body('{"choices": [{"message": {"content": 7}}]}'), K.MALFORMED, chat_only=True),
    _fault(
        "tool calls of a wrong type", lambda: m.body('{"choices": [{"message": {"tool_calls": [1]}}]}'), K.MALFORMED, chat_only=True
    ),
    _fault("huge", m.huge, K.TOO_LARGE),
    _fault("huge, as stated", lambda: m.huge(stated=True), K.TOO_LARGE),
    _fault("another protocol", m.not_http, K.CUT_OFF),
)
