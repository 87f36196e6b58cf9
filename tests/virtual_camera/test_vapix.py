"""The VAPIX handlers without HTTP: any arguments, the scales, presets, parameters and the control queue."""

from __future__ import annotations

import json
from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.camera.capabilities import Velocity
from scope_ptz.geometry import Limits, Perspective, Pose, direction
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera import device as device_module
from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.vapix import moves, scales
from scope_ptz.virtual_camera.vapix.arguments import Arguments
from scope_ptz.virtual_camera.vapix.control_queue import CONTROL_TIMEOUT_S, ControlQueue
from scope_ptz.virtual_camera.vapix.json_apis import api_discovery, basic_device_info
from scope_ptz.virtual_camera.vapix.parameters import param, parameters
from scope_ptz.virtual_camera.vapix.ptz import ptz, ptz_config, ptz_queue
from scope_ptz.virtual_camera.vapix.queries import QUERIES
from scope_ptz.virtual_camera.vapix.replies import Client, Reply
from scope_ptz.virtual_camera.vapix.vapix_camera import VapixCamera

ROOT, GUARD = Client("root", Role.ADMINISTRATOR), Client("guard", Role.OPERATOR)
LIMITS = Limits()


@dataclass
class HandClock:
    """Stands in for ``time.monotonic``, so that no test waits."""

    now: float = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def time(monkeypatch: pytest.MonkeyPatch) -> HandClock:
    clock = HandClock()
    monkeypatch.setattr(device_module, "monotonic", clock)
    return clock


@pytest.fixture
def vapix(analytic_scene: Scene, time: HandClock) -> VapixCamera:
    return VapixCamera(VirtualDevice(analytic_scene, width=320, height=180))


def send(vapix: VapixCamera, client: Client = ROOT, **arguments: str) -> Reply:
    return ptz(vapix, Arguments(arguments), client)


def arrive(vapix: VapixCamera, time: HandClock, seconds: float = 60.0) -> Pose:
    time.now += seconds
    return vapix.device.pose()


def position(vapix: VapixCamera) -> dict[str, str]:
    return dict(line.split("=", 1) for line in send(vapix, query="position").body.splitlines())


NAMES = st.sampled_from([*moves.COMMANDS, "query", "speed", "camera", "info", "group", "format", "imagewidth", "focus", "x"])
TEXTS = st.one_of(
    st.text(max_size=12),
    st.floats().map(str),
    st.integers(-20_000, 20_000).map(str),
    st.tuples(st.floats(), st.floats()).map(lambda pair: f"{pair[0]},{pair[1]}"),
    st.lists(st.integers(-500, 500), min_size=3, max_size=3).map(lambda numbers: ",".join(map(str, numbers))),
    st.sampled_from([*moves.WORDS, *QUERIES, "zoom", "speed", "json"]),
)


@pytest.fixture(scope="module")
def shared_unit(analytic_scene: Scene) -> VapixCamera:
    return VapixCamera(VirtualDevice(analytic_scene, width=320, height=180, time_scale=1e6))


@pytest.mark.full
@given(arguments=st.dictionaries(NAMES, TEXTS, max_size=4))
def test_any_request_gets_a_documented_reply(shared_unit: VapixCamera, arguments: dict[str, str]) -> None:
    reply = ptz(shared_unit, Arguments(arguments), ROOT)
    assert (reply.status, reply.body == "") in ((204, True), (200, False))
    pose = shared_unit.device.pose()
    assert LIMITS.clamp(pose)[0] == pose


@given(arguments=st.dictionaries(st.sampled_from(["setserverpresetname", "setserverpresetno", "removeserverpresetno", "home",
       "renameserverpresetno", "newname", "removeserverpresetname", "removeallserverpresets"]), TEXTS, max_size=3))  # fmt: skip
def test_any_configuration_keeps_the_presets_whole(shared_unit: VapixCamera, arguments: dict[str, str]) -> None:
    reply = ptz_config(shared_unit, Arguments(arguments))
    assert reply.status == 204 or reply.body.startswith("Error:")
    listed = send(shared_unit, query="presetposcam").body.splitlines()
    assert len(listed) == 1 + len(shared_unit.device.presets())


