"""Leaderboard submissions: generated files are valid, and every error is reported with its line."""

from __future__ import annotations

import json
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema  # type: ignore[import-untyped]
import pytest
from typer.testing import CliRunner, Result

import scope_ptz
from scope_ptz.bench.scoring.checks import run_checks
from scope_ptz.bench.scoring.trials import CheckRecord, Evaluation, Trial
from scope_ptz.bench.scoring.verdict import score_episode
from scope_ptz.bench.submissions.submission import secrets_in, submission_lines, submission_schema, write_submission
from scope_ptz.bench.submissions.submission_checks import check_submission
from scope_ptz.bench.submissions.submission_trials import checks_of
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.bench.tasks.task import Task
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.cli.app import app
from scope_ptz.errors import InputError
from tests.bench.reports.sample_evaluations import card, trial
from tests.bench.sample_runs import samples

PUBLISHED = Path(scope_ptz.__file__).parent / "data" / "submission.schema.json"
TASKS = tuple(task for task, _ in samples())
Rows = list[dict[str, Any]]
LONG = {"planner_s": 9, "perception_s": 0, "camera_s": 0, "render_s": 0, "total_s": 1}


def passing_evaluation(epochs: int = 2) -> Evaluation:
    """Return an evaluation in which every run but one passes the checks."""
    trials: list[Trial] = []
    for task, episode in samples():
        facts = TaskFacts(
            id=task.id, dataset=task.dataset, stratum=task.stratum, scene=task.scene, viewpoint="v", preset=task.preset,
            instruction=task.instruction, category=task.category, scope=task.scope, difficulty=task.difficulty, expected="x",
        )  # fmt: skip
        checks = tuple(CheckRecord(name=c.name, passed=c.passed, reason=c.reason) for c in run_checks(task, episode))
        assert score_episode(task, episode).headline == "correct"
        assert {check.name for check in checks} == checks_of(task)
        calls = dict(Counter(call.name for call in episode.calls))
        further: dict[str, Any] = {"outcome": episode.outcome, "tool_calls": calls, "steps": 1 + len(episode.calls)}
        for epoch in range(1, epochs + 1):
            trials.append(trial(facts, epoch=epoch, checks=checks, answer=episode.answer, **further))
    trials.sort(key=lambda t: (t.task.id, t.epoch))
    first = trials[0]
    failed = tuple(c.model_copy(update={"passed": False}) if c.name == "coverage" else c for c in first.checks)
    trials[0] = first.model_copy(update={"headline": "incorrect", "error_mode": "scope", "checks": failed})
    planner = card("qwen3-4b", "moondream2").planner.model_copy(
        update={"provider": "http://10.0.0.7:8000/v1", "reported": {"model": "qwen3", "api_key": "abc", "url": "http://10.0.0.7"}}
    )
    found = card("qwen3-4b", "moondream2", epochs=epochs, split="/home/somebody/tasks.jsonl", host="secret-host")
    return Evaluation(card=found.model_copy(update={"planner": planner}), trials=tuple(trials), wanted=len(trials))


@pytest.fixture
def rows(tmp_path: Path) -> Rows:
    path = tmp_path / "made.jsonl"
    write_submission(submission_lines(passing_evaluation()), path)
    return [json.loads(line) for line in path.read_text("utf-8").splitlines()]


def faults_of(rows: Rows, tmp_path: Path, tasks: tuple[Task, ...] = TASKS) -> str:
    path = tmp_path / "changed.jsonl"
    path.write_text("".join(json.dumps(row) + "\n" for row in rows), "utf-8")
    return "\n".join(check_submission(path, tasks).faults)


def test_a_generated_submission_is_valid(rows: Rows, tmp_path: Path) -> None:
    assert faults_of(rows, tmp_path) == ""
    assert len(rows) == 1 + 2 * len(TASKS)
    for row in rows:
        jsonschema.validate(row, submission_schema())
    text = json.dumps(rows)
    assert not any(word in text for word in ("secret-host", "10.0.0.7", "somebody", "abc")) and "tasks.jsonl" in text


