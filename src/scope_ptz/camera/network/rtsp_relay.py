"""A relay between FFmpeg and a device's RTSP server, which keeps the password from FFmpeg.

FFmpeg follows RTSP redirects to any host, and sends the password there, in clear text if that host asks for it. It therefore
connects to a relay in this process, which signs in to the device itself and refuses redirects.
"""

from __future__ import annotations

import secrets
import selectors
import socket
import ssl
import threading
from contextlib import suppress
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from scope_ptz.camera.network.errors import CameraSignInError, CameraUnreachableError, ForeignAddressError
from scope_ptz.camera.network.rtsp_messages import MessageSplitter, RtspMessage
from scope_ptz.camera.network.rtsp_sign_in import RtspSignIn
from scope_ptz.errors import CameraError

if TYPE_CHECKING:
    from scope_ptz.camera.network.credentials import Credentials

POLL_S = 0.2
"""Seconds after which the thread notices that the relay was closed."""

UNREAD_BYTES = 128 * 1024
"""Size of the buffer of media that FFmpeg has not read yet. A larger one would delay the picture if FFmpeg is slow."""

_CHUNK_BYTES = 64 * 1024
_DEFAULT_PORTS = {"rtsp": 554, "rtsps": 322}


@dataclass(slots=True)
class _Sent:
    """A request that the device has not answered yet.

    Attributes:
        request: The request, without authorization.
        cseq: The sequence number that FFmpeg gave it.
        challenged: Whether it answers a challenge to itself, so that another challenge means that the account is refused.
    """

    request: RtspMessage
    cseq: str
    challenged: bool = False


