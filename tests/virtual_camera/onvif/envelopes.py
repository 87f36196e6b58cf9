"""Requests written by hand: for what a well-behaved client cannot send."""

from __future__ import annotations

import base64
import hashlib
import os
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Any

import httpx2
from lxml import etree

PTZ = "http://www.onvif.org/ver20/ptz/wsdl"
DEVICE = "http://www.onvif.org/ver10/device/wsdl"
MEDIA = "http://www.onvif.org/ver10/media/wsdl"
MEDIA2 = "http://www.onvif.org/ver20/media/wsdl"
SOAP = "http://www.w3.org/2003/05/soap-envelope"
_WSS = "http://docs.oasis-open.org/wss/2004/01/oasis-200401-wss-"


def token(
    name: str, password: str, *, created: datetime | str | None = None, nonce: bytes | None = None, text: bool = False
) -> str:
    """Return a WS-Security header."""
    created = datetime.now(UTC) if created is None else created
    stamp = created if isinstance(created, str) else created.isoformat().replace("+00:00", "Z")
    nonce = os.urandom(16) if nonce is None else nonce
    digest = base64.b64encode(hashlib.sha1(nonce + stamp.encode() + password.encode()).digest()).decode()  # noqa: S324
    kind, secret = ("PasswordText", password) if text else ("PasswordDigest", digest)
    return (
        f'<o:Security xmlns:o="{_WSS}wssecurity-secext-1.0.xsd" xmlns:u="{_WSS}wssecurity-utility-1.0.xsd" s:mustUnderstand="1">'
        f"<o:UsernameToken><o:Username>{name}</o:Username>"
        f'<o:Password Type="{_WSS}username-token-profile-1.0#{kind}">{secret}</o:Password>'
        f"<o:Nonce>{base64.b64encode(nonce).decode()}</o:Nonce><u:Created>{stamp}</u:Created></o:UsernameToken></o:Security>"
    )


def envelope(body: str, header: str = "") -> bytes:
    """Return a SOAP request."""
    return f'<s:Envelope xmlns:s="{SOAP}"><s:Header>{header}</s:Header><s:Body>{body}</s:Body></s:Envelope>'.encode()


def ptz_request(name: str, inner: str = "") -> str:
    """Return the body of a PTZ request for the profile."""
    tt = "http://www.onvif.org/ver10/schema"
    return f'<{name} xmlns="{PTZ}" xmlns:tt="{tt}"><ProfileToken>profile-1</ProfileToken>{inner}</{name}>'


def ago(seconds: float) -> datetime:
    """Return a time before now."""
    return datetime.now(UTC) - timedelta(seconds=seconds)


@dataclass(frozen=True)
class Answer:
    """A reply: its HTTP status, and its body as XML (None if it is none)."""

    status: int
    root: Any
    headers: httpx2.Headers

    @property
    def codes(self) -> list[str]:
        """The fault's codes from the outermost, without prefixes; empty if it is no fault."""
        values = self.root.iterfind(f".//{{{SOAP}}}Fault/{{{SOAP}}}Code//{{{SOAP}}}Value")
        return [value.text.partition(":")[2] for value in values]

    @property
    def reason(self) -> str:
        return str(self.root.findtext(f".//{{{SOAP}}}Reason/{{{SOAP}}}Text"))


async def post(url: str, content: bytes, path: str = "/onvif/device_service", **options: Any) -> Answer:
    """Send bytes and return the reply."""
    async with httpx2.AsyncClient(base_url=url, **options) as client:
        reply = await client.post(path, content=content, headers={"Content-Type": "application/soap+xml"})
    return Answer(reply.status_code, etree.fromstring(reply.content) if reply.content else None, reply.headers)
