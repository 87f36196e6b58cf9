"""Gold runs cover every error mode, are stored without loss, and detect a rule that has become worse."""

from __future__ import annotations

import gzip
import json
from collections import Counter
from pathlib import Path

import pytest

from scope_ptz.bench.scoring import error_modes
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.errors import InputError
from scope_ptz.taskgen.gold.gold_runs import confusion_matrix, create_gold_runs, read_gold, write_gold
from scope_ptz.taskgen.gold.mutations import FaultContext, GoldRun
from tests.bench.sample_runs import FRAME, PRESETS, samples

SAMPLES = samples()
TASKS = [task for task, _ in SAMPLES]


@pytest.fixture(scope="module")
def gold() -> list[GoldRun]:
    return create_gold_runs(SAMPLES, {"test": FaultContext(PRESETS, FRAME)}, seed=1)


def test_every_error_mode_is_added_and_recognised(gold: list[GoldRun]) -> None:
    result = confusion_matrix(gold)
    assert set(Counter(one.mode for one in gold)) == set(ErrorMode)
    assert result.correct_modes == result.total == len(gold)
    assert result.accepted == 0 and result.false_accept_rate == 0
    assert result.as_dict()["matrix"]["scope"] == {"scope": sum(one.mode is ErrorMode.SCOPE for one in gold)}


def test_stored_runs_are_equal_and_give_the_same_bytes(gold: list[GoldRun], tmp_path: Path) -> None:
    one, two = tmp_path / "one.gz", tmp_path / "two.gz"
    write_gold(gold, one)
    published, runs = read_gold(one, TASKS)
    assert published == {"runs": len(gold), "named": len(gold), "accepted": 0}
    assert confusion_matrix(runs).cells == confusion_matrix(gold).cells
    assert [g.episode.observations for g in runs] == [g.episode.observations for g in gold]
    write_gold(runs, two)
    assert one.read_bytes() == two.read_bytes()


def test_worse_rules_are_detected(gold: list[GoldRun], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_gold(gold, tmp_path / "gold.gz")
    published, runs = read_gold(tmp_path / "gold.gz", TASKS)
    assert not confusion_matrix(runs).is_worse_than(published)
    remaining = tuple(rule for rule in error_modes._RULES if rule[0] is not ErrorMode.SCOPE)
    monkeypatch.setattr(error_modes, "_RULES", remaining)
    worse = confusion_matrix(runs)
    assert worse.is_worse_than(published)
    assert {mode for _, _, mode, _ in worse.off_diagonal} == {"scope"}


def test_a_run_with_wrong_perception_gets_no_further_fault() -> None:
    wrong = [(task, run) for task, run in SAMPLES if any(call.name == "count_objects" for call in run.calls)][:1]
    task, run = wrong[0]
    calls = [
        type(c)(**{n: getattr(c, n) for n in type(c).__slots__} | {"result": {**(c.result or {}), "count": 9}}) for c in run.calls
    ]
    run_with_error = type(run)(**{n: getattr(run, n) for n in type(run).__slots__} | {"calls": tuple(calls)})
    contexts = {"test": FaultContext(PRESETS, FRAME)}
    assert create_gold_runs([(task, run)], contexts, seed=1)
    assert create_gold_runs([(task, run_with_error)], contexts, seed=1) == []


@pytest.mark.parametrize("damage", ["cut", "task", "text"])
def test_a_damaged_file_is_reported(gold: list[GoldRun], tmp_path: Path, damage: str) -> None:
    path = tmp_path / "gold.gz"
    write_gold(gold, path)
    lines = gzip.decompress(path.read_bytes()).decode().splitlines()
    if damage == "cut":
        lines.pop()
    elif damage == "task":
        lines[-1] = json.dumps({**json.loads(lines[-1]), "task": "scope1-none-001"})
    path.write_bytes(b"not gzip" if damage == "text" else gzip.compress("\n".join(lines).encode()))
    with pytest.raises(InputError, match="gold"):
        read_gold(path, TASKS)
