"""Whether a task still says what the ground truth says: its expected value is worked out again from scene and evidence.

The rules below look at the finished task only, not at how it was made; a value that was changed by hand, or a scene that was baked
anew, shows here.
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
from scope_ptz.taskgen.authoring.words import noun_of, plain_colour
from scope_ptz.taskgen.facts.kinds import Kind, kinds_in
from scope_ptz.taskgen.facts.robust import EYES, TRACE_PX, Sight, visible

Look = Callable[[Scene, str, Perspective | Equirectangular, float], ViewTruth]


def inconsistencies(task: Task, scene: Scene, look: Look = view_truth) -> list[str]:
    """What of a task disagrees with the truth of its scene, in words."""
    if task.preset not in {preset.name for preset in scene.file.presets}:
        return [f"the scene has no preset {task.preset}"]
    if gone := {view.aim.viewpoint for view in task.evidence} - {viewpoint.name for viewpoint in scene.file.viewpoints}:
        return [f"the scene has no viewpoint {', '.join(sorted(gone))}"]
    wrong = [w for view in task.evidence for w in _view(task, view, scene, look)]
    worked_out = _worked_out(task)
    if worked_out is not None and worked_out != _value(task.expected):
        wrong.append(f"the evidence makes it {worked_out}, expected is {_value(task.expected)}")
    wrong += _facts(task, scene)
    return wrong


def _value(expected: AnyExpected) -> object:
    match expected:
        case Number() | Choice() | Ordering() | Relation():
            return expected.value
        case YesNo():
            return expected.value
        case NoneThere():
            return 0.0
    return None


def _view(task: Task, view: EvidenceView, scene: Scene, look: Look) -> Iterator[str]:
    """Count again what a view shows."""
    if not view.must_look:
        return
    at = None if view.scope == "full" else Pose(view.aim.pan_deg, view.aim.tilt_deg, view.aim.zoom)
    sight = Sight(scene, view.aim.viewpoint, at, task.time_s)
    truth = look(scene, view.aim.viewpoint, sight.projection, task.time_s)
    shown = [s for s in truth.sightings if visible(s)]
    kinds = {noun_of(kind): kind for kind in kinds_in(scene.things)}
    match view.shows:
        case Number() if view.whole and "half" not in task.tags and view.shows.unit:
            kind = kinds.get(view.shows.unit[0], Kind(view.shows.unit[0]))
            number = sum(kind.fits(s.instance) for s in shown)
            if number != view.shows.value:
                yield f"{number} {view.shows.unit[0]} are visible, the evidence shows {view.shows.value:g}"
            if len(view.items) != number:
                yield f"{len(view.items)} pieces of evidence stand for {number}"
        case NoneThere():
            kind = kinds.get(view.shows.subject[0], Kind(view.shows.subject[0]))
            if any(kind.fits(s.instance) and s.pixels > TRACE_PX for s in truth.sightings):
                # In the half of a frame there is none; so there is none in all of it, as these tasks are made.
                yield f"a {view.shows.subject[0]} shows"
        case YesNo() if view.shows.value and view.shows.affirms and "verification" not in task.tags:
            kind = kinds.get(view.shows.affirms[0], Kind(view.shows.affirms[0]))
            if not any(kind.fits(s.instance) for s in shown):
                yield f"no {view.shows.affirms[0]} is visible"


def _worked_out(task: Task) -> object:
    """The answer that the counts of the evidence lead to; None where it does not rest on counts."""
    sort = next((tag.removeprefix("sort:") for tag in task.tags if tag.startswith("sort:")), "")
    counts = [_value(view.shows) for view in task.evidence if isinstance(view.shows, Number | NoneThere)]
    numbers = [n for n in counts if isinstance(n, float)]
    if not numbers or len(numbers) != len(task.evidence):
        return None
    match sort:
        case "count" | "coloured" | "in-state" | "all-around" | "count-all" | "none" | "count-half":
            return numbers[0]
        case "sum" | "together":
            return sum(numbers)
        case "difference" | "excess":
            return numbers[0] - numbers[1]
    if sort == "whether-more":
        return numbers[0] > numbers[1]
    if isinstance(task.expected, Relation):
        return "same" if numbers[0] == numbers[1] else "forward" if numbers[0] > numbers[1] else "backward"
    if isinstance(task.expected, Choice | Ordering):
        return _compared(task.expected, numbers, fewest=sort.startswith("fewer"))
    return None


def _compared(expected: Choice | Ordering, numbers: Sequence[float], *, fewest: bool) -> object:
    """Options stand in the order of the evidence (those of an ordering from most to fewest)."""
    if isinstance(expected, Ordering):
        return expected.value if len(set(numbers)) == len(numbers) else None
    if len(set(numbers)) == 1:
        return "same"
    names = [name for name in expected.options if name != "same"]
    return names[numbers.index(min(numbers) if fewest else max(numbers))]


def _facts(task: Task, scene: Scene) -> Iterator[str]:
    """Attributes, texts and places in the frame, as the items of the evidence have them."""
    for view in task.evidence:
        for item in view.items:
            thing = scene.by_id.get(item.instance)
            if thing is not None and "verification" in task.tags and isinstance(task.expected, YesNo):
                so = plain_colour(thing.attributes.get("colour")) == task.expected.affirms[0]
                if so != task.expected.value:
                    yield f"{item.instance} is{'' if so else ' not'} {task.expected.affirms[0]}"
            if thing is not None and isinstance(item.value, str) and "attribute" in task.tags:
                facts = {str(v) for v in thing.attributes.values()} | {plain_colour(v) or "" for v in thing.attributes.values()}
                if _value(task.expected) not in facts:
                    yield f"{item.instance} has no such attribute as {_value(task.expected)}"
            placed = "frame" in task.tags and isinstance(task.expected, Choice)
            if placed and not set(str(_value(task.expected)).split()) <= _places(view, item):
                yield f"{item.instance} is not {_value(task.expected)}"
    if isinstance(task.expected, Text):
        words = {text.id: text.text.strip() for text in scene.file.texts}
        said = " ".join(dict.fromkeys(words.get(item.instance, "") for view in task.evidence for item in view.items))
        if not any(same_text(said, accepted, ocr=False) for accepted in task.expected.accepted):
            yield f"the evidence says {said!r}"


def _places(view: EvidenceView, item: Item) -> set[str]:
    """In which halves of the reference frame the middle of an item lies."""
    frame = EYES.view(Pose(view.aim.pan_deg, view.aim.tilt_deg, view.aim.zoom))
    points = frame.points(box_directions(item.box_deg))
    x, y = (float(v) for v in (np.min(points, axis=0) + np.max(points, axis=0)) / 2)
    return {"left" if x < 0.5 else "right", *(("upper", "top") if y < 0.5 else ("lower", "bottom"))}