@given(st.integers(1, 9999))
def test_zoom_positions_survive_a_round_trip(step: int) -> None:
    assert scales.zoom_step(scales.magnification(step, LIMITS), LIMITS) == step


@given(st.floats(-100, 100), st.floats(-100, 100))
def test_speeds_rise_with_their_values(one: float, other: float) -> None:
    low, high = sorted((one, other))
    assert scales.speed_fraction(low) <= scales.speed_fraction(high)
    assert scales.speed_fraction(-one) == -scales.speed_fraction(one)


def test_the_ends_of_the_speed_scale() -> None:
    assert [scales.speed_fraction(value) for value in (-100, 0, 100, 1000)] == [-1, 0, 1, 1]


@given(pan=st.floats(-170, 170), tilt=st.floats(-55, 25), zoom=st.integers(1, 9999))
def test_a_position_that_is_read_can_be_sent_back(shared_unit: VapixCamera, pan: float, tilt: float, zoom: int) -> None:
    assert send(shared_unit, pan=str(pan), tilt=str(tilt), zoom=str(zoom)).status == 204
    while shared_unit.device.is_moving():
        pass
    read = position(shared_unit)
    assert [float(read["pan"]), float(read["tilt"])] == pytest.approx([pan, tilt], abs=1e-4)
    assert int(read["zoom"]) == zoom


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        ({"pan": "left"}, "pan: expected a number"),
        ({"pan": "nan"}, "pan: expected a number"),
        ({"pan": "inf"}, "pan: expected a number"),
        ({"pan": ""}, "pan: expected a number"),
        ({"continuouspantiltmove": "10"}, "2 comma-separated numbers"),
        ({"areazoom": "10,10,0"}, "areazoom"),
        ({"move": "sideways"}, "move: unknown value: sideways"),
        ({"query": "weather"}, "query: unknown value: weather"),
        ({"query": "attributes", "group": "focus"}, "group: unknown value"),
        ({"gotoserverpresetname": "nowhere"}, "no preset 'nowhere'"),
        ({"gotoserverpresetno": "99"}, "99"),
        ({"camera": "2", "pan": "1"}, "only camera is 1"),
        ({"brightness": "100"}, "not supported"),
        ({"focus": "near"}, "focus: expected a number"),
        ({"autofocus": "maybe"}, "autofocus: unknown value"),
        ({}, "no command"),
        ({"timestamp": "1"}, "no command"),
    ],
)
def test_errors_are_successes_of_http(vapix: VapixCamera, arguments: dict[str, str], problem: str) -> None:
    reply = ptz(vapix, Arguments(arguments), ROOT)
    assert reply.status == 200
    assert reply.body.startswith("Error: ")
    assert problem in reply.body
    assert reply.body.count("\n") == 1
    assert not vapix.device.is_moving()


def test_values_beyond_a_limit_are_clamped(vapix: VapixCamera, time: HandClock) -> None:
    assert send(vapix, pan="5000", tilt="-5000", zoom="99999").status == 204
    assert arrive(vapix, time) == Pose(179, -60, 5)
    send(vapix, rpan="360", rtilt="-360", rzoom="-9999")
    assert arrive(vapix, time) == Pose(179, -60, 1)


def test_axes_of_separate_requests_move_together(vapix: VapixCamera, time: HandClock) -> None:
    send(vapix, pan="90")
    time.now += 0.1
    send(vapix, tilt="-20")
    time.now += 0.1
    send(vapix, zoom="9999")
    assert arrive(vapix, time) == Pose(90, -20, 5)


def test_the_move_speed_is_kept_and_slows_pan_and_tilt_only(vapix: VapixCamera, time: HandClock) -> None:
    start = vapix.device.pose()
    send(vapix, speed="40", rpan="60", zoom="9999")
    assert send(vapix, query="speed").body == "speed=40\n"
    halfway = arrive(vapix, time, 5.0)
    assert halfway.zoom == pytest.approx(5)
    assert halfway.pan_deg - start.pan_deg == pytest.approx(30, abs=1)


