"""WS-Discovery by UDP multicast on the loopback interface."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import AsyncIterator, Iterator
from contextlib import closing
from typing import Any
from uuid import uuid4

import pytest
from lxml import etree

from scope_ptz.camera.network.interfaces import local_addresses
from scope_ptz.errors import ConfigError
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.faults import Faults
from scope_ptz.virtual_camera.identity import device_uuid
from scope_ptz.virtual_camera.onvif import discovery
from scope_ptz.virtual_camera.onvif.discovery import GROUP, DiscoverableCamera, _Responder, serve_discovery
from scope_ptz.virtual_camera.onvif.discovery_messages import parse_query

pytestmark = pytest.mark.anyio

HTTP_PORT = 8123
WSA = "http://schemas.xmlsoap.org/ws/2004/08/addressing"
WSD = "http://schemas.xmlsoap.org/ws/2005/04/discovery"
NAMES = {"a": WSA, "d": WSD}


def question(body: str, message_id: str = "") -> bytes:
    action = "Resolve" if "Resolve" in body else "Probe"
    return (
        f'<s:Envelope xmlns:s="http://www.w3.org/2003/05/soap-envelope" xmlns:a="{WSA}" xmlns:d="{WSD}" '
        'xmlns:dn="http://www.onvif.org/ver10/network/wsdl" xmlns:tds="http://www.onvif.org/ver10/device/wsdl">'
        f"<s:Header><a:Action>{WSD}/{action}</a:Action><a:MessageID>{message_id or f'urn:uuid:{uuid4()}'}</a:MessageID>"
        f"<a:To>urn:schemas-xmlsoap-org:ws:2005:04:discovery</a:To></s:Header><s:Body>{body}</s:Body></s:Envelope>"
    ).encode()


PROBE = question("<d:Probe><d:Types>dn:NetworkVideoTransmitter</d:Types></d:Probe>", "urn:uuid:one")


@pytest.fixture
async def port(device: VirtualDevice) -> AsyncIterator[int]:
    """A port of the system's choice in place of 3702, so that tests at the same time do not hear each other."""
    async with serve_discovery([DiscoverableCamera(device, HTTP_PORT)], port=0) as port:
        yield port


@pytest.fixture
def searcher() -> Iterator[socket.socket]:
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as searcher:
        searcher.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
        searcher.bind(("127.0.0.1", 0))
        searcher.setblocking(False)
        yield searcher


async def ask(searcher: socket.socket, port: int, *questions: bytes) -> Any:
    """Send questions, the last of which is answered, and return the first answer."""
    loop = asyncio.get_running_loop()
    for data in questions:
        await loop.sock_sendto(searcher, data, (GROUP, port))
    async with asyncio.timeout(20):
        return etree.fromstring(await loop.sock_recv(searcher, 65536))


def relates_to(answer: Any) -> str:
    return str(answer.findtext(".//a:RelatesTo", namespaces=NAMES))


async def test_a_probe_finds_the_device(port: int, searcher: socket.socket, device: VirtualDevice) -> None:
    answer = await ask(searcher, port, PROBE)
    match = answer.find(".//d:ProbeMatches/d:ProbeMatch", namespaces=NAMES)
    assert relates_to(answer) == "urn:uuid:one"
    assert answer.findtext(".//a:Action", namespaces=NAMES) == f"{WSD}/ProbeMatches"
    assert match.findtext("a:EndpointReference/a:Address", namespaces=NAMES) == f"urn:uuid:{device_uuid(device)}"
    assert match.findtext("d:XAddrs", namespaces=NAMES) == f"http://127.0.0.1:{HTTP_PORT}/onvif/device_service"
    assert match.findtext("d:MetadataVersion", namespaces=NAMES) == "1"
    prefix, name = match.findtext("d:Types", namespaces=NAMES).split()[0].split(":")
    assert (match.nsmap[prefix], name) == ("http://www.onvif.org/ver10/network/wsdl", "NetworkVideoTransmitter")
    assert "onvif://www.onvif.org/type/ptz" in match.findtext("d:Scopes", namespaces=NAMES).split()


@pytest.mark.parametrize(
    "body",
    [
        "<d:Probe/>",
        "<d:Probe><d:Types/></d:Probe>",
        "<d:Probe><d:Types>tds:Device dn:NetworkVideoTransmitter</d:Types></d:Probe>",
        "<d:Probe><d:Scopes>onvif://www.onvif.org/type</d:Scopes></d:Probe>",
        f'<d:Probe><d:Scopes MatchBy="{WSD}/strcmp0">onvif://www.onvif.org/type/ptz</d:Scopes></d:Probe>',
    ],
)
async def test_probes_that_match(port: int, searcher: socket.socket, body: str) -> None:
    assert relates_to(await ask(searcher, port, question(body, "urn:uuid:two"))) == "urn:uuid:two"