def test_the_published_schema_matches_the_code() -> None:
    assert json.loads(PUBLISHED.read_text("utf-8")) == submission_schema()


def change(number: int, **values: Any) -> Callable[[Rows], None]:
    return lambda rows: rows[number].update(values)


def drop(number: int) -> Callable[[Rows], None]:
    return lambda rows: rows.__delitem__(number)


def change_card(**values: Any) -> Callable[[Rows], None]:
    return lambda rows: rows[0]["card"].update(values)


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (drop(3), "is missing (repeats"),
        (drop(3), "line 1: the totals state"),
        (lambda rows: rows.append(rows[2]), "occurs 2 times"),
        (change(2, task="scope1-made-up-001"), "is not a task of the split"),
        (change(2, epoch=3), "repeat 3, but the header states 2"),
        (change(2, error_mode="scope"), "the error mode scope although it is correct"),
        (change(1, error_mode=None), "no error mode although it is incorrect"),
        (change(1, headline="correct", error_mode=None), "correct although not every check passed"),
        (change(2, headline="incorrect", error_mode="scope"), "incorrect although no check failed"),
        (change(2, headline="unscored"), "unscored although a check failed"),
        (change(2, checks={}), "has no checks"),
        (change(2, answer="I cannot tell."), "the answer is wrong, but the result of its check is right"),
        (change(2, scored_by="judge"), "but no judgement has this verdict"),
        (change(2, category="ocr"), "category is ocr, but the task"),
        (change(2, outcome="won"), "it is won"),
        (change(2, steps=61), "61 steps, but the limit is 60"),
        (change(2, steps=-1), "steps: Input should be greater than or equal to 0"),
        (change(2, steps=1.5), "line 3: trial.steps"),
        (change(2, tool_calls={"hack_camera": 1}), "unknown tools: hack_camera"),
        (change(2, cost_usd=-1), "cost_usd"),
        (change(2, extra=1), "extra"),
        (change(2, kind="other"), "line 3"),
        (change(2, times=LONG), "took 9 s, but the whole trial took 1 s"),
        (change(2, answer="use sk-abcdefghijklmnop1234"), "line 3: answer looks like a secret"),
        (change(0, canary="none"), "canary"),
        (change(0, format=3), "format"),
        (change(0, format=2), "it has no trace"),
        (change(0, tasks_digest="0" * 64), "the task digest differs"),
        (change(0, tasks=1), "the header states 1 tasks"),
        (change(0, wanted=1), "the header states 1 trials"),
        (change_card(dataset="scope9"), "the header states the dataset scope9"),
        (change_card(package_version="99.0.0"), "newer than the installed version"),
        (change_card(package_version="new"), "is not a version number"),
        (change_card(epochs=3), "is missing (repeats 3)"),
        (change_card(sampling={"api_key": "x"}), "card.sampling.api_key looks like a secret"),
        (drop(0), "exactly one header"),
        (lambda rows: rows.insert(2, rows[0]), "this file has 2 headers"),
    ],
)  # fmt: skip
def test_every_error_is_reported(edit: Callable[[Rows], None], message: str, rows: Rows, tmp_path: Path) -> None:
    edit(rows)
    assert message in faults_of(rows, tmp_path)


def mark_as_broken(**values: Any) -> Callable[[Rows], None]:
    return change(1, headline="infrastructure", error_mode=None, **values)


def change_counting_run(**values: Any) -> Callable[[Rows], None]:
    """Change the first run of a task that requires a move, a call and a count."""
    return lambda rows: next(row for row in rows[1:] if row["task"].endswith("counting-001")).update(values)


def remove_perception_call(rows: Rows) -> None:
    rows[2].update(tool_calls={"go_to_preset": 1})


