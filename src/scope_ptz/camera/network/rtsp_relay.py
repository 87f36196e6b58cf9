"""A relay between FFmpeg and a device's RTSP server, which hides the password from FFmpeg.

FFmpeg follows RTSP redirects to any host and sends the password there, in clear text if that host asks for it. FFmpeg therefore
connects to a relay in this process, which signs in to the device itself and rejects redirects.
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
"""Interval in seconds at which the thread checks whether the relay has been closed."""

UNREAD_BYTES = 128 * 1024
"""Size in bytes of the buffer for media that FFmpeg has not read yet. A larger buffer would add delay when FFmpeg is slow."""

_CHUNK_BYTES = 64 * 1024
_DEFAULT_PORTS = {"rtsp": 554, "rtsps": 322}


@dataclass(slots=True)
class _PendingRequest:
    """A request that the device has not answered yet.

    Attributes:
        request: The request, without authorization.
        cseq: FFmpeg's sequence number for the request.
        challenged: Whether the request was resent after a challenge. A second challenge means that the credentials were rejected.
    """

    request: RtspMessage
    cseq: str
    challenged: bool = False


class RtspRelay:
    """Relays an RTSP connection. As a context manager, it returns the URL for FFmpeg and closes the connection on exit.

    Args:
        url: The stream's URL on the device, without credentials.
        credentials: The credentials; None if the stream requires none.
        timeout_s: Timeout in seconds for connecting and for sending.
        tls: The TLS context for an ``rtsps`` server; by default, one that trusts the system's certificate authorities.

    Attributes:
        failure: The error that makes the device unusable; None if there is none.
    """

    def __init__(self, url: str, credentials: Credentials | None, *, timeout_s: float, tls: ssl.SSLContext | None = None) -> None:
        parts = urlsplit(url)
        self._host, self._port = parts.hostname or "", parts.port or _DEFAULT_PORTS[parts.scheme]
        self._server = parts.netloc
        self._origin = f"{parts.scheme}://{parts.netloc}"
        self._tls = (tls or ssl.create_default_context()) if parts.scheme == "rtsps" else None
        self._timeout_s = timeout_s
        self._sign_in = RtspSignIn(self._server, credentials, tls=self._tls is not None)
        self._path = parts.path + (f"?{parts.query}" if parts.query else "")
        self._own_origin = ""
        self.failure: CameraError | None = None
        self._closing = threading.Event()
        self._pending: dict[str, _PendingRequest] = {}
        self._request_count, self._player_verified = 0, False
        self._thread: threading.Thread | None = None

    def __enter__(self) -> str:
        listener = socket.create_server(("127.0.0.1", 0), backlog=1)
        # The token prevents other programs on this machine from watching the camera without its password.
        self._own_origin = f"rtsp://127.0.0.1:{listener.getsockname()[1]}/{secrets.token_urlsafe(24)}"
        self._thread = threading.Thread(target=self._run, args=(listener,), name=f"rtsp relay {self._server}", daemon=True)
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
                f"The TLS connection to {self._server} failed. Either the camera's certificate is not trusted, or the camera does "
                "not use TLS on this port. If the certificate is self-signed, set its fingerprint in scope.yaml."
            )
        except (OSError, EOFError):
            pass  # FFmpeg or the device closed the connection; ``RtspStream`` reopens it

    def _accept(self, listener: socket.socket) -> socket.socket:
        """Accept FFmpeg's connection. Later connections are not accepted."""
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
        """Relay data in both directions until either end closes its connection or the relay is closed."""
        requests, replies = MessageSplitter("the RTSP client"), MessageSplitter(self._server)
        with selectors.DefaultSelector() as selector:
            for connection in (player, device):
                selector.register(connection, selectors.EVENT_READ)
            while not self._closing.is_set():
                for key, _ in selector.select(POLL_S):
                    if key.fileobj is device:
                        for item in replies.feed(_receive(device)):
                            self._handle(item, player, device)
                    else:
                        for item in requests.feed(_receive(player)):
                            device.sendall(item if isinstance(item, bytes) else self._translate(item))

    def _translate(self, request: RtspMessage) -> bytes:
        """Rewrite a request from FFmpeg for the device.

        Raises:
            EOFError: The request is not from FFmpeg.
        """
        method, _, rest = request.start.partition(" ")
        if not self._player_verified and not rest.startswith(self._own_origin):
            raise EOFError
        self._player_verified = True
        rest = self._origin + rest.removeprefix(self._own_origin) if rest.startswith(self._own_origin) else rest
        cseq = (request.values("cseq") or ["0"])[0]
        return self._encode(_PendingRequest(RtspMessage(f"{method} {rest}", request.headers, request.body), cseq))

    def _encode(self, pending_request: _PendingRequest) -> bytes:
        """Encode a request with this connection's sequence number, and with an authorization header if the device requires one."""
        self._request_count += 1
        self._pending[str(self._request_count)] = pending_request
        method, uri, _ = pending_request.request.start.split(" ", 2)
        numbered = pending_request.request.with_header("CSeq", str(self._request_count))
        return numbered.with_header("Authorization", self._sign_in.answer(method, uri)).encode()

    def _pop_answered(self, reply: RtspMessage) -> _PendingRequest | None:
        """Remove and return the request that a reply belongs to; None if there is none.

        Devices reply in order, so a reply without a known sequence number belongs to the oldest request.
        """
        key = next(iter(reply.values("cseq")), "")
        return self._pending.pop(key if key in self._pending else next(iter(self._pending), ""), None)

    def _handle(self, item: RtspMessage | bytes, player: socket.socket, device: socket.socket) -> None:
        """Forward a packet or a message to FFmpeg, or answer an authentication challenge.

        Raises:
            CameraError: The reply is a redirect, or the device rejected the credentials.
        """
        if isinstance(item, bytes) or item.status is None:
            player.sendall(item if isinstance(item, bytes) else item.encode())
            return
        if 300 <= item.status < 400:
            raise ForeignAddressError(
                f"The RTSP server at {self._server} redirects to another address. The redirect was not followed, and no "
                "credentials were sent there. Check the camera's stream settings."
            )
        pending_request = self._pop_answered(item)
        if pending_request is None:
            return
        if item.status == 401:
            self._sign_in.accept(item.values("www-authenticate"))
            if pending_request.challenged and not self._sign_in.is_stale:
                raise CameraSignInError(
                    f"The RTSP server at {self._server} rejected the user name or the password. Check both, then try again."
                )
            pending_request.challenged = True
            device.sendall(self._encode(pending_request))
            return
        player.sendall(item.with_header("CSeq", pending_request.cseq).encode())


def _receive(connection: socket.socket) -> bytes:
    """Receive the available data.

    Raises:
        EOFError: The other end has closed the connection.
    """
    data = connection.recv(_CHUNK_BYTES)
    if not data:
        raise EOFError
    # Data that TLS has already decrypted does not make the socket readable.
    with suppress(AttributeError):
        while connection.pending():  # type: ignore[attr-defined]
            data += connection.recv(_CHUNK_BYTES)
    return data
