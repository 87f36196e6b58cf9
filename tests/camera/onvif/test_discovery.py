"""WS-Discovery finds the virtual camera, and believes nothing else that answers."""

from __future__ import annotations

import pytest

from scope_ptz.camera.onvif.discovery import DiscoveredDevice, discover, parse_match
from scope_ptz.errors import InputError
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.onvif.discovery import DiscoverableCamera, serve_discovery

MATCH = """<e:Envelope xmlns:e="http://www.w3.org/2003/05/soap-envelope" xmlns:d="http://schemas.xmlsoap.org/ws/2005/04/discovery">
<e:Body><d:ProbeMatches><d:ProbeMatch><d:Scopes>{scopes}</d:Scopes><d:XAddrs>{places}</d:XAddrs></d:ProbeMatch></d:ProbeMatches>
</e:Body></e:Envelope>"""


def _match(places: str, scopes: str = "") -> list[DiscoveredDevice]:
    return parse_match(MATCH.format(places=places, scopes=scopes).encode(), "10.0.0.7")


@pytest.mark.anyio
async def test_virtual_camera_is_found(analytic_scene: Scene) -> None:
    camera = DiscoverableCamera(VirtualDevice(analytic_scene, name="yard gate"), 8123)
    async with serve_discovery([camera], port=0) as port:
        found = await discover(["127.0.0.1"], wait_s=0.4, port=port)
    assert found == [DiscoveredDevice("127.0.0.1:8123", "yard gate", "M5075-G")]
    assert found[0].spec == "onvif://USER@127.0.0.1:8123"


@pytest.mark.anyio
async def test_nobody_answers() -> None:
    assert await discover(["127.0.0.1"], wait_s=0.05, port=9) == []


@pytest.mark.anyio
async def test_wrong_interface_is_refused() -> None:
    with pytest.raises(InputError, match="IPv4"):
        await discover(["eth0"])


def test_address_that_answered_is_preferred() -> None:
    assert _match("http://169.254.1.1/onvif http://10.0.0.7:8080/onvif")[0].address == "10.0.0.7:8080"
    assert _match("http://192.168.1.4/onvif")[0].address == "192.168.1.4"
    assert _match("https://10.0.0.7/onvif")[0].spec == "onvif://USER@10.0.0.7?tls=on"


def test_names_are_made_printable() -> None:
    found = _match("http://10.0.0.7/", "onvif://www.onvif.org/name/a%1B%5B31mb%0Ac onvif://www.onvif.org/hardware/X")[0]
    assert found.name == "a [31mb c"
    assert found.model == "X"


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\xff\x00<",
        b"<a/>",
        b'<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/passwd">]><a>&b;</a>',
        MATCH.format(places="file:///etc/passwd", scopes="").encode(),
        MATCH.format(places="http://[::1", scopes="").encode(),
        MATCH.format(places="http://a:99999/ http://;rm/", scopes="").encode(),
    ],
)
def test_anything_else_is_ignored(data: bytes) -> None:
    assert parse_match(data, "10.0.0.7") == []
