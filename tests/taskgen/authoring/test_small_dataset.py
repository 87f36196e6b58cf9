"""A dataset of the synthetic scene: quotas, unique tasks, pairs, reproducible bytes, and validation that detects faults."""

from __future__ import annotations

import os
import random
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import anyio
import pytest

from scope_ptz.bench.tasks.expected import Choice, NoneThere, Number, YesNo
from scope_ptz.bench.tasks.files import dump_tasks, load_tasks
from scope_ptz.bench.tasks.task import Task
from scope_ptz.factory.validation_perception import ground_truth_tools
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.assembly import QUOTAS as PUBLISHED
from scope_ptz.taskgen.authoring.assembly import BuiltTasks
from scope_ptz.taskgen.authoring.reactions import create_reactions
from scope_ptz.taskgen.facts.answer_phrasing import offered_answers
from scope_ptz.taskgen.validation.adversarial import common_answers
from scope_ptz.taskgen.validation.dataset_checks import structural_faults
from scope_ptz.taskgen.validation.report_text import report_lines
from scope_ptz.taskgen.validation.validate import validate
from scope_ptz.taskgen.validation.validation_report import ValidationReport
from tests.taskgen.authoring.conftest import QUOTAS

pytestmark = pytest.mark.full


def core(built_tasks: BuiltTasks) -> list[Task]:
    return [task for task in built_tasks.tasks if task.stratum == "core"]


def run_validation(tasks: list[Task], scene: Scene) -> ValidationReport:
    scenes = {scene.name: scene}
    return anyio.run(lambda: validate(tasks, scenes, ground_truth_tools(scenes)))


def test_published_quotas_add_up_to_the_536_tasks_of_the_paper() -> None:
    assert sum(PUBLISHED.values()) == 536


def test_quotas_are_filled_or_the_shortfall_is_reported(built_tasks: BuiltTasks) -> None:
    counts = Counter(task.category for task in core(built_tasks))
    assert {name: counts[name] + built_tasks.missing.get(name, 0) for name in QUOTAS} == QUOTAS
    assert counts["counting"] == QUOTAS["counting"]


_BUILD = """
import sys
from pathlib import Path
from scope_ptz.taskgen.authoring.assembly import build
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.factory.validation_perception import is_answerable
from scope_ptz.simulator.pack import Scene
from tests.taskgen.authoring.conftest import QUOTAS
folder, seed, out = sys.argv[1:]
dump_tasks(build([Scene(Path(folder))], int(seed), QUOTAS, None, is_answerable).tasks, Path(out))
"""


@pytest.mark.full
def test_same_seed_gives_the_same_bytes_and_another_seed_does_not(
    built_tasks: BuiltTasks, analytic_folder: Path, tmp_path: Path
) -> None:
    """Separate processes have different hash seeds, so they order sets of strings differently."""
    files = [tmp_path / f"{n}.jsonl" for n in range(3)]
    dump_tasks(built_tasks.tasks, files[0])
    for seed, hashes, file in ((1, "4711", files[1]), (2, "0", files[2])):
        environment = {**os.environ, "PYTHONHASHSEED": hashes}
        subprocess.run([sys.executable, "-c", _BUILD, str(analytic_folder), str(seed), str(file)], env=environment, check=True)
    one, same, another = (file.read_bytes() for file in files)
    assert one == same != another
    assert load_tasks(files[0]) == tuple(built_tasks.tasks)


def test_the_twin_of_a_selected_task_may_be_in_the_rest_of_the_dataset(built_tasks: BuiltTasks) -> None:
    alone = [task for task in built_tasks.tasks if task.pair is not None][:1]
    assert [fault.attempt for fault in structural_faults(alone)] == ["pair"]
    assert not structural_faults(alone, dataset=built_tasks.tasks)


def test_no_two_tasks_ask_the_same_question(built_tasks: BuiltTasks) -> None:
    assert not structural_faults(built_tasks.tasks)
    views = Counter(
        (t.evidence[0].aim, t.evidence[0].scope, t.expected, t.tags) for t in core(built_tasks) if t.category == "counting"
    )
    assert max(views.values()) == 1
    assert len({task.id for task in built_tasks.tasks}) == len(built_tasks.tasks)


def test_every_absence_has_a_presence_as_its_twin(built_tasks: BuiltTasks) -> None:
    by_id = {task.id: task for task in built_tasks.tasks}
    absences = [task for task in core(built_tasks) if isinstance(task.expected, NoneThere)]
    assert absences
    for task in absences:
        twin = by_id[task.pair or ""]
        assert twin.pair == task.id
        assert not isinstance(twin.expected, NoneThere)
        assert task.preset == twin.preset or task.evidence[0].aim.viewpoint == twin.evidence[0].aim.viewpoint


def test_a_sum_over_two_views_counts_no_object_twice(built_tasks: BuiltTasks) -> None:
    for task in core(built_tasks):
        if len(task.evidence) > 1 and isinstance(task.expected, Number) and not {"sort:difference", "sort:excess"} & set(task.tags):
            things = [item.instance for view in task.evidence for item in view.items]
            assert len(things) == len(set(things)) == task.expected.value


