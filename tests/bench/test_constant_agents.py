"""Tasks that constant answers pass, in synthetic runs and with the real tools."""

from __future__ import annotations

from collections import Counter

import pytest

from scope_ptz.bench.engine.entries import entry_of, select_entries
from scope_ptz.bench.program_runner import ProgramRunner
from scope_ptz.bench.scoring.constant_agents import (
    FRAME,
    ConstantReply,
    chance_level,
    constant_replies,
    expects_reply,
    find_accepting_tasks,
    find_passed_tasks,
    observing_episode,
    passes_without_answer,
)
from scope_ptz.bench.scoring.verdict import score_episode
from scope_ptz.bench.tasks.expected import ActionOnly, NoneThere, Number
from scope_ptz.bench.tasks.splits import load_split
from scope_ptz.bench.tasks.stratified import answer_key
from scope_ptz.bench.tasks.task import ProgramCall, Task
from scope_ptz.factory.validation_perception import ground_truth_tools
from scope_ptz.factory.worlds import open_scenes
from tests.bench.sample_runs import samples

pytestmark = pytest.mark.anyio


@pytest.mark.parametrize(
    "split", ["lite", pytest.param("core", marks=pytest.mark.full), pytest.param("unseen", marks=pytest.mark.full)]
)
def test_constant_answers_rarely_pass(split: str) -> None:
    level = chance_level(load_split(split))
    assert level.without_calls.correct == 0
    assert 0 < level.looking.correct <= level.accepted.correct
    assert level.looking.share < 0.2
    assert level.looking.consistent_share <= 0.05
    assert all(0 <= share < 0.5 for share in level.by_category.values())


@pytest.mark.full
@pytest.mark.parametrize("split", ["lite1", "paraphrase"])
def test_samples_that_separate_pairs_have_a_higher_chance_level(split: str) -> None:
    """The paraphrase split never contains both tasks of a pair, and the first lite split divided every pair."""
    level, core = chance_level(load_split(split)), chance_level(load_split("core"))
    assert level.looking.consistent_share > 3 * core.looking.consistent_share


def test_always_asking_for_clarification_passes_most_unclear_requests() -> None:
    level = chance_level(load_split("reaction"))
    assert level.without_calls.share > 0.5


def test_the_level_of_the_same_tasks_is_computed_once() -> None:
    tasks = load_split("lite")
    assert chance_level(tasks) is chance_level(list(tasks))


def test_synthetic_runs_pass_the_checks_that_real_runs_pass() -> None:
    """One perception call covers every task whose evidence is a single view, but not tasks with several views."""
    tasks = [task for task in load_split("core") if not isinstance(task.expected, ActionOnly)]
    covered = [passes_without_answer(task, observing_episode(task)) for task in tasks]
    one_view = [sum(view.must_look for view in task.evidence) == 1 and task.behaviour.framing is None for task in tasks]
    assert [task.id for task, passes, one in zip(tasks, covered, one_view, strict=True) if one and not passes] == []


def test_answering_none_passes_absences_but_not_their_twins() -> None:
    tasks = load_split("core")
    reply = ConstantReply("None.")
    none = find_passed_tasks(tasks, find_accepting_tasks(tasks, [reply]), observes=True)[reply]
    by_id = {task.id: task for task in tasks}
    absences = {task.id for task in tasks if isinstance(task.expected, NoneThere)}
    assert len(none & absences) > 60
    assert all(answer_key(by_id[name].expected) == "no" for name in none)
    assert not {by_id[name].pair for name in none} & none


def test_replies_are_the_most_frequent_answers() -> None:
    texts = [reply.text for reply in constant_replies(load_split("core"))]
    assert {"None.", "Yes.", "1", "2", "3"} <= set(texts) and len(texts) == len(set(texts))


def test_action_only_tasks_expect_no_reply() -> None:
    tasks = [task for task, _ in samples()]
    assert all(expects_reply(task) for task in tasks if not isinstance(task.expected, ActionOnly))
    assert not any(expects_reply(task) for task in tasks if isinstance(task.expected, ActionOnly))


@pytest.mark.full
@pytest.mark.parametrize("text", ["None.", "1", "red"])
async def test_the_real_tools_give_the_same_verdicts(text: str) -> None:
    """Run the moves and the first perception call of reference programs through the real tools."""
    tasks = [
        task
        for task in load_split("core")
        if task.scene == "highway-works"
        and not isinstance(task.expected, ActionOnly)
        and not any(step.tool in ("zoom_to_object", "track_object") for step in task.reference)
    ][::6]
    scenes = open_scenes(["highway-works"])
    runner = ProgramRunner(scenes["highway-works"], ground_truth_tools(scenes), FRAME)
    passed = find_passed_tasks(tasks, find_accepting_tasks(tasks, [ConstantReply(text)]), observes=True)[ConstantReply(text)]
    for task in tasks:
        episode = await runner.run(task, with_one_perception_call(task), text)
        assert (score_episode(task, episode).headline == "correct") <= (task.id in passed), task.id


def with_one_perception_call(task: Task) -> list[ProgramCall]:
    """Return the reference program without the perception calls after the first."""
    perception_steps = [number for number, step in enumerate(task.reference) if step.tool in ("count_objects", "query_answer")]
    return [step for number, step in enumerate(task.reference) if number not in perception_steps[1:]]


@pytest.mark.parametrize("limit", [8, 20, 40, 60, 100])
def test_a_limit_is_balanced_over_answers(limit: int) -> None:
    tasks = load_split("core")
    scenes = open_scenes(sorted({task.scene for task in tasks}))
    entries = tuple(entry_of(task, scenes[task.world]) for task in tasks)
    selected = [entry.task for entry in select_entries(entries, limit=limit) if entry.task is not None]
    assert len(selected) == limit
    ids = {task.id for task in selected}
    absences = [task for task in selected if isinstance(task.expected, NoneThere)]
    assert len(absences) <= 0.2 * limit + 1
    assert sum(task.pair in ids for task in absences) >= len(absences) - 1
    level = chance_level(selected)
    assert level.looking.consistent <= 2
    numbers = Counter(answer_key(task.expected) for task in selected if isinstance(task.expected, Number))
    assert max(numbers.values(), default=0) <= max(1, limit // 20)
