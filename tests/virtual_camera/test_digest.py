"""Digest authentication against the answers of two HTTP clients, the example of the standard, and attacks."""

from __future__ import annotations

import hashlib
import re

import httpx2
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.virtual_camera.accounts import Account, Accounts, Role
from scope_ptz.virtual_camera.digest import DigestAuthenticator

OPERATOR = Account("operator", "Circle of Life", Role.OPERATOR)


def _answer(challenge: str, *, password: str = OPERATOR.password, user: str = "operator", method: str = "GET", count: int = 1,
            uri: str = "/a?b=1", with_qop: bool = True) -> str:  # fmt: skip
    """Answer a challenge, written from the standard and not from the server's code."""
    fields = dict(re.findall(r'(\w+)="?([^",]+)"?', challenge))
    name = fields["algorithm"]

    def h(text: str) -> str:
        return hashlib.new("sha256" if name == "SHA-256" else "md5", text.encode()).hexdigest()

    ha1, ha2 = h(f"{user}:{fields['realm']}:{password}"), h(f"{method}:{uri}")
    nonce, realm = fields["nonce"], fields["realm"]
    shared = f'Digest username="{user}", realm="{realm}", nonce="{nonce}", uri="{uri}", algorithm={name}'
    if not with_qop:
        response = h(f"{ha1}:{nonce}:{ha2}")
        return f'{shared}, response="{response}"'
    response = h(f"{ha1}:{nonce}:{count:08x}:0a4f113b:auth:{ha2}")
    return f'{shared}, qop=auth, nc={count:08x}, cnonce="0a4f113b", response="{response}"'


class _Time:
    now = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def time() -> _Time:
    return _Time()


@pytest.fixture
def server(time: _Time) -> DigestAuthenticator:
    return DigestAuthenticator(Accounts([OPERATOR]), "AXIS_1", now_s=time)


@pytest.mark.parametrize("which", [0, 1, 2])
def test_both_algorithms_are_offered_and_accepted(server: DigestAuthenticator, which: int) -> None:
    challenges = server.challenges()
    assert [name in challenge for name, challenge in zip(("=MD5", "=SHA-256", "=MD5"), challenges, strict=True)] == [True] * 3
    assert server.check(_answer(challenges[which]), "GET", "/a?b=1").account is OPERATOR


@pytest.mark.parametrize("which", [0, 1, 2])
def test_an_independent_client_signs_in(server: DigestAuthenticator, which: int) -> None:
    """The flow of httpx2's digest client, without a network."""
    request = httpx2.Request("POST", "http://camera/axis-cgi/com/ptz.cgi?query=position")
    flow = httpx2.DigestAuth("operator", "Circle of Life").sync_auth_flow(request)
    first = next(flow)
    assert server.check(first.headers.get("Authorization"), "POST", "/axis-cgi/com/ptz.cgi?query=position").account is None
    refusal = httpx2.Response(401, headers={"WWW-Authenticate": server.challenges()[which]}, request=first)
    second = flow.send(refusal)
    verdict = server.check(second.headers["Authorization"], "POST", "/axis-cgi/com/ptz.cgi?query=position")
    assert verdict.account is OPERATOR


def test_an_old_nonce_is_stale_and_a_wrong_password_never_is(server: DigestAuthenticator, time: _Time) -> None:
    challenge = server.challenges()[0]
    time.now += 299
    assert server.check(_answer(challenge, count=1), "GET", "/a?b=1").account is OPERATOR
    time.now += 2
    right, wrong = _answer(challenge, count=2), _answer(challenge, count=3, password="a guess")
    assert server.check(right, "GET", "/a?b=1").stale
    assert not server.check(wrong, "GET", "/a?b=1").stale
    assert "stale=true" in server.challenges(stale=True)[0]


def test_a_recorded_answer_cannot_be_sent_again(server: DigestAuthenticator) -> None:
    answer = _answer(server.challenges()[0])
    assert server.check(answer, "GET", "/a?b=1").account
    again = server.check(answer, "GET", "/a?b=1")
    assert again.account is None
    assert again.stale


def test_requests_may_overtake_each_other(server: DigestAuthenticator) -> None:
    challenge = server.challenges()[0]
    for count in (1, 5, 3, 2, 70, 69, 4 + 64):
        assert server.check(_answer(challenge, count=count), "GET", "/a?b=1").account, count
    assert not server.check(_answer(challenge, count=3), "GET", "/a?b=1").account


def test_an_answer_is_good_for_its_request_only(server: DigestAuthenticator) -> None:
    challenge = server.challenges()[0]
    answer = _answer(challenge)
    assert not server.check(answer, "POST", "/a?b=1").account
    assert not server.check(answer, "GET", "/a?b=2").account
    assert server.check(_answer(challenge, uri="http://camera/a?b=1"), "GET", "/a?b=1").account


def test_a_nonce_of_another_server_is_worth_nothing(server: DigestAuthenticator, time: _Time) -> None:
    other = DigestAuthenticator(Accounts([OPERATOR]), "AXIS_1", now_s=time)
    assert not server.check(_answer(other.challenges()[0]), "GET", "/a?b=1").account
    assert not server.check(_answer(other.challenges()[0]), "GET", "/a?b=1").stale


def test_rtsp_clients_without_qop_are_accepted_where_it_is_not_offered(server: DigestAuthenticator) -> None:
    uri = "rtsp://127.0.0.1/axis-media/media.amp"
    relaxed = DigestAuthenticator(Accounts([OPERATOR]), "AXIS_1", qop=False)
    challenge = relaxed.challenges()[1]
    assert "qop" not in challenge
    assert relaxed.check(_answer(challenge, with_qop=False, method="DESCRIBE", uri=uri), "DESCRIBE").account is OPERATOR
    assert not server.check(_answer(server.challenges()[1], with_qop=False), "GET", "/a?b=1").account


@pytest.mark.parametrize("header", [None, "", "Basic b3BlcmF0b3I6Q2lyY2xlIG9mIExpZmU=", "Digest", 'Digest nonce="', "Digest ünï=1"])
def test_other_headers_are_refused(server: DigestAuthenticator, header: str | None) -> None:
    assert server.check(header, "GET", "/a?b=1").account is None


@given(st.text(max_size=200), st.text(max_size=20))
def test_any_header_is_an_answer_or_a_refusal(text: str, nonce: str) -> None:
    server = DigestAuthenticator(Accounts([OPERATOR]), "AXIS_1")
    assert server.check("Digest " + text, "GET", "/").account is None
    assert server.check(f'Digest nonce="{nonce}", qop=auth, cnonce="a", {text}', "GET", "/").account is None


@given(st.integers(0, 60), st.data())
def test_a_changed_character_in_an_answer_is_noticed(where: int, data: st.DataObject) -> None:
    server = DigestAuthenticator(Accounts([OPERATOR]), "AXIS_1")
    answer = _answer(server.challenges()[1])
    start = answer.rindex('response="') + len('response="')
    index = start + where
    other = data.draw(st.sampled_from([c for c in "0123456789abcdef" if c != answer[index]]))
    assert server.check(answer[:index] + other + answer[index + 1 :], "GET", "/a?b=1").account is None
