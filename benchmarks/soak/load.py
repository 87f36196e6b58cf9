"""Clients that put load on the camera: one moves it continually, and others disconnect abruptly."""

from __future__ import annotations

import itertools
import socket
import struct
import threading
import time
from contextlib import suppress

import httpx2

from soak.camera_process import Camera

DISCONNECT_EVERY_S = 0.5
POSES = [(pan, tilt, zoom) for zoom in (1, 3500, 9999) for pan, tilt in ((0, 0), (90, -20), (179, 5), (-90, -10))]
"""Poses that the camera cycles through: pan and tilt in degrees, and zoom in the camera's units."""


def move_continually(url: str, ended: threading.Event, rounds: list[float]) -> None:
    """Cycle through the poses with absolute and continuous moves. Append the time of each complete cycle to ``rounds``."""
    with httpx2.Client(base_url=url, trust_env=False, timeout=30) as session:
        while True:
            for pan, tilt, zoom in POSES:
                for query in (f"pan={pan}&tilt={tilt}&zoom={zoom}", "continuouspantiltmove=15,5", "continuouspantiltmove=0,0"):
                    session.get(f"/axis-cgi/com/ptz.cgi?{query}").raise_for_status()
                    if ended.wait(1.6 if query.startswith("pan=") else 0.2):
                        return
            rounds.append(time.monotonic())


def disconnect_repeatedly(camera: Camera, ended: threading.Event) -> None:
    """Connect, read a few bytes or none, and disconnect without closing the session, in four different ways."""
    for disconnect in itertools.cycle([disconnect_tcp, disconnect_udp, disconnect_mjpeg, disconnect_silently]):
        with suppress(OSError):
            disconnect(camera, ended)
        if ended.wait(DISCONNECT_EVERY_S):
            return


def disconnect_tcp(camera: Camera, ended: threading.Event) -> None:
    """Play a stream over TCP, stop reading, and reset the connection."""
    with open_connection(camera.rtsp_url) as connection:
        play(connection, camera.rtsp_url, "RTP/AVP/TCP;unicast;interleaved=0-1")
        connection.recv(10_000)
        ended.wait(0.3)  # without reading


def disconnect_udp(camera: Camera, _: threading.Event) -> None:
    """Play a stream over UDP and disappear after the first packet."""
    with open_connection(camera.rtsp_url) as connection, socket.socket(type=socket.SOCK_DGRAM) as rtp:
        rtp.bind(("127.0.0.1", 0))
        rtp.settimeout(5)
        port = rtp.getsockname()[1]
        play(connection, camera.rtsp_url, f"RTP/AVP;unicast;client_port={port}-{port + 1}")
        rtp.recv(2000)


def disconnect_mjpeg(camera: Camera, ended: threading.Event) -> None:
    """Request Motion JPEG, stop reading, and reset the connection."""
    with open_connection(camera.url) as connection:
        connection.sendall(b"GET /axis-cgi/mjpg/video.cgi HTTP/1.1\r\nHost: camera\r\n\r\n")
        connection.recv(10_000)
        ended.wait(0.3)


def disconnect_silently(camera: Camera, _: threading.Event) -> None:
    """Send half a request and reset the connection."""
    with open_connection(camera.rtsp_url) as connection:
        connection.sendall(b"DESCRIBE rtsp://cam")


def open_connection(url: str) -> socket.socket:
    """Open a connection that is reset when it is closed."""
    host, _, port = url.partition("://")[2].partition("/")[0].partition(":")
    connection = socket.create_connection((host, int(port)), timeout=10)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    return connection


def play(connection: socket.socket, url: str, transport: str) -> None:
    """Set a stream up and play it."""
    connection.sendall(f"SETUP {url} RTSP/1.0\r\nCSeq: 1\r\nTransport: {transport}\r\n\r\n".encode())
    reply = connection.recv(4000).decode()
    token = reply.partition("Session: ")[2].partition(";")[0]
    connection.sendall(f"PLAY {url} RTSP/1.0\r\nCSeq: 2\r\nSession: {token}\r\n\r\n".encode())
