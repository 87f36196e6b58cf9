"""The relay signs in to the camera's own RTSP server, and to nothing else."""

from __future__ import annotations

import hashlib
import re
import socket
import ssl
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager

import pytest

from scope_ptz.camera.network.credentials import Credentials
from scope_ptz.camera.network.errors import CameraReplyError, CameraSignInError, ForeignAddressError
from scope_ptz.camera.network.rtsp_messages import MAX_HEAD_BYTES, MessageSplitter, RtspMessage
from scope_ptz.camera.network.rtsp_relay import RtspRelay
from scope_ptz.camera.network.rtsp_sign_in import RtspSignIn
from scope_ptz.camera.network.trust import PinnedContext
from scope_ptz.virtual_camera.http.certificate import Certificate, create_certificate

ACCOUNT = Credentials("operator", 'pass "word"')
PLACE = "10.0.0.7:554"
DIGEST = 'Digest realm="cam", nonce="abc"'

Answer = Callable[[RtspMessage], list[bytes]]


def reply(request: RtspMessage, status: str = "200 OK", *headers: str, body: bytes = b"") -> bytes:
    """Return a reply with the sequence number of a request."""
    length = (f"Content-Length: {len(body)}",) if body else ()
    lines = [f"RTSP/1.0 {status}", f"CSeq: {request.values('cseq')[0]}", *headers, *length, "", ""]
    return "\r\n".join(lines).encode() + body


@contextmanager
def rtsp_server(answer: Answer, certificate: Certificate | None = None) -> Iterator[tuple[int, list[RtspMessage | bytes]]]:
    """Serve one connection, and yield the port and the list of what arrives."""
    listener, seen = socket.create_server(("127.0.0.1", 0)), list[RtspMessage | bytes]()

    def serve() -> None:
        with closing(listener):
            connection, _ = listener.accept()
        splitter = MessageSplitter("client")
        if certificate is not None:
            try:
                connection = certificate.server_context().wrap_socket(connection, server_side=True)
            except ssl.SSLError:
                return
        with connection:
            while data := connection.recv(4096):
                for found in splitter.feed(data):
                    seen.append(found)
                    for part in answer(found) if isinstance(found, RtspMessage) else ():
                        connection.sendall(part)

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    yield listener.getsockname()[1], seen
    thread.join(10)
    assert not thread.is_alive()


class Player:
    """Sends requests as FFmpeg does, one after the other."""

    def __init__(self, url: str) -> None:
        self.url = url
        place = url.split("/")[2].split(":")
        self.connection = socket.create_connection((place[0], int(place[1])), 10)
        self._splitter, self._found = MessageSplitter("relay"), list[RtspMessage | bytes]()
        self._cseq = 100

    def ask(self, method: str, url: str | None = None) -> RtspMessage | bytes | None:
        """Return what comes next after a request; None if the connection is closed."""
        self._cseq += 1
        self.connection.sendall(f"{method} {url or self.url} RTSP/1.0\r\nCSeq: {self._cseq}\r\n\r\n".encode())
        return self.next()

    def next(self) -> RtspMessage | bytes | None:
        while not self._found:
            try:
                data = self.connection.recv(4096)
            except ConnectionResetError:
                return None
            if not data:
                return None
            self._found += self._splitter.feed(data)
        return self._found.pop(0)


@contextmanager
def relayed(answer: Answer, account: Credentials | None = ACCOUNT) -> Iterator[tuple[RtspRelay, Player, list[RtspMessage | bytes]]]:
    with rtsp_server(answer) as (port, seen):
        relay = RtspRelay(f"rtsp://127.0.0.1:{port}/media?a=1", account, timeout_s=5)
        with relay as url:
            player = Player(url)
            with player.connection:
                yield relay, player, seen


