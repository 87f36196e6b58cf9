"""A minute of the soak test of the virtual camera. Results that depend on the speed of the machine are not checked."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARK = Path(__file__).parents[2] / "benchmarks" / "virtual_camera_soak.py"


@pytest.mark.full
def test_a_minute_of_streams_moves_and_disconnecting_clients(tmp_path: Path) -> None:
    output = tmp_path / "results.json"
    result = subprocess.run(
        [sys.executable, "-W", "error", str(BENCHMARK), "--minutes", "1", "--json", str(output)],
        cwd=tmp_path, capture_output=True, text=True, timeout=400, check=False,
    )  # fmt: skip
    assert (result.returncode, result.stderr) == (0, "")
    results = json.loads(output.read_text())
    assert results["left_over"] == {"threads": 0, "sockets": 0}
    assert results["sessions_open_at_end"] == 0
    assert results["clients_total"] > 10
    assert results["memory_growth"] < 1.3
    assert 0 < results["server"]["oldest_sent_s"] <= 0.5
    assert results["server"]["sent"] > 100
    for name, stream in results["streams"].items():
        assert stream["failure"] == "", name
        assert stream["out_of_order"] == 0, name
        assert stream["frames_per_s"] > 0, name
