"""Benchmark tasks have the same results with the AXIS and ONVIF drivers as with the simulated camera in process."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from scope_ptz.agent.timing import Timings
from scope_ptz.bench.tasks.splits import load_split
from scope_ptz.camera.axis.camera import AxisCamera
from scope_ptz.geometry import Pose

PROGRAM = Path(__file__).parents[1] / "benchmarks" / "driver_parity.py"
FEW_TASKS = tuple(f"scope1-highway-works-{name}" for name in ("counting-010", "single-call-001", "location-011"))
"""Tasks at one viewpoint: moves, a zoom, a count and a question."""


@pytest.fixture(scope="module")
def parity() -> ModuleType:
    spec = importlib.util.spec_from_file_location("driver_parity", PROGRAM)
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules["driver_parity"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.full
@pytest.mark.anyio
async def test_a_few_tasks_are_the_same_on_all_paths(parity: ModuleType) -> None:
    measured = await parity.measure([task for task in load_split("core") if task.id in FEW_TASKS])
    assert {each.task for each in measured} == set(FEW_TASKS)
    for each in measured:
        assert each.deviations() == []
        assert [run.perception for run in each.runs.values()] == ["ground-truth", *2 * ["simulation-only-truth"]]
        assert each.runs["in process"].outcome == "answered"
        assert all(run.calls for run in each.runs.values())


@pytest.mark.full
@pytest.mark.parametrize(("split", "count"), [("core", 20), ("unseen", 6)])
def test_a_sample_is_the_same_on_all_paths(split: str, count: int, tmp_path: Path) -> None:
    result = subprocess.run(
        [sys.executable, "-W", "error", str(PROGRAM), "--split", split, "--tasks", str(count)],
        cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False,
    )  # fmt: skip
    assert result.returncode == 0, result.stdout
    assert f"| axis | {count}/{count} (100.0%) | {count}/{count} (100.0%) | {count}/{count} (100.0%) |" in result.stdout
    assert f"| onvif | {count}/{count} (100.0%) | {count}/{count} (100.0%) | {count}/{count} (100.0%) |" in result.stdout


@pytest.mark.full
@pytest.mark.anyio
async def test_a_wrong_field_of_view_in_a_driver_is_a_deviation(parity: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    class WrongLens(AxisCamera):
        @classmethod
        async def open(cls, *arguments: Any, **options: Any) -> AxisCamera:
            return await super().open(*arguments, **options, fields_deg=(50.0, 10.0))

    monkeypatch.setattr(parity, "AxisCamera", WrongLens)
    tasks = [task for task in load_split("core") if task.id == "scope1-highway-works-single-call-006"]
    (measured,) = await parity.measure(tasks)
    assert "zoom in on the yellow road roller" in tasks[0].instruction
    found = [(path, kind) for path, kind, _ in measured.deviations()]
    assert ("axis", "pose") in found
    assert "onvif" not in dict(found)


@pytest.mark.full
@pytest.mark.anyio
async def test_hundreds_of_core_tasks_stay_in_one_viewpoint_and_most_use_the_camera(parity: ModuleType) -> None:
    local = parity.tasks_in_one_viewpoint(load_split("core"))
    assert len(local) > 300
    sample = local[::12]
    used = await parity.tasks_with_calls(sample)
    assert len(sample) / 2 < len(used) < len(sample)


@pytest.mark.parametrize(
    ("change", "kinds"),
    [
        ({}, []),
        ({"pose": Pose(10.29, -5.0, 2.03)}, []),
        ({"pose": Pose(10.31, -5.0, 2.0)}, ["pose"]),
        ({"pose": Pose(10.0, -5.31, 2.0)}, ["pose"]),
        ({"pose": Pose(10.0, -5.0, 2.05)}, ["pose"]),
        ({"calls": [("adjust_ptz", {"pan_deg": 10.004})]}, []),
        ({"calls": [("adjust_ptz", {"pan_deg": 10.02})]}, ["calls"]),
        ({"calls": [("adjust_ptz", {"tilt_deg": 10.0})]}, ["calls"]),
        ({"calls": []}, ["calls"]),
        ({"calls": [("go_home", {}), ("adjust_ptz", {"pan_deg": 10.0})]}, ["calls"]),
        ({"answer": "Five."}, ["answer"]),
        ({"outcome": "camera_error"}, ["answer"]),
    ],
)  # fmt: skip
def test_every_deviation_is_reported(parity: ModuleType, change: dict[str, Any], kinds: list[str]) -> None:
    reference = parity.PathRun([("adjust_ptz", {"pan_deg": 10.0})], "answered", "Four.", Pose(10, -5, 2), Timings(), "ground-truth")
    measured = parity.TaskRuns("task", {"in process": reference, "axis": reference, "onvif": replace(reference, **change)})
    found = measured.deviations()
    assert [(path, kind) for path, kind, _ in found] == [("onvif", kind) for kind in kinds]
    lines = "\n".join(parity.report([measured]))
    assert ("No deviations." in lines) == (not kinds)
    assert all(f"- task, onvif, {kind}: " in lines for kind in kinds)


def test_only_the_note_on_the_source_is_removed(parity: ModuleType) -> None:
    assert parity.without_source("I see 4. (Source: the simulator's ground truth.)") == "I see 4."
    assert parity.without_source("I panned (10 degrees).") == "I panned (10 degrees)."


@pytest.fixture(scope="module")
def tracking(parity: ModuleType) -> ModuleType:
    spec = importlib.util.spec_from_file_location("driver_tracking", PROGRAM.with_name("driver_tracking.py"))
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules["driver_tracking"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.full
@pytest.mark.anyio
async def test_tracking_has_the_same_result_on_all_paths(tracking: ModuleType) -> None:
    compared = await tracking.compare(["highway-works"], objects=1, seconds=2)
    assert len(compared) == 3
    for each in compared:
        assert each.deviations() == []
        observations = each.runs["in process"].observations
        assert len(observations) >= 4 and observations[0].seen and sum(observation.seen for observation in observations) >= 3
        assert observations[0].pose != observations[-1].pose


def test_every_deviation_in_tracking_is_reported(tracking: ModuleType) -> None:
    observations = (tracking.Observation(0.0, Pose(10, -5, 2), True), tracking.Observation(0.5, Pose(12, -5, 2), True))
    reference = tracking.ChaseRun(observations, "Followed.", Pose(12, -5, 2))
    chase = tracking.Chase("yard", "mast", Pose(10, -5, 2), 1.0, "track the van for 1 seconds")
    compared = tracking.ChaseComparison(chase, {"in process": reference, "axis": reference, "onvif": reference})
    assert compared.deviations() == []
    assert "No deviations." in tracking.report([compared])
    late = replace(reference, observations=(observations[0], replace(observations[1], seen=False)))
    aside = replace(reference, observations=(observations[0], replace(observations[1], pose=Pose(12.4, -5, 2))))
    elsewhere, silent = replace(reference, final=Pose(12, -4, 2)), replace(reference, answer="Nothing.")
    for wrong, text in ((late, "other times"), (aside, "observation 1"), (elsewhere, "ends at"), (silent, "'Nothing.'")):
        (found,) = tracking.ChaseComparison(chase, {"in process": reference, "axis": reference, "onvif": wrong}).deviations()
        assert found.startswith("onvif: ") and text in found