def test_requests_reach_the_camera_signed_and_the_player_has_no_password() -> None:
    packet = b"$\x00\x00\x03abc"

    def answer(request: RtspMessage) -> list[bytes]:
        if not request.values("authorization"):
            return [reply(request, "401 Unauthorized", f"WWW-Authenticate: {DIGEST}")]
        return [reply(request, "200 OK", "Content-Type: application/sdp", body=b"v=0\r\n"), packet]

    with relayed(answer) as (relay, player, seen):
        assert ACCOUNT.password not in player.url
        described = player.ask("DESCRIBE")
        assert isinstance(described, RtspMessage)
        assert (described.status, described.body, described.values("cseq")) == (200, b"v=0\r\n", ["101"])
        assert player.next() == packet
        player.connection.sendall(b"$\x01\x00\x02hi")
        again = player.ask("OPTIONS", "rtsp://camera/elsewhere")
        assert isinstance(again, RtspMessage)
        assert again.values("cseq") == ["102"]
    assert relay.failure is None
    first, second, report, third = seen
    assert report == b"$\x01\x00\x02hi"
    assert isinstance(first, RtspMessage)
    assert isinstance(second, RtspMessage)
    assert isinstance(third, RtspMessage)
    uri = first.start.split(" ")[1]
    assert re.fullmatch(r"rtsp://127\.0\.0\.1:\d+/media\?a=1", uri)
    assert not first.values("authorization")
    assert third.start.startswith("OPTIONS rtsp://camera/elsewhere ")

    def md5(text: str) -> str:
        return hashlib.md5(text.encode()).hexdigest()  # noqa: S324 - digest authentication uses it

    expected = md5(f"{md5(f'operator:cam:{ACCOUNT.password}')}:abc:{md5(f'DESCRIBE:{uri}')}")
    assert f'response="{expected}"' in second.values("authorization")[0]


def test_redirect_is_refused() -> None:
    with relayed(lambda request: [reply(request, "302 Moved", "Location: rtsp://10.9.9.9/x")]) as (relay, player, seen):
        assert player.ask("OPTIONS") is None
    assert isinstance(relay.failure, ForeignAddressError)
    assert len(seen) == 1


@pytest.mark.parametrize(
    ("challenge", "account", "message"),
    [
        ('Basic realm="cam"', ACCOUNT, "does not offer digest"),
        ('Digest realm="cam", nonce="n", algorithm=SHA-512-256', ACCOUNT, "does not offer digest"),
        ("Bearer", ACCOUNT, "does not offer digest"),
        (DIGEST, None, "requires an account"),
        (DIGEST, ACCOUNT, "rejected the user name or the password"),
    ],
)
def test_refused_accounts(challenge: str, account: Credentials | None, message: str) -> None:
    def refuse(request: RtspMessage) -> list[bytes]:
        return [reply(request, "401 Unauthorized", f"WWW-Authenticate: {challenge}")]

    with relayed(refuse, account) as (relay, player, seen):
        assert player.ask("DESCRIBE") is None
    assert isinstance(relay.failure, CameraSignInError)
    assert message in str(relay.failure)
    assert ACCOUNT.password not in str(relay.failure)
    assert not any("Basic " in value for each in seen if isinstance(each, RtspMessage) for value in each.values("authorization"))


def test_an_expired_nonce_is_answered_again() -> None:
    def answer(request: RtspMessage) -> list[bytes]:
        signed = "".join(request.values("authorization"))
        if 'nonce="new"' in signed:
            return [reply(request)]
        nonce = 'nonce="new", stale=TRUE' if signed else 'nonce="old"'
        return [reply(request, "401 Unauthorized", f'WWW-Authenticate: Digest realm="cam", {nonce}')]

    with relayed(answer) as (relay, player, seen):
        found = player.ask("DESCRIBE")
        assert isinstance(found, RtspMessage)
        assert found.status == 200
    assert relay.failure is None
    assert len(seen) == 3


def test_other_programs_cannot_use_the_relay() -> None:
    with relayed(lambda request: [reply(request)]) as (relay, player, seen):
        place = "/".join(player.url.split("/")[:3])
        assert player.ask("DESCRIBE", f"{place}/media?a=1") is None
    assert seen == []
    assert relay.failure is None


