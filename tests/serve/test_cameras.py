"""Camera cards, scene time, poses of presets, and turning virtual cameras on and off."""

from __future__ import annotations

import logging
import socket
import time
from collections.abc import Iterator
from pathlib import Path

import httpx2
import pytest

from scope_ptz.serve.security.access import Access
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.site.site import SiteOptions, site_cameras
from scope_ptz.settings import load_settings
from tests.serve.conftest import SPEC
from tests.serve.serving import CAMERA, OTHER, Served, serving

DEVICE = "yard-gate"
RULED = "quiet-yard"
LONG = "track the ball for 300 seconds"


@pytest.fixture(scope="module")
def closed_port() -> int:
    """A port of this machine on which nothing listens."""
    with socket.create_server(("127.0.0.1", 0)) as taken:
        return int(taken.getsockname()[1])


@pytest.fixture(scope="module")
def site(scenes: None, closed_port: int, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server with a camera that does not answer, a simulated camera with rules, and two simulated cameras without rules."""
    folder = tmp_path_factory.mktemp("site")
    (folder / "scope.yaml").write_text(
        f"""
cameras:
  {DEVICE}: {{camera: "axis://operator@127.0.0.1:{closed_port}", password: "env:GATE_PASSWORD"}}
  {RULED}:
    camera: "{SPEC}"
    mounting: {{position: ceiling}}
    rules: {{keep_out: [{{name: windows, pan_deg: [100, 120], tilt_deg: [-20, 10]}}]}}
"""
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SCOPE_CONFIG", str(folder / "scope.yaml"))
        patch.setenv("GATE_PASSWORD", "not-to-be-seen")
        cameras = site_cameras((DEVICE, RULED), load_settings()) | {CAMERA: SPEC, OTHER: SPEC}
        with serving(SiteOptions(folder / "runs"), Access("127.0.0.1", limits=RateLimits(None)), cameras) as server:
            yield server


@pytest.fixture
def user(site: Served) -> Iterator[httpx2.Client]:
    """A client of the server. Nobody controls any camera."""
    for station in site.site.stations.values():
        site.call(station.control.clear)
    with site.client() as opened:
        yield opened


def code(reply: httpx2.Response) -> tuple[int, str]:
    """Return the status and the error code of a reply."""
    return reply.status_code, reply.json()["error"]["code"]


def test_scene_time_is_paused_sought_and_sped_up(user: httpx2.Client) -> None:
    path = f"/cameras/{CAMERA}/time"
    changed = user.patch(path, json={"playing": False, "time_s": 20}).json()
    assert changed == {"time_s": 20.0, "playing": False, "speed": 1.0}
    time.sleep(0.1)
    assert user.get(path).json()["time_s"] == 20.0
    picture = user.get(f"/cameras/{CAMERA}/frame")
    assert '"time_s": 20.0' in picture.headers["scope-frame"]
    assert user.get(f"/cameras/{CAMERA}/frame").content == picture.content, "while scene time is paused, pictures are the same"
    assert user.patch(path, json={"speed": 10, "playing": True}).json()["speed"] == 10.0
    first = user.get(path).json()["time_s"]
    time.sleep(0.1)
    assert user.get(path).json()["time_s"] >= first + 0.9
    assert user.patch(path, json={"time_s": 5.0, "playing": False, "speed": 1.0}).json()["time_s"] == 5.0
    assert user.post(f"/cameras/{CAMERA}/move", json={"pan_deg": 3.0}).json()["pose"]["pan_deg"] == 3.0, "the motors still work"
    assert user.patch(path, json={}).json() == {"time_s": 5.0, "playing": False, "speed": 1.0}


@pytest.mark.parametrize("body", [{"time_s": -1}, {"time_s": 1e9}, {"speed": 0}, {"speed": 11}, {"playing": "yes"}, {"now": 1}])
def test_invalid_times_are_refused(user: httpx2.Client, body: dict[str, object]) -> None:
    assert code(user.patch(f"/cameras/{CAMERA}/time", json=body)) == (422, "wrong_request")


def test_scene_time_needs_control(user: httpx2.Client, site: Served) -> None:
    user.patch(f"/cameras/{CAMERA}/time", json={"playing": True})
    with site.client(tab="two") as second:
        assert code(second.patch(f"/cameras/{CAMERA}/time", json={"playing": False})) == (409, "not_in_control")
        assert second.patch(f"/cameras/{OTHER}/time", json={"time_s": 1.0}).status_code == 200, "another camera can be changed"
        assert second.get(f"/cameras/{CAMERA}/time").json()["playing"] is True


def test_scene_time_cannot_be_changed_during_an_instruction(user: httpx2.Client) -> None:
    user.patch(f"/cameras/{CAMERA}/time", json={"playing": True})
    run = user.post("/runs", json={"camera": CAMERA, "instruction": LONG}).json()
    assert code(user.patch(f"/cameras/{CAMERA}/time", json={"playing": False})) == (409, "busy")
    user.post(f"/runs/{run['id']}/cancel")


def test_a_real_camera_has_no_scene_time(user: httpx2.Client) -> None:
    for reply in (user.get(f"/cameras/{DEVICE}/time"), user.patch(f"/cameras/{DEVICE}/time", json={"playing": False})):
        assert code(reply) == (409, "not_simulated")
        assert "real world" in reply.json()["error"]["message"]


def test_a_card_lists_the_abilities_of_a_camera(user: httpx2.Client) -> None:
    user.get(f"/cameras/{CAMERA}")
    user.post(f"/cameras/{CAMERA}/control")
    card = user.get(f"/cameras/{CAMERA}/card").json()
    assert (card["kind"], card["scene"]["name"], card["health"]) == (
        "simulated",
        "analytic-yard",
        {"state": "connected", "problem": None},
    )
    assert {"move", "drive", "presets", "scene_time", "ground_truth", "virtual_camera"} == set(card["abilities"])
    assert card["open"] and card["control"]["mine"] and card["scene_time"]["speed"] > 0
    assert card["virtual_camera"]["on"] is False
    assert code(user.get("/cameras/nothing/card")) == (404, "unknown")


def test_the_card_of_a_camera_that_fails_has_the_error_and_no_secret(user: httpx2.Client, closed_port: int) -> None:
    card = user.get(f"/cameras/{DEVICE}/card")
    assert card.status_code == 200
    facts = card.json()
    assert (facts["kind"], facts["health"]["state"], facts["health"]["problem"]["code"]) == ("axis", "failed", "camera_failed")
    assert str(closed_port) in facts["health"]["problem"]["message"]
    assert "not-to-be-seen" not in card.text
    assert code(user.get(f"/cameras/{DEVICE}/thumbnail")) == (404, "unknown")


def test_thumbnails_do_not_open_a_camera_and_respect_its_rules(user: httpx2.Client, site: Served) -> None:
    fresh = site.site.stations[OTHER]
    was_open = fresh.is_open
    reply = user.get(f"/cameras/{OTHER}/thumbnail")
    assert (reply.status_code, reply.headers["content-type"]) == (200, "image/jpeg")
    assert fresh.is_open == was_open
    assert code(user.get(f"/cameras/{RULED}/thumbnail")) == (404, "unknown"), "the picture would show what the rules hide"
    user.get(f"/cameras/{RULED}")
    assert user.get(f"/cameras/{RULED}/thumbnail", params={"width": 160}).status_code == 200


def test_presets_of_a_scene_have_poses_before_a_visit(user: httpx2.Client) -> None:
    presets = user.get(f"/cameras/{CAMERA}/presets").json()
    assert all(each["pose"] and each["viewpoint"] for each in presets)
    there = presets[-1]
    arrival = user.post(f"/cameras/{CAMERA}/presets/{there['name']}/go").json()
    assert arrival["pose"] == pytest.approx(there["pose"])
    state = user.get(f"/cameras/{CAMERA}").json()
    assert (state["viewpoint"], state["presets"]) == (there["viewpoint"], presets)


def test_poses_of_presets_are_those_of_the_mounted_camera(user: httpx2.Client) -> None:
    preset = user.get(f"/cameras/{RULED}/presets").json()[-1]
    arrival = user.post(f"/cameras/{RULED}/presets/{preset['name']}/go").json()
    assert arrival["pose"] == pytest.approx(preset["pose"], abs=1e-6)


def test_a_virtual_camera_is_turned_on_and_off(user: httpx2.Client, site: Served, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG)
    path = f"/cameras/{CAMERA}/virtual"
    reply = user.post(path, json={})
    assert reply.status_code == 201, reply.text
    assert reply.headers["cache-control"] == "no-store"
    made = reply.json()
    assert made["on"] and made["account"] == "root" and len(made["password"]) >= 16
    for url in (made["vapix_url"], made["onvif_url"], made["rtsp_url"]):
        assert "://127.0.0.1:" in url
        assert made["password"] not in url
    picture = f"{made['vapix_url']}/axis-cgi/jpg/image.cgi"
    with httpx2.Client(trust_env=False) as program:
        assert program.get(picture).status_code == 401
        assert program.get(picture, auth=httpx2.DigestAuth("root", made["password"])).status_code == 200
    shown = user.get(path).json()
    assert shown == {**made, "password": None}, "the password is returned only once"
    assert user.get(f"/cameras/{CAMERA}/card").json()["virtual_camera"] == shown
    assert code(user.post(path, json={})) == (409, "not_possible")
    assert user.delete(path).status_code == 204
    assert user.get(path).json()["on"] is False
    with pytest.raises(httpx2.ConnectError), httpx2.Client(trust_env=False) as program:
        program.get(picture)
    again = user.post(path, json={"viewpoint": made["viewpoint"]}).json()
    assert again["password"] != made["password"]
    user.delete(path)
    assert user.delete(path).status_code == 204
    assert made["password"] not in caplog.text
    assert again["password"] not in caplog.text


def test_only_scenes_have_virtual_cameras(user: httpx2.Client) -> None:
    assert code(user.post(f"/cameras/{DEVICE}/virtual", json={})) == (409, "not_simulated")
    assert code(user.post(f"/cameras/{RULED}/virtual", json={})) == (409, "refused_by_camera")
    assert code(user.post(f"/cameras/{CAMERA}/virtual", json={"viewpoint": "nowhere"})) == (404, "unknown")
    for body in ({"scene": "other"}, {"host": "example.org"}, {"port": 80}, {"viewpoint": ""}):
        assert code(user.post(f"/cameras/{CAMERA}/virtual", json=body)) == (422, "wrong_request")
    assert user.get(f"/cameras/{CAMERA}/virtual").json()["on"] is False


def test_a_viewer_cannot_change_scene_time_or_virtual_cameras(guarded: Served, tokens: dict[str, str]) -> None:
    with guarded.client(tokens["vera"]) as viewer:
        base = f"/cameras/{CAMERA}"
        for reply in (
            viewer.patch(f"{base}/time", json={"playing": False}),
            viewer.post(f"{base}/virtual", json={}),
            viewer.delete(f"{base}/virtual"),
        ):
            assert code(reply) == (403, "not_allowed")
        assert viewer.get(f"{base}/time").status_code == 200
        assert viewer.get(f"{base}/card").status_code == 200


@pytest.mark.full
def test_virtual_cameras_end_with_the_server(scenes: None, tmp_path: Path) -> None:
    access = Access("127.0.0.1", limits=RateLimits(None))
    with serving(SiteOptions(tmp_path / "runs"), access, {CAMERA: SPEC}) as server, server.client() as client:
        made = client.post(f"/cameras/{CAMERA}/virtual", json={}).json()
    with pytest.raises(httpx2.ConnectError), httpx2.Client(trust_env=False) as program:
        program.get(made["vapix_url"])
