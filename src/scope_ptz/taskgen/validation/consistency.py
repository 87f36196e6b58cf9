"""Check that a task is consistent with its scene: recompute its expected answer from the scene and the evidence.

The rules use only the finished task, not the code that created it. They detect answers that were edited by hand, and scenes that
were baked again after the task was created.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from scope_ptz.bench.answers import same_text
from scope_ptz.bench.scoring.coverage import box_directions
from scope_ptz.bench.tasks.expected import AnyExpected, Choice, NoneThere, Number, Ordering, Relation, Text, YesNo
from scope_ptz.bench.tasks.task import EvidenceView, Item, Task
from scope_ptz.geometry import Equirectangular, Perspective, Pose
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import ViewTruth, view_truth
from scope_ptz.taskgen.authoring.noun_phrases import plain_colour, singular_noun
from scope_ptz.taskgen.facts.kinds import Kind, kinds_in
from scope_ptz.taskgen.facts.robust import TASK_CAMERA, TRACE_PX, RobustTruth, is_visible

TruthReader = Callable[[Scene, str, Perspective | Equirectangular, float], ViewTruth]
"""A function that reads the ground truth of a view, given the scene, the viewpoint, the projection and the time in seconds."""


def find_inconsistencies(task: Task, scene: Scene, read_truth: TruthReader = view_truth) -> list[str]:
    """Return a description of each difference between a task and the ground truth of its scene."""
    if task.preset not in {preset.name for preset in scene.file.presets}:
        return [f"the scene has no preset {task.preset}"]
    if missing := {view.aim.viewpoint for view in task.evidence} - {viewpoint.name for viewpoint in scene.file.viewpoints}:
        return [f"the scene has no viewpoint {', '.join(sorted(missing))}"]
    differences = [reason for view in task.evidence for reason in _check_view(task, view, scene, read_truth)]
    computed = _answer_from_counts(task)
    if computed is not None and computed != _expected_value(task.expected):
        differences.append(f"the evidence gives {computed}, but {_expected_value(task.expected)} is expected")
    differences += _check_facts(task, scene)
    return differences


def _expected_value(expected: AnyExpected) -> object:
    match expected:
        case Number() | Choice() | Ordering() | Relation():
            return expected.value
        case YesNo():
            return expected.value
        case NoneThere():
            return 0.0
    return None


def _check_view(task: Task, view: EvidenceView, scene: Scene, read_truth: TruthReader) -> Iterator[str]:
    """Recount the objects in a view, and yield a description of each difference."""
    if not view.must_look:
        return
    pose = None if view.scope == "full" else Pose(view.aim.pan_deg, view.aim.tilt_deg, view.aim.zoom)
    projection = RobustTruth(scene, view.aim.viewpoint, pose, task.time_s).projection
    truth = read_truth(scene, view.aim.viewpoint, projection, task.time_s)
    shown = [s for s in truth.sightings if is_visible(s)]
    kinds = {singular_noun(kind): kind for kind in kinds_in(scene.things)}
    match view.shows:
        case Number() if view.whole and "half" not in task.tags and view.shows.unit:
            kind = kinds.get(view.shows.unit[0], Kind(view.shows.unit[0]))
            number = sum(kind.fits(s.instance) for s in shown)
            if number != view.shows.value:
                yield f"{number} {view.shows.unit[0]} are visible, but the evidence shows {view.shows.value:g}"
            if len(view.items) != number:
                yield f"the evidence has {len(view.items)} items, but {number} objects are visible"
        case NoneThere():
            kind = kinds.get(view.shows.subject[0], Kind(view.shows.subject[0]))
            if any(kind.fits(s.instance) and s.pixels > TRACE_PX for s in truth.sightings):
                # Tasks about half a frame get this answer only if the whole frame contains no such object.
                yield f"a {view.shows.subject[0]} is in view"
        case YesNo() if view.shows.value and view.shows.affirms and "verification" not in task.tags:
            kind = kinds.get(view.shows.affirms[0], Kind(view.shows.affirms[0]))
            if not any(kind.fits(s.instance) for s in shown):
                yield f"no {view.shows.affirms[0]} is visible"


def _answer_from_counts(task: Task) -> object:
    """Return the answer that follows from the counts in the evidence; None if the answer does not depend on counts."""
    question_type = next((tag.removeprefix("sort:") for tag in task.tags if tag.startswith("sort:")), "")
    counts = [_expected_value(view.shows) for view in task.evidence if isinstance(view.shows, Number | NoneThere)]
    numbers = [n for n in counts if isinstance(n, float)]
    if not numbers or len(numbers) != len(task.evidence):
        return None
    match question_type:
        case "count" | "coloured" | "in-state" | "all-around" | "count-all" | "none" | "count-half":
            return numbers[0]
        case "sum" | "together":
            return sum(numbers)
        case "difference" | "excess":
            return numbers[0] - numbers[1]
    if question_type == "whether-more":
        return numbers[0] > numbers[1]
    if isinstance(task.expected, Relation):
        return "same" if numbers[0] == numbers[1] else "forward" if numbers[0] > numbers[1] else "backward"
    if isinstance(task.expected, Choice | Ordering):
        return _option_from_counts(task.expected, numbers, fewest=question_type.startswith("fewer"))
    return None


def _option_from_counts(expected: Choice | Ordering, numbers: Sequence[float], *, fewest: bool) -> object:
    """Return the option with the most (or fewest) objects. Options and evidence are in the same order.

    For an ordering, return the expected order if all numbers differ, otherwise None.
    """
    if isinstance(expected, Ordering):
        return expected.value if len(set(numbers)) == len(numbers) else None
    if len(set(numbers)) == 1:
        return "same"
    names = [name for name in expected.options if name != "same"]
    return names[numbers.index(min(numbers) if fewest else max(numbers))]


def _check_facts(task: Task, scene: Scene) -> Iterator[str]:
    """Yield a description of each attribute, text or position in the evidence that differs from the scene."""
    for view in task.evidence:
        for item in view.items:
            thing = scene.by_id.get(item.instance)
            if thing is not None and "verification" in task.tags and isinstance(task.expected, YesNo):
                has_colour = plain_colour(thing.attributes.get("colour")) == task.expected.affirms[0]
                if has_colour != task.expected.value:
                    yield f"{item.instance} is{'' if has_colour else ' not'} {task.expected.affirms[0]}"
            if thing is not None and isinstance(item.value, str) and "attribute" in task.tags:
                facts = {str(v) for v in thing.attributes.values()} | {plain_colour(v) or "" for v in thing.attributes.values()}
                if _expected_value(task.expected) not in facts:
                    yield f"{item.instance} has no attribute with the value {_expected_value(task.expected)}"
            states_position = "frame" in task.tags and isinstance(task.expected, Choice)
            if states_position and not set(str(_expected_value(task.expected)).split()) <= _halves(view, item):
                yield f"{item.instance} is not {_expected_value(task.expected)}"
    if isinstance(task.expected, Text):
        words = {lettering.id: lettering.text.strip() for lettering in scene.file.texts}
        text = " ".join(dict.fromkeys(words.get(item.instance, "") for view in task.evidence for item in view.items))
        if not any(same_text(text, accepted, ocr=False) for accepted in task.expected.accepted):
            yield f"the text in the evidence is {text!r}"


def _halves(view: EvidenceView, item: Item) -> set[str]:
    """Return the halves of the evidence view that contain an item's centre."""
    frame = TASK_CAMERA.view(Pose(view.aim.pan_deg, view.aim.tilt_deg, view.aim.zoom))
    points = frame.points(box_directions(item.box_deg))
    x, y = (float(v) for v in (np.min(points, axis=0) + np.max(points, axis=0)) / 2)
    return {"left" if x < 0.5 else "right", *(("upper", "top") if y < 0.5 else ("lower", "bottom"))}
