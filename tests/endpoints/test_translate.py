"""Translation of server errors into messages that a user can act on."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from email.utils import format_datetime
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import MAX_DETAIL_CHARS, FailureKind, ServerFailure, one_line_excerpt
from scope_ptz.endpoints.translate import as_failure, error_body, retry_after_s, status_failure

AT = Endpoint(url="http://127.0.0.1:8000/v1")
K = FailureKind


@pytest.mark.parametrize(
    ("headers", "seconds"),
    [
        ({}, None),
        ({"retry-after": "7"}, 7.0),
        ({"retry-after": "1.5"}, 1.5),
        ({"retry-after-ms": "250", "retry-after": "7"}, 0.25),
        ({"retry-after": "Wed, 21 Oct 2015 07:28:00 GMT"}, 0.0),
        ({"retry-after": "-3"}, None),
        ({"retry-after": "nan"}, None),
        ({"retry-after": "inf"}, None),
        ({"retry-after": "soon"}, None),
        ({"retry-after": ""}, None),
    ],
)
def test_retry_after(headers: dict[str, str], seconds: float | None) -> None:
    assert retry_after_s(headers) == seconds


def test_retry_after_as_a_date() -> None:
    asked = retry_after_s({"retry-after": format_datetime(datetime.now(UTC) + timedelta(seconds=20), usegmt=True)})
    assert asked is not None
    assert 18 <= asked <= 20


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ('{"error": {"message": "model not loaded", "type": "x", "code": 404}}', "model not loaded"),
        ('{"error": "model not loaded"}', "model not loaded"),
        ('{"object": "error", "message": "model not loaded", "code": 404}', "model not loaded"),
        ('{"detail": "model not loaded"}', "model not loaded"),
        ('{"detail": [{"loc": ["body", "tools"], "msg": "extra"}]}', '[{"loc": ["body", "tools"], "msg": "extra"}]'),
        ("<html><body><h1>404</h1>model not loaded</body></html>", "404 model not loaded"),
        ("model\n\n\tnot\x1b[31m loaded", "model not [31m loaded"),
        ("", ""),
        ("[]", "[]"),
    ],
)
def test_the_message_of_the_server(body: str, words: str) -> None:
    failure = status_failure(404, {}, body, AT)
    assert failure.detail == words
    assert words in str(failure)


@settings(deadline=None)
@given(st.integers(300, 999), st.text() | st.builds(str, st.dictionaries(st.text(), st.text())), st.text())
def test_every_status_and_body_is_a_failure(status: int, body: str, secret: str) -> None:
    failure = status_failure(status, {}, body, AT)
    assert failure.status == status
    assert len(failure.detail) <= MAX_DETAIL_CHARS


@pytest.mark.parametrize(
    ("body", "kind"),
    [
        ({"error": "queue is full"}, K.ERROR_BODY),
        ({"error": {"message": "slow down", "code": 429}}, K.RATE_LIMITED),
        ({"error": {"message": "who?", "code": "invalid_api_key"}}, K.UNAUTHORISED),
        ({"object": "error", "message": "no"}, K.ERROR_BODY),
        ({"error": None, "choices": []}, None),
        ({"answer": "an error occurred in the picture"}, None),
    ],
)
def test_errors_with_a_success_status(body: dict[str, Any], kind: FailureKind | None) -> None:
    failure = error_body(body, AT)
    assert (failure.kind if failure else None) is kind


@pytest.mark.parametrize("text", ["Bearer abcdef123456", "key sk-proj-abc_DEF-12345 is wrong", "sk-abcdefgh"])
def test_text_that_looks_like_a_key_is_hidden(text: str) -> None:
    assert "***" in one_line_excerpt(text, "")
    assert not any(part in one_line_excerpt(text, "") for part in ("abcdef", "abc_DEF"))


def test_a_placeholder_key_does_not_hide_words() -> None:
    assert one_line_excerpt("none of the models is loaded", "none") == "none of the models is loaded"


def test_a_bug_is_not_a_server_failure() -> None:
    assert as_failure(KeyError("x"), AT) is None
    assert as_failure(OSError("disk full"), AT) is None


def test_a_failure_deep_in_a_chain_is_found() -> None:
    inner = ServerFailure(K.TOO_LARGE, where=AT.url)
    try:
        try:
            raise inner
        except ServerFailure as error:
            raise ExceptionGroup("several", [ValueError("x"), RuntimeError("wrapped")]) from error
    except ExceptionGroup as group:
        assert as_failure(group, AT) is inner


@pytest.mark.parametrize("kind", list(FailureKind))
def test_every_kind_has_a_message_and_a_remedy(kind: FailureKind) -> None:
    words = str(ServerFailure(kind, where=AT.url))
    assert words.startswith(f"The model server at {AT.url} ")
    assert words.count(". ") >= 1
    assert words.endswith(".")
