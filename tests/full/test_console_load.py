"""Run the load benchmark of the console for a minute. Results that depend on the speed of the machine are not checked."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARK = Path(__file__).parents[2] / "benchmarks" / "console_load.py"


@pytest.mark.full
def test_a_minute_of_viewers_conversations_stops_and_intruders(tmp_path: Path) -> None:
    output = tmp_path / "results.json"
    completed = subprocess.run(
        [sys.executable, str(BENCHMARK), "--seconds", "60", "--json", str(output), "--no-browser"],
        cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert (completed.returncode, completed.stderr) == (0, "scope: cancelled.\n")
    results = json.loads(output.read_text())
    assert results["problems"] == []
    assert results["exit_code"] == 130
    assert results["left_over"]["sockets"] == 0
    assert results["threads"]["most"] < 60
    assert results["memory_growth"] < 2.0
    assert set(results["intruders"]) == {"409"}, "a client without control never moves a camera"
    assert set(results["runs"]) <= {"answered", "cancelled", "clarification", "refused"}
    assert results["runs"]["answered"] > 0
    assert results["stop_s"]["count"] > 5
    for name, viewer in results["viewers"].items():
        assert viewer["failure"] == "", name
        assert viewer["out_of_order"] == 0, name
        assert viewer["frames_per_s"] > 0, name
