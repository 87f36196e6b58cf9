"""``scope bench run`` writes a log with every tool call, perception call and picture, which can be read back as data."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import cv2
import numpy as np
import pytest
from inspect_ai.log import read_eval_log

from scope_ptz.bench.engine.entries import Entry, select_entries
from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.engine.sample_files import open_sample
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.tasks.task_wording import facts_of
from tests.bench.engine.yard_tasks import SCENE, TASKS
from tests.cli.conftest import Scope


def test_a_log_is_read_as_scored_runs(log_copy: Path) -> None:
    evaluation = read_evaluation(log_copy)
    assert evaluation.finished
    assert [trial.task.id for trial in evaluation.trials] == [task.id for task in TASKS]
    assert [trial.headline for trial in evaluation.trials] == ["correct", "incorrect", "correct", "correct"]
    count_trial, wrong_trial, turn_trial, _ = evaluation.trials
    assert count_trial.tool_calls == {"count_objects": 1}
    # Perception time excludes capture time, and together they do not exceed the duration of the call.
    (observation,) = count_trial.looks
    assert observation.view == "current" and observation.capture_s > 0 and observation.eyes_s > 0
    assert 0 < observation.eyes_s + observation.capture_s <= observation.call_s
    assert count_trial.timings.perception_s > 0
    assert (count_trial.task.viewpoint, count_trial.task.category) == ("mast", "counting")
    # Perception was right, so the error is not attributed to it.
    assert wrong_trial.error_mode not in (None, ErrorMode.VLM_COUNTING)
    assert turn_trial.timings.total_s >= turn_trial.timings.planner_s > 0
    assert {check.name for check in turn_trial.checks} >= {"outcome", "pose"}


def test_the_card_states_the_settings(log_copy: Path) -> None:
    card = read_evaluation(log_copy).card
    assert (card.pair, card.ranked) == ("grammar + ground-truth", False)
    assert (card.agent, card.epochs, card.seed, card.max_steps) == ("scope", 1, 1, 60)
    assert card.engine_version.startswith("inspect-ai 0.3.")
    assert len(card.dataset_digest) == 16
    assert card.contended


def test_the_log_shows_tool_calls_perception_calls_and_pictures(log_copy: Path) -> None:
    log = read_eval_log(str(log_copy), resolve_attachments=True)
    assert log.samples is not None
    sample = next(s for s in log.samples if "counting-001" in str(s.id))
    spans = {e.id: e for e in sample.events if e.event == "span_begin"}
    models = [e for e in sample.events if e.event == "model"]
    perception_calls = [e for e in models if e.role == "eyes"]
    assert [e.role for e in models] == ["planner", "eyes", "planner"]
    # The perception call is inside the tool call that made it, with its picture.
    assert spans[str(perception_calls[0].span_id)].name == "count_objects"
    assert any(part.type == "image" for part in perception_calls[0].input[0].content if not isinstance(part, str))
    (call,) = [e for e in sample.events if e.event == "tool"]
    assert call.arguments == {"description": "balls", "view": "current"}
    assert "image" in [part.type for part in call.result if not isinstance(part, str | int | float | bool)]  # type: ignore[union-attr]
    assert {"planner", "eyes"} == set(log.eval.model_roles or {})


def test_trace_and_pictures_of_a_run_can_be_extracted(log_copy: Path) -> None:
    files = open_sample(log_copy, f"scope1-{SCENE}-counting-001#1")
    assert files.trace.ended is not None
    assert files.trace.ended.outcome == "answered"
    (called,) = files.trace.calls
    name = (called.outcome.result or {})["frames"][0]
    jpeg = files.picture(name)
    assert jpeg is not None
    picture = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    assert picture.shape == (720, 1280, 3)
    assert files.picture("frames/999-view.jpg") is None


def test_completed_runs_are_not_repeated(scope: Scope, log_copy: Path, tasks_file: Path) -> None:
    before = log_copy.read_bytes()
    result = scope("bench", "run", "--tasks", str(tasks_file), "--out", str(log_copy.parent), "--json")
    assert result.code == 0
    assert "already complete" in result.err
    assert result.json["headlines"] == {"correct": 3, "incorrect": 1, "unscored": 0, "infrastructure": 0}
    assert result.json["by_category"] == {"counting": 0.5, "single_call": 1.0}
    assert (result.json["macro"], result.json["micro"]) == (0.75, 0.75)
    assert log_copy.read_bytes() == before
    assert list(log_copy.parent.glob("*.eval")) == [log_copy]


def test_epochs_categories_and_no_pictures(scope: Scope, tasks_file: Path, tmp_path: Path) -> None:
    result = scope(
        "bench", "run", "--tasks", str(tasks_file), "--category", "single_call", "--limit", "1", "--epochs", "2", "--no-pictures",
        "--latency", "--out", str(tmp_path), "--json",
    )  # fmt: skip
    assert result.code == 0, result.err
    evaluation = read_evaluation(Path(result.json["log"]))
    assert [(t.task.category, t.epoch) for t in evaluation.trials] == [("single_call", 1), ("single_call", 2)]
    assert (evaluation.wanted, evaluation.card.contended, evaluation.card.concurrency) == (2, False, 1)
    assert not open_sample(Path(result.json["log"]), evaluation.trials[0].sample).references


def test_a_limit_spreads_over_categories_scenes_and_scopes() -> None:
    rows = [
        (category, scene, "full" if category == "counting" and number == 0 else "current", number)
        for scene in ("north", "south", "west")
        for category in ("ocr", "counting", "location")
        for number in range(10)
    ]
    facts = facts_of(TASKS[0], "mast")
    entries = tuple(
        Entry(
            facts=facts.model_copy(update={"id": f"{scene}-{category}-{n}", "category": category, "scene": scene, "scope": scope}),
            world=scene,
        )
        for category, scene, scope, n in rows
    )
    for limit in (3, 8, 30, 89):
        selected = select_entries(entries, limit=limit)
        assert len({e.facts.id for e in selected}) == limit
        assert selected == select_entries(entries, limit=limit), "the selection must be deterministic"
        assert [e for e in entries if e in selected] == list(selected), "the order must be kept"
        for name in ("category", "scene"):
            counts = Counter(getattr(e.facts, name) for e in selected)
            assert len(counts) == 3 and max(counts.values()) - min(counts.values()) <= 2
        # Three of ninety tasks have the scope "full". Even a small selection includes one, but not all of them.
        full = sum(e.facts.scope == "full" for e in selected)
        assert 1 <= full <= max(1, round(limit / 30) + 1)
    assert select_entries(entries, limit=90) == select_entries(entries) == entries


def test_a_pair_may_contain_built_in_models(scope: Scope, tasks_file: Path, tmp_path: Path) -> None:
    pairs = ("grammar+ground-truth", "grammar+noisy")
    options = ("--tasks", str(tasks_file), "--category", "single_call", "--no-pictures", "--json")
    logs = [Path(scope("bench", "run", *options, "--pair", name, "--out", str(tmp_path)).json["log"]) for name in pairs]
    assert [read_evaluation(log).card.pair for log in logs] == ["grammar + ground-truth", "grammar + noisy"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--category", "nonsense"], "no category"),
        (["--scene", "elsewhere"], "no scene"),
        (["--tasks", "no-such-split"], "no split"),
        (["--tasks", "missing.jsonl"], "cannot be read"),
        (["--pair", "nobody+nothing"], "There is no"),
        (["--pair", "qwen3-4b+ground-truth"], "'qwen3-4b' requires a model server"),
        (["--pair", "nobody+ground-truth"], "There is no planner 'nobody'"),
        (["--pair", "ground-truth+grammar"], "There is no planner 'ground-truth'"),
        (["--agent", "nonsense"], "module:Class"),
        (["--agent", "json:nothing"], "cannot be imported"),
        (["--agent", "json:JSONDecoder"], "is not an agent"),
        (["--price", "cheap"], "--price must be two prices"),
        (["--resume", "missing.eval"], "does not exist"),
        (["--perception", "rapidocr", "--no-pictures"], "requires pictures"),
    ],
)
def test_wrong_options_are_reported(scope: Scope, tasks_file: Path, tmp_path: Path, options: list[str], message: str) -> None:
    arguments = options if "--tasks" in options else ["--tasks", str(tasks_file), *options]
    result = scope("bench", "run", "--out", str(tmp_path), *arguments)
    assert result.code == 2
    assert message in result.err
    assert "Traceback" not in result.err
    assert not list(tmp_path.glob("*.eval"))


def test_resuming_another_evaluation_is_refused(scope: Scope, log_copy: Path, tasks_file: Path, tmp_path: Path) -> None:
    result = scope("bench", "run", "--tasks", str(tasks_file), "--seed", "2", "--resume", str(log_copy), "--out", str(tmp_path))
    assert result.code == 2
    assert "another evaluation" in result.err


def test_a_sample_names_its_task(log_copy: Path) -> None:
    header = read_eval_log(str(log_copy), header_only=True)
    metadata = json.dumps(header.eval.metadata)
    assert "dataset_digest" in metadata
