"""Episodes from recorded traces: poses, viewpoints, perception calls, pictures and outcomes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import anyio
import pytest

from scope_ptz.agent.records import Budgets
from scope_ptz.agent.store import RunFolder
from scope_ptz.agent.trace import TraceWriter, read_trace
from scope_ptz.bench.scoring.episode import Episode, FrameGeometry, PresetViewpoints, episode_of
from scope_ptz.errors import PerceptionError
from scope_ptz.geometry import Equirectangular, Perspective, Pose
from scope_ptz.tools.sweep import sweep
from tests.agent.scripted import ScriptedCamera, answer, calls, make_agent

PRESET_VIEWPOINTS = PresetViewpoints({"gate": "mast", "highway": "bridge"}, "mast")
COUNT = ("count_objects", {"description": "cones"})


def run(folder: Path, *script: Any, **options: Any) -> Episode:
    episode_options = {name: options.pop(name) for name in ("planner_sees", "keeps_files") if name in options}
    run_folder = RunFolder.create(folder, "go")

    async def work() -> None:
        with TraceWriter(run_folder.trace) as trace:
            await make_agent(*script, images=run_folder, **options).run("go", listener=trace)

    anyio.run(work)
    return episode_of(read_trace(run_folder.path), PRESET_VIEWPOINTS, **episode_options)


def test_poses_and_viewpoints_follow_the_calls(tmp_path: Path) -> None:
    episode = run(
        tmp_path,
        calls(("go_to_preset", {"name": "highway"})),
        calls(("adjust_ptz", {"pan_deg": 15.0})),
        calls(COUNT),
        calls(("go_home", {})),
        calls(COUNT),
        answer("Two."),
        counts=[2],
    )
    assert [c.after.viewpoint for c in episode.calls] == ["bridge", "bridge", "bridge", "mast", "mast"]
    assert [c.after.pose.pan_deg for c in episode.calls] == [20.0, 35.0, 35.0, 0.0, 0.0]
    assert [c.before.pose.pan_deg for c in episode.calls] == [0.0, 20.0, 35.0, 35.0, 0.0]
    first, second = episode.observations
    assert (first.viewpoint, second.viewpoint) == ("bridge", "mast")
    assert isinstance(first.projection, Perspective)
    assert (first.projection.pan_deg, first.request, first.kind) == (35.0, "cones", "count")
    assert (episode.outcome, episode.answer, episode.final.viewpoint) == ("answered", "Two.", "mast")


def test_a_failed_perception_call_is_no_observation_and_a_wrong_preset_moves_nothing(tmp_path: Path) -> None:
    episode = run(
        tmp_path,
        calls(("go_to_preset", {"name": "nowhere"})),
        calls(COUNT),
        answer("None."),
        counts=[PerceptionError("down")],
    )
    assert [c.fault for c in episode.calls] == ["bad_call", "perception"]
    assert episode.observations == ()
    assert {c.after.pose for c in episode.calls} == {Pose()}


def test_pictures_exist_in_the_run_folder_or_were_deliberately_not_stored(tmp_path: Path) -> None:
    stored = run(tmp_path, calls(("take_image", {}), ("take_image", {})), answer())
    assert [(p.file, p.exists) for p in stored.pictures] == [("pictures/001.png", True), ("pictures/002.png", True)]
    not_stored = run(tmp_path, calls(("take_image", {})), answer(), keeps_files=False)
    assert [p.exists for p in not_stored.pictures] == [None]


def test_views_shown_to_a_planner_with_vision_count_as_observations(tmp_path: Path) -> None:
    without_vision = run(tmp_path, calls(("adjust_ptz", {"pan_deg": 15.0})), answer("Five."))
    assert without_vision.observations == ()
    with_vision = run(tmp_path, calls(("adjust_ptz", {"pan_deg": 15.0})), answer("Five."), planner_sees=True)
    assert [
        (observation.kind, observation.projection.pan_deg)
        for observation in with_vision.observations
        if isinstance(observation.projection, Perspective)
    ] == [
        ("planner", 0.0),
        ("planner", 15.0),
    ]


def test_zooming_observes_from_its_start_and_tracking_throughout(tmp_path: Path) -> None:
    zoomed = run(tmp_path, calls(("zoom_to_object", {"description": "van"})), answer(), counts=[1])
    assert zoomed.observations[0].kind == "locate"
    assert isinstance(zoomed.observations[0].projection, Perspective)
    assert zoomed.observations[0].projection.pan_deg == 0.0
    tracked = run(tmp_path, calls(("track_object", {"description": "van", "duration_s": 2.0})), answer(), counts=[1])
    assert len(tracked.observations) >= 3
    assert tracked.observations[-1].time_s > tracked.observations[0].time_s


def test_an_incomplete_run_has_no_outcome(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path, "go")

    async def work() -> None:
        with TraceWriter(folder.trace) as trace:
            await make_agent(calls(COUNT), answer(), images=folder).run("go", listener=trace)

    anyio.run(work)
    lines = folder.trace.read_text("utf-8").splitlines(keepends=True)
    folder.trace.write_text("".join(lines[:-1]), "utf-8")
    episode = episode_of(read_trace(folder.path), PRESET_VIEWPOINTS)
    assert (episode.outcome, episode.answer) == (None, "")
    limited = run(tmp_path, calls(COUNT), budgets=Budgets(max_steps=2))
    assert limited.outcome == "step_limit"


@pytest.mark.parametrize("size", [(1280, 720), (640, 480)])
def test_the_sweep_of_an_episode_matches_that_of_the_tool(size: tuple[int, int]) -> None:
    camera = ScriptedCamera()
    sweep_projection = anyio.run(sweep, camera).projection
    assert isinstance(sweep_projection, Equirectangular)
    assert FrameGeometry(64, 36).sweep() == sweep_projection
    band = FrameGeometry(*size).sweep()
    assert band.pan_span_deg == 360.0
    assert band.bottom_tilt_deg < -60
