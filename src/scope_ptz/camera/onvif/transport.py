"""Send SOAP messages only to the configured device, regardless of the addresses that it reports."""

from __future__ import annotations

import logging
import os
from collections.abc import Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from scope_ptz.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from scope_ptz.camera.network.http import DeviceHttp

FAULT_STATUSES = (400, 403, 500)
"""HTTP status codes of replies whose body is a SOAP fault, which is more specific than the status."""


@dataclass(frozen=True, slots=True)
class SoapReply:
    """A SOAP reply, with the attributes that zeep reads."""

    status_code: int
    content: bytes = field(repr=False)
    headers: Mapping[str, str]
    encoding: str = "utf-8"


class PinnedTransport:
    """A transport for zeep. Every message goes to the configured host and port; redirects are refused.

    Args:
        http: The HTTP connection to the device.
    """

    cache = None

    def __init__(self, http: DeviceHttp) -> None:
        self._http = http

    async def post_xml(self, address: str, envelope: Any, headers: Mapping[str, str]) -> SoapReply:
        """Send a message once and return the reply. Its authentication header is valid only once, so a retry needs a new message.

        Raises:
            CameraError: One of the errors of ``camera.network.errors``.
        """
        content = to_bytes(envelope)
        reply = await self._http.post(pinned_path(self._http, address), content, headers, repeat=False, accept=FAULT_STATUSES)
        return SoapReply(reply.status, _readable(reply.body), {"Content-Type": reply.content_type or "text/xml"})

    async def aclose(self) -> None:
        """Do nothing, because the camera closes the HTTP client."""


def pinned_path(http: DeviceHttp, address: str) -> str:
    """Return the path and query of an address that the device reported, rewritten to the configured host.

    Raises:
        ForeignAddressError: It is not an HTTP address.
    """
    parts = urlsplit(http.address.pin_http(address))
    return f"{parts.path}?{parts.query}" if parts.query else parts.path


def to_bytes(envelope: Any) -> bytes:
    """Serialise a message."""
    from lxml import etree

    return bytes(etree.tostring(envelope, xml_declaration=True, encoding="utf-8"))


def import_onvif() -> Any:
    """Import ``onvif-zeep-async``, and undo the changes that its import makes to logging.

    Raises:
        ConfigError: It is not installed.
    """
    try:
        with _unchanged_logging():
            import onvif.client
    except ImportError:
        raise ConfigError("ONVIF needs onvif-zeep-async. Install it with: pip install 'scope-ptz[camera]'") from None
    return onvif.client


@contextmanager
def _unchanged_logging() -> Iterator[None]:
    root = logging.getLogger()
    level, handlers = root.level, list(root.handlers)
    try:
        yield
    finally:
        root.setLevel(level)
        for handler in [each for each in root.handlers if each not in handlers]:
            root.removeHandler(handler)


@contextmanager
def unchanged_proxies() -> Iterator[None]:
    """Return a context that restores the environment variables that the ONVIF client deletes, because other code uses them."""
    kept = {name: os.environ[name] for name in ("http_proxy", "https_proxy") if name in os.environ}
    try:
        yield
    finally:
        os.environ.update(kept)


def _readable(body: bytes) -> bytes:
    """Return a reply in which invalid UTF-8 is replaced, because some devices garble preset names."""
    if b"encoding=" in body[:100] and b"utf-8" not in body[:100].lower():
        return body
    try:
        body.decode("utf-8")
    except UnicodeDecodeError:
        return body.decode("utf-8", "replace").encode("utf-8")
    return body
