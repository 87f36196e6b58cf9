"""The ONVIF services as an ASGI application."""

from __future__ import annotations

import logging
import re
from collections.abc import Awaitable, Callable, Iterable, MutableMapping
from dataclasses import dataclass
from typing import Any

from zeep.exceptions import Error as ZeepError

from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.digest import DigestAuthenticator, DigestResult
from scope_ptz.virtual_camera.identity import serial_number
from scope_ptz.virtual_camera.onvif.clock import device_time_s
from scope_ptz.virtual_camera.onvif.device_service import PATHS, DeviceService
from scope_ptz.virtual_camera.onvif.imaging_service import ImagingService
from scope_ptz.virtual_camera.onvif.media2_service import Media2Service
from scope_ptz.virtual_camera.onvif.media_service import MediaService
from scope_ptz.virtual_camera.onvif.operations import Operations, Reply, Request
from scope_ptz.virtual_camera.onvif.ptz_configuration import PtzConfiguration
from scope_ptz.virtual_camera.onvif.ptz_presets import PresetOperations
from scope_ptz.virtual_camera.onvif.ptz_service import PtzService
from scope_ptz.virtual_camera.onvif.soap import (
    MAX_REQUEST_BYTES,
    Envelope,
    SoapFault,
    as_bytes,
    parse_envelope,
)  # fmt: skip
from scope_ptz.virtual_camera.onvif.username_tokens import CreationTime, UsernameTokens, creation_time, not_authorized
from scope_ptz.virtual_camera.onvif.wsdl import DEVICE, IMAGING, MEDIA, MEDIA2, PTZ, load_document, load_operations

CONTENT_TYPE = "application/soap+xml; charset=utf-8"

_LOG = logging.getLogger(__name__)
_HOST = re.compile(r"(\[[0-9a-fA-F:.]+\]|[A-Za-z0-9._-]{1,253})(:[0-9]{1,5})?")

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]


@dataclass(frozen=True, slots=True)
class RequestTarget:
    """The address at which a client reached the device, and the result of HTTP authentication.

    Attributes:
        host: The device's host name or address, in the form used in URLs.
        origin: The device's scheme, host and port.
        digest_result: The result of HTTP digest authentication; None if the client did not use it.
    """

    host: str
    origin: str
    digest_result: DigestResult | None = None