def test_continuous_moves_of_pan_and_zoom_are_independent(vapix: VapixCamera, time: HandClock) -> None:
    device = vapix.device
    send(vapix, continuouspantiltmove="100,-40")
    assert device.commanded_velocity == Velocity(100, -6, 0)
    send(vapix, continuouszoommove="50")
    assert device.commanded_velocity == Velocity(100, -6, 0.75)
    send(vapix, continuouspantiltmove="0,0")
    assert device.commanded_velocity == Velocity(0, 0, 0.75)
    time.now += 0.5
    send(vapix, continuouszoommove="0")
    stopped = arrive(vapix, time)
    assert arrive(vapix, time) == stopped
    assert stopped.zoom > 1.0


def test_a_stop_ends_a_continuous_move(vapix: VapixCamera, time: HandClock) -> None:
    send(vapix, continuouspantiltmove="10,0")
    time.now += 1
    send(vapix, move="stop")
    time.now += 1
    stopped = vapix.device.pose()
    assert arrive(vapix, time) == stopped
    assert not vapix.device.is_moving()


@given(x=st.integers(0, 320), y=st.integers(0, 180), zoom=st.integers(1, 9999))
def test_a_centred_pixel_is_in_the_centre(shared_unit: VapixCamera, x: int, y: int, zoom: int) -> None:
    vapix, device = shared_unit, shared_unit.device
    send(vapix, pan="20", tilt="-15", zoom=str(zoom))
    while device.is_moving():
        pass
    before = device.pose()
    view = Perspective(before.pan_deg, before.tilt_deg, device.optics.hfov_deg(before.zoom), 320, 180)
    aimed_at = view.directions((x / 320, y / 180))
    assert send(vapix, center=f"{x * 4},{y * 4}", imagewidth="1280", imageheight="720").status == 204
    while device.is_moving():
        pass
    after = device.pose()
    assert direction(after.pan_deg, after.tilt_deg) == pytest.approx(aimed_at, abs=1e-6)
    assert after.zoom == before.zoom


def test_areazoom_narrows_the_field_of_view(vapix: VapixCamera, time: HandClock) -> None:
    optics = vapix.device.optics
    send(vapix, areazoom="160,90,200")
    pose = arrive(vapix, time)
    assert (pose.pan_deg, pose.tilt_deg) == pytest.approx((vapix.device.home.pan_deg, vapix.device.home.tilt_deg))
    assert optics.focal(pose.zoom) == pytest.approx(2 * optics.focal(1.0))
    send(vapix, areazoom="160,90,50")
    assert arrive(vapix, time).zoom == pytest.approx(1.0)


@pytest.mark.parametrize("word", moves.DIRECTIONS)
def test_steps_go_where_they_say(vapix: VapixCamera, time: HandClock, word: str) -> None:
    start, (right, up) = vapix.device.pose(), moves.DIRECTIONS[word]
    send(vapix, move=word)
    end = arrive(vapix, time)
    assert end.pan_deg - start.pan_deg == pytest.approx(right * 0.25 * 71)
    assert (end.tilt_deg > start.tilt_deg) - (end.tilt_deg < start.tilt_deg) == up


def test_limits_and_calibration_agree_with_the_camera(vapix: VapixCamera) -> None:
    limits = dict(line.split("=") for line in send(vapix, query="limits").body.splitlines())
    assert {name: float(value) for name, value in limits.items()} == {
        "MinPan": -179, "MaxPan": 179, "MinTilt": -60, "MaxTilt": 30, "MinZoom": 1, "MaxZoom": 9999, "MinFieldAngle": 140,
        "MaxFieldAngle": 710, "MinFocus": 1, "MaxFocus": 9999, "MinIris": 1, "MaxIris": 9999,
    }  # fmt: skip
    found = json.loads(send(vapix, query="attributes", group="zoom", format="json").body)["Camera 1"]
    assert "speeds" not in found
    for row in found["zoomSteps"]:
        assert float(row["zoom"]) == pytest.approx(scales.magnification(int(row["value"]), LIMITS), abs=1e-6)
    assert {row["value"] for row in found["zoomSteps"]} >= {"1", "9999"}
    speeds = json.loads(send(vapix, query="attributes", group="speed", format="json").body)["Camera 1"]["speeds"]
    assert speeds[-1] == {"value": "100", "speed": "100"}
    plain = send(vapix, query="attributes").body
    assert "speeds=value=1 | speed=0.05," in plain