class RtspRelay:
    """Relays one RTSP connection. As a context manager, it returns the URL that FFmpeg opens; leaving it closes the connection.

    Args:
        url: The stream's URL on the device, without credentials.
        credentials: The account; None if the stream needs none.
        timeout_s: Seconds that connecting and sending may take.
        tls: Verifies the certificate of an ``rtsps`` server; by default, with the authorities that the system trusts.

    Attributes:
        failure: Why the device cannot be used; None as long as it can.
    """

    def __init__(self, url: str, credentials: Credentials | None, *, timeout_s: float, tls: ssl.SSLContext | None = None) -> None:
        parts = urlsplit(url)
        self._host, self._port = parts.hostname or "", parts.port or _DEFAULT_PORTS[parts.scheme]
        self._place = parts.netloc
        self._origin = f"{parts.scheme}://{parts.netloc}"
        self._tls = (tls or ssl.create_default_context()) if parts.scheme == "rtsps" else None
        self._timeout_s = timeout_s
        self._sign_in = RtspSignIn(self._place, credentials, tls=self._tls is not None)
        self._path = parts.path + (f"?{parts.query}" if parts.query else "")
        self._own_origin = ""
        self.failure: CameraError | None = None
        self._closing = threading.Event()
        self._waiting: dict[str, _Sent] = {}
        self._sent_count, self._known = 0, False
        self._thread: threading.Thread | None = None

    def __enter__(self) -> str:
        listener = socket.create_server(("127.0.0.1", 0), backlog=1)
        # The token keeps other programs on this machine from watching the camera without its password.
        self._own_origin = f"rtsp://127.0.0.1:{listener.getsockname()[1]}/{secrets.token_urlsafe(24)}"
        self._thread = threading.Thread(target=self._run, args=(listener,), name=f"rtsp relay {self._place}", daemon=True)
        self._thread.start()
        return self._own_origin + self._path

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._closing.set()
        if self._thread is not None:
            self._thread.join(self._timeout_s + 2 * POLL_S)

    def _run(self, listener: socket.socket) -> None:
        try:
            with self._accept(listener) as player, self._connect() as device:
                self._exchange(player, device)
        except CameraError as error:
            self.failure = error
        except ssl.SSLError:
            self.failure = CameraUnreachableError(
                f"The TLS connection to {self._place} failed. Its certificate is not trusted, or it does not speak TLS at this "
                "port. If the certificate is self-signed, configure its fingerprint in scope.yaml."
            )
        except (OSError, EOFError):
            pass  # FFmpeg or the device has closed the connection, which ``RtspStream`` opens again

    def _accept(self, listener: socket.socket) -> socket.socket:
        """Return the connection of FFmpeg. No other connection is accepted after it."""
        with listener:
            listener.settimeout(POLL_S)
            while not self._closing.is_set():
                with suppress(TimeoutError):
                    player, _ = listener.accept()
                    player.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, UNREAD_BYTES)
                    player.settimeout(self._timeout_s)
                    return player
        raise EOFError

    def _connect(self) -> socket.socket:
        device = socket.create_connection((self._host, self._port), self._timeout_s)
        device.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if self._tls is None:
            return device
        try:
            return self._tls.wrap_socket(device, server_hostname=self._host)
        except BaseException:
            device.close()
            raise

    def _exchange(self, player: socket.socket, device: socket.socket) -> None:
        """Relay in both directions until an end closes its connection, or the relay is closed."""
        requests, replies = MessageSplitter("the RTSP client"), MessageSplitter(self._place)
        with selectors.DefaultSelector() as selector:
            for each in (player, device):
                selector.register(each, selectors.EVENT_READ)
            while not self._closing.is_set():
                for key, _ in selector.select(POLL_S):
                    if key.fileobj is device:
                        for found in replies.feed(_receive(device)):
                            self._handle(found, player, device)
                    else:
                        for found in requests.feed(_receive(player)):
                            device.sendall(found if isinstance(found, bytes) else self._translate(found))

    def _translate(self, request: RtspMessage) -> bytes:
        """Return a request of FFmpeg as it is sent to the device.

        Raises:
            EOFError: The request comes from another program.
        """
        method, _, rest = request.start.partition(" ")
        if not self._known and not rest.startswith(self._own_origin):
            raise EOFError
        self._known = True
        rest = self._origin + rest.removeprefix(self._own_origin) if rest.startswith(self._own_origin) else rest
        cseq = (request.values("cseq") or ["0"])[0]
        return self._encode(_Sent(RtspMessage(f"{method} {rest}", request.headers, request.body), cseq))

    def _encode(self, sent: _Sent) -> bytes:
        """Return a request with a sequence number of this connection, signed if the device requires it."""
        self._sent_count += 1
        self._waiting[str(self._sent_count)] = sent
        method, uri, _ = sent.request.start.split(" ", 2)
        numbered = sent.request.replacing("CSeq", str(self._sent_count))
        return numbered.replacing("Authorization", self._sign_in.answer(method, uri)).encode()

    def _answered(self, reply: RtspMessage) -> _Sent | None:
        """Return the request that a reply answers; None if there is none.

        If the reply states no known number, it is the oldest one, because devices answer in order.
        """
        key = next(iter(reply.values("cseq")), "")
        return self._waiting.pop(key if key in self._waiting else next(iter(self._waiting), ""), None)

    def _handle(self, found: RtspMessage | bytes, player: socket.socket, device: socket.socket) -> None:
        """Forward a packet or a reply to FFmpeg, or answer a challenge.

        Raises:
            CameraError: The reply is a redirect, or refuses the account.
        """
        if isinstance(found, bytes) or found.status is None:
            player.sendall(found if isinstance(found, bytes) else found.encode())
            return
        if 300 <= found.status < 400:
            raise ForeignAddressError(
                f"The RTSP server at {self._place} redirects to another address. Redirects are not followed and no credentials "
                "were sent there. Check the camera's stream settings."
            )
        sent = self._answered(found)
        if sent is None:
            return
        if found.status == 401:
            self._sign_in.accept(found.values("www-authenticate"))
            if sent.challenged and not self._sign_in.stale:
                raise CameraSignInError(
                    f"The RTSP server at {self._place} refuses the user name or the password. Check both, then try again."
                )
            sent.challenged = True
            device.sendall(self._encode(sent))
            return
        player.sendall(found.replacing("CSeq", sent.cseq).encode())


def _receive(connection: socket.socket) -> bytes:
    """Return the data that has arrived.

    Raises:
        EOFError: The other end has closed the connection.
    """
    data = connection.recv(_CHUNK_BYTES)
    if not data:
        raise EOFError
    # Data that TLS has already decrypted does not make the socket readable again.
    with suppress(AttributeError):
        while connection.pending():  # type: ignore[attr-defined]
            data += connection.recv(_CHUNK_BYTES)
    return data
