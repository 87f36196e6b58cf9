"""Parse WS-Discovery queries, and build a device's messages. ONVIF uses the April 2005 version of WS-Discovery."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any
from urllib.parse import urlsplit
from uuid import UUID, uuid4

from lxml import etree
from lxml.builder import ElementMaker

from scope_ptz.virtual_camera.onvif.soap import ENVELOPE, SUBMISSION_ADDRESSING, SoapFault, as_bytes, parse_envelope
from scope_ptz.virtual_camera.onvif.wsdl import DEVICE

DISCOVERY = "http://schemas.xmlsoap.org/ws/2005/04/discovery"
NETWORK = "http://www.onvif.org/ver10/network/wsdl"
ALL_CLIENTS = "urn:schemas-xmlsoap-org:ws:2005:04:discovery"  # the destination for messages to all clients

TYPES = {(NETWORK, "NetworkVideoTransmitter"), (DEVICE, "Device")}
"""The device's types, as pairs of namespace and name."""

_ANONYMOUS = "http://schemas.xmlsoap.org/ws/2004/08/addressing/role/anonymous"
_NAMESPACES = {"env": ENVELOPE, "wsa": SUBMISSION_ADDRESSING, "d": DISCOVERY, "dn": NETWORK, "tds": DEVICE}
_E = ElementMaker(namespace=ENVELOPE, nsmap=_NAMESPACES)
_A = ElementMaker(namespace=SUBMISSION_ADDRESSING)
_D = ElementMaker(namespace=DISCOVERY)
_TYPES_TEXT = "dn:NetworkVideoTransmitter tds:Device"
_METADATA_VERSION = "1"


@dataclass(frozen=True, slots=True)
class Target:
    """A discoverable device.

    Attributes:
        uuid: The device's UUID.
        scopes: The device's scopes.
        xaddr: URL of its device service; empty if it depends on the client's network.
    """

    uuid: UUID
    scopes: tuple[str, ...]
    xaddr: str

    @property
    def address(self) -> str:
        """The UUID as a URN, which is the device's address in WS-Discovery."""
        return f"urn:uuid:{self.uuid}"


@dataclass(frozen=True, slots=True)
class Query:
    """A Probe or Resolve message.

    Attributes:
        message_id: The message id, which the response refers to.
        resolves: The address of the device to resolve; None for a Probe.
        types: The types that a device must have to match a Probe.
        scopes: The scopes that a device must have to match a Probe.
        match_by: The URI of the rule for matching scopes; empty for the default, which matches prefixes.
    """

    message_id: str
    resolves: str | None
    types: frozenset[tuple[str, str]] = frozenset()
    scopes: tuple[str, ...] = ()
    match_by: str = ""

    def matches(self, target: Target) -> bool:
        """Return whether the query matches a device."""
        if self.resolves is not None:
            return self.resolves == target.address
        if not self.types <= TYPES:
            return False
        rule = self.match_by.removeprefix(DISCOVERY)
        if rule in ("", "/rfc3986"):
            return all(any(_has_prefix(scope, prefix) for scope in target.scopes) for prefix in self.scopes)
        return rule == "/strcmp0" and set(self.scopes) <= set(target.scopes)


def parse_query(data: bytes) -> Query | None:
    """Parse a datagram. Return None if it is neither a Probe nor a Resolve."""
    try:
        envelope = parse_envelope(data)
        if envelope.header is None:
            return None
        message_id = (envelope.header.findtext(f"{{{SUBMISSION_ADDRESSING}}}MessageID") or "").strip()
        if not message_id or len(message_id) > 256:
            return None
        body = envelope.body
        if body.tag == f"{{{DISCOVERY}}}Resolve":
            address = body.findtext(f"{{{SUBMISSION_ADDRESSING}}}EndpointReference/{{{SUBMISSION_ADDRESSING}}}Address") or ""
            return Query(message_id, address.strip())
        if body.tag != f"{{{DISCOVERY}}}Probe":
            return None
        types, scopes = body.find(f"{{{DISCOVERY}}}Types"), body.find(f"{{{DISCOVERY}}}Scopes")
        names = () if types is None else (types.text or "").split()
        return Query(
            message_id,
            None,
            frozenset(_qname(types, name) for name in names),
            () if scopes is None else tuple((scopes.text or "").split()),
            "" if scopes is None else scopes.get("MatchBy", ""),
        )
    except (SoapFault, ValueError):
        return None


class DiscoveryMessages:
    """Builds a device's messages, which are numbered so that clients can order them.

    Args:
        target: The device.
        instance: A number that increases each time the device starts. Message numbering then restarts.
    """

    def __init__(self, target: Target, instance: int) -> None:
        self.target, self._instance, self._number = target, instance, 0

    def hello(self) -> bytes:
        """Return a Hello message."""
        return self._message("Hello", ALL_CLIENTS, None, _D.Hello(*self._description(self.target.xaddr)))

    def bye(self) -> bytes:
        """Return a Bye message."""
        return self._message("Bye", ALL_CLIENTS, None, _D.Bye(self._reference()))

    def match(self, query: Query, xaddr: str) -> bytes:
        """Return the response to a query that matches the device.

        Args:
            query: The query.
            xaddr: The URL at which the client can reach the device service.
        """
        kind = "Probe" if query.resolves is None else "Resolve"
        match_element = _D(f"{kind}Match", *self._description(xaddr))
        return self._message(f"{kind}Matches", _ANONYMOUS, query.message_id, _D(f"{kind}Matches", match_element))

    def _reference(self) -> Any:
        return _A.EndpointReference(_A.Address(self.target.address))

    def _description(self, xaddr: str) -> list[Any]:
        addresses = [_D.XAddrs(xaddr)] if xaddr else []
        scopes = _D.Scopes(" ".join(self.target.scopes))
        return [self._reference(), _D.Types(_TYPES_TEXT), scopes, *addresses, _D.MetadataVersion(_METADATA_VERSION)]

    def _message(self, action: str, to: str, relates_to: str | None, body: Any) -> bytes:
        self._number += 1
        header = _E.Header(_A.MessageID(f"urn:uuid:{uuid4()}"))
        if relates_to is not None:
            header.append(_A.RelatesTo(relates_to))
        header.append(_A.To(to))
        header.append(_A.Action(f"{DISCOVERY}/{action}"))
        header.append(_D.AppSequence(InstanceId=str(self._instance), MessageNumber=str(self._number)))
        return as_bytes(_E.Envelope(header, _E.Body(body)))


def _qname(element: etree._Element, name: str) -> tuple[str, str]:
    prefix, _, local = name.rpartition(":")
    return element.nsmap.get(prefix or None, ""), local


def _has_prefix(scope: str, prefix: str) -> bool:
    """Return whether a scope has a prefix: the same scheme and host, and a path that starts with the prefix's segments."""
    scope_url, prefix_url = urlsplit(scope), urlsplit(prefix)
    if (scope_url.scheme.lower(), scope_url.netloc.lower()) != (prefix_url.scheme.lower(), prefix_url.netloc.lower()):
        return False
    segments = prefix_url.path.strip("/").split("/") if prefix_url.path.strip("/") else []
    return scope_url.path.strip("/").split("/")[: len(segments)] == segments
