"""Evaluations from Python: tasks, results by category, and objects of the caller."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

import scope_ptz
from scope_ptz.errors import InputError, TraceError, UnknownNameError
from scope_ptz.planner.base import Decision, Finish, State
from scope_ptz.planner.grammar import GrammarPlanner


class SaysThree(scope_ptz.Planner):
    name = "says three"
    closed = False

    async def step(self, state: State) -> Decision:
        return Finish(kind="answered", text="There are 3.")

    async def close(self) -> None:
        self.closed = True


@pytest.fixture(scope="module")
def tasks() -> tuple[scope_ptz.Task, ...]:
    return scope_ptz.load_tasks("core", categories=["single_call", "counting"], scenes=["highway-works"], limit=4)


@pytest.fixture(scope="module")
def results(tasks: tuple[scope_ptz.Task, ...], tmp_path_factory: pytest.TempPathFactory) -> scope_ptz.EvaluationResults:
    return scope_ptz.evaluate(tasks=tasks, out=tmp_path_factory.mktemp("logs"), pictures=False)


def test_tasks_are_selected(tasks: tuple[scope_ptz.Task, ...]) -> None:
    assert len(tasks) == 4
    assert {task.scene for task in tasks} == {"highway-works"}
    assert {task.category for task in tasks} == {"single_call", "counting"}
    assert tasks == scope_ptz.load_tasks("core", categories=["counting", "single_call"], scenes=["highway-works"], limit=4)


def test_scores_match_the_trials(results: scope_ptz.EvaluationResults) -> None:
    assert len(results) == len(list(results)) == len(results.trials) == 4
    assert results.finished
    correct = [trial.headline == "correct" for trial in results.trials]
    assert results.micro == sum(correct) / 4
    assert results.macro == sum(results.scores.values()) / 2
    assert set(results.scores) == {"single_call", "counting"}
    assert results.pair == "grammar + ground-truth"
    assert "4 trials" in repr(results)
    assert "macro (mean of categories)" in results._repr_html_()


def test_results_are_read_from_the_log_or_its_folder(results: scope_ptz.EvaluationResults) -> None:
    assert scope_ptz.load_results(results.log).trials == results.trials
    assert scope_ptz.load_results(results.log.parent).trials == results.trials


def test_results_as_a_data_frame(results: scope_ptz.EvaluationResults) -> None:
    table = results.to_pandas()
    assert list(table["task"]) == [trial.task.id for trial in results.trials]
    assert table["correct"].mean() == results.micro


def test_repeating_a_call_reads_a_complete_log(results: scope_ptz.EvaluationResults, tasks: tuple[scope_ptz.Task, ...]) -> None:
    assert scope_ptz.evaluate(tasks=tasks, out=results.log.parent, pictures=False).log == results.log


def test_objects_of_the_caller_are_evaluated_and_stay_open(tasks: tuple[scope_ptz.Task, ...], tmp_path: Path) -> None:
    planner = SaysThree()

    async def notebook_cell() -> scope_ptz.EvaluationResults:
        return scope_ptz.evaluate(planner, tasks=tasks, out=tmp_path, pictures=False)

    results = asyncio.run(notebook_cell())
    assert {trial.answer for trial in results.trials} == {"There are 3."}
    assert results.pair == "says three + ground-truth"
    assert not planner.closed


@pytest.mark.full
def test_a_planner_object_scores_like_the_named_planner(
    results: scope_ptz.EvaluationResults, tasks: tuple[scope_ptz.Task, ...], tmp_path: Path
) -> None:
    from_object = scope_ptz.evaluate(GrammarPlanner(), tasks=tasks, out=tmp_path, pictures=False)
    assert from_object.scores == results.scores


def test_wrong_names_are_errors(tmp_path: Path) -> None:
    with pytest.raises(UnknownNameError, match="nowhere"):
        scope_ptz.load_tasks(scenes=["nowhere"])
    with pytest.raises(InputError, match="list of names"):
        scope_ptz.load_tasks(categories="counting")
    with pytest.raises(UnknownNameError, match="nobody"):
        scope_ptz.evaluate("nobody", out=tmp_path)
    with pytest.raises(TraceError, match="no log"):
        scope_ptz.load_results(tmp_path)