class OnvifApp:
    """A camera's ONVIF services. Clients authenticate with a WS-UsernameToken or with HTTP digest authentication.

    Args:
        device: The camera.
        rtsp_port: Port of its RTSP server, for the URLs in replies.

    Raises:
        ConfigError: The WSDL files are not installed.
    """

    def __init__(self, device: VirtualDevice, *, rtsp_port: int = 554) -> None:
        self._device = device
        self._types, self._messages = load_document().types, load_operations()
        self._tokens = UsernameTokens(device.accounts, lambda: device_time_s(device))
        self._digest = DigestAuthenticator(device.accounts, f"AXIS_{serial_number(device)}")
        configuration = PtzConfiguration(device)
        ptz = PtzService(device, configuration)
        self._operations: dict[str, Operations] = {
            DEVICE: DeviceService(device, self._capabilities, rtsp_port).operations(),
            MEDIA: MediaService(device, configuration, rtsp_port).operations(),
            IMAGING: ImagingService(device).operations(),
            MEDIA2: Media2Service(device, configuration, rtsp_port).operations(),
            PTZ: {
                **ptz.operations(),
                **configuration.operations(),
                **PresetOperations(device, configuration, ptz).operations(),
            },
        }

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request (ASGI)."""
        if scope["path"].rstrip("/") not in PATHS.values():
            return await _send(send, 404, b"")
        if scope["method"] != "POST":
            return await _send(send, 405, b"", [(b"allow", b"POST")])
        target, headers = self._request_target(scope), []
        try:
            data = await _read(receive)
            if data is None:
                return None
            status, reply = 200, self.answer(data, target)
        except SoapFault as fault:
            status, reply = fault.status, fault.envelope()
            if status == 401:
                stale = target.digest_result is not None and target.digest_result.stale
                headers = [(b"www-authenticate", text.encode()) for text in self._digest.challenges(stale=stale)]
        return await _send(send, status, reply, headers)

    def answer(self, data: bytes, target: RequestTarget) -> bytes:
        """Return the reply to a request.

        Raises:
            SoapFault: The request is invalid or is rejected.
        """
        envelope = parse_envelope(data)
        namespace, _, name = envelope.body.tag.removeprefix("{").rpartition("}")
        operation = self._operations.get(namespace, {}).get(name)
        if operation is None:
            known = (namespace, name) in self._messages
            verb = "does not support" if known else "does not know"
            raise SoapFault(f"The device {verb} the operation {name[:64]}.", "ActionNotSupported", receiver=known)
        created_at = None if operation.role is None else self._authorize(envelope, target, operation.role)
        try:
            arguments = self._messages[namespace, name].input.body.parse(envelope.body, self._types)
        except (ZeepError, ValueError, TypeError, ArithmeticError, LookupError, AttributeError) as error:
            _LOG.debug("Arguments of %s: %s", name, error)
            raise SoapFault(f"The arguments of {name} do not match the types in its WSDL.", "InvalidArgs") from error
        reply = operation.run(Request(arguments, target.host, target.origin, created_at))
        return as_bytes(self._serialize(namespace, name, reply))

    def _authorize(self, envelope: Envelope, target: RequestTarget, role: Role) -> CreationTime | None:
        """Check that the sender of a request has the required role.

        Returns:
            The time at which the request was created; None if it does not include one.

        Raises:
            SoapFault: The sender is not authenticated, or does not have the role.
        """
        if self._device.faults.unauthorized:
            raise not_authorized("The user name or the password is wrong.")
        if self._device.accounts.is_open:
            return creation_time(envelope.header)
        sender = self._tokens.sender(envelope.header)
        account = sender.account if sender else target.digest_result.account if target.digest_result else None
        if account is None:
            raise not_authorized("The operation requires authentication.", status=401)
        if account.role < role:
            raise not_authorized(f"The operation requires the role {role.name.lower()}.")
        return sender.created_at if sender else None

    def _request_target(self, scope: Scope) -> RequestTarget:
        headers = dict(scope["headers"])
        host, origin = _server_address(scope, headers.get(b"host", b"").decode("latin-1"))
        if (answer := headers.get(b"authorization")) is None:
            return RequestTarget(host, origin)
        query = scope["query_string"].decode("latin-1")
        uri = scope["raw_path"].decode("latin-1") + (f"?{query}" if query else "")
        return RequestTarget(host, origin, self._digest.check(answer.decode("latin-1"), scope["method"], uri))

    def _serialize(self, namespace: str, name: str, reply: Reply) -> Any:
        return self._messages[namespace, name].output.serialize(**reply).content

    def _capabilities(self, namespace: str) -> Any:
        """Return the capabilities of the service with a namespace, as an XML element."""
        reply = self._operations[namespace]["GetServiceCapabilities"].run(Request(None, "", ""))
        return self._serialize(namespace, "GetServiceCapabilities", reply).find(f".//{{{namespace}}}Capabilities")


def _server_address(scope: Scope, host_header: str) -> tuple[str, str]:
    """Return the host and the origin (scheme, host and port) at which the client reached the server.

    Args:
        scope: The ASGI scope, which provides the address if the header is invalid.
        host_header: The value of the ``Host`` header.
    """
    match = _HOST.fullmatch(host_header)
    if match is None:
        host, port = scope.get("server") or ("localhost", None)
        host = f"[{host}]" if ":" in host else host
        return host, f"{scope['scheme']}://{host}" + (f":{port}" if port else "")
    return match[1], f"{scope['scheme']}://{host_header}"


async def _read(receive: Receive) -> bytes | None:
    """Read the body of a request. Return None if the client has disconnected.

    Raises:
        SoapFault: The body is too large.
    """
    parts, size = [], 0
    while True:
        message = await receive()
        if message["type"] == "http.disconnect":
            return None
        size += len(message.get("body", b""))
        if size > MAX_REQUEST_BYTES:
            raise SoapFault(f"A request must have at most {MAX_REQUEST_BYTES} bytes.", "WellFormed", status=413)
        parts.append(message.get("body", b""))
        if not message.get("more_body", False):
            return b"".join(parts)


async def _send(send: Send, status: int, body: bytes, headers: Iterable[tuple[bytes, bytes]] = ()) -> None:
    content_type = [(b"content-type", CONTENT_TYPE.encode())] if body else []
    length = (b"content-length", str(len(body)).encode())
    await send({"type": "http.response.start", "status": status, "headers": [*content_type, length, *headers]})
    await send({"type": "http.response.body", "body": body})
