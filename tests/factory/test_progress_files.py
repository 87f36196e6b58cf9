"""The progress files of an evaluation, as another program reads them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.estimate import Estimate
from scope_ptz.bench.engine.run_totals import accuracy, macro_accuracy
from scope_ptz.bench.reports.progress_state import STATE_FILE, TRIALS_FILE, ProgressState
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.bench.scoring.verdict import Headline
from scope_ptz.bench.tasks.splits import load_split
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.errors import InputError, OutputError
from scope_ptz.factory.evaluation_options import EvaluationPlan
from scope_ptz.factory.progress_files import ProgressFiles, ProgressGroup

HEADLINES: tuple[Headline, ...] = ("correct", "incorrect", "correct", "unscored", "infrastructure", "correct")


def trials() -> list[Trial]:
    """Return trials of six tasks at several viewpoints."""
    tasks = load_split("lite")[:: len(load_split("lite")) // len(HEADLINES)]
    return [
        Trial(
            task=facts_of(task, f"view-{index}"), sample=f"{task.id}#1", headline=headline, reason="", outcome="answered", answer=""
        )
        for index, (task, headline) in enumerate(zip(tasks, HEADLINES, strict=False))
    ]


def plan(*finished: Trial) -> EvaluationPlan:
    return EvaluationPlan(
        runs=6, planner="grammar", perception="ground-truth", agent=None, concurrency=1, finished=finished,
        estimate=Estimate(6, 6, 6), uses_planner_server=False,
    )  # fmt: skip


def state(folder: Path) -> ProgressState:
    return ProgressState.model_validate_json((folder / STATE_FILE).read_text())


def stored_trials(folder: Path) -> list[Trial]:
    return [Trial.model_validate_json(line) for line in (folder / TRIALS_FILE).read_text().splitlines()]


@pytest.fixture
def progress(tmp_path: Path) -> Iterator[ProgressFiles]:
    with closing(ProgressFiles(tmp_path / "progress")) as files:
        yield files


def test_progress_has_the_scores_of_the_evaluation(progress: ProgressFiles, tmp_path: Path) -> None:
    rows = trials()
    progress.planned(plan(*rows[:2]))
    first = state(tmp_path / "progress")
    assert (first.runs, first.done, first.correct, first.seconds_left) == (6, 2, 1, None)
    for trial in rows[2:]:
        progress.run_began(trial.sample, Entry(facts=trial.task, world=trial.task.scene))
        assert [each.task for each in state(tmp_path / "progress").running] == [trial.task.id]
        progress.run_ended(trial.sample, trial)
    last = state(tmp_path / "progress")
    assert (last.done, last.correct, last.incorrect, last.unscored, last.broken, last.running) == (6, 3, 1, 1, 1, ())
    assert last.micro is not None and last.macro is not None and last.micro.low is not None and last.micro.high is not None
    assert last.micro.value == pytest.approx(accuracy(rows)) and last.macro.value == pytest.approx(macro_accuracy(rows))
    assert last.micro.low < last.micro.value < last.micro.high
    assert sum(each.runs for each in last.categories) == 6
    assert last.seconds_left == 0.0 and not last.finished
    assert stored_trials(tmp_path / "progress") == rows


def test_a_repeated_run_replaces_the_earlier_one(progress: ProgressFiles, tmp_path: Path) -> None:
    rows, tmp_path = trials(), tmp_path / "progress"
    progress.planned(plan(*rows))
    repeated = rows[4].model_copy(update={"headline": "correct"})
    progress.run_ended(repeated.sample, repeated)
    assert (state(tmp_path).done, state(tmp_path).broken, state(tmp_path).correct) == (6, 0, 4)
    assert stored_trials(tmp_path) == [*rows[:4], repeated, rows[5]]


def test_only_one_evaluation_can_write_to_a_folder(tmp_path: Path) -> None:
    progress = ProgressFiles(tmp_path)
    with pytest.raises(InputError, match="Another evaluation"):
        ProgressFiles(tmp_path)
    progress.close()
    ProgressFiles(tmp_path).close()
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="Choose another folder"):
        ProgressFiles(tmp_path / "file")


def test_a_full_disk_does_not_stop_the_evaluation(progress: ProgressFiles, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows, tmp_path = trials(), tmp_path / "progress"

    def raise_disk_full(*_: object, **__: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", raise_disk_full)
    progress.planned(plan())
    progress.run_ended(rows[0].sample, rows[0])
    monkeypatch.undo()
    progress.run_ended(rows[1].sample, rows[1])
    assert state(tmp_path).done == 2
    assert any("No space left" in note for note in state(tmp_path).notes)


def test_a_group_forwards_every_event(tmp_path: Path) -> None:
    with closing(ProgressFiles(tmp_path / "one")) as one, closing(ProgressFiles(tmp_path / "other")) as other:
        group, rows = ProgressGroup(one, other), trials()
        group.planned(plan())
        group.note("a note")
        group.run_began(rows[0].sample, Entry(facts=rows[0].task, world=rows[0].task.scene))
        group.run_ended(rows[0].sample, rows[0])
        group.closed()
    contents = [json.loads((tmp_path / name / STATE_FILE).read_text()) for name in ("one", "other")]
    assert contents[0]["notes"] == contents[1]["notes"] == ["a note"]
    assert contents[0]["done"] == contents[1]["done"] == 1
