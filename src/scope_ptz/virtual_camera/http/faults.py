"""Apply a camera's faults to HTTP requests, except those below ``/virtual/``, which can turn faults off."""

from __future__ import annotations

import random

import anyio
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.http.access import AccessControl
from scope_ptz.virtual_camera.http.connection import abort_connection

CONTROL_PATH = "/virtual/"
"""Path prefix of requests that are exempt from faults, so that faults can always be turned off."""

GARBAGE = b"\x00\xff<<<%%garbage}{"
"""The content that replaces reply bodies while the fault ``garbage`` is on."""


class _ConnectionAbortedError(Exception):
    """The connection was closed while a reply was being sent."""


class FaultMiddleware:
    """Middleware that drops, delays, rejects or corrupts replies according to the device's faults.

    Args:
        app: The application that handles the requests.
        device: The camera.
        access: The access control, which creates the reply for rejected accounts.
        closing: An event that is set when the server shuts down, which ends all delays.
    """

    def __init__(self, app: ASGIApp, device: VirtualDevice, access: AccessControl, closing: anyio.Event) -> None:
        self._app, self._device, self._access, self._closing = app, device, access, closing
        self._random = random.Random(0)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or scope["path"].startswith(CONTROL_PATH):
            await self._app(scope, receive, send)
            return
        faults = self._device.faults
        if faults.stall_s:
            with anyio.move_on_after(faults.stall_s):
                await self._closing.wait()
        if self._device.down or self._random.random() < faults.drop:
            await abort_connection(scope, receive)
        elif faults.unauthorized:
            await self._access.refusal()(scope, receive, send)
        else:
            await self._answer(scope, receive, send)

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def send_faulty(message: Message) -> None:
            if self._device.down:
                raise _ConnectionAbortedError
            await send(_corrupt(message) if self._device.faults.garbage else message)

        try:
            await self._app(scope, receive, send_faulty)
        except* _ConnectionAbortedError:
            await abort_connection(scope, receive)


def _corrupt(message: Message) -> Message:
    """Return a message with its body replaced with garbage."""
    if message["type"] == "http.response.start":
        headers = [(name, value) for name, value in message["headers"] if name.lower() != b"content-length"]
        return {**message, "status": 200 if message["status"] == 204 else message["status"], "headers": headers}
    return {**message, "body": GARBAGE}