def remove_move(rows: Rows) -> None:
    row = next(row for row in rows[1:] if "pose" in row["checks"] and "calls" not in row["checks"])
    row.update(tool_calls={"take_image": 1})


def remove_picture(rows: Rows) -> None:
    row = next(row for row in rows[1:] if "pictures" in row["checks"])
    row["tool_calls"].pop("take_image")


def fewer_checks(rows: Rows) -> None:
    del rows[1]["checks"]["coverage"]
    rows[1].update(headline="correct", error_mode=None)


JUDGED = [{"judge": "me", "prompt": "p", "verdict": "correct", "error_mode": None}]


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (fewer_checks, "checks of the task are missing: coverage"),
        (lambda rows: rows[2]["checks"].update(luck=True), "the task does not have these checks: luck"),
        (lambda rows: rows[2]["checks"].update(outcome=False), "the outcome answered contradicts the check"),
        (mark_as_broken(), "but the trial ended answered"),
        (change_counting_run(checks={"outcome": True, "answer": True}), "checks of the task are missing: calls, coverage, pose"),
        (mark_as_broken(outcome="step_limit"), "but the trial ended step_limit"),
        (mark_as_broken(perception_failures=1), "but the trial ended answered"),
        (change(1, headline="correct", error_mode=None, scored_by="judge", judged=JUDGED), "although the task has checks"),
        (change(2, tool_calls={}, steps=0), "ended answered without a step"),
        (change(2, tool_calls={}, steps=0), "the check 'coverage' passed without a perception call"),
        (remove_perception_call, "the check 'coverage' passed without a perception call"),
        (change_counting_run(tool_calls={"count_objects": 1}),
         "the check 'calls' passed, but only 0 of 1 required calls of go_to_preset"),
        (change_counting_run(steps=0), "2 calls, but no step"),
        (change_counting_run(bad_calls=2, perception_failures=1), "3 failed calls, but only 2 calls"),
        (remove_move, "passed, but no call moved the camera"),
        (remove_picture, "the check 'pictures' passed, but take_image was called 0 of"),
        (lambda rows: rows[0]["card"]["perception"].update(name="ground-truth"), "ground-truth is built in, so"),
        (lambda rows: rows[0]["card"]["planner"].update(name="grammar"), "grammar is built in, so"),
    ],
)  # fmt: skip
def test_values_that_contradict_the_file_or_the_tasks_are_refused(
    edit: Callable[[Rows], None], message: str, rows: Rows, tmp_path: Path
) -> None:
    edit(rows)
    assert message in faults_of(rows, tmp_path)


def test_unusual_but_real_runs_are_accepted(rows: Rows, tmp_path: Path) -> None:
    """These are runs that did not start or failed, runs without observations, and runs of planners with vision."""
    not_started = change(1, headline="infrastructure", error_mode=None, outcome=None, checks={}, steps=0, tool_calls={}, answer="")
    failed = dict.fromkeys(rows[1]["checks"], False)
    cut = mark_as_broken(outcome="planner_error", answer="", checks=failed)
    blind = mark_as_broken(answer="I cannot tell.", perception_failures=1, checks={**failed, "outcome": True})
    for edit in (not_started, cut, blind):
        changed = json.loads(json.dumps(rows))
        edit(changed)
        found = faults_of(changed, tmp_path).splitlines()
        assert all(line.startswith("line 1: the totals state") for line in found), found
    for planner_settings in ({"sees": "true"}, {}):
        changed = json.loads(json.dumps(rows))
        remove_perception_call(changed)
        changed[0]["card"]["sampling"] = {"planner": planner_settings}
        changed[0]["card"]["perception"]["name"] = "moondream2" if planner_settings else changed[0]["card"]["planner"]["name"]
        assert faults_of(changed, tmp_path) == ""