def test_paraphrases_have_the_expected_answer_of_their_task(built_tasks: BuiltTasks) -> None:
    by_id = {task.id: task for task in built_tasks.tasks}
    wordings = [task for task in built_tasks.tasks if task.stratum == "paraphrase"]
    assert wordings
    for task in wordings:
        original = by_id[task.paraphrase_of or ""]
        assert task.instruction != original.instruction
        assert (task.expected, task.behaviour, task.reference) == (original.expected, original.behaviour, original.reference)


def test_the_dataset_is_sound(report: ValidationReport) -> None:
    assert report.sound, "\n".join(report_lines(report))
    assert not report.disagreements
    assert report.passed["reference"] == report.tasks
    assert all(share == 0 for share in report.adversarial_shares.values())
    assert {"nothing", "guess", "blind", "stay", "wrong-answer", "ignored", "wrong-pose"} <= set(report.tried)


def test_no_fixed_answer_passes_both_tasks_of_a_pair(report: ValidationReport, built_tasks: BuiltTasks) -> None:
    twins = {task.id: task.pair for task in core(built_tasks)}
    assert set(report.guessed) >= {f"looked-and-guessed: {guess}" for guess in ("none", "0", "yes", "no", "most common")}
    for name, ids in report.guessed.items():
        assert not any(twins[one] in ids for one in ids), name
        assert report.pairs_passed[name] == sum(twins[one] is None for one in ids)
    none = set(report.guessed["looked-and-guessed: none"])
    # Outside pairs, "none" is right only for questions whose answer is no.
    denied = {task.id for task in core(built_tasks) if isinstance(task.expected, YesNo) and not task.expected.value}
    assert none and {one for one in none if twins[one] is None} <= denied


def test_answers_that_a_question_offers() -> None:
    sides = Choice(value="right", options={"left": ("left half",), "right": ("right half",)})
    assert offered_answers(sides, "Turn 20 degrees to the right. Is the car in the left or the right half?") == ("left", "right")
    assert offered_answers(sides, "On which side is the car?") == ()
    assert offered_answers(Number(value=2), "How many cars or vans are there?") == ()
    three = Choice(value="bus", options={"red car": (), "van": (), "bus": (), "same": ()})
    assert offered_answers(three, "Which is nearest: the van, the red car or the bus?") == ("van", "red car", "bus")


def test_most_common_answer_does_not_contain_words_of_its_question(built_tasks: BuiltTasks) -> None:
    counts = [task.expected for task in core(built_tasks) if task.category == "counting" and task.pair is None]
    common = Counter(f"{e.value:g}" for e in counts if isinstance(e, Number)).most_common(1)[0][0]
    assert common_answers(built_tasks.tasks, exclude_pairs=True)["counting"] == common


def wrong_count(task: Task) -> Task:
    assert isinstance(task.expected, Number)
    return task.model_copy(update={"expected": task.expected.model_copy(update={"value": task.expected.value + 1})})


def without_required_observation(task: Task) -> Task:
    views = tuple(view.model_copy(update={"must_look": False}) for view in task.evidence)
    return task.model_copy(update={"evidence": views, "behaviour": task.behaviour.model_copy(update={"final": None})})


def with_another_final_pose(task: Task) -> Task:
    final = task.behaviour.final
    assert final is not None
    moved = final.model_copy(update={"pan_deg": final.pan_deg + 2.0})
    return task.model_copy(update={"behaviour": task.behaviour.model_copy(update={"final": moved})})


@pytest.mark.parametrize(
    ("damage", "field"), [(without_required_observation, "adversarial_passes"), (with_another_final_pose, "faults")]
)
def test_a_damaged_task_is_detected(
    built_tasks: BuiltTasks, analytic_scene: Scene, damage: Callable[[Task], Task], field: str
) -> None:
    task = next(t for t in core(built_tasks) if t.category == "counting" and isinstance(t.expected, Number) and t.behaviour.final)
    report = run_validation([damage(task).model_copy(update={"pair": None})], analytic_scene)
    assert not report.sound
    assert getattr(report, field)


def test_a_wrong_expected_count_is_reported(built_tasks: BuiltTasks, analytic_scene: Scene) -> None:
    task = next(t for t in core(built_tasks) if t.category == "counting" and isinstance(t.expected, Number))
    report = run_validation([wrong_count(task).model_copy(update={"pair": None})], analytic_scene)
    assert not report.sound
    assert [fault.attempt for fault in report.faults] == ["truth"]


def test_a_missing_twin_is_reported(built_tasks: BuiltTasks) -> None:
    task = next(t for t in core(built_tasks) if t.pair)
    assert [fault.attempt for fault in structural_faults([task])] == ["pair"]


def test_reactions_require_that_the_camera_does_not_move(analytic_scene: Scene) -> None:
    tasks, missing = create_reactions([analytic_scene], 1)
    assert missing == 0 and len(tasks) >= 40
    assert len({task.instruction for task in tasks}) == len(tasks)
    assert run_validation(random.Random(1).sample(tasks, 3), analytic_scene).sound


def test_a_missing_preset_is_reported(built_tasks: BuiltTasks, analytic_scene: Scene) -> None:
    task = next(t for t in core(built_tasks) if t.pair is None).model_copy(update={"preset": "old-gate"})
    report = run_validation([task], analytic_scene)
    assert [fault.reason for fault in report.faults] == ["the scene has no preset old-gate"]
