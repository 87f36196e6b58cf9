"""Parse SOAP 1.2 requests, and build replies and faults."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from lxml import etree
from lxml.builder import ElementMaker

ENVELOPE = "http://www.w3.org/2003/05/soap-envelope"
ERRORS = "http://www.onvif.org/ver10/error"
SECURITY = "http://docs.oasis-open.org/wss/2004/01/oasis-200401-wss-wssecurity-secext-1.0.xsd"
ADDRESSING = "http://www.w3.org/2005/08/addressing"
SUBMISSION_ADDRESSING = "http://schemas.xmlsoap.org/ws/2004/08/addressing"  # the W3C Member Submission, used by WS-Discovery

MAX_REQUEST_BYTES = 65536
"""Maximum size of a request in bytes. The largest common request (SetConfiguration) is about 4 kB."""

_UNDERSTOOD = {SECURITY, ADDRESSING, SUBMISSION_ADDRESSING}  # namespaces of headers that a request may mark as mandatory
_E = ElementMaker(namespace=ENVELOPE, nsmap={"env": ENVELOPE, "ter": ERRORS})
_LANGUAGE = "{http://www.w3.org/XML/1998/namespace}lang"


class SoapFault(Exception):  # noqa: N818 - the term of the SOAP specification
    """Raised to reject a request. The fault is sent as the reply.

    Args:
        reason: A human-readable message.
        subcodes: The subcodes in the ONVIF error namespace, from general to specific.
        receiver: Whether the device rather than the request is at fault (Receiver instead of Sender in SOAP).
        status: HTTP status code of the response; by default, 400 for a Sender fault and 500 for a Receiver fault.
    """

    def __init__(self, reason: str, *subcodes: str, receiver: bool = False, status: int | None = None) -> None:
        super().__init__(reason)
        self.reason, self.subcodes, self.receiver = reason, subcodes, receiver
        self.status = status or (500 if receiver else 400)

    code: str | None = None
    """The fault's top-level code if it is neither Sender nor Receiver."""

    def envelope(self) -> bytes:
        """Return the fault as a SOAP message."""
        subcode: Any = None
        for name in reversed(self.subcodes):
            inner = [] if subcode is None else [subcode]
            subcode = _E.Subcode(_E.Value(f"ter:{name}"), *inner)
        code = _E.Code(_E.Value(f"env:{self.code or ('Receiver' if self.receiver else 'Sender')}"))
        if subcode is not None:
            code.append(subcode)
        text = _E.Text(self.reason)
        text.set(_LANGUAGE, "en")
        return as_bytes(_E.Envelope(_E.Body(_E.Fault(code, _E.Reason(text)))))


class NotUnderstood(SoapFault):
    """The fault for an unsupported mandatory header."""

    code = "MustUnderstand"


def invalid_argument(reason: str, *subcodes: str) -> SoapFault:
    """Return a fault for an invalid argument. ``subcodes``, such as ``NoProfile``, follow ``InvalidArgVal``."""
    return SoapFault(reason, "InvalidArgVal", *subcodes)


@dataclass(frozen=True, slots=True)
class Envelope:
    """A parsed request: its header, and the element in its body."""

    header: Any
    body: Any


def parse_xml(data: bytes) -> Any:
    """Parse untrusted XML without document types, entities or network access, and with lxml's default limits on depth and size.

    Raises:
        SoapFault: The document is not well-formed, or has a document type declaration.
    """
    # Create a parser for each document, because a parser that failed must not be reused in another thread.
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, dtd_validation=False, huge_tree=False, remove_comments=True,
        remove_pis=True,
    )  # fmt: skip
    try:
        root = etree.fromstring(data, parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        raise SoapFault("The request is not well-formed XML.", "WellFormed") from error
    if root.getroottree().docinfo.doctype:
        raise SoapFault("A request must not have a document type declaration.", "WellFormed")
    return root


def parse_envelope(data: bytes) -> Envelope:
    """Parse a SOAP 1.2 request.

    Raises:
        SoapFault: The request is not a SOAP 1.2 envelope with one element in its body, or has an unsupported mandatory header.
    """
    root = parse_xml(data)
    name = etree.QName(root)
    if name.localname != "Envelope" or name.namespace != ENVELOPE:
        fault = SoapFault("The request is not a SOAP 1.2 envelope.", status=400)
        fault.code = "VersionMismatch" if name.localname == "Envelope" else None
        raise fault
    header, body = root.find(f"{{{ENVELOPE}}}Header"), root.find(f"{{{ENVELOPE}}}Body")
    if body is None or len(body) != 1:
        raise SoapFault("A request must have one element in the body of its envelope.", "WellFormed")
    for block in () if header is None else header:
        needed = block.get(f"{{{ENVELOPE}}}mustUnderstand", "").strip() in ("1", "true")
        if needed and etree.QName(block).namespace not in _UNDERSTOOD:
            raise NotUnderstood("The request has a mandatory header that the device does not support.")
    return Envelope(header, body[0])


def as_bytes(element: Any) -> bytes:
    """Serialise an element as an XML document."""
    return bytes(etree.tostring(element, xml_declaration=True, encoding="UTF-8"))
