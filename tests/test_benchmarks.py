"""Every benchmark runs with a small workload. No times are checked."""

from __future__ import annotations

import runpy
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"
SMALL_WORKLOADS = {
    "plan_latency": ["--limit", "20"],
    "startup": ["--rounds", "1"],
}


def run(name: str, *arguments: str, folder: Path) -> str:
    result = subprocess.run(
        [sys.executable, str(BENCHMARKS / f"{name}.py"), *arguments],
        cwd=folder, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    return result.stdout


@pytest.mark.full
@pytest.mark.parametrize("name", ["plan_latency", "startup"])
def test_a_benchmark_prints_ratios(name: str, tmp_path: Path) -> None:
    assert " x " in run(name, *SMALL_WORKLOADS[name], folder=tmp_path)


# blender_engines runs inside Blender; reprojection starts it.
@pytest.mark.parametrize(
    "name", sorted(path.stem for path in BENCHMARKS.glob("*.py") if path.stem not in {*SMALL_WORKLOADS, "blender_engines"})
)
def test_a_benchmark_can_be_imported_and_has_help(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The benchmark runs in this process, because a new process would spend most of its time on imports."""
    monkeypatch.setattr("sys.argv", [name, "--help"])
    monkeypatch.syspath_prepend(BENCHMARKS)
    with pytest.raises(SystemExit) as excinfo:
        runpy.run_path(str(BENCHMARKS / f"{name}.py"), run_name="__main__")
    assert excinfo.value.code == 0
    assert "usage:" in capsys.readouterr().out


@pytest.mark.full
@pytest.mark.parametrize(("name", "arguments"), [
    ("reprojection", ["--scene", "highway-works"]),
    ("model_overhead", ["--rounds", "6"]),
    ("reading", ["--scene", "highway-works", "--views", "1"]),
    ("bench_numbers", ["--split", "lite"]),
    ("gym_steps", ["--rounds", "4", "--vector"]),
    ("simulated_report", ["out"]),
    ("search_baselines", ["--episodes", "2", "--scene", "highway-works"]),
])  # fmt: skip
def test_a_longer_benchmark_runs(name: str, arguments: list[str], tmp_path: Path) -> None:
    assert run(name, *arguments, folder=tmp_path).strip()
