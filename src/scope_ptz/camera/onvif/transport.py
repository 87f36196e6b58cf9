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
"""HTTP status codes of replies that may contain a SOAP fault, which is more specific than the status."""


@dataclass(frozen=True, slots=True)
class SoapReply:
    """A SOAP reply, with the attributes that zeep reads."""

    status_code: int
    content: bytes = field(repr=False)
    headers: Mapping[str, str]
    encoding: str = "utf-8"


class PinnedTransport:
    """A zeep transport that sends every message to the configured host and port, and rejects redirects.

    Args:
        http: The HTTP connection to the device.
    """

    cache = None

    def __init__(self, http: DeviceHttp) -> None:
        self._http = http

    async def post_xml(self, address: str, envelope: Any, headers: Mapping[str, str]) -> SoapReply:
        """Send a message and return the reply. The message is not resent, because its authentication header is valid only once.

        Raises:
            CameraError: One of the errors in ``camera.network.errors``.
        """
        content = to_bytes(envelope)
        reply = await self._http.post(pinned_path(self._http, address), content, headers, retry=False, accept=FAULT_STATUSES)
        return SoapReply(reply.status, _replace_invalid_utf8(reply.body), {"Content-Type": reply.content_type or "text/xml"})

    async def aclose(self) -> None:
        """Do nothing, because the camera closes the HTTP client."""


def pinned_path(http: DeviceHttp, address: str) -> str:
    """Return the path and query of a URL that the device reported, for use with the configured host.

    Raises:
        ForeignAddressError: It is not an HTTP URL.
    """
    parts = urlsplit(http.address.pin_http(address))
    return f"{parts.path}?{parts.query}" if parts.query else parts.path


def to_bytes(envelope: Any) -> bytes:
    """Serialise a message to XML."""
    from lxml import etree

    return bytes(etree.tostring(envelope, xml_declaration=True, encoding="utf-8"))


def import_onvif() -> Any:
    """Import ``onvif-zeep-async`` without the changes that the import makes to logging.

    Raises:
        ConfigError: ``onvif-zeep-async`` is not installed.
    """
    try:
        with _unchanged_logging():
            import onvif.client
    except ImportError:
        raise ConfigError("ONVIF requires onvif-zeep-async. Install it with: pip install 'scope-ptz[camera]'") from None
    return onvif.client


@contextmanager
def _unchanged_logging() -> Iterator[None]:
    root = logging.getLogger()
    level, handlers = root.level, list(root.handlers)
    try:
        yield
    finally:
        root.setLevel(level)
        for handler in [candidate for candidate in root.handlers if candidate not in handlers]:
            root.removeHandler(handler)


@contextmanager
def unchanged_proxies() -> Iterator[None]:
    """Return a context manager that restores the proxy variables that the ONVIF client deletes, because other code uses them."""
    saved = {name: os.environ[name] for name in ("http_proxy", "https_proxy") if name in os.environ}
    try:
        yield
    finally:
        os.environ.update(saved)


def _replace_invalid_utf8(body: bytes) -> bytes:
    """Replace invalid UTF-8 in a reply, because some devices garble preset names."""
    if b"encoding=" in body[:100] and b"utf-8" not in body[:100].lower():
        return body
    try:
        body.decode("utf-8")
    except UnicodeDecodeError:
        return body.decode("utf-8", "replace").encode("utf-8")
    return body
