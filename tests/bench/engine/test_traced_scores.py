"""Scores are computed from traces alone: editing a log gains nothing, and edits are reported."""

from __future__ import annotations

import json
import shutil
from collections import Counter
from collections.abc import Collection
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from scope_ptz import load_results
from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.engine.stored_run import STORE
from scope_ptz.bench.reports.log_findings import finding_lines
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.bench.tasks.task_facts import TaskFacts
from tests.bench.engine.editing import Change, Json, edit_log, files_of, records_of, set_trace, trace_change, write_log
from tests.cli.conftest import Scope
from tests.frozen import adapter

PUBLISHED = Path(__file__).parents[2] / "frozen" / "v0_1_0" / "logs" / "truth.eval"
"""A log of published tasks, with successes and failures, written by version 0.1.0."""


@pytest.fixture(scope="module")
def honest(tmp_path_factory: pytest.TempPathFactory) -> Evaluation:
    """Return the published log, scored with the current rules."""
    log = tmp_path_factory.mktemp("honest") / PUBLISHED.name
    shutil.copy(PUBLISHED, log)
    assert adapter.rescore_checks(log).code == 0
    evaluation = read_evaluation(log)
    assert evaluation.findings == ()
    assert failures(evaluation)
    return evaluation


def failures(evaluation: Evaluation) -> list[str]:
    return [trial.sample for trial in evaluation.trials if trial.headline == "incorrect"]


def correct(evaluation: Evaluation) -> set[str]:
    return {trial.sample for trial in evaluation.trials if trial.headline == "correct"}


def stored_trials(sample: Json) -> list[Json]:
    return [score["metadata"]["trial"] for score in sample["scores"].values() if "trial" in (score.get("metadata") or {})]


def claim_value(sample: Json) -> None:
    for score in sample["scores"].values():
        score["value"] = "C"


def claim_everything(sample: Json) -> None:
    """Claim success consistently: in value, headline, error mode and checks."""
    claim_value(sample)
    for score in sample["scores"].values():
        score["metadata"] |= {"headline": "correct", "error_mode": None}
    for trial in stored_trials(sample):
        trial.update(headline="correct", reason="every check passed")
        trial.pop("error_mode", None)
        for check in trial["checks"]:
            check["passed"] = True


def claim_another_error_mode(sample: Json) -> None:
    for trial in stored_trials(sample):
        trial["error_mode"] = "vlm_query" if trial["error_mode"] != "vlm_query" else "scope"


def claim_speed(sample: Json) -> None:
    for trial in stored_trials(sample):
        trial["timings"] = {"total_s": 0.001}


def claim_fewer_calls(sample: Json) -> None:
    for trial in stored_trials(sample):
        trial |= {"tool_calls": {"take_image": 7}, "steps": 55}


def claim_tokens(sample: Json) -> None:
    for trial in stored_trials(sample):
        trial["input_tokens"] = 7


def claim_answer(sample: Json) -> None:
    for trial in stored_trials(sample):
        trial |= {"answer": "There are 4.", "outcome": "answered"}


@pytest.mark.parametrize(
    "change",
    [claim_value, claim_everything, claim_another_error_mode, claim_speed, claim_fewer_calls, claim_tokens, claim_answer],
)
def test_edited_scores_are_reported_and_ignored(honest: Evaluation, tmp_path: Path, change: Change) -> None:
    attacked = failures(honest)
    evaluation = read_evaluation(edit_log(Path(honest.log), tmp_path / "attacked.eval", change, attacked))
    assert evaluation.trials == honest.trials
    assert {finding.sample for finding in evaluation.findings} == set(attacked)
    assert {finding.kind for finding in evaluation.findings} == {"score-differs"}


def accept_every_answer(sample: Json) -> None:
    """Accept any answer, and check nothing else."""
    sample["metadata"]["task"]["expected"] = {"kind": "action_only"}
    sample["metadata"]["task"]["evidence"] = []
    sample["metadata"]["task"]["behaviour"] = {"outcomes": ["answered", "clarification", "refused", "step_limit"]}
    claim_everything(sample)


def other_category(sample: Json) -> None:
    sample["metadata"]["category"] = "ocr" if sample["metadata"]["category"] != "ocr" else "counting"


def no_task(sample: Json) -> None:
    """Remove the task, so that only a judge could score the run, and add the verdict of an invented judge."""
    sample["metadata"]["task"] = None
    verdict = {"judge": "friend", "prompt": "p", "verdict": "correct"}
    sample["scores"]["judge"] = {"value": "C", "metadata": {"judgement": verdict}}