def test_totals_are_recomputed(rows: Rows, tmp_path: Path) -> None:
    rows[0]["totals"]["headlines"] = {"correct": 2 * len(TASKS)}
    rows[0]["totals"]["error_modes"] = {"reasoning": 4}
    found = faults_of(rows, tmp_path)
    assert (
        "state 28 trials with headline correct, but the file contains 27" in found
        and "state 0 trials with headline incorrect" in found
    )
    assert "state 4 trials with error mode reasoning, but the file contains 0" in found
    assert "state 0 trials with error mode scope" in found


def test_invalid_json_lines_are_reported_and_unreadable_files_refused(tmp_path: Path) -> None:
    path = tmp_path / "x.jsonl"
    path.write_text('{"kind": "trial"\n[1]\n{"a": NaN}\n' + "[" * 100_000 + "\n", "utf-8")
    found = "\n".join(check_submission(path, TASKS).faults)
    assert "line 1: not valid JSON" in found and "line 2" in found and "line 3: not valid JSON (NaN" in found and "line 4" in found
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not UTF-8"):
        check_submission(path, TASKS)
    with pytest.raises(InputError, match="cannot be read"):
        check_submission(tmp_path / "none.jsonl", TASKS)


def test_an_invented_tool_is_counted_and_a_key_in_an_answer_is_removed(tmp_path: Path) -> None:
    evaluation = passing_evaluation(1)
    changed = evaluation.trials[1].model_copy(
        update={"tool_calls": {"take_image": 1, "<script>": 2}, "answer": f"{evaluation.trials[1].answer} hf_abcdefghijklmnopqrstu"}
    )
    found = evaluation.model_copy(update={"trials": (evaluation.trials[0], changed, *evaluation.trials[2:])})
    _, lines = submission_lines(found)
    line = next(row for row in lines if "unknown" in row.tool_calls)
    assert line.tool_calls == {"take_image": 1, "unknown": 2} and "[removed]" in line.answer and "hf_" not in line.answer


def test_only_addresses_and_keys_are_removed_from_settings() -> None:
    planner = {
        "url": "http://10.0.0.7/v1", "temperature": 0.7, "prompt": "You steer a camera.", "api_key": "abc",
        "options": {"thinking": True, "proxy": "http://proxy.lan", "stop": ["a", "b://c"]}, "tools": [{"name": "go_home"}],
    }  # fmt: skip
    evaluation = passing_evaluation(1)
    sampling = {"planner": planner, "price": {"input": 1.0}}
    found = evaluation.model_copy(update={"card": evaluation.card.model_copy(update={"sampling": sampling})})
    assert submission_lines(found)[0].card.sampling == {
        "planner": {
            "temperature": 0.7, "prompt": "You steer a camera.", "options": {"thinking": True, "stop": ["a"]},
            "tools": [{"name": "go_home"}],
        },
        "price": {"input": 1.0},
    }  # fmt: skip


def test_an_unfinished_run_cannot_be_submitted() -> None:
    evaluation = passing_evaluation()
    with pytest.raises(InputError, match=r"only 3 of \d+ trials"):
        submission_lines(evaluation.model_copy(update={"trials": evaluation.trials[:3]}))


def test_runs_without_models_are_labelled_as_unranked(tmp_path: Path) -> None:
    evaluation = passing_evaluation(1)
    path = tmp_path / "reference.jsonl"
    unranked = evaluation.model_copy(update={"card": card("grammar", "ground-truth", split="x.jsonl")})
    write_submission(submission_lines(unranked), path)
    found = check_submission(path, TASKS)
    assert not found.faults and "not ranked" in found.summary and found.as_dict()["valid"] is True
    with pytest.raises(InputError, match="not a published split"):
        check_submission(path)


