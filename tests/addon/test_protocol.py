"""The parts of the add-on that need no Blender: addresses, pictures, views, steps, and connections that fail."""

from __future__ import annotations

import ast
import socket
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from scope_addon.protocol.address import parse_address
from scope_addon.protocol.errors import AddOnError, ServerRefusedError
from scope_addon.protocol.instruction_run import InstructionRun, PictureStored, Problem, RunEvent, StepStarted
from scope_addon.protocol.link import CameraLink
from scope_addon.protocol.png import png_of_rgba
from scope_addon.protocol.server import ServerProcess
from scope_addon.protocol.server_client import ServerClient
from scope_addon.protocol.steps import End, Step
from scope_addon.protocol.tasks import RequestThread
from scope_addon.protocol.view import View, bearing_tilt_deg, parse_size, parse_view
from scope_ptz.blender.addon_zip import addon_folder
from scope_ptz.geometry.sphere import camera_axes
from tests.addon.fake_blender import FakeBlender
from tests.serve.serving import CAMERA, Served
from tests.support.loopback import nobody_listens

VIEW = {"viewpoint": "gate", "position_m": [1, 2, 3], "bearing_deg": 400.0, "tilt_deg": -30, "hfov_deg": 60.0}


def test_addresses_are_parsed() -> None:
    assert parse_address(" http://127.0.0.1:8123/ ").url == "http://127.0.0.1:8123"
    assert parse_address("https://ptz.example").port == 443
    assert parse_address("http://[::1]:8000", "abc").url == "http://[::1]:8000"
    assert [parse_address(url).is_local for url in ("http://localhost", "http://127.8.0.1", "https://example.org")] == [
        True,
        True,
        False,
    ]


@pytest.mark.parametrize(
    ("url", "token", "problem"),
    [
        ("", "", "must look like"),
        ("127.0.0.1:8000", "", "must look like"),
        ("ftp://127.0.0.1", "", "must look like"),
        ("file:///etc/passwd", "", "must look like"),
        ("http://127.0.0.1:port", "", "not a number"),
        ("http://anna:secret@127.0.0.1", "", "Remove the password"),
        ("http://192.168.0.9:8000", "secret", "unencrypted"),
        ("https://example.org", "two\nlines", "Copy it again"),
    ],
)
def test_wrong_addresses_are_explained(url: str, token: str, problem: str) -> None:
    with pytest.raises(AddOnError, match=problem) as raised:
        parse_address(url, token)
    assert "secret" not in str(raised.value)


def test_pictures_are_valid_png_files() -> None:
    pixels = np.random.default_rng(1).integers(0, 256, (5, 7, 4), dtype=np.uint8)
    decoded = cv2.imdecode(np.frombuffer(png_of_rgba(pixels.tobytes(), 7, 5), np.uint8), cv2.IMREAD_UNCHANGED)
    assert decoded is not None
    assert np.array_equal(decoded[::-1, :, ::-1], pixels[..., :3]), "the GPU stores the bottom row first"
    with pytest.raises(ValueError, match="RGBA pixels need"):
        png_of_rgba(b"abc", 7, 5)


@pytest.mark.parametrize(("bearing_deg", "tilt_deg"), [(0.0, 0.0), (40.0, -30.0), (-170.0, 80.0), (123.0, -90.0), (5.0, 90.0)])
def test_views_have_the_axes_of_the_cameras(bearing_deg: float, tilt_deg: float) -> None:
    right, up, ahead = View("", (0.0, 0.0, 0.0), bearing_deg, tilt_deg, 60.0).axes()
    assert np.allclose([right, up, ahead], camera_axes(bearing_deg, tilt_deg))
    assert bearing_tilt_deg(ahead, up) == pytest.approx((bearing_deg, tilt_deg))


def test_a_smooth_move_turns_the_shorter_way_and_ends_exactly() -> None:
    start, end = (View("gate", (0.0, 0.0, 0.0), bearing, tilt, 60.0) for bearing, tilt in ((350.0, 0.0), (10.0, 8.0)))
    assert start.interpolate(end, 0.5).bearing_deg % 360 == pytest.approx(0.0)
    assert start.interpolate(end, 0.5).tilt_deg == pytest.approx(4.0)
    assert start.interpolate(end, 1.0) == end
    assert start.interpolate(end._replace(viewpoint="roof"), 0.1).viewpoint == "roof"


@pytest.mark.parametrize(
    "wrong",
    [
        {"position_m": [1, 2]},
        {"tilt_deg": 91},
        {"hfov_deg": 0},
        {"hfov_deg": "x"},
        {"bearing_deg": float("nan")},
        {"position_m": None},
    ],
)
def test_wrong_views_are_refused(wrong: dict[str, Any]) -> None:
    assert parse_view(VIEW).position_m == (1.0, 2.0, 3.0)
    with pytest.raises(AddOnError, match="no valid view"):
        parse_view({**VIEW, **wrong})


@pytest.mark.parametrize("wrong", [{}, {"width": 160}, {"width": 1e9, "height": 90}, {"width": 5000, "height": 90}])
def test_wrong_sizes_are_refused(wrong: dict[str, Any]) -> None:
    assert parse_size({"width": 160, "height": 90}) == (160, 90)
    with pytest.raises(AddOnError, match="picture size"):
        parse_size(wrong)


def follow(instruction: InstructionRun) -> list[RunEvent]:
    """Return the events of a run until it ends."""
    events: list[RunEvent] = []
    while not events or not isinstance(events[-1], (End, Problem)):
        events.append(instruction.events.get(timeout=60))
    instruction.join(60)
    return events


