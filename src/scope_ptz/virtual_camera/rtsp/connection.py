"""RTSP connections, which read and handle requests one at a time."""

from __future__ import annotations

import asyncio
import logging
import random
from collections.abc import Awaitable, Callable
from contextlib import suppress

from anyio import to_thread

from scope_ptz.errors import ScopeError
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.digest import DigestAuthenticator
from scope_ptz.virtual_camera.live_source import LiveSource
from scope_ptz.virtual_camera.rtsp.encoder import parameter_sets
from scope_ptz.virtual_camera.rtsp.messages import (
    REASONS,
    InterleavedPacket,
    MalformedError,
    RefusedError,
    Reply,
    Request,
    TunnelRequest,
    read_message,
)
from scope_ptz.virtual_camera.rtsp.sdp import describe, describe_events
from scope_ptz.virtual_camera.rtsp.session import Session
from scope_ptz.virtual_camera.rtsp.sessions import Sessions
from scope_ptz.virtual_camera.rtsp.sinks import InterleavedSink, limit_send_buffers, open_udp
from scope_ptz.virtual_camera.rtsp.stream_url import StreamFormat, StreamUrl, parse_url, stream_format
from scope_ptz.virtual_camera.rtsp.transport_header import TransportOffer, choose_transport
from scope_ptz.virtual_camera.rtsp.tunnel import GET_REPLY, Tunnels

IDLE_TIMEOUT_S = 60.0
"""Seconds after which a connection without sessions is closed."""

IO_TIMEOUT_S = 10.0  # maximum time in seconds to receive the rest of a message, or to send a reply
GARBAGE = b"\x00\xff<<<%%garbage}{\r\n\r\n"  # sent in place of each reply while the fault ``garbage`` is on
SERVER = "scope-ptz"

logger = logging.getLogger(__name__)

Handler = Callable[[Request], Awaitable[Reply]]