def test_focus_and_iris_are_set_and_read_back(vapix: VapixCamera, time: HandClock) -> None:
    def position() -> dict[str, str]:
        return dict(line.split("=") for line in send(vapix, query="position").body.splitlines())

    assert (position()["autofocus"], position()["autoiris"]) == ("on", "on")
    before = int(position()["focus"])
    assert send(vapix, rfocus="-500", riris="1000").status == 204
    time.now += 10
    assert int(position()["focus"]) == pytest.approx(before - 500, abs=1)
    assert int(position()["iris"]) == pytest.approx(6000, abs=1)
    assert (position()["autofocus"], position()["autoiris"]) == ("off", "off")
    send(vapix, focus="9999", iris="-3")
    time.now += 10
    assert (position()["focus"], position()["iris"]) == ("9999", "1")
    send(vapix, autofocus="on", autoiris="on")
    time.now += 10
    assert int(position()["focus"]) == before
    assert send(vapix, autofocus="off", focus="near").body.startswith("Error")
    assert position()["autofocus"] == "on"  # a request with a wrong argument changes nothing


def test_presets_are_saved_renamed_listed_and_removed(vapix: VapixCamera, time: HandClock) -> None:
    send(vapix, pan="45", tilt="-3", zoom="5000")
    there = arrive(vapix, time)
    assert ptz_config(vapix, Arguments({"setserverpresetname": "North, Gate 2", "home": "yes"})).status == 204
    assert vapix.device.home == there
    number = vapix.device.find_preset("North, Gate 2").number
    assert f"presetposno{number}=North, Gate 2" in send(vapix, query="presetposcam").body
    data = json.loads(send(vapix, query="presetposcamdata", format="json").body)["Camera 1"]["presets"]
    assert f"presetposno{number}=North, Gate 2:tilt=-3.000000:pan=45.000000:zoom=5000" in data
    assert ptz_config(vapix, Arguments({"renameserverpresetno": str(number), "newname": "South"})).status == 204
    assert parameters(vapix)[f"PTZ.Preset.P0.Position.P{number}.Name"] == "South"
    assert parameters(vapix)["PTZ.Preset.P0.HomePosition"] == str(number)
    assert ptz_config(vapix, Arguments({"setserverpresetno": "77"})).status == 204
    assert vapix.device.preset(77).name == "p77"
    assert ptz_config(vapix, Arguments({"removeserverpresetno": "77"})).status == 204
    assert ptz_config(vapix, Arguments({"removeserverpresetname": "South"})).status == 204
    assert send(vapix, gotoserverpresetname="South").body.startswith("Error:")


@pytest.mark.parametrize("name", ["", " ", "a:b", 'a"b', "a\nb", "x" * 32])
def test_bad_preset_names(vapix: VapixCamera, name: str) -> None:
    before = vapix.device.presets()
    assert ptz_config(vapix, Arguments({"setserverpresetname": name})).body.startswith("Error:")
    assert vapix.device.presets() == before


def test_parameters_by_group(vapix: VapixCamera) -> None:
    everything = param(vapix, Arguments({"action": "list"}), ROOT).body.splitlines()
    assert all(line.startswith("root.") and "=" in line for line in everything)
    for group, inside in (("root.PTZ", "PTZ."), ("PTZ", "PTZ."), ("root.Brand.ProdNbr", "Brand.ProdNbr=M5075-G")):
        rows = param(vapix, Arguments({"action": "list", "group": group}), ROOT).body.splitlines()
        assert rows
        assert all(row.startswith(f"root.{inside}") for row in rows)
    both = param(vapix, Arguments({"action": "list", "group": "root.Brand,root.IOPort"}), ROOT).body
    assert "root.Brand.Brand=AXIS" in both
    assert "root.IOPort.I0" in both
    assert sum(line.startswith("root.PTZ.Support.S1.") for line in everything) == 35


