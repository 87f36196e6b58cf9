"""Clients that leave without a word, and what is left over after them: nothing."""

from __future__ import annotations

import asyncio
import gc
import socket
import threading
from contextlib import suppress
from pathlib import Path

import anyio
import pytest

from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.rtsp import sessions, sinks
from tests.support.rtsp_client import RtspClient
from tests.virtual_camera.rtsp.serving import Served, serving, until

pytestmark = pytest.mark.anyio


def sockets() -> int:
    """Return the number of open sockets of this process."""
    gc.collect()
    found = 0
    for each in Path("/proc/self/fd").iterdir():
        with suppress(OSError):  # the handle of the listing itself
            found += str(each.readlink()).startswith("socket:")
    return found


def udp_pair() -> tuple[socket.socket, socket.socket, str]:
    """Return two UDP sockets and the transport that names them."""
    pair = tuple(socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
    for each in pair:
        each.bind(("127.0.0.1", 0))
        each.setblocking(False)
    ports = [each.getsockname()[1] for each in pair]
    return pair[0], pair[1], f"RTP/AVP;unicast;client_port={ports[0]}-{ports[1]}"


async def test_a_closed_connection_ends_its_sessions(open_device: VirtualDevice) -> None:
    async with serving(open_device) as served:
        for _ in range(5):
            async with RtspClient(served.port) as client:
                await client.play()
                await client.packet(0)
        await served.until_left()
        assert served.server.statistics.sessions == 5


async def test_closed_ports_end_a_session_at_once(open_device: VirtualDevice) -> None:
    async with serving(open_device) as served, RtspClient(served.port) as client:
        rtp, rtcp, transport = udp_pair()
        await client.play(transport)
        loop = asyncio.get_running_loop()
        assert (await loop.sock_recv(rtp, 2000))[1] & 0x7F == 96
        rtp.close()
        rtcp.close()
        await until(lambda: served.server.sessions == 0)
        assert (await client.request("PLAY", Session=client.set_up.session)).status == 454


async def test_a_silent_client_by_udp_is_given_up_and_reports_keep_one_alive(
    open_device: VirtualDevice, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sessions, "ORPHAN_TIMEOUT_S", 0.5)
    async with serving(open_device) as served:
        pairs = [udp_pair() for _ in range(2)]
        clients = []
        for _, _, transport in pairs:
            async with RtspClient(served.port) as client:
                await client.play(transport)
                clients.append(client)
        rtcp, transport = pairs[0][1], clients[0].set_up["transport"]
        server_port = int(transport.partition("server_port=")[2].partition(";")[0].partition("-")[2])
        with anyio.fail_after(30):
            while served.server.sessions != 1:
                rtcp.sendto(b"\x80\xc9\x00\x01abcd", ("127.0.0.1", server_port))
                await anyio.sleep(0.05)
        for _ in range(20):
            rtcp.sendto(b"\x80\xc9\x00\x01abcd", ("127.0.0.1", server_port))
            await anyio.sleep(0.05)
        assert served.server.sessions == 1
        await served.until_left()
        for first, second, _ in pairs:
            first.close()
            second.close()


async def test_an_unused_session_expires_and_requests_keep_one_alive(open_device: VirtualDevice) -> None:
    async with serving(open_device, session_timeout_s=1.0) as served, RtspClient(served.port) as client:
        set_up = [await client.request("SETUP", Transport="RTP/AVP/TCP;unicast") for _ in range(2)]
        assert "timeout=1" in set_up[0]["session"]
        with anyio.fail_after(30):
            while served.server.sessions == 2:
                assert (await client.request("OPTIONS", Session=set_up[0].session)).status == 200
                await anyio.sleep(0.05)
        assert (await client.request("GET_PARAMETER", Session=set_up[0].session)).status == 200
        assert (await client.request("GET_PARAMETER", Session=set_up[1].session)).status == 454


async def test_a_client_that_reads_nothing_costs_no_memory_and_is_dropped(
    analytic_scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sinks, "SEND_TIMEOUT_S", 1.0)
    async with serving(VirtualDevice(analytic_scene, width=640, height=360), rate_hz=100) as served:
        stuck, reader = RtspClient(served.port), RtspClient(served.port)
        async with stuck, reader:
            stuck._writer.transport.pause_reading()  # type: ignore[attr-defined]
            raw = stuck._writer.get_extra_info("socket")
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            url = stuck.url
            await stuck.send(
                f"SETUP {url} RTSP/1.0\r\nCSeq: 1\r\nTransport: RTP/AVP/TCP;interleaved=0-1\r\n\r\n".encode(),
            )
            await until(lambda: served.server.sessions == 1)
            (token,) = served.server._sessions._sessions
            await stuck.send(f"PLAY {url} RTSP/1.0\r\nCSeq: 2\r\nSession: {token}\r\n\r\n".encode())
            await reader.play()
            # The other client gets its pictures all the while.
            with anyio.fail_after(60):
                while served.server.sessions == 2:
                    await reader.packet(0)
            await until(lambda: served.server.connections == 1)
            assert served.server.statistics.oldest_s <= 0.5


async def test_many_clients_leave_no_thread_and_no_socket(open_device: VirtualDevice) -> None:
    async def one(served: Served, k: int) -> None:
        async with RtspClient(served.port) as client:
            if k % 3 == 0:
                await client.request("SETUP", Transport="RTP/AVP/TCP;unicast")
                return
            pair = udp_pair()
            await client.play(pair[2] if k % 3 == 1 else "RTP/AVP/TCP;unicast;interleaved=0-1")
            for each in pair[:2]:
                each.close()

    async with serving(open_device) as warm, RtspClient(warm.port) as client:
        await client.play()
        await client.packet(0)
    before = sockets(), {thread for thread in threading.enumerate() if "AnyIO" not in thread.name}
    async with serving(open_device) as served:
        async with anyio.create_task_group() as group:
            for k in range(30):
                group.start_soon(one, served, k)
        await served.until_left()
    await until(lambda: sockets() == before[0])
    assert {thread for thread in threading.enumerate() if "AnyIO" not in thread.name} == before[1]


async def test_the_server_ends_while_clients_play(open_device: VirtualDevice) -> None:
    pair = udp_pair()
    async with serving(open_device) as served:
        clients = [RtspClient(served.port) for _ in range(3)]
        for k, client in enumerate(clients):
            await client.__aenter__()
            await client.play(pair[2] if k == 0 else "RTP/AVP/TCP;unicast;interleaved=0-1")
        port = served.port
    for client in clients:
        with pytest.raises((EOFError, OSError)):
            while True:
                await client.packet(0)
        await client.__aexit__(None, None, None)
    loop = asyncio.get_running_loop()
    data = b""
    while data[:2] != bytes([0x81, 203]):  # the goodbye
        data = await loop.sock_recv(pair[1], 2000)
    for each in pair[:2]:
        each.close()
    with socket.create_server(("127.0.0.1", port)):
        pass
