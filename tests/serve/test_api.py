"""The API on a simulated camera: instructions, tools, moves, presets, control, pictures and feedback."""

from __future__ import annotations

import io
import json
import threading
import time
import zipfile
from collections.abc import Callable
from typing import Any
from urllib.parse import quote

import cv2
import httpx2
import numpy as np
import pytest

from tests.serve.serving import CAMERA, OTHER, Served

LONG = "track the ball for 300 seconds"
"""An instruction that is still in progress when a test ends."""


def events_of(client: httpx2.Client, run: str, last: int | None = None) -> list[tuple[int, str, dict[str, Any]]]:
    """Follow a run to its end and return the id, name and data of each event."""
    found = []
    headers = {} if last is None else {"Last-Event-ID": str(last)}
    with client.stream("GET", f"/runs/{run}/events", headers=headers) as response:
        assert response.headers["content-type"].startswith("text/event-stream")
        fields: dict[str, str] = {}
        for line in response.iter_lines():
            if line:
                name, _, value = line.partition(": ")
                fields[name] = value
            elif "data" in fields:
                found.append((int(fields["id"]), fields["event"], json.loads(fields["data"])))
                fields = {}
    return found


def ask(client: httpx2.Client, instruction: str, **more: object) -> dict[str, Any]:
    response = client.post("/ask", json={"camera": CAMERA, "instruction": instruction, **more})
    assert response.status_code == 200, response.text
    reply: dict[str, Any] = response.json()
    return reply


def start(client: httpx2.Client, instruction: str, **more: object) -> str:
    response = client.post("/runs", json={"camera": CAMERA, "instruction": instruction, **more})
    assert response.status_code == 202, response.text
    return str(response.json()["id"])


def until(condition: Callable[[], bool], seconds: float = 30.0) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "it did not happen"
        time.sleep(0.02)


def pose_of(client: httpx2.Client) -> dict[str, float]:
    pose: dict[str, float] = client.get(f"/cameras/{CAMERA}/pose").json()
    return pose


def test_an_instruction_is_carried_out_in_one_request(client: httpx2.Client) -> None:
    run = ask(client, "pan right 20 degrees")
    assert (run["outcome"], run["running"], run["camera"], run["actor"]) == ("answered", False, CAMERA, "local")
    details = client.get(f"/runs/{run['id']}/details").json()
    assert details["steps"][0]["arguments"] == {"pan_deg": 20.0}


def test_a_run_is_followed_by_events_and_resumed_by_their_ids(client: httpx2.Client, served: Served) -> None:
    run = start(client, "pan right 10 degrees, then count the balls")
    live = events_of(client, run)
    assert [number for number, _, _ in live] == list(range(len(live)))
    assert [name for _, name, _ in live] == ["start", "decision", "call", "decision", "call", "decision", "end"]
    assert events_of(client, run, last=3) == live[4:]
    # The stored run has the same events with the same ids, as after a restart of the server.
    del served.site.runner._handles[run]
    assert events_of(client, run) == live
    assert events_of(client, run, last=5) == live[6:]
    lines = (served.site.library.root / run / "trace.jsonl").read_text().splitlines()
    assert [json.loads(line) for line in lines] == [data for _, _, data in live]


def test_a_second_client_finds_and_follows_a_run_in_progress(client: httpx2.Client, served: Served) -> None:
    run = start(client, LONG)
    with served.client(tab="two") as second:
        assert second.get(f"/cameras/{CAMERA}").json()["run"] == run
        assert second.get(f"/runs/{run}").json()["running"] is True
        assert second.post(f"/runs/{run}/cancel").status_code == 202
        assert events_of(second, run)[-1][2]["outcome"] == "cancelled"
    assert client.get(f"/runs/{run}").json()["outcome"] == "cancelled"


def test_stop_ends_a_run_and_needs_no_control(client: httpx2.Client, served: Served) -> None:
    run = start(client, LONG)
    with served.client(tab="two") as second:
        assert second.post(f"/cameras/{CAMERA}/stop").status_code == 204
    until(lambda: not client.get(f"/runs/{run}").json()["running"])
    assert client.get(f"/cameras/{CAMERA}").json()["run"] is None
    before = pose_of(client)
    time.sleep(0.2)
    assert pose_of(client) == before