@pytest.mark.parametrize(
    "data",
    [
        question("<d:Probe><d:Types>dn:NetworkVideoDisplay</d:Types></d:Probe>"),
        question("<d:Probe><d:Types>tds:NetworkVideoTransmitter</d:Types></d:Probe>"),  # right name, other namespace
        question("<d:Probe><d:Types>NetworkVideoTransmitter</d:Types></d:Probe>"),
        question("<d:Probe><d:Scopes>onvif://www.onvif.org/ty</d:Scopes></d:Probe>"),  # not a whole segment
        question(f'<d:Probe><d:Scopes MatchBy="{WSD}/strcmp0">onvif://www.onvif.org/type</d:Scopes></d:Probe>'),
        question(f'<d:Probe><d:Scopes MatchBy="{WSD}/ldap">onvif://www.onvif.org/type</d:Scopes></d:Probe>'),
        question(f"<d:Resolve><a:EndpointReference><a:Address>urn:uuid:{uuid4()}</a:Address></a:EndpointReference></d:Resolve>"),
        b"\xff\x00 not XML",
        b'<!DOCTYPE x [<!ENTITY a "b">]>' + PROBE,
        PROBE.replace(b"MessageID", b"Message"),
        PROBE + b" " * 10_000,
    ],
)
async def test_what_does_not_match_gets_no_answer(port: int, searcher: socket.socket, data: bytes) -> None:
    """Datagrams on one machine arrive in order, so the answer to the probe after it is the first one."""
    assert relates_to(await ask(searcher, port, data, PROBE)) == "urn:uuid:one"


async def test_a_device_is_resolved_by_its_identity(port: int, searcher: socket.socket, device: VirtualDevice) -> None:
    address = f"<a:EndpointReference><a:Address>urn:uuid:{device_uuid(device)}</a:Address></a:EndpointReference>"
    answer = await ask(searcher, port, question(f"<d:Resolve>{address}</d:Resolve>"))
    xaddr = answer.findtext(".//d:ResolveMatches/d:ResolveMatch/d:XAddrs", namespaces=NAMES)
    assert xaddr == f"http://127.0.0.1:{HTTP_PORT}/onvif/device_service"


async def test_a_probe_through_another_interface_of_this_machine_is_answered(port: int, device: VirtualDevice) -> None:
    """Many clients probe through the interface of the default route and cannot choose another one."""
    others = [address for address in local_addresses() if address != "127.0.0.1"]
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as searcher:
        searcher.setblocking(False)
        for address in others:
            searcher.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(address))
            answer = await ask(searcher, port, PROBE)
            xaddr = answer.findtext(".//d:ProbeMatch/d:XAddrs", namespaces=NAMES)
            assert xaddr == f"http://127.0.0.1:{HTTP_PORT}/onvif/device_service"


@pytest.mark.parametrize(("host", "answers"), [("127.0.0.1", 0), ("0.0.0.0", 1)])  # noqa: S104 - nothing is bound to it
async def test_other_machines_get_answers_only_from_cameras_on_the_network(
    device: VirtualDevice, monkeypatch: pytest.MonkeyPatch, host: str, answers: int
) -> None:
    routes = {"203.0.113.7": "192.0.2.1", "192.0.2.1": "192.0.2.1"}
    monkeypatch.setattr(discovery, "source_address", lambda address: routes[address[0]])
    responder, sent = _Responder([DiscoverableCamera(device, HTTP_PORT)], host), list[Any]()
    monkeypatch.setattr(responder, "_send", lambda data, address: sent.append((data, address)))
    responder.datagram_received(PROBE, ("203.0.113.7", 40_000))
    assert len(sent) == answers
    responder.datagram_received(PROBE, ("192.0.2.1", 40_000))
    assert len(sent) == answers + 1


async def test_a_device_that_is_down_is_silent(port: int, searcher: socket.socket, device: VirtualDevice) -> None:
    loop = asyncio.get_running_loop()
    device.faults = Faults(down=True)
    await loop.sock_sendto(searcher, question("<d:Probe/>", "urn:uuid:unheard"), (GROUP, port))
    for _ in range(20):  # the responder reads it while it is down
        await asyncio.sleep(0.01)
    device.faults = Faults()
    assert relates_to(await ask(searcher, port, PROBE)) == "urn:uuid:one"


async def test_hello_and_bye(device: VirtualDevice) -> None:
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((GROUP, 0))
        membership = socket.inet_aton(GROUP) + socket.inet_aton("127.0.0.1")
        listener.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
        listener.setblocking(False)
        async with serve_discovery([DiscoverableCamera(device, HTTP_PORT)], port=listener.getsockname()[1]):
            pass
        async with asyncio.timeout(20):
            messages = [etree.fromstring(await asyncio.get_running_loop().sock_recv(listener, 65536)) for _ in range(2)]
    actions = [message.findtext(".//a:Action", namespaces=NAMES) for message in messages]
    assert actions == [f"{WSD}/Hello", f"{WSD}/Bye"]
    numbers = [int(message.find(".//d:AppSequence", namespaces=NAMES).get("MessageNumber")) for message in messages]
    assert numbers == [1, 2]


async def test_several_devices_answer_one_probe(device: VirtualDevice, searcher: socket.socket) -> None:
    other = VirtualDevice(device.scene, name="other", width=320, height=180)
    cameras = [DiscoverableCamera(device, HTTP_PORT), DiscoverableCamera(other, HTTP_PORT + 1)]
    async with serve_discovery(cameras, port=0) as port:
        first = await ask(searcher, port, PROBE)
        second = await ask(searcher, port)
    found = {each.findtext(".//d:ProbeMatch/d:XAddrs", namespaces=NAMES) for each in (first, second)}
    assert len(found) == 2


async def test_an_interface_that_is_not_there_is_an_error(device: VirtualDevice) -> None:
    for host in ("203.0.113.7", "::1"):
        with pytest.raises(ConfigError, match="Turn discovery off"):
            async with serve_discovery([DiscoverableCamera(device, HTTP_PORT)], host=host, port=0):
                raise AssertionError


def test_parsing_ignores_other_messages() -> None:
    assert parse_query(question("<d:Hello/>")) is None