def imported_task(sample: Json) -> None:
    """Replace the published task by an imported one with the same id, which only a judge can score."""
    facts = {name: sample["metadata"][name] for name in TaskFacts.model_fields}
    no_task(sample)
    sample["metadata"]["imported"] = {"imported": 1, "facts": facts, "line": 1, "raw": {}}


@pytest.mark.parametrize("change", [accept_every_answer, other_category, no_task, imported_task])
def test_the_published_task_decides(honest: Evaluation, tmp_path: Path, change: Change) -> None:
    attacked = failures(honest)
    evaluation = read_evaluation(edit_log(Path(honest.log), tmp_path / "attacked.eval", change, attacked))
    assert [(t.task, t.headline, t.error_mode, t.checks) for t in evaluation.trials] == [
        (t.task, t.headline, t.error_mode, t.checks) for t in honest.trials
    ]
    assert {finding.sample for finding in evaluation.findings if finding.kind == "task-differs"} == set(attacked)


def test_presets_in_the_log_do_not_determine_viewpoints(honest: Evaluation, tmp_path: Path) -> None:
    def set_one_viewpoint(sample: Json) -> None:
        places = sample["store"][STORE]["presets"]
        sample["store"][STORE]["presets"] = dict.fromkeys(places, "elsewhere")

    evaluation = read_evaluation(
        edit_log(Path(honest.log), tmp_path / "a.eval", set_one_viewpoint, [t.sample for t in honest.trials])
    )
    assert evaluation.trials == honest.trials


def end(records: list[Json]) -> Json:
    assert records[-1]["event"] == "end"
    return records[-1]


def other_answer(records: list[Json]) -> None:
    end(records)["text"] = "There are 4 of them."


def other_outcome(records: list[Json]) -> None:
    end(records)["outcome"] = "clarification" if records[-1]["outcome"] == "answered" else "answered"


def other_final_pose(records: list[Json]) -> None:
    end(records)["pose"]["pan_deg"] += 5.0


def without_calls(records: list[Json]) -> list[Json]:
    return [record for record in records if record["event"] != "call"]


def fewer_steps(records: list[Json]) -> None:
    end(records)["steps"] = 0


def invented_call(records: list[Json]) -> list[Json]:
    call = next(record for record in records if record["event"] == "call")
    return [*records[:-1], {**call, "step": 40}, records[-1]]


def other_arguments(records: list[Json]) -> None:
    call = next(record for record in records if record["event"] == "call")
    call["outcome"]["call"]["arguments"] = {"description": "something else"}


def larger_frames(records: list[Json]) -> None:
    records[0] |= {"frame_width": 12800, "frame_height": 7200}


def other_instruction(records: list[Json]) -> None:
    records[0]["instruction"] = "Say hello."


def other_viewpoint(records: list[Json]) -> None:
    records[0]["viewpoint"] = "elsewhere"


def no_end(records: list[Json]) -> list[Json]:
    return records[:-1]


def two_ends(records: list[Json]) -> list[Json]:
    return [*records, records[-1]]


def negative_time(records: list[Json]) -> None:
    end(records)["timings"] = {"total_s": -100.0}


@pytest.mark.parametrize(
    "change",
    [
        other_answer, other_outcome, other_final_pose, without_calls, fewer_steps, invented_call, other_arguments, larger_frames,
        other_instruction, other_viewpoint, no_end, two_ends, negative_time,
    ],
)  # fmt: skip
def test_a_contradictory_trace_is_reported_and_unscored(honest: Evaluation, tmp_path: Path, change: Any) -> None:
    names = [trial.sample for trial in honest.trials if trial.tool_calls]
    evaluation = read_evaluation(edit_log(Path(honest.log), tmp_path / "attacked.eval", trace_change(change), names))
    assert {trial.headline for trial in evaluation.trials if trial.sample in names} == {"unscored"}
    assert {finding.sample for finding in evaluation.findings} == set(names)
    assert {finding.kind for finding in evaluation.findings} <= {"trace-damaged", "trace-missing"}