def test_only_one_run_at_a_time_and_no_moves_during_it(client: httpx2.Client) -> None:
    run = start(client, LONG)
    for path, body in (("/runs", {"camera": CAMERA, "instruction": "zoom in 2x"}), (f"/cameras/{CAMERA}/move", {"zoom": 2.0})):
        refused = client.post(path, json=body)
        assert (refused.status_code, refused.json()["error"]["code"]) == (409, "busy")
        assert run in refused.json()["error"]["message"]
    other = client.post("/ask", json={"camera": OTHER, "instruction": "zoom in 2x"})
    assert other.json()["outcome"] == "answered", "another camera is free"
    client.post(f"/cameras/{CAMERA}/stop")


@pytest.mark.full
def test_undo_returns_to_the_view_before(client: httpx2.Client) -> None:
    before = pose_of(client)
    ask(client, "pan right 20 degrees, then zoom in 2x")
    client.post(f"/cameras/{CAMERA}/move", json={"tilt_deg": -20.0})
    middle = pose_of(client)
    assert middle["tilt_deg"] == -20.0
    assert client.post(f"/cameras/{CAMERA}/undo").json()["pose"]["tilt_deg"] == pytest.approx(before["tilt_deg"])
    assert client.post(f"/cameras/{CAMERA}/undo").json()["pose"] == pytest.approx(before)


def test_every_tool_is_an_operation(client: httpx2.Client) -> None:
    names = [tool["function"]["name"] for tool in client.get("/tools").json()]
    assert len(names) == 9
    document = client.get("/openapi.json").json()
    assert {f"/v1/cameras/{{camera}}/tools/{name}" for name in names} < set(document["paths"])
    reply = client.post(f"/cameras/{CAMERA}/tools/adjust_ptz", json={"pan_deg": 5.0}).json()
    assert reply["error"] is None
    assert reply["result"]["pose"]["pan_deg"] == reply["pose"]["pan_deg"]
    run = client.get(f"/runs/{reply['run']}").json()
    assert (run["kind"], run["instruction"]) == ("tool", "adjust_ptz(pan_deg=5.0)")
    failed = client.post(f"/cameras/{CAMERA}/tools/go_to_preset", json={"name": "nowhere"}).json()
    assert (failed["result"], failed["fault"]) == (None, "bad_call")
    both = client.post(f"/cameras/{CAMERA}/tools/adjust_ptz", json={"zoom_factor": 2.0, "zoom_limit": "in"}).json()
    assert both["fault"] == "bad_call"
    for wrong in ({"pan_deg": "5"}, {"roll_deg": 5.0}, {"pan_deg": float("nan")}, [1]):
        response = client.post(
            f"/cameras/{CAMERA}/tools/adjust_ptz", content=json.dumps(wrong), headers={"Content-Type": "application/json"}
        )
        assert (response.status_code, response.json()["error"]["code"]) == (422, "wrong_request")