class RtspConnection:
    """A client's connection.

    Args:
        device: The camera.
        source: The camera's live video.
        sessions: The camera's sessions, which all of its connections share.
        tunnels: The camera's RTSP-over-HTTP tunnels, which all of its connections share.
        digest: The authenticator.
        rng: Random number generator that decides which requests to drop.
        reader: The connection's incoming data.
        writer: The connection's outgoing data.
    """

    def __init__(
        self,
        device: VirtualDevice,
        source: LiveSource,
        sessions: Sessions,
        tunnels: Tunnels,
        digest: DigestAuthenticator,
        rng: random.Random,
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
    ) -> None:
        self._device, self._source, self._sessions, self._digest = device, source, sessions, digest
        self._tunnels = tunnels
        self._rng = rng
        self._reader, self._writer = reader, writer
        self._local_address: str = writer.get_extra_info("sockname")[0]
        self._peer: str = writer.get_extra_info("peername")[0]
        self._account = ""
        self._own_sessions: dict[str, Session] = {}
        self._handlers: dict[str, Handler] = {
            "OPTIONS": self._options,
            "DESCRIBE": self._describe,
            "SETUP": self._setup,
            "PLAY": self._play,
            "PAUSE": self._pause,
            "TEARDOWN": self._teardown,
            "GET_PARAMETER": self._parameter,
            "SET_PARAMETER": self._parameter,
        }

    def abort(self) -> None:
        """Abort the connection, which ends ``run``."""
        self._writer.transport.abort()

    async def run(self) -> None:
        """Handle requests until either side closes the connection."""
        limit_send_buffers(self._writer)
        try:
            while await self._serve_next():
                pass
        except (OSError, EOFError, TimeoutError):
            pass  # the client disconnected or is too slow
        finally:
            self._tunnels.close(self._reader)
            for session in list(self._own_sessions.values()):
                session.connected = False
                if isinstance(session.sink, InterleavedSink):
                    await self._sessions.end(session)
            self._writer.close()
            with suppress(OSError):
                await self._writer.wait_closed()

    async def _serve_next(self) -> bool:
        """Wait for a message and handle it. Return whether to keep the connection open."""
        try:
            async with asyncio.timeout(IDLE_TIMEOUT_S):
                first = await self._reader.readexactly(1)
        except TimeoutError:
            return any(not session.ended for session in self._own_sessions.values())
        try:
            async with asyncio.timeout(IO_TIMEOUT_S):
                message = await read_message(self._reader, first)
        except MalformedError as error:
            await self._write(Reply(error.status).encode(None))
            return False
        if isinstance(message, TunnelRequest):
            return await self._tunnel(message)
        if isinstance(message, InterleavedPacket):
            self._touch(message.channel)
        elif message is not None:
            return await self._respond(message)
        return True

    async def _tunnel(self, request: TunnelRequest) -> bool:
        """Turn the connection into one direction of an RTSP-over-HTTP tunnel. Return whether to keep it open."""
        try:
            if request.method == "GET":
                self._reader = self._tunnels.open(request, self._peer)
                await self._write(GET_REPLY)
                return True
            await self._tunnels.receive(request, self._peer, self._reader, self._writer.transport)
        except RefusedError as refused:
            await self._write(f"HTTP/1.0 {refused.status} {REASONS[refused.status]}\r\nConnection: close\r\n\r\n".encode())
        return False

    def _touch(self, channel: int) -> None:
        for session in self._own_sessions.values():
            if isinstance(session.sink, InterleavedSink) and channel in session.sink.channels:
                session.touch()

    async def _respond(self, request: Request) -> bool:
        faults = self._device.faults
        if faults.stall_s:
            await asyncio.sleep(faults.stall_s)
        if self._device.down or self._rng.random() < faults.drop:
            self.abort()
            return False
        if faults.garbage:
            await self._write(GARBAGE)
            return True
        try:
            reply = await self._answer(request)
        except RefusedError as refused:
            reply = Reply(refused.status, tuple(refused.headers.items()))
        except ScopeError as error:
            logger.warning("%s of %s failed: %s", request.method, self._device.name, error)
            reply = Reply(500)
        await self._write(Reply(reply.status, (("Server", SERVER), *reply.headers), reply.body).encode(request.cseq))
        return True

    async def _write(self, content: bytes) -> None:
        self._writer.write(content)
        async with asyncio.timeout(IO_TIMEOUT_S):
            await self._writer.drain()

    async def _answer(self, request: Request) -> Reply:
        handler = self._handlers.get(request.method)
        if handler is None:
            raise RefusedError(501, {"Public": ", ".join(self._handlers)})
        if "require" in request.headers:
            raise RefusedError(551, {"Unsupported": request.headers["require"]})
        if self._device.faults.unauthorized or (request.method != "OPTIONS" and not self._device.accounts.is_open):
            result = self._digest.check(request.headers.get("authorization"), request.method)
            if result.account is None or self._device.faults.unauthorized:
                challenges = self._digest.challenges(stale=result.stale)
                return Reply(401, tuple(("WWW-Authenticate", challenge) for challenge in challenges))
            self._account = result.account.name
        return await handler(request)

    def _stream_format(self, url: StreamUrl) -> StreamFormat:
        return stream_format(url, self._device, self._source.rate_hz)

    def _session(self, request: Request) -> Session:
        token = request.headers.get("session", "").partition(";")[0].strip()
        return self._sessions.find(token, (self._peer, self._account))

    def _session_header(self, session: Session) -> tuple[str, str]:
        return "Session", f"{session.token};timeout={max(1, int(self._sessions.timeout_s))}"

    async def _options(self, request: Request) -> Reply:
        if "session" in request.headers:
            with suppress(RefusedError):  # the request only keeps the session alive, so an unknown session is not an error
                self._session(request)
        return Reply(headers=(("Public", ", ".join(self._handlers)),))

    async def _describe(self, request: Request) -> Reply:
        url = parse_url(request.uri)
        accepted = request.headers.get("accept", "*/*").lower()
        if not any(media_type in accepted for media_type in ("application/sdp", "application/*", "*/*")):
            raise RefusedError(406)
        if url.events_only:
            body = describe_events(url, name=self._device.name, host=self._local_address)
        else:
            requested_format = self._stream_format(url)
            width, height, fps = requested_format.width, requested_format.height, requested_format.fps
            encoder_sets = await to_thread.run_sync(parameter_sets, width, height, fps)
            body = describe(url, requested_format, encoder_sets, name=self._device.name, host=self._local_address)
        head = (("Content-Type", "application/sdp"), ("Content-Base", url.content_base), ("Cache-Control", "no-cache"))
        return Reply(headers=head, body=body)

    async def _setup(self, request: Request) -> Reply:
        url = parse_url(request.uri)
        offer = choose_transport(request.headers.get("transport", ""))
        if "session" in request.headers:
            session = self._session(request)
            if session.playing:
                raise RefusedError(455)
            if session.sink is not None:
                session.sink.close()
                session.sink = None
        else:
            session = self._sessions.open(None if url.events_only else self._stream_format(url), (self._peer, self._account))
        try:
            transport = await (self._set_up_tcp(session, offer) if offer.interleaved else self._set_up_udp(session, offer))
        except RefusedError:
            await self._sessions.end(session)
            raise
        self._own_sessions = {token: other for token, other in self._own_sessions.items() if not other.ended} | {
            session.token: session
        }
        return Reply(
            headers=(("Transport", f'{transport};ssrc={session.packetizer.ssrc:08X};mode="PLAY"'), self._session_header(session))
        )

    async def _set_up_tcp(self, session: Session, offer: TransportOffer) -> str:
        used_channels = {
            c
            for other in self._own_sessions.values()
            if isinstance(other.sink, InterleavedSink) and not other.ended
            for c in other.sink.channels
        }
        pairs = [offer.pair] if offer.pair is not None else [(k, k + 1) for k in range(0, 256, 2)]
        channels = next((pair for pair in pairs if not used_channels.intersection(pair)), None)
        if channels is None:
            raise RefusedError(461)
        session.sink, session.on_lost = InterleavedSink(self._writer, channels), self.abort
        return f"RTP/AVP/TCP;unicast;interleaved={channels[0]}-{channels[1]}"

    async def _set_up_udp(self, session: Session, offer: TransportOffer) -> str:
        assert offer.pair is not None  # noqa: S101 - a UDP offer always has ports
        session.sink = await open_udp(self._local_address, self._peer, offer.pair, session.touch, session.handle_loss)
        session.on_lost = lambda: self._sessions.end_soon(session)
        client_ports, server_ports = offer.pair, session.sink.ports
        return f"RTP/AVP;unicast;client_port={client_ports[0]}-{client_ports[1]};server_port={server_ports[0]}-{server_ports[1]}"

    async def _play(self, request: Request) -> Reply:
        url = parse_url(request.uri)
        session = self._session(request)
        sequence, timestamp = session.play()
        info = f"url={url.track};seq={sequence};rtptime={timestamp}"
        return Reply(headers=(self._session_header(session), ("Range", "npt=now-"), ("RTP-Info", info)))

    async def _pause(self, request: Request) -> Reply:
        session = self._session(request)
        session.pause()
        return Reply(headers=(self._session_header(session),))

    async def _teardown(self, request: Request) -> Reply:
        session = self._session(request)
        await self._sessions.end(session)
        return Reply()

    async def _parameter(self, request: Request) -> Reply:
        """Handle a request to get or set parameters. The camera has none, so only empty (keep-alive) requests succeed."""
        head = (self._session_header(self._session(request)),) if "session" in request.headers else ()
        if request.body:
            raise RefusedError(451)
        return Reply(headers=head)
