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


def test_a_truncated_log(evaluated: Path, tmp_path: Path) -> None:
    whole = evaluated.read_bytes()
    path = tmp_path / "cut.eval"
    for share in (0.1, 0.5, 0.99):
        path.write_bytes(whole[: int(len(whole) * share)])
        with pytest.raises(TraceError):
            read_evaluation(path)


def test_a_log_of_another_evaluation(evaluated: Path, tmp_path: Path) -> None:
    path = tmp_path / "other.eval"
    with ZipFile(evaluated) as old, ZipFile(path, "w") as new:
        for name in old.namelist():
            content = json.loads(old.read(name))
            if name == "header.json":
                content["eval"]["metadata"] = {}
            new.writestr(name, json.dumps(content))
    with pytest.raises(TraceError, match="this benchmark did not write"):
        read_evaluation(path)


def test_a_missing_run(evaluated: Path) -> None:
    for name in ("nothing#1", "nothing", "", "#", "../../x#1"):
        with pytest.raises(TraceError, match="does not contain the run"):
            open_sample(evaluated, name)


def test_scores_are_appended_and_none_is_lost(scope: Scope, evaluated: Path) -> None:
    before = read_evaluation(evaluated)
    done = scope("bench", "rescore", str(evaluated), "--checks")
    assert done.code == 0, done.err
    with ZipFile(evaluated) as log:
        samples = [json.loads(log.read(n)) for n in log.namelist() if n.startswith("samples/")]
    assert all(len(sample["scores"]) == 2 for sample in samples)
    after = read_evaluation(evaluated)
    assert after.trials == before.trials
    assert after.card == before.card
    trial = after.trials[0]
    (look,) = [c for c in open_sample(evaluated, trial.sample).trace.calls if c.outcome.call.name == "count_objects"]
    assert open_sample(evaluated, trial.sample).picture((look.outcome.result or {})["frames"][0])


def test_rescoring_requires_checks_or_a_judge(scope: Scope, evaluated: Path) -> None:
    done = scope("bench", "rescore", str(evaluated))
    assert done.code == 2
    assert "--judge-url" in done.err
