"""Servers on loopback with two cameras in the analytic scene."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import httpx2
import pytest

from scope_ptz.serve.security.access import Access
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.security.tokens import TokenFile
from scope_ptz.serve.site.site import SiteOptions
from tests.serve.serving import CAMERA, OTHER, Served, serving

SPEC = "sim:analytic-yard?width=320&height=180"


@pytest.fixture(scope="module")
def scenes(analytic_folder: Path) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SCOPE_SCENES_DIR", str(analytic_folder.parent))
        yield


@pytest.fixture(scope="module")
def served(scenes: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server for programs on this machine, without tokens and rate limits."""
    options = SiteOptions(tmp_path_factory.mktemp("served") / "runs")
    with serving(options, Access("127.0.0.1", limits=RateLimits(None)), {CAMERA: SPEC, OTHER: SPEC}) as server:
        yield server


@pytest.fixture(scope="module")
def tokens(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The tokens by name, and the path of their file."""
    path = tmp_path_factory.mktemp("tokens") / "tokens.json"
    file = TokenFile(path)
    return {
        "anna": file.add("anna", "operator"),
        "ben": file.add("ben", "operator"),
        "vera": file.add("vera", "viewer"),
        "path": str(path),
    }


@pytest.fixture(scope="module")
def guarded(scenes: None, tokens: dict[str, str], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server that needs tokens."""
    options = SiteOptions(tmp_path_factory.mktemp("guarded") / "runs")
    access = Access("127.0.0.1", TokenFile(Path(tokens["path"])), limits=RateLimits(None))
    with serving(options, access, {CAMERA: SPEC, OTHER: SPEC}) as server:
        yield server


@pytest.fixture
def client(served: Served) -> Iterator[httpx2.Client]:
    """A client without control. The camera is free and in its home position."""
    for station in served.site.stations.values():
        served.call(station.control.clear)
    with served.client() as opened:
        opened.post(f"/cameras/{CAMERA}/stop")
        opened.post(f"/cameras/{CAMERA}/home")
        yield opened