@pytest.mark.parametrize(
    "text",
    [
        "Bearer abcdefghijklmnop",
        "https://me:pass@host/",
        "ghp_abcdefghijklmnopqrstuv",
        "AKIAABCDEFGHIJKLMNOP",
        "-----BEGIN PRIVATE KEY",
    ],
)
def test_secrets_are_found(text: str) -> None:
    assert list(secrets_in({"a": {"b": [f"see {text}"]}})) == ["a.b"]
    assert not list(secrets_in({"max_tokens": 5, "reason": "The sign reads KEYS CUT HERE", "input_tokens": 7}))


def test_the_commands(rows: Rows, tmp_path: Path) -> None:
    path, tasks = tmp_path / "made.jsonl", tmp_path / "tasks.jsonl"
    dump_tasks(TASKS, tasks)
    run = CliRunner().invoke
    good = run(app, ["bench", "submission", "validate", str(path), "--tasks", str(tasks)])
    assert good.exit_code == 0 and "valid" in good.stdout
    lines = path.read_text("utf-8").splitlines(keepends=True)
    path.write_text("".join(lines[:-1]), "utf-8")
    bad = run(app, ["bench", "submission", "validate", str(path), "--tasks", str(tasks), "--json"])
    assert bad.exit_code == 1 and json.loads(bad.stdout)["valid"] is False
    assert run(app, ["bench", "submission", "validate", str(tmp_path / "no.jsonl")]).exit_code == 2


def test_a_submission_requires_a_complete_split(tmp_path: Path) -> None:
    evaluation, tasks, out = passing_evaluation(2), tmp_path / "tasks.jsonl", tmp_path / "out.jsonl"
    dump_tasks(TASKS, tasks)

    def make(evaluation: Evaluation, *options: str) -> Result:
        log = tmp_path / "log.json"
        log.write_text(evaluation.model_dump_json(warnings=False), "utf-8")
        out.unlink(missing_ok=True)
        return CliRunner().invoke(app, ["bench", "submission", "make", str(log), "--out", str(out), *options])

    tasks_option = ("--tasks", str(tasks))
    run_result = make(evaluation, *tasks_option)
    assert run_result.exit_code == 0 and not check_submission(out, TASKS).faults
    unknown = make(evaluation)
    assert (unknown.exit_code, out.exists()) == (2, False) and "Give its tasks with --tasks" in unknown.stderr
    # The log of a run with --limit is finished but does not cover the split.
    first = evaluation.trials[0].task.id
    remaining = tuple(t for t in evaluation.trials if t.task.id != first)
    limited = evaluation.model_copy(update={"trials": remaining, "wanted": len(remaining)})
    refused = make(limited, *tasks_option)
    assert (refused.exit_code, out.exists()) == (2, False)
    assert f"{first} is missing (repeats 1, 2)" in refused.stderr and "--partial" in refused.stderr
    partial = make(limited, *tasks_option, "--partial")
    assert partial.exit_code == 0 and "is incomplete and not a valid submission" in partial.stderr
    assert any(f"{first} is missing" in fault for fault in check_submission(out, TASKS).faults)
    core = limited.model_copy(update={"card": limited.card.model_copy(update={"split": "core"})})
    refused = make(core)
    assert refused.exit_code == 2 and "does not cover core" in refused.stderr and "more faults" in refused.stderr
    # A task with another instruction is another task.
    other_instruction = evaluation.trials[0].model_copy(
        update={"task": evaluation.trials[0].task.model_copy(update={"instruction": "Something else."})}
    )
    trials = (other_instruction, other_instruction.model_copy(update={"epoch": 2}), *evaluation.trials[2:])
    other = make(evaluation.model_copy(update={"trials": trials}), *tasks_option)
    assert other.exit_code == 2 and "the task digest differs" in other.stderr


def test_validation_does_not_import_optional_dependencies() -> None:
    code = "import sys, scope_ptz.bench.submissions.submission_checks; print(*sorted({n.split('.')[0] for n in sys.modules}))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "scope_ptz" in loaded and not {"inspect_ai", "jinja2", "matplotlib", "pandas", "scipy", "statsmodels"} & set(loaded)