def test_a_missing_or_unreadable_trace_is_not_correct(honest: Evaluation, tmp_path: Path) -> None:
    names = [trial.sample for trial in honest.trials]
    for number, text in enumerate(("", "nothing", '{"event": "start"}\n', "[]\n" * 5)):
        path = edit_log(Path(honest.log), tmp_path / f"{number}.eval", partial(set_trace, records=text), names)
        evaluation = read_evaluation(path)
        assert not correct(evaluation)
        assert len(evaluation.trials) == len(honest.trials)
        assert {trial.headline for trial in evaluation.trials} == {"unscored"}
        assert {finding.sample for finding in evaluation.findings} == set(names)

    def without_store(sample: Json) -> None:
        sample["store"], sample["events"] = {}, []

    evaluation = read_evaluation(edit_log(Path(honest.log), tmp_path / "store.eval", without_store, names))
    assert {trial.headline for trial in evaluation.trials} == {"unscored"}


def test_unusual_line_separators_in_an_answer_do_not_damage_a_trace(honest: Evaluation, tmp_path: Path) -> None:
    def unusual(sample: Json) -> None:
        records = records_of(sample)
        for record in records:
            if record["event"] == "end":
                record["text"] = "One\u2028two\x85three."
            elif record["event"] == "decision" and record["decision"]["kind"] == records[-1]["outcome"]:
                record["decision"]["text"] = "One\u2028two\x85three."
        set_trace(sample, "".join(json.dumps(record, ensure_ascii=False) + "\n" for record in records))

    names = [trial.sample for trial in honest.trials]
    evaluation = read_evaluation(edit_log(Path(honest.log), tmp_path / "unusual.eval", unusual, names))
    assert {trial.answer for trial in evaluation.trials} == {"One\u2028two\x85three."}
    assert "unscored" not in {trial.headline for trial in evaluation.trials}


def without_samples(log: Path, names: Collection[str]) -> dict[str, Any]:
    """Return the files of a log without those of some samples."""
    return {n: c for n, c in files_of(log).items() if not (n.startswith("samples/") and f"{c['id']}#{c['epoch']}" in names)}


def test_deleted_samples_count_as_not_correct(honest: Evaluation, tmp_path: Path) -> None:
    deleted = set(failures(honest))
    files = without_samples(Path(honest.log), deleted)
    evaluation = read_evaluation(write_log(files, tmp_path / "attacked.eval"))
    assert correct(evaluation) == correct(honest)
    assert len(evaluation.trials) == len(honest.trials)
    assert {finding.sample for finding in evaluation.findings if finding.kind == "sample-missing"} == deleted


@pytest.mark.parametrize("status", ["success", "cancelled", "error"])
def test_deleting_samples_from_the_header_too_voids_every_score(honest: Evaluation, tmp_path: Path, status: str) -> None:
    deleted = set(failures(honest))
    files = without_samples(Path(honest.log), deleted)
    dataset = files["header.json"]["eval"]["dataset"]
    dataset["sample_ids"] = [name for name in dataset["sample_ids"] if f"{name}#1" not in deleted]
    dataset["samples"] = len(dataset["sample_ids"])
    files["header.json"]["status"] = status
    evaluation = read_evaluation(write_log(files, tmp_path / "attacked.eval"))
    assert not correct(evaluation)
    assert evaluation.findings[0].kind == "tasks-changed"


def test_copies_of_a_success_do_not_count(honest: Evaluation, tmp_path: Path) -> None:
    """A success cannot replace a failure under its name, nor be added again."""
    files = files_of(Path(honest.log))
    samples = {f"{c['id']}#{c['epoch']}": (n, c) for n, c in files.items() if n.startswith("samples/")}
    success = samples[sorted(correct(honest))[0]][1]
    failed_name, failed = samples[failures(honest)[0]]
    replaced = {**files, failed_name: {**success, "id": failed["id"]}}
    evaluation = read_evaluation(write_log(replaced, tmp_path / "replaced.eval"))
    assert correct(evaluation) < correct(honest) or correct(evaluation) == correct(honest) - {sorted(correct(honest))[0]}
    repeated = {**files, "samples/once-more.json": success}
    evaluation = read_evaluation(write_log(repeated, tmp_path / "repeated.eval"))
    assert Counter(t.headline for t in evaluation.trials)["correct"] == len(correct(honest)) - 1
    assert {finding.kind for finding in evaluation.findings} == {"sample-repeated"}
    # The failed sample with the trace of the success.
    stolen = json.loads(json.dumps(failed))
    set_trace(stolen, records_of(success))
    evaluation = read_evaluation(write_log({**files, failed_name: stolen}, tmp_path / "stolen.eval"))
    assert correct(evaluation) <= correct(honest)