@pytest.mark.parametrize(
    "arguments",
    [
        {},
        {"action": "list", "group": "root.Weather"},
        {"action": "update"},
        {"action": "update", "PTZ.CameraDefault": "2"},
        {"action": "update", "PTZ.Various.V1.CtlQueueing": "maybe"},
    ],
)
def test_parameter_errors(vapix: VapixCamera, arguments: dict[str, str]) -> None:
    reply = param(vapix, Arguments(arguments), ROOT)
    assert reply.status == 200
    assert reply.body.startswith("# Error: ")


def test_the_control_queue_is_off_until_it_is_switched_on(vapix: VapixCamera) -> None:
    assert ptz_queue(vapix, Arguments({"control": "request"}), ROOT).body.startswith("Error:")
    assert send(vapix, GUARD, rpan="1").status == 204
    switch = Arguments({"action": "update", "root.PTZ.Various.V1.CtlQueueing": "true"})
    assert param(vapix, switch, GUARD).status == 403
    assert param(vapix, switch, ROOT).body == "OK\n"
    assert "no client has control" in send(vapix, GUARD, rpan="1").body
    assert ptz_queue(vapix, Arguments({"control": "request"}), GUARD).body == (
        '<a name="1"></a><a name="60"></a><a name="20"></a>\n'
    )
    assert send(vapix, GUARD, rpan="1").status == 204
    assert send(vapix, ROOT, query="position").body.startswith("pan=")
    assert "'guard' has control" in send(vapix, ROOT, rpan="1").body
    ptz_queue(vapix, Arguments({"control": "request"}), ROOT)  # an administrator goes first
    assert send(vapix, ROOT, rpan="1").status == 204
    assert "'root' has control" in send(vapix, GUARD, rpan="1").body
    ptz_queue(vapix, Arguments({"control": "drop"}), ROOT)
    assert send(vapix, GUARD, rpan="1").status == 204


def test_control_ends_without_commands_and_places_without_polls() -> None:
    clock = HandClock()
    queue = ControlQueue(clock)
    queue.enabled = True
    first, second, third = (Client(name, Role.OPERATOR) for name in ("first", "second", "third"))
    assert [queue.request(client).position for client in (first, second, third)] == [1, 2, 3]
    clock.now += queue.poll_s - 1
    assert queue.status(second).position == 2
    clock.now += 5
    assert queue.status(third).position == 0
    queue.check(first)
    for _ in range(4):
        clock.now += CONTROL_TIMEOUT_S / 4 - 1
        assert queue.status(second).position == 2
    clock.now += 5
    assert queue.status(second).position == 1
    queue.check(second)
    clock.now += CONTROL_TIMEOUT_S + 1
    assert queue.status(second).position == 0


@pytest.mark.parametrize("answer", [api_discovery, basic_device_info])
@pytest.mark.parametrize(
    ("method", "body", "code"),
    [
        ("GET", b"", 2002),
        ("POST", b"{", 4000),
        ("POST", b"[]", 4000),
        ("POST", b"\xff" * 10, 4000),
        ("POST", b"[" * 100_000, 4000),
        ("POST", b"{}", 4002),
        ("POST", b'{"method": "fly"}', 2004),
        ("POST", b'{"method": "getApiList", "apiVersion": "9.0"}', 2003),
    ],
)
def test_json_errors(vapix: VapixCamera, answer: object, method: str, body: bytes, code: int) -> None:
    reply = answer(vapix, method, body)  # type: ignore[operator]
    assert reply.status == 200
    assert json.loads(reply.body)["error"]["code"] == code


def test_json_replies_repeat_the_context(vapix: VapixCamera) -> None:
    request = {"apiVersion": "1.0", "context": "abc", "method": "getProperties", "params": {"propertyList": ["ProdNbr"]}}
    found = json.loads(basic_device_info(vapix, "POST", json.dumps(request).encode()).body)
    assert found["context"] == "abc"
    assert found["data"] == {"propertyList": {"ProdNbr": "M5075-G"}}
    listed = json.loads(api_discovery(vapix, "POST", b'{"method": "getApiList"}').body)["data"]["apiList"]
    assert "ptz-control" in {api["id"] for api in listed}
