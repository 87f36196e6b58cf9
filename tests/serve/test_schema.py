"""Generated requests to the API: every reply must be documented in its schema, and no request may cause a server error."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.serve.serving import Served

ENDLESS = "/v1/cameras/{camera}/live.mjpeg"
"""The operation whose reply ends only when the client disconnects. Other tests cover it."""


@pytest.mark.full
def test_generated_requests_get_documented_replies(served: Served, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Generated requests start evaluations, which would continue after the test.
    monkeypatch.setattr(served.site.evaluations, "_program", (sys.executable, "-c", "pass"))
    program = Path(sys.executable).with_name("schemathesis")
    options = ["--checks", "all", "--max-examples", "10", "--phases", "examples,coverage,fuzzing", "--exclude-path", ENDLESS]
    options += ["--generation-deterministic", "--request-timeout", "60", "--no-color"]
    command = [str(program), "run", f"{served.url}/openapi.json", *options]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stdout[-6000:]
    assert "no issues found" in done.stdout.lower() or "passed" in done.stdout.lower(), done.stdout[-2000:]


def test_every_operation_is_documented(served: Served) -> None:
    with served.client() as client:
        document = client.get("/openapi.json").json()
    names = []
    for path, operations in document["paths"].items():
        assert path.startswith("/v1/")
        for operation in operations.values():
            names.append(operation["operationId"])
            assert operation.get("description"), path
            assert {"401", "403", "422", "429"} < set(operation["responses"]), path
    assert len(names) == len(set(names)) > 45
    assert document["servers"] == [{"url": "/api"}]


def test_tokens_are_documented_where_they_are_needed(guarded: Served, tokens: dict[str, str]) -> None:
    with guarded.client(tokens["vera"]) as client:
        document = client.get("/openapi.json").json()
    assert document["security"] == [{"token": []}]
    assert document["paths"]["/v1/health"]["get"]["security"] == []
    assert document["paths"]["/v1/session"]["post"]["security"] == []
    assert "security" not in document["paths"]["/v1/runs"]["post"]


def test_no_page_loads_resources_from_other_hosts(served: Served) -> None:
    with served.client() as client:
        for path in ("/docs", "/redoc", "/openapi.json", "/health"):
            text = client.get(path).text
            assert "http://" not in text and "https://" not in text