def test_a_run_is_followed_with_its_marked_pictures(served: Served, tmp_path: Path) -> None:
    served.call(served.site.station(CAMERA).control.clear)
    instruction = InstructionRun(
        parse_address(served.root), "blender-test", CAMERA, "pan right 5 degrees and count the balls", "", tmp_path
    )
    instruction.start()
    events = follow(instruction)
    steps, end = [each for each in events if isinstance(each, Step)], events[-1]
    assert [step.call.partition("(")[0] for step in steps] == ["adjust_ptz", "count_objects"]
    assert steps[0].call == "adjust_ptz(pan_deg=5)"
    assert not any(step.failed for step in steps)
    assert isinstance(end, End)
    assert end.outcome == "Answered"
    assert [timing.part for timing in end.timings] == ["planner", "perception", "camera", "pictures", "total"]
    assert any(isinstance(each, StepStarted) for each in events)
    shown = next(each for each in events if isinstance(each, PictureStored))
    assert np.asarray(cv2.imread(str(shown.path))).shape == (180, 320, 3)
    assert [path.name for path in tmp_path.iterdir()] == ["scope-frame.jpg"]


def test_a_run_can_be_cancelled(served: Served, tmp_path: Path) -> None:
    served.call(served.site.station(CAMERA).control.clear)
    instruction = InstructionRun(parse_address(served.root), "blender-test", CAMERA, "track the ball for 300 seconds", "", tmp_path)
    instruction.start()
    instruction.cancel()
    end = follow(instruction)[-1]
    assert isinstance(end, End)
    assert end.outcome == "Cancelled"


def test_a_refused_instruction_gives_a_message(served: Served, tmp_path: Path) -> None:
    instruction = InstructionRun(parse_address(served.root), "blender-test", "nowhere", "go home", "", tmp_path)
    instruction.start()
    (problem,) = follow(instruction)
    assert isinstance(problem, Problem)
    assert "no camera 'nowhere'" in problem.text


def test_tasks_report_results_and_failures(served: Served) -> None:
    tasks, results = RequestThread(parse_address(served.root), "blender-test"), []
    tasks.add(lambda client: client.request("GET", "/pairs"), lambda reply, problem: results.append((reply, problem)))
    tasks.add(lambda client: client.request("GET", "/cameras/nowhere"), lambda reply, problem: results.append((reply, problem)))
    tasks.add(lambda client: client.request("GET", "/pairs")["x"], lambda reply, problem: results.append((reply, problem)))
    tasks.stop()
    tasks.join(60)
    assert results == [], "only the main thread calls the functions"
    tasks.collect()
    assert results[0] == (["grammar+ground-truth"], "")
    assert "no camera 'nowhere'" in results[1][1]
    assert "Update the add-on" in results[2][1]


def test_an_idle_connection_that_the_server_closed_is_opened_again(served: Served) -> None:
    client = ServerClient(parse_address(served.root), "blender-test")
    assert client.request("GET", "/pairs") == ["grammar+ground-truth"]
    assert client._connection is not None
    assert client._connection.sock is not None
    client._connection.sock.shutdown(socket.SHUT_RDWR)
    assert client.request("GET", "/pairs") == ["grammar+ground-truth"]
    with pytest.raises(ServerRefusedError) as refused:
        client.request("POST", "/runs", {})
    assert refused.value.status == 422
    client.close()


@contextmanager
def replying(content: bytes) -> Iterator[str]:
    """Serve one fixed reply to every connection. Without content, accept connections and never reply."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        opened: list[socket.socket] = []

        def work() -> None:
            while True:
                try:
                    connection, _ = listener.accept()
                except OSError:
                    return
                opened.append(connection)
                if content:
                    connection.recv(65536)
                    connection.sendall(content)
                    connection.close()

        thread = threading.Thread(target=work, daemon=True)
        thread.start()
        yield f"http://127.0.0.1:{listener.getsockname()[1]}"
        listener.shutdown(socket.SHUT_RDWR)
        thread.join(30)
        for connection in opened:
            connection.close()


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"HTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\nhello", "not JSON"),
        (b"HTTP/1.1 404 Not Found\r\nContent-Length: 5\r\n\r\nhello", "status 404"),
        (b"220 mail.example ESMTP\r\n", "was lost"),
        (b"HTTP/1.1 200 OK\r\nContent-Length: 500\r\n\r\nhello", "was lost"),
    ],
)
def test_other_servers_are_recognised(content: bytes, problem: str) -> None:
    with replying(content) as url:
        client = ServerClient(parse_address(url), "blender-test")
        with pytest.raises(AddOnError, match=problem):
            client.request("GET", "/pairs")
        client.close()


def test_a_missing_server_gives_a_message() -> None:
    with nobody_listens() as url:
        fake = FakeBlender(url)
        fake.link.start()
        fake.link.join(60)
    assert fake.link.ended
    assert "No server is running" in fake.link.problem
    fake.link.stop()


def test_a_silent_server_does_not_block_the_main_thread() -> None:
    with replying(b"") as url:
        link = CameraLink(parse_address(url), CAMERA, "blender-test", {})
        link.start()
        assert not link.connected
        assert link.requests.empty()
        link.update({})
        link.stop()


def test_a_missing_program_is_explained(tmp_path: Path) -> None:
    with pytest.raises(AddOnError, match="The program 'no-such-scope' was not found"):
        ServerProcess("no-such-scope", [], tmp_path)


def test_the_add_on_needs_only_the_standard_library_and_blender() -> None:
    allowed = {*sys.stdlib_module_names, "bpy", "blf", "gpu", "gpu_extras", "mathutils"}
    for path in addon_folder().rglob("*.py"):
        tree = ast.parse(path.read_bytes(), feature_version=(3, 10))
        for node in ast.walk(tree):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and not node.level:
                names = [node.module or ""]
            assert {name.partition(".")[0] for name in names} <= allowed, path
