"""A deliberate fault injector in front of the ONVIF services of the virtual camera: the faults of vendors, in their messages."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.onvif.app import OnvifApp

FAULT = (
    '<e:Envelope xmlns:e="http://www.w3.org/2003/05/soap-envelope" xmlns:t="http://www.onvif.org/ver10/error"><e:Body><e:Fault>'
    "<e:Code><e:Value>e:Sender</e:Value><e:Subcode><e:Value>t:{code}</e:Value></e:Subcode></e:Code>"
    '<e:Reason><e:Text xml:lang="en">{reason}</e:Text></e:Reason></e:Fault></e:Body></e:Envelope>'
)


@dataclass
class Vendor:
    """How a device deviates.

    Attributes:
        refuse: Returns the code of a fault for an operation and its request, or "".
        change: Returns the reply of an operation as the device sends it.
        redirect: Where every request is redirected to; "" for nowhere.
        seen: The operations that were asked for.
    """

    refuse: Callable[[str, bytes], str] = lambda _name, _request: ""
    change: Callable[[str, bytes], bytes] = lambda _name, reply: reply
    redirect: str = ""
    seen: list[str] = field(default_factory=list)

    def __call__(self, device: VirtualDevice) -> Any:
        """Return the application of a device (for ``serve``)."""
        inner = OnvifApp(device)

        async def app(scope: Any, receive: Any, send: Any) -> None:
            if self.redirect:
                await _reply(send, 307, b"", [(b"location", self.redirect.encode())])
                return
            body = b""
            while (message := await receive())["type"] == "http.request":
                body += message.get("body", b"")
                if not message.get("more_body"):
                    break
            found = re.search(rb"<(?:[\w-]+:)?Body[^>]*>\s*<(?:[\w-]+:)?(\w+)", body)
            name = found[1].decode() if found else ""
            self.seen.append(name)
            if code := self.refuse(name, body):
                await _reply(send, 400, FAULT.format(code=code, reason="vendor").encode())
                return
            start: dict[str, Any] = {}

            async def given() -> Any:
                return {"type": "http.request", "body": body}

            async def taken(message: Any) -> None:
                if message["type"] == "http.response.start":
                    start.update(message)
                else:
                    headers = [pair for pair in start["headers"] if pair[0] != b"content-length"]
                    await _reply(send, start["status"], self.change(name, message.get("body", b"")), headers)

            await inner(scope, given, taken)

        return app


def without(tag: str) -> Callable[[bytes], bytes]:
    """Return a function that takes elements out of a reply."""
    pattern = re.compile(rf"<((?:[\w-]+:)?){tag}\b[^>]*?(?:/>|>.*?</\1{tag}>)".encode(), re.DOTALL)
    return lambda reply: pattern.sub(b"", reply)


async def _reply(send: Any, status: int, body: bytes, headers: list[tuple[bytes, bytes]] | None = None) -> None:
    length = (b"content-length", str(len(body)).encode())
    kind = [] if headers else [(b"content-type", b"application/soap+xml")]
    await send({"type": "http.response.start", "status": status, "headers": [*(headers or []), *kind, length]})
    await send({"type": "http.response.body", "body": body})
