"""Verification repeats the calls of a run: honest logs are reproduced, and consistent forgeries are detected."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.engine.sample_files import open_sample
from scope_ptz.bench.engine.stored_run import STORE
from scope_ptz.bench.engine.traces.frame_comparison import compare_frames
from tests.bench.engine.editing import Json, edit_log, trace_change
from tests.bench.engine.yard_tasks import SCENE
from tests.cli.conftest import Scope

COUNT, TURN = f"scope1-{SCENE}-counting-001#1", f"scope1-{SCENE}-single-call-001#1"


pytestmark = pytest.mark.full


def verify(scope: Scope, log: Path) -> tuple[int, dict[str, Any]]:
    run_result = scope("bench", "verify", str(log), "--json")
    return run_result.code, json.loads(run_result.out)[str(log)]


def run_named(result: dict[str, Any], name: str) -> dict[str, Any]:
    return next(run for run in result["each"] if run["run"] == name)


def call_of(records: list[Json]) -> Json:
    return next(record for record in records if record["event"] == "call")


def test_an_honest_log_is_verified_with_its_frames(scope: Scope, log_copy: Path) -> None:
    code, result = verify(scope, log_copy)
    assert (code, result["verified"], result["differs"], result["not_verifiable"]) == (0, 4, 0, 0), result
    assert result["frames"] >= 8
    assert all(run["replies"] for run in result["each"])
    run_result = scope("bench", "verify", str(log_copy), "--limit", "1")
    assert run_result.code == 0 and "1 of 1 runs verified" in run_result.out


def other_pose(records: list[Json]) -> None:
    """Change the pose after the turn in every field that states it."""
    call = call_of(records)
    call["pose"]["pan_deg"] += 10.0
    call["outcome"]["result"]["pose"]["pan_deg"] += 10.0
    records[-1]["pose"]["pan_deg"] += 10.0


def other_reply(records: list[Json]) -> None:
    """Remove one box from the perception reply, and adjust the result to match."""
    call = call_of(records)
    call["replies"][0]["result"]["boxes"].pop()
    result = call["outcome"]["result"]
    result["boxes"].pop()
    result["count"] -= 1


def other_count(records: list[Json]) -> None:
    call_of(records)["outcome"]["result"]["count"] += 1


def invented_call(records: list[Json]) -> list[Json]:
    """Add a count that was never made, with its decision, before the end of the run."""
    start, *middle, finish, end = records
    decision = json.loads(json.dumps(next(r for r in middle if r["event"] == "decision")))
    call = json.loads(json.dumps(call_of(middle)))
    decision["step"] = call["step"] = finish["step"]
    call["outcome"]["result"] = {**(call["outcome"]["result"] or {}), "count": 99}
    call["outcome"]["call"] = {"id": "x", "name": "count_objects", "arguments": {"description": "cars", "view": "current"}}
    decision["decision"]["calls"] = [call["outcome"]["call"]]
    finish["step"] += 1
    end["steps"] += 1
    return [start, *middle, decision, call, finish, end]


def missing_call(records: list[Json]) -> list[Json]:
    """Remove the move and its decision, and let the run end at its start pose."""
    start, decision, call, finish, end = records
    assert (decision["event"], call["event"]) == ("decision", "call")
    finish["step"], end["steps"] = 1, 1
    end["pose"] = start["pose"]
    return [start, finish, end]


def other_scene_time(records: list[Json]) -> None:
    records[-1]["scene_time_s"] += 3.0


@pytest.mark.parametrize(
    ("change", "name", "text"),
    [
        (other_pose, TURN, "pose was recorded"),
        (other_reply, COUNT, "perception reply"),
        (other_count, COUNT, "count in the result"),
        (invented_call, COUNT, "result"),
        (missing_call, TURN, "scene time at the end"),
        (other_scene_time, TURN, "scene time at the end"),
    ],
)
def test_a_forged_trace_is_detected(
    scope: Scope, log_copy: Path, tmp_path: Path, change: Callable[[list[Json]], Any], name: str, text: str
) -> None:
    log = edit_log(log_copy, tmp_path / "forged.eval", trace_change(change), [name])
    code, result = verify(scope, log)
    assert code == 1
    assert (result["verified"], result["differs"]) == (3, 1)
    run = run_named(result, name)
    assert run["status"] == "differs"
    assert text in " ".join(run["differences"]), run


def swap_frames(sample: Json) -> None:
    pictures = sample["store"][STORE]["pictures"]
    first, *_, last = sorted(pictures)
    assert pictures[first] != pictures[last]
    pictures[first], pictures[last] = pictures[last], pictures[first]


def no_frames(sample: Json) -> None:
    sample["store"][STORE]["pictures"] = {}


def other_presets(sample: Json) -> None:
    sample["store"][STORE]["presets"]["yard"] = "elsewhere"


@pytest.mark.parametrize(
    ("change", "text"),
    [(swap_frames, "does not show the view"), (no_frames, "is missing"), (other_presets, "viewpoints of the presets")],
)
def test_forged_frames_and_viewpoints_are_detected(
    scope: Scope, log_copy: Path, tmp_path: Path, change: Callable[[Json], None], text: str
) -> None:
    code, result = verify(scope, edit_log(log_copy, tmp_path / "forged.eval", change, [TURN]))
    assert code == 1
    assert text in " ".join(run_named(result, TURN)["differences"])


def test_a_run_of_another_version_is_not_verifiable(scope: Scope, log_copy: Path, tmp_path: Path) -> None:
    def older(records: list[Json]) -> None:
        records[0]["rendering"] = 1

    def unknown_perception(records: list[Json]) -> None:
        records[0]["perception_version"] = None

    for number, change in enumerate((older, unknown_perception)):
        log = edit_log(log_copy, tmp_path / f"{number}.eval", trace_change(change), [COUNT])
        code, result = verify(scope, log)
        assert (code, result["verified"], result["not_verifiable"]) == (0, 3, 1)
        assert "version" in run_named(result, COUNT)["differences"][0]


def test_model_replies_are_not_recomputed_but_results_must_follow_from_them(scope: Scope, log_copy: Path, tmp_path: Path) -> None:
    def by_a_model(records: list[Json]) -> None:
        records[0] |= {"perception": "some-model", "perception_version": None}
        other_reply(records)
        result = call_of(records)["outcome"]["result"]
        result["message"] = result["message"].replace(str(result["count"] + 1), str(result["count"]))

    def claims_more(records: list[Json]) -> None:
        by_a_model(records)
        other_count(records)

    code, result = verify(scope, edit_log(log_copy, tmp_path / "model.eval", trace_change(by_a_model), [COUNT]))
    run = run_named(result, COUNT)
    assert (code, run["status"], run["replies"]) == (0, "verified", False), run
    code, result = verify(scope, edit_log(log_copy, tmp_path / "forged.eval", trace_change(claims_more), [COUNT]))
    assert (code, run_named(result, COUNT)["status"]) == (1, "differs")


def test_the_tolerance_of_frames(log_copy: Path) -> None:
    """Recompressed pixels are accepted. A frame with an altered area or from another view is not."""
    sample = open_sample(log_copy, COUNT)
    jpeg = sample.picture(sample.trace.started.frame or "")
    assert jpeg is not None
    image = np.asarray(cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR))

    def encoded(pixels: Any, quality: int) -> bytes:
        return bytes(cv2.imencode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, quality])[1])

    for quality in (75, 85, 92, 98):
        difference = compare_frames(jpeg, encoded(image, quality))
        assert difference is not None and difference.accepted, difference
    painted = image.copy()
    painted[300:348, 600:648] = 255 - painted[300:348, 600:648]
    shifted = np.roll(image, 6, axis=1)
    for other in (painted, shifted, 255 - image):
        difference = compare_frames(jpeg, encoded(other, 92))
        assert difference is not None and not difference.accepted, difference
    assert compare_frames(jpeg, encoded(image[:-8], 92)) is None
    assert compare_frames(b"nothing", jpeg) is None


def test_an_honest_log_has_no_findings(log_copy: Path) -> None:
    assert read_evaluation(log_copy).findings == ()