def test_nothing_is_left_when_nobody_connects() -> None:
    before = threading.active_count()
    with RtspRelay("rtsp://127.0.0.1:9/x", None, timeout_s=1) as url:
        assert threading.active_count() == before + 1
    assert threading.active_count() == before
    host, port = url.split("/")[2].split(":")
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection((host, int(port)), 1)


def test_algorithms_and_qop() -> None:
    sign_in = RtspSignIn(PLACE, ACCOUNT, tls=False)
    assert sign_in.answer("OPTIONS", "rtsp://x/") is None
    challenges = [f'Digest realm="r", nonce="n", algorithm={name}, qop="auth,auth-int", opaque="o"' for name in ("MD5", "SHA-256")]
    sign_in.accept(challenges)
    first, second = sign_in.answer("PLAY", "rtsp://x/"), sign_in.answer("PLAY", "rtsp://x/")
    assert first is not None
    assert second is not None
    assert "algorithm=SHA-256" in first
    assert "nc=00000001" in first
    assert "nc=00000002" in second
    assert 'opaque="o"' in first
    own = re.search(r'cnonce="(\w+)"', first)
    assert own is not None

    def sha(text: str) -> str:
        return hashlib.sha256(text.encode()).hexdigest()

    secret, request = sha(f"operator:r:{ACCOUNT.password}"), sha("PLAY:rtsp://x/")
    assert f'response="{sha(f"{secret}:n:00000001:{own[1]}:auth:{request}")}"' in first


def test_basic_is_used_only_over_tls() -> None:
    sign_in = RtspSignIn(PLACE, ACCOUNT, tls=True)
    sign_in.accept(['Basic realm="cam"'])
    assert (sign_in.answer("PLAY", "rtsps://x/") or "").startswith("Basic ")
    sign_in.accept(['Basic realm="cam"', DIGEST])
    assert (sign_in.answer("PLAY", "rtsps://x/") or "").startswith("Digest ")


def test_tls_requires_the_pinned_certificate() -> None:
    own, other = (create_certificate("camera", ("127.0.0.1",)) for _ in range(2))
    body = b"x" * 100_000  # several TLS records
    for pinned in (own, other):
        with rtsp_server(lambda request: [reply(request, body=body)], own) as (port, seen):
            tls = PinnedContext.of(pinned.pem)
            relay = RtspRelay(f"rtsps://127.0.0.1:{port}/media", ACCOUNT, timeout_s=5, tls=tls)
            with relay as url:
                player = Player(url)
                with player.connection:
                    found = player.ask("OPTIONS")
        if pinned is own:
            assert isinstance(found, RtspMessage)
            assert found.body == body
            assert relay.failure is None
        else:
            assert found is None
            assert seen == []
            assert "certificate is not trusted" in str(relay.failure)


@pytest.mark.parametrize(
    "data",
    [
        b"HTTP/1.1 200 OK\r\n\r\n",
        b"\x00" * (MAX_HEAD_BYTES + 1),
        b"RTSP/1.0 200 OK\r\nno colon\r\n\r\n",
        b"RTSP/1.0 200 OK\r\nContent-Length: -1\r\n\r\n",
        b"RTSP/1.0 200 OK\r\nContent-Length: 99999999\r\n\r\n",
    ],
)
def test_invalid_data_is_refused(data: bytes) -> None:
    with pytest.raises(CameraReplyError, match="not valid RTSP"):
        list(MessageSplitter(PLACE).feed(data))


def test_data_may_arrive_in_any_pieces() -> None:
    whole = b"$\x00\x00\x05\r\n\r\n$RTSP/1.0 200 OK\r\nCSeq: 1\r\nContent-Length: 3\r\n\r\nabc$\x01\x00\x00"
    splitter = MessageSplitter(PLACE)
    found = [each for byte in whole for each in splitter.feed(bytes((byte,)))]
    message = RtspMessage("RTSP/1.0 200 OK", (("CSeq", "1"), ("Content-Length", "3")), b"abc")
    assert found == [b"$\x00\x00\x05\r\n\r\n$", message, b"$\x01\x00\x00"]
