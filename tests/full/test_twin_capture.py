"""A twin captured over the network from a camera with wrong poses and a drift matches the pack of the camera."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARK = Path(__file__).parents[2] / "benchmarks" / "twin_capture.py"


@pytest.mark.full
@pytest.mark.parametrize(("driver", "scene"), [("axis", "highway-works"), ("onvif", "high-street")])
def test_a_twin_captured_over_the_network_matches_its_site(driver: str, scene: str, tmp_path: Path) -> None:
    result = subprocess.run(
        [
            sys.executable, str(BENCHMARK), "--driver", driver, "--scene", scene, "--pan=-35:35", "--tilt=-15:5",
            "--close-ups", "3", "--views", "5", "--json",
        ],
        cwd=tmp_path, capture_output=True, text=True, timeout=500, check=False,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    results = json.loads(result.stdout)
    assert results["ssim_without_common_turn"]["1x"]["mean"] >= 0.9
    assert results["adjusted_error_deg"]["mean"] < min(0.2, results["reported_error_deg"]["mean"])
    assert results["adjusted_error_without_common_turn_deg"]["median"] < 0.05
    assert results["views_turned_deg"]["mean"] < 0.2
    assert results["unseen_share"] < 0.01
