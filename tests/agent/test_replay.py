"""Replays: a run is reproduced without its models, and a changed scene is detected."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import anyio
import pytest

from scope_ptz.agent.records import Budgets
from scope_ptz.agent.replay import Replay, replay
from scope_ptz.agent.store import RunFolder
from scope_ptz.agent.trace import Trace, TraceWriter, read_trace
from scope_ptz.camera.base import Camera
from scope_ptz.errors import CameraError, PerceptionError, TraceError
from scope_ptz.geometry import Pose
from scope_ptz.planner.base import Decision, State
from tests.agent.scripted import ScriptedCamera, Step, answer, calls, make_agent

MOVE = ("adjust_ptz", {"pan_deg": 15.0, "zoom_factor": 1.3})
COUNT = ("count_objects", {"description": "cones"})


def record(
    root: Path,
    *script: Step,
    counts: tuple[int | BaseException, ...] = (0,),
    budgets: Budgets | None = None,
    camera: Camera | None = None,
) -> Trace:
    folder = RunFolder.create(root, "x")

    async def work() -> None:
        with TraceWriter(folder.trace) as trace:
            await make_agent(*script, counts=counts, images=folder, budgets=budgets, camera=camera).run("x", listener=trace)

    anyio.run(work)
    return read_trace(folder.path)


def replay_of(trace: Trace, camera: Camera | None = None) -> Replay:
    return anyio.run(replay, trace, camera or ScriptedCamera())


@pytest.mark.parametrize(
    "script",
    [
        (calls(("go_to_preset", {"name": "highway"})), calls(COUNT), calls(MOVE), calls(COUNT), answer("Done.")),
        (calls(("go_to_preset", {"name": "nowhere"}), MOVE), answer("No such preset.")),
        (calls(("query_answer", {"question": "how many?", "view": "full"}), ("take_image", {})), answer("3")),
        (calls(("zoom_to_object", {"description": "van"})), calls(("go_home", {})), answer("Back.")),
        (calls(("track_object", {"description": "van", "duration_s": 3.0})), answer("Followed.")),
        (answer("Nothing to do."),),
    ],
    ids=["loop", "bad call", "full view", "zoom", "track", "no calls"],
)
def test_a_replay_gives_the_same_results(tmp_path: Path, script: tuple[Step, ...]) -> None:
    trace = record(tmp_path, *script, counts=(3, 5))
    replayed_run = replay_of(trace)
    assert replayed_run.matches, replayed_run
    assert len(replayed_run.comparisons) == len(trace.calls)


def test_perception_failures_are_replayed(tmp_path: Path) -> None:
    trace = record(tmp_path, calls(COUNT), calls(COUNT), answer("x"), counts=(PerceptionError("timeout"), 2))
    assert trace.calls[0].outcome.error == "timeout"
    assert replay_of(trace).matches


def test_a_step_limit_is_replayed(tmp_path: Path) -> None:
    assert replay_of(record(tmp_path, calls(MOVE), budgets=Budgets(max_steps=2))).matches


def test_an_interrupted_run_is_replayed_up_to_its_end(tmp_path: Path) -> None:
    trace = record(tmp_path, calls(MOVE, MOVE), calls(COUNT), answer("x"), counts=(4,))
    cut = replace(trace, calls=trace.calls[:1], ended=None)
    replayed_run = replay_of(cut)
    assert replayed_run.matches
    assert len(replayed_run.comparisons) == 1


def test_a_run_whose_camera_failed_is_replayed_up_to_its_end(tmp_path: Path) -> None:
    def fail(state: State) -> Decision:
        camera.failures["move"] = CameraError("stuck")
        return calls(MOVE)

    camera = ScriptedCamera()
    trace = record(tmp_path, calls(MOVE), fail, camera=camera)
    assert trace.ended is not None
    assert trace.ended.outcome == "camera_error"
    replayed_run = replay_of(trace)
    assert replayed_run.matches
    assert len(replayed_run.comparisons) == 1


def test_a_different_scene_is_detected(tmp_path: Path) -> None:
    trace = record(tmp_path, calls(("go_to_preset", {"name": "gate"})), calls(MOVE), answer("x"))
    replayed_run = replay_of(trace, ScriptedCamera(presets=("yard", "gate")))
    assert not replayed_run.matches
    assert "pose was" in replayed_run.comparisons[0].difference


def test_a_different_start_pose_is_detected(tmp_path: Path) -> None:
    trace = record(tmp_path, calls(MOVE), answer("x"))
    camera = ScriptedCamera()
    anyio.run(camera.move, Pose(1.0, 0.0, 1.0))
    assert not replay_of(trace, camera).matches


def test_runs_of_real_cameras_cannot_be_replayed(tmp_path: Path) -> None:
    trace = record(tmp_path, answer("x"))
    real = replace(trace, started=trace.started.model_copy(update={"simulated": False}))
    with pytest.raises(TraceError, match="real camera"):
        replay_of(real)