def test_further_runs_of_a_task_do_not_count(honest: Evaluation, tmp_path: Path) -> None:
    """A success is run once more than the card states, which would give its task more weight."""
    files = files_of(Path(honest.log))
    name = sorted(correct(honest))[0]
    repeated_run = next(
        json.loads(json.dumps(c)) for n, c in files.items() if n.startswith("samples/") and f"{c['id']}#{c['epoch']}" == name
    )
    repeated_run["epoch"] = 2
    records = records_of(repeated_run)
    records[0]["started"] = "2026-11-23T00:00:00Z"
    set_trace(repeated_run, records)
    evaluation = read_evaluation(write_log({**files, "samples/again.json": repeated_run}, tmp_path / "attacked.eval"))
    assert correct(evaluation) == correct(honest)
    assert [finding.kind for finding in evaluation.findings] == ["sample-repeated"]
    assert "repeat 2, but the card states 1" in evaluation.findings[0].detail


def test_a_card_with_other_models_is_reported(honest: Evaluation, tmp_path: Path) -> None:
    files = files_of(Path(honest.log))
    files["header.json"]["eval"]["metadata"]["card"]["perception"] |= {"name": "moondream3", "deterministic": False}
    evaluation = read_evaluation(write_log(files, tmp_path / "attacked.eval"))
    assert [finding.kind for finding in evaluation.findings] == ["card-differs"]
    assert "moondream3" in finding_lines(evaluation)[0] and "ground-truth" in finding_lines(evaluation)[0]


def test_a_task_outside_the_split_is_not_correct(honest: Evaluation, tmp_path: Path) -> None:
    name = sorted(correct(honest))[0]

    def rename(sample: Json) -> None:
        for part in (sample, sample["metadata"], sample["metadata"]["task"]):
            part["id"] = "scope1-invented-counting-001"

    evaluation = read_evaluation(edit_log(Path(honest.log), tmp_path / "attacked.eval", rename, [name]))
    assert not correct(evaluation) - correct(honest)
    assert {"task-unknown", "sample-missing"} <= {finding.kind for finding in evaluation.findings}


@pytest.mark.full
def test_unpublished_tasks_must_match_the_card(log_copy: Path, tmp_path: Path) -> None:
    """The tasks of this log are private, so only the digest on the run card can show that they were changed."""
    before = read_evaluation(log_copy)
    assert before.findings == () and len(correct(before)) == 3

    def accept(sample: Json) -> None:
        sample["metadata"]["task"]["expected"]["value"] = 3

    evaluation = read_evaluation(edit_log(log_copy, tmp_path / "attacked.eval", accept, failures(before)))
    assert not correct(evaluation)
    assert "tasks-changed" in {finding.kind for finding in evaluation.findings}


@pytest.mark.full
def test_an_edited_log_is_named_in_the_report_and_the_terminal(scope: Scope, log_copy: Path, tmp_path: Path) -> None:
    names = failures(read_evaluation(log_copy))
    log = edit_log(log_copy, tmp_path / "attacked.eval", claim_everything, names)
    out = tmp_path / "report"
    result = scope("bench", "report", str(log), "--out", str(out), "--no-pages")
    assert result.code == 0, result.err
    for text in (result.out, (out / "report.md").read_text("utf-8"), (out / "index.html").read_text("utf-8")):
        assert "attacked.eval" in text and "differ from the checks executed on its traces" in text
        assert names[0] in text.replace("\\", "")
    assert (out / "report.md").read_text("utf-8").index("attacked.eval") < (out / "report.md").read_text("utf-8").index("## ")
    rows = (out / "tables" / "failed_tasks.csv").read_text("utf-8")
    assert names[0].partition("#")[0] in rows
    rescored = scope("bench", "rescore", str(log), "--checks")
    assert rescored.code == 0 and names[0] in rescored.err
    rescored_log = read_evaluation(log)
    assert rescored_log.findings == () and failures(rescored_log) == names


def test_results_in_python_are_recomputed_and_an_edited_log_is_named(
    log_copy: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    names = failures(read_evaluation(log_copy))
    results = load_results(edit_log(log_copy, tmp_path / "attacked.eval", claim_everything, names))
    assert [trial.sample for trial in results.trials if trial.headline == "incorrect"] == names
    assert names[0] in caplog.text


def test_an_unedited_log_has_no_findings(scope: Scope, log_copy: Path) -> None:
    result = scope("bench", "rescore", str(log_copy), "--checks")
    assert "attacked" not in result.err and "not used" not in result.err
