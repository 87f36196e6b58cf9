"""An RTSP client in plain Python, written from the standards. It exposes details that other clients hide."""

from __future__ import annotations

import asyncio
import hashlib
import re
from collections import deque
from contextlib import suppress
from dataclasses import dataclass, field
from struct import unpack_from
from types import TracebackType
from typing import Self

NTP_EPOCH_S = 2_208_988_800


@dataclass(frozen=True)
class Answer:
    """A reply of the server. ``headers`` maps lower-case names to all their values."""

    status: int
    headers: dict[str, list[str]]
    body: bytes

    def __getitem__(self, name: str) -> str:
        return self.headers[name][0]

    @property
    def session(self) -> str:
        return self["session"].partition(";")[0]


@dataclass(frozen=True)
class RtpPacket:
    """A parsed RTP packet."""

    marker: bool
    sequence: int
    timestamp: int
    ssrc: int
    payload: bytes

    @classmethod
    def parse(cls, data: bytes) -> RtpPacket:
        first, second, sequence, timestamp, ssrc = unpack_from("!BBHII", data)
        assert (first, second & 0x7F) == (0x80, 96)
        return cls(bool(second & 0x80), sequence, timestamp, ssrc, data[12:])


@dataclass(frozen=True)
class SenderReport:
    """The part of a sender report that maps time stamps to wall-clock time."""

    ssrc: int
    unix_s: float
    timestamp: int
    packets: int
    octets: int

    @classmethod
    def parse(cls, data: bytes) -> SenderReport:
        first, kind, length, ssrc, seconds, fraction, timestamp, packets, octets = unpack_from("!BBHIIIIII", data)
        assert (first, kind, length) == (0x80, 200, 6)
        return cls(ssrc, seconds - NTP_EPOCH_S + fraction / 2**32, timestamp, packets, octets)

    def taken_s(self, timestamp: int) -> float:
        """Return the Unix time of a time stamp near this report."""
        ticks = (timestamp - self.timestamp + 2**31) % 2**32 - 2**31
        return self.unix_s + ticks / 90_000


@dataclass
class Depacketizer:
    """Assembles pictures from packets (RFC 6184)."""

    nals: list[bytes] = field(default_factory=list)
    _fragments: bytearray = field(default_factory=bytearray)

    def add(self, packet: RtpPacket) -> list[bytes] | None:
        """Add a packet. Return the NAL units of a picture if the packet completes it."""
        kind = packet.payload[0] & 0x1F
        assert kind in {1, 5, 7, 8, 28}, kind
        if kind == 28:
            indicator, header = packet.payload[:2]
            if header & 0x80:
                self._fragments = bytearray([(indicator & 0xE0) | (header & 0x1F)])
            self._fragments += packet.payload[2:]
            if header & 0x40:
                self.nals.append(bytes(self._fragments))
        else:
            self.nals.append(packet.payload)
        if not packet.marker:
            return None
        picture, self.nals = self.nals, []
        return picture


class RtspClient:
    """A connection to an RTSP server.

    Args:
        port: Port on this machine.
        user: Account. Requests are signed if the server requires it.
        password: Password of the account.
        path: Path and options of the stream.
    """

    def __init__(self, port: int, *, user: str = "", password: str = "", path: str = "/axis-media/media.amp") -> None:
        self.port, self.url = port, f"rtsp://127.0.0.1:{port}{path}"
        self._user, self._password = user, password
        self._challenge: dict[str, str] = {}
        self._count = 0
        self._packets: deque[tuple[int, bytes]] = deque()

    async def __aenter__(self) -> Self:
        self._reader, self._writer = await asyncio.open_connection("127.0.0.1", self.port)
        return self

    async def __aexit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.vanish()
        with suppress(OSError):
            await self._writer.wait_closed()

    def vanish(self) -> None:
        """Abort the connection."""
        self._writer.transport.abort()

    async def send(self, content: bytes) -> None:
        """Send raw bytes."""
        self._writer.write(content)
        await self._writer.drain()

    async def request(self, method: str, uri: str = "", body: bytes = b"", **headers: str) -> Answer:
        """Send a request and return the answer. Sign the request if the server requires it."""
        answer = await self._once(method, uri or self.url, body, headers)
        if answer.status == 401 and self._user and not headers.get("Authorization"):
            challenge = next(each for each in answer.headers["www-authenticate"] if "MD5" in each)
            self._challenge = dict(re.findall(r'(\w+)="?([^",]+)"?', challenge))
            answer = await self._once(method, uri or self.url, body, headers)
        return answer

    async def play(self, transport: str = "RTP/AVP/TCP;unicast;interleaved=0-1") -> Answer:
        """Describe, set up and play. Return the answer to PLAY."""
        description = await self.request("DESCRIBE", Accept="application/sdp")
        assert description.status == 200, description
        track = [line for line in description.body.decode().splitlines() if line.startswith("a=control:")][-1].partition(":")[2]
        self.set_up = await self.request("SETUP", track, Transport=transport)
        assert self.set_up.status == 200, self.set_up
        answer = await self.request("PLAY", description["content-base"], Session=self.set_up.session)
        assert answer.status == 200, answer
        return answer

    async def packet(self, channel: int) -> bytes:
        """Return the next packet on a channel."""
        while True:
            for k, (packet_channel, data) in enumerate(self._packets):
                if packet_channel == channel:
                    del self._packets[k]
                    return data
            assert await self._read() is None

    async def answer(self) -> Answer:
        """Return the next reply; packets before it are kept."""
        while (answer := await self._read()) is None:
            pass
        return answer

    async def _once(self, method: str, uri: str, body: bytes, headers: dict[str, str]) -> Answer:
        self._count += 1
        authorization = {"Authorization": self.signature(method, uri)} if self._challenge else {}
        lines = {"CSeq": str(self._count), **authorization, **headers, **({"Content-Length": str(len(body))} if body else {})}
        head = "".join(f"{name}: {value}\r\n" for name, value in lines.items())
        await self.send(f"{method} {uri} RTSP/1.0\r\n{head}\r\n".encode() + body)
        answer = await self.answer()
        assert answer["cseq"] == str(self._count)
        return answer

    def signature(self, method: str, uri: str = "") -> str:
        """Return the answer to the server's challenge for a request."""
        uri = uri or self.url

        def h(text: str) -> str:
            return hashlib.md5(text.encode()).hexdigest()  # noqa: S324 - the standard's

        realm, nonce = self._challenge["realm"], self._challenge["nonce"]
        response = h(f"{h(f'{self._user}:{realm}:{self._password}')}:{nonce}:{h(f'{method}:{uri}')}")
        return f'Digest username="{self._user}", realm="{realm}", nonce="{nonce}", uri="{uri}", response="{response}"'

    async def _read(self) -> Answer | None:
        first = await self._reader.readexactly(1)
        if first == b"$":
            channel, *length = await self._reader.readexactly(3)
            self._packets.append((channel, await self._reader.readexactly(int.from_bytes(bytes(length), "big"))))
            return None
        head = (first + await self._reader.readuntil(b"\r\n\r\n")).decode()
        status, *lines = head.split("\r\n")
        headers: dict[str, list[str]] = {}
        for line in filter(None, lines):
            name, _, value = line.partition(": ")
            headers.setdefault(name.lower(), []).append(value)
        body = await self._reader.readexactly(int(headers.get("content-length", ["0"])[0]))
        assert status.startswith("RTSP/1.0 "), status
        return Answer(int(status.split()[1]), headers, body)