@pytest.mark.full
def test_manual_moves(client: httpx2.Client) -> None:
    arrived = client.post(f"/cameras/{CAMERA}/move", json={"pan_deg": 30.0, "tilt_deg": -5.0, "zoom": 2.0}).json()
    assert arrived["pose"] == pytest.approx({"pan_deg": 30.0, "tilt_deg": -5.0, "zoom": 2.0})
    arrived = client.post(f"/cameras/{CAMERA}/centre", json={"x": 1.0, "y": 0.5}).json()
    assert arrived["pose"]["pan_deg"] > 40.0
    assert arrived["pose"]["zoom"] == pytest.approx(2.0)
    # A click into an older picture refers to the pose of that picture.
    old = {"pan_deg": -30.0, "tilt_deg": 0.0, "zoom": 1.0}
    arrived = client.post(f"/cameras/{CAMERA}/centre", json={"x": 0.5, "y": 0.5, "pose": old}).json()
    assert arrived["pose"]["pan_deg"] == pytest.approx(-30.0, abs=1e-6)
    box = {"x_min": 0.4, "y_min": 0.4, "x_max": 0.6, "y_max": 0.6, "pose": {**old, "zoom": 1.0}}
    arrived = client.post(f"/cameras/{CAMERA}/frame-box", json=box).json()
    assert arrived["pose"]["zoom"] > 3.5
    assert client.post(f"/cameras/{CAMERA}/frame-box", json={**box, "x_max": 0.3}).status_code == 409
    clamped = client.post(f"/cameras/{CAMERA}/move", json={"tilt_deg": 80.0}).json()
    assert clamped["clamped"] == ["tilt"]
    client.post(f"/cameras/{CAMERA}/home")
    start_pan = pose_of(client)["pan_deg"]
    assert client.post(f"/cameras/{CAMERA}/drive", json={"pan_dps": 20.0, "timeout_s": 5.0}).status_code == 204
    until(lambda: pose_of(client)["pan_deg"] > start_pan + 1.0)
    client.post(f"/cameras/{CAMERA}/stop")
    assert pose_of(client) == pose_of(client)


