"""Damaged, truncated and foreign logs give a clear error."""

from __future__ import annotations

import json
from pathlib import Path
from zipfile import ZipFile

import pytest

from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.engine.sample_files import open_sample
from scope_ptz.errors import TraceError
from tests.cli.conftest import Scope


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 half a zip", b'{"version": 2}', bytes(range(256)) * 40])
def test_a_file_that_is_not_a_log(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "some.eval"
    path.write_bytes(content)
    with pytest.raises(TraceError, match=r"some\.eval"):
        read_evaluation(path)


def test_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(TraceError, match="does not exist"):
        read_evaluation(tmp_path / "none.eval")
    with pytest.raises(TraceError, match=r"cannot be read|no log"):
        read_evaluation(tmp_path)


def test_a_truncated_log(log_copy: Path, tmp_path: Path) -> None:
    data = log_copy.read_bytes()
    path = tmp_path / "cut.eval"
    for fraction in (0.1, 0.5, 0.99):
        path.write_bytes(data[: int(len(data) * fraction)])
        with pytest.raises(TraceError):
            read_evaluation(path)


def test_a_log_of_another_evaluation(log_copy: Path, tmp_path: Path) -> None:
    path = tmp_path / "other.eval"
    with ZipFile(log_copy) as old, ZipFile(path, "w") as new:
        for name in old.namelist():
            content = json.loads(old.read(name))
            if name == "header.json":
                content["eval"]["metadata"] = {}
            new.writestr(name, json.dumps(content))
    with pytest.raises(TraceError, match="this benchmark did not write"):
        read_evaluation(path)


def test_a_missing_run(log_copy: Path) -> None:
    for name in ("nothing#1", "nothing", "", "#", "../../x#1"):
        with pytest.raises(TraceError, match="does not contain the run"):
            open_sample(log_copy, name)


def test_scores_are_appended_and_none_is_lost(scope: Scope, log_copy: Path) -> None:
    before = read_evaluation(log_copy)
    result = scope("bench", "rescore", str(log_copy), "--checks")
    assert result.code == 0, result.err
    with ZipFile(log_copy) as log:
        samples = [json.loads(log.read(n)) for n in log.namelist() if n.startswith("samples/")]
    assert all(len(sample["scores"]) == 2 for sample in samples)
    after = read_evaluation(log_copy)
    assert after.trials == before.trials
    assert after.card == before.card
    trial = after.trials[0]
    (call,) = [c for c in open_sample(log_copy, trial.sample).trace.calls if c.outcome.call.name == "count_objects"]
    assert open_sample(log_copy, trial.sample).picture((call.outcome.result or {})["frames"][0])


def test_rescoring_requires_checks_or_a_judge(scope: Scope, log_copy: Path) -> None:
    result = scope("bench", "rescore", str(log_copy))
    assert result.code == 2
    assert "--judge-url" in result.err