@pytest.mark.full
def test_presets_are_saved_renamed_shown_and_removed(client: httpx2.Client) -> None:
    base = f"/cameras/{CAMERA}/presets"
    known = [preset["name"] for preset in client.get(base).json()]
    thumbnail = client.get(f"{base}/{known[0]}/thumbnail")
    assert thumbnail.headers["content-type"] == "image/jpeg"
    picture = cv2.imdecode(np.frombuffer(thumbnail.content, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None and picture.shape[1] == 320
    client.post(f"/cameras/{CAMERA}/move", json={"pan_deg": 33.0})
    assert client.put(f"{base}/dock no. 1", json={"description": "the dock"}).json()["name"] == "dock no. 1"
    before = pose_of(client)
    client.post(f"/cameras/{CAMERA}/move", json={"pan_deg": 10.0})
    renamed = client.patch(f"{base}/dock no. 1", json={"name": "ramp"}).json()
    assert (renamed["name"], renamed["description"], renamed["pose"]) == ("ramp", "the dock", before)
    assert pose_of(client)["pan_deg"] == pytest.approx(10.0), "the camera is back where it was"
    assert client.get(f"{base}/ramp/thumbnail").status_code == 200
    assert client.get(f"{base}/dock no. 1/thumbnail").status_code == 404
    assert client.post(f"{base}/ramp/go").json()["pose"]["pan_deg"] == pytest.approx(before["pan_deg"])
    assert client.patch(f"{base}/ramp", json={"name": known[0]}).status_code == 409
    assert client.delete(f"{base}/ramp").status_code == 204
    assert [preset["name"] for preset in client.get(base).json()] == known
    assert client.delete(f"{base}/ramp").status_code == 404


def test_control_is_taken_asked_for_and_handed_over(client: httpx2.Client, served: Served) -> None:
    base = f"/cameras/{CAMERA}/control"
    client.delete(base)
    assert client.get(base).json()["holder"] is None
    with served.client(tab="two") as second:
        assert client.post(base).json()["mine"] is True
        refused = second.post(f"/cameras/{CAMERA}/move", json={"zoom": 2.0})
        assert (refused.status_code, refused.json()["error"]["code"]) == (409, "not_in_control")
        assert second.post(base).json()["mine"] is False
        (request,) = client.get(base).json()["requests"]
        assert second.post(f"{base}/answer", json={"client": request["client"], "grant": True}).status_code == 409
        client.post(f"{base}/answer", json={"client": request["client"], "grant": False})
        assert second.get(base).json()["mine"] is False
        second.post(base)
        assert client.post(f"{base}/answer", json={"client": request["client"], "grant": True}).json()["mine"] is False
        assert second.get(base).json()["mine"] is True
        assert second.post(f"/cameras/{CAMERA}/move", json={"zoom": 2.0}).status_code == 200
        assert client.post(f"/cameras/{CAMERA}/move", json={"zoom": 1.0}).status_code == 409
        second.delete(base)
        assert client.post(f"/cameras/{CAMERA}/move", json={"zoom": 1.0}).status_code == 200


def test_conversations_remember_their_own_turns_only(client: httpx2.Client, served: Served) -> None:
    one, two = (client.post("/conversations", json={"camera": CAMERA}).json()["id"] for _ in range(2))
    ask(client, "zoom in 2x", conversation=one)
    ask(client, "pan right 10 degrees", conversation=two)
    run = ask(client, "zoom out again", conversation=one)
    (first, *_) = events_of(client, run["id"])
    assert [turn["instruction"] for turn in first[2]["conversation"]] == ["zoom in 2x"]
    served.call(served.site.library.wait_for_indexing)
    served.site.library._turns.clear()  # as after a restart
    run = ask(client, "go home", conversation=one)
    (first, *_) = events_of(client, run["id"])
    assert [turn["instruction"] for turn in first[2]["conversation"]] == ["zoom in 2x", "zoom out again"]
    listed = client.get("/runs", params={"conversation": two}).json()["runs"]
    assert [each["instruction"] for each in listed] == ["pan right 10 degrees"]
    wrong = client.post("/ask", json={"camera": OTHER, "instruction": "go home", "conversation": one})
    assert wrong.status_code == 409
    assert client.patch(f"/conversations/{one}", json={"title": "zooms"}).json()["title"] == "zooms"
    assert client.delete(f"/conversations/{one}").status_code == 204
    assert client.post("/ask", json={"camera": CAMERA, "instruction": "go home", "conversation": one}).status_code == 404


def test_a_dry_run_reports_its_moves_without_moving(client: httpx2.Client) -> None:
    before = pose_of(client)
    run = ask(client, "pan right 20 degrees", dry_run=True)
    assert (run["kind"], len(run["preview"])) == ("dry_run", 1)
    assert "would move to pan" in run["preview"][0]
    assert pose_of(client) == before


def test_pictures_with_and_without_marks(client: httpx2.Client, served: Served) -> None:
    run = ask(client, "count the balls")["id"]
    pictures = {picture["name"]: picture for picture in client.get(f"/runs/{run}/pictures").json()}
    (name,) = [name for name, picture in pictures.items() if picture["tool"] == "count_objects"]
    assert len(pictures[name]["marks"]) > 0
    plain = client.get(f"/runs/{run}/pictures/{name}")
    assert plain.content == (served.site.library.root / run / name).read_bytes()
    marked = client.get(f"/runs/{run}/pictures/{name}", params={"marks": True})
    images = [cv2.imdecode(np.frombuffer(each.content, np.uint8), cv2.IMREAD_COLOR) for each in (plain, marked)]
    assert images[0] is not None and images[1] is not None
    assert images[0].shape == images[1].shape
    box = pictures[name]["marks"][0]["box"]
    x, y = round(box["x_min"] * images[0].shape[1]), round((box["y_min"] + box["y_max"]) / 2 * images[0].shape[0])
    assert np.abs(images[1][y, x].astype(int) - (247, 195, 76)).max() < 60, "the left side of the box is drawn"
    assert client.get(f"/runs/{run}/filmstrip").headers["content-type"] == "image/png"
    assert client.get(f"/runs/{run}/pictures/frames/999-view.jpg").status_code == 404
    assert client.get(f"/runs/{run}/pictures/frames/..%2Ftrace.jsonl").status_code == 404


def test_runs_are_listed_filtered_kept_and_exported(client: httpx2.Client, served: Served) -> None:
    run = ask(client, "pan left 7 degrees")["id"]
    served.call(served.site.library.wait_for_indexing)
    found = client.get("/runs", params={"text": "left 7", "camera": CAMERA, "outcome": "answered"}).json()
    assert [each["id"] for each in found["runs"]] == [run]
    assert found["count"] == 1
    assert CAMERA in client.get("/runs/values").json()["camera"]
    assert client.put(f"/runs/{run}/kept", json={"kept": True}).status_code == 204
    assert client.get(f"/runs/{run}/details").json()["run"]["kept"] is True
    line = client.get("/runs/export", params={"text": "left 7", "format": "chat"}).text
    assert json.loads(line)["run"] == run
    archive = client.get("/runs/export", params={"text": "left 7", "format": "zip"}).content
    assert f"{run}/trace.jsonl" in zipfile.ZipFile(io.BytesIO(archive)).namelist()
    assert client.get("/runs", params={"after": "nonsense"}).status_code == 409


def test_feedback_is_stored_with_the_run(client: httpx2.Client) -> None:
    run = ask(client, "count the balls")["id"]
    given = client.post(f"/runs/{run}/feedback", json={"rating": -1, "comment": "one is missing", "position": 0})
    assert given.status_code == 201
    assert client.get(f"/runs/{run}/feedback").json() == [given.json()]
    assert run in [each["id"] for each in client.get("/runs", params={"rating": "bad"}).json()["runs"]]
    assert client.post(f"/runs/{run}/feedback", json={"rating": 1, "position": 9}).status_code == 404
    assert client.delete(f"/feedback/{given.json()['id']}").status_code == 204


def test_a_frame_carries_its_geometry(client: httpx2.Client) -> None:
    for form in ("jpeg", "png"):
        response = client.get(f"/cameras/{CAMERA}/frame", params={"format": form})
        picture = cv2.imdecode(np.frombuffer(response.content, np.uint8), cv2.IMREAD_COLOR)
        facts = json.loads(response.headers["scope-frame"])
        assert picture is not None and (facts["width"], facts["height"]) == picture.shape[1::-1] == (320, 180)
        assert facts["pose"] == pose_of(client)
    small = client.get(f"/cameras/{CAMERA}/frame", params={"width": 160})
    picture = cv2.imdecode(np.frombuffer(small.content, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None and picture.shape[1::-1] == (160, 90)


def test_names_come_from_the_configuration_only(client: httpx2.Client) -> None:
    for camera in ("sim:analytic-yard", "blender:yard.blend", "axis://10.0.0.7", "analytic-yard", "../yard"):
        assert client.post("/ask", json={"camera": camera, "instruction": "go home"}).status_code == 404
        assert client.get(f"/cameras/{quote(camera, safe='')}").status_code == 404
    for pair in ("qwen3-4b+moondream3", "grammar", "http://evil/v1"):
        assert client.post("/ask", json={"camera": CAMERA, "instruction": "go home", "pair": pair}).status_code == 404
    for field in ("planner", "planner_url", "runs_dir", "agent", "spec"):
        assert client.post("/ask", json={"camera": CAMERA, "instruction": "go home", field: "x"}).status_code == 422


def test_health_of_pairs(client: httpx2.Client) -> None:
    (pair,) = client.get("/pairs").json()
    health = client.get(f"/pairs/{pair}/health").json()
    assert (health["planner"]["state"], health["perception"]["state"]) == ("built_in", "built_in")
    assert client.get("/pairs/nothing/health").status_code == 404


def test_errors_have_one_form(client: httpx2.Client) -> None:
    replies = [
        client.get("/nothing"),
        client.get("/cameras/nothing"),
        client.delete("/cameras"),
        client.post("/ask", json={"camera": CAMERA}),
        client.post("/ask", content=b"{", headers={"Content-Type": "application/json"}),
        client.post("/ask", json={"camera": CAMERA, "instruction": "   "}),
        client.get("/runs/nothing/events"),
    ]
    assert [reply.status_code for reply in replies] == [404, 404, 405, 422, 422, 409, 404]
    for reply in replies:
        assert set(reply.json()) == {"error"}
        assert set(reply.json()["error"]) == {"code", "message"}


def test_many_clients_start_runs_at_once_and_one_wins(client: httpx2.Client, served: Served) -> None:
    statuses = []

    def attempt(number: int) -> None:
        with served.client(tab=f"t{number}") as other:
            statuses.append(other.post("/runs", json={"camera": CAMERA, "instruction": LONG}).status_code)

    client.delete(f"/cameras/{CAMERA}/control")
    threads = [threading.Thread(target=attempt, args=(number,)) for number in range(5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(statuses) == [202, 409, 409, 409, 409]
    client.post(f"/cameras/{CAMERA}/stop")
