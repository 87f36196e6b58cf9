"""Compute the correct answer to a draft from the ground truth, with one function for each program name in the schema.

Programs use only robust ground truth (see ``facts.robust``). A draft with an uncertain answer is rejected.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from scope_ptz.bench.answers import Declined, Unreadable, agrees, names_any, parse_answer
from scope_ptz.bench.tasks.expected import ActionOnly, AnyExpected, Choice, NoneThere, Number, Text, YesNo
from scope_ptz.bench.tasks.task import Behaviour, EvidenceView, ProgramCall, Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import Sighting
from scope_ptz.taskgen.authoring.drafts import count_call, difficulty, evidence_view, query_call
from scope_ptz.taskgen.authoring.noun_phrases import (
    answer_words,
    colour_options,
    object_words,
    plain_colour,
    plural_noun,
    singular_noun,
)
from scope_ptz.taskgen.authoring.task_places import TaskPlace
from scope_ptz.taskgen.facts.kinds import Kind
from scope_ptz.taskgen.generating.draft_places import DraftRejectedError, resolve_places
from scope_ptz.taskgen.generating.draft_schema import ALLOWED_PROGRAMS, Draft

_MAX_COUNT = 15  # people disagree about larger counts
TAG = "generated"


@dataclass(frozen=True)
class _Solution:
    """The result of an answer program.

    Attributes:
        expected: The correct answer.
        evidence: The views from which the answer follows.
        program: The reference program.
        object_count: Number of objects that an agent must distinguish.
        tags: The task's tags.
    """

    expected: AnyExpected
    evidence: tuple[EvidenceView, ...] = ()
    program: tuple[ProgramCall, ...] = ()
    object_count: int = 1
    tags: tuple[str, ...] = ()


def create_task(draft: Draft, scene: Scene, name: str, dataset: str) -> Task:
    """Create a task from a draft, with an expected answer from the ground truth.

    Args:
        draft: The draft.
        scene: The task's scene.
        name: Id of the task.
        dataset: Name of the dataset.

    Raises:
        DraftRejectedError: The draft cannot become a task.
    """
    if draft.program not in ALLOWED_PROGRAMS[draft.category]:
        raise DraftRejectedError(f"'{draft.program}' is not allowed in the category {draft.category}")
    places = resolve_places(draft, scene)
    categories = {thing.category for thing in scene.things} | set(scene.file.absent)
    for kind in _kinds(draft):
        if kind.category not in categories:
            raise DraftRejectedError(f"the inventory has no '{kind.category}'")
        if not names_any(draft.instruction, object_words(kind)):
            raise DraftRejectedError(f"the instruction does not name the {kind.category}")
        if kind.colour is not None and kind.colour not in draft.instruction.lower():
            raise DraftRejectedError(f"the instruction does not say {kind.colour}")
    solution = _PROGRAMS[draft.program](draft, places)
    _check_expected_answer(draft, solution.expected)
    last = places[-1]
    return Task(
        id=name,
        dataset=dataset,
        scene=scene.file.name,
        variation=scene.variation,
        preset=draft.start,
        time_s=scene.file.start_s,
        instruction=draft.instruction,
        category=draft.category,
        scope="full" if last.swept else "current",
        difficulty=difficulty(solution.program, solution.object_count, swept=last.swept),
        expected=solution.expected,
        # An agent may visit the views of a comparison or sum in any order.
        behaviour=Behaviour(final=last.final if len(places) == 1 or draft.program == "action" else None),
        evidence=solution.evidence,
        reference=solution.program,
        needs=tuple(dict.fromkeys(need for place in places for need in place.needs)),
        tags=(TAG, *solution.tags),
    )


def _check_expected_answer(draft: Draft, expected: AnyExpected) -> None:
    """Reject a draft whose expected answer is wrong, or whose instruction contains the answer."""
    if isinstance(expected, ActionOnly):
        return
    reading = parse_answer(expected, draft.expected)
    if isinstance(reading, Unreadable | Declined) or not agrees(expected, reading):
        correct = expected.model_dump(include={"value", "accepted", "subject"})
        raise DraftRejectedError(f"the draft expects '{draft.expected}', the ground truth says {correct or expected.kind}")
    if isinstance(expected, Text) and any(text.lower() in draft.instruction.lower() for text in expected.accepted):
        raise DraftRejectedError("the instruction contains its answer")


def _kinds(draft: Draft) -> list[Kind]:
    return [Kind(thing.category, thing.colour) for thing in draft.things]


def _only_kind(draft: Draft) -> Kind:
    if len(draft.things) != 1:
        raise DraftRejectedError("this program needs exactly one kind of thing")
    return _kinds(draft)[0]


def _only_place(places: Sequence[TaskPlace]) -> TaskPlace:
    if len(places) != 1:
        raise DraftRejectedError("this program needs exactly one view")
    return places[0]


def _count_objects(place: TaskPlace, kind: Kind) -> tuple[Number | NoneThere, EvidenceView, int]:
    """Count the objects of a kind in a view. Return the count as an expected answer, as evidence and as an integer.

    Raises:
        DraftRejectedError: The count is uncertain or too large.
    """
    things = place.truth.all_of(kind)
    if things is None:
        raise DraftRejectedError(f"the number of {plural_noun(kind)} in that view is uncertain")
    if not things:
        if not place.truth.certainly_lacks(kind):
            raise DraftRejectedError(f"it is uncertain whether that view shows a {singular_noun(kind)}")
        none = NoneThere(subject=answer_words(kind))
        return none, evidence_view(place, none, object_words(kind), whole=True), 0
    if len(things) > _MAX_COUNT:
        raise DraftRejectedError(f"there are more than {_MAX_COUNT} {plural_noun(kind)}, so people would count them differently")
    number = Number(value=float(len(things)), unit=answer_words(kind))
    return (
        number,
        evidence_view(place, number, object_words(kind), [place.truth.item(t, True) for t in things], whole=True),
        len(things),
    )


def _only_object(place: TaskPlace, kind: Kind) -> Sighting:
    things = place.truth.all_of(kind)
    if not things or len(things) > 1:
        raise DraftRejectedError(f"it is uncertain whether that view shows exactly one {singular_noun(kind)}")
    return things[0]


def _solve_count(draft: Draft, places: Sequence[TaskPlace]) -> _Solution:
    place, kind = _only_place(places), _only_kind(draft)
    expected, evidence, number = _count_objects(place, kind)
    tag = "sort:none" if not number else "sort:count"
    return _Solution(expected, (evidence,), (*place.calls, count_call(plural_noun(kind), place)), number, (tag,))


def _solve_exists(draft: Draft, places: Sequence[TaskPlace]) -> _Solution:
    place, kind = _only_place(places), _only_kind(draft)
    expected, evidence, number = _count_objects(place, kind)
    answer = YesNo(value=True, affirms=answer_words(kind)) if number else expected
    evidence = evidence.model_copy(update={"shows": answer})
    return _Solution(answer, (evidence,), (*place.calls, count_call(plural_noun(kind), place)), 1, ("sort:exists",))


def _solve_colour(draft: Draft, places: Sequence[TaskPlace]) -> _Solution:
    place, kind = _only_place(places), _only_kind(draft)
    thing = _only_object(place, kind)
    colour = plain_colour(thing.instance.attributes.get("colour"))
    if colour is None or kind.colour is not None:
        raise DraftRejectedError(f"the {kind.category} has no plain colour to ask about")
    if colour in draft.instruction.lower():
        raise DraftRejectedError("the instruction contains its answer")
    choice = Choice(value=colour, options=colour_options())
    evidence = evidence_view(place, choice, object_words(kind), [place.truth.item(thing, colour)], whole=False)
    question = query_call(f"what colour is the {singular_noun(kind)}?", place)
    return _Solution(choice, (evidence,), (*place.calls, question), 1, ("attribute", "sort:colour"))


def _solve_text(draft: Draft, places: Sequence[TaskPlace]) -> _Solution:
    place, kind = _only_place(places), _only_kind(draft)
    thing = _only_object(place, kind)
    texts = place.truth.texts_on(thing.instance)
    if not texts:
        raise DraftRejectedError(f"the text on the {singular_noun(kind)} is not certainly legible in that view")
    words = " / ".join(dict.fromkeys(t.text.text.strip() for t in texts))
    text = Text(accepted=(words,), ocr=True)
    evidence = evidence_view(place, text, object_words(kind), [place.truth.text_item(t) for t in texts], whole=False)
    question = query_call(f"what does the {singular_noun(kind)} say?", place)
    return _Solution(text, (evidence,), (*place.calls, question), len(texts), ("sort:text",))


def _solve_side(draft: Draft, places: Sequence[TaskPlace]) -> _Solution:
    place, kind = _only_place(places), _only_kind(draft)
    if draft.axis is None or place.swept:
        raise DraftRejectedError("a side question needs one view, and the axis across or down")
    thing = _only_object(place, kind)
    names = ("left", "right") if draft.axis == "across" else ("upper", "lower")
    side = place.truth.side(thing, 0 if draft.axis == "across" else 1)
    if side is None:
        raise DraftRejectedError(f"it is uncertain in which half the {singular_noun(kind)} is")
    synonyms = {"upper": ("top", "above"), "lower": ("bottom", "below")}
    choice = Choice(value=names[side], options={name: synonyms.get(name, ()) for name in names})
    evidence = evidence_view(place, choice, object_words(kind), [place.truth.item(thing, names[side])], whole=False)
    question = query_call(f"is the {singular_noun(kind)} in the {names[0]} or the {names[1]} half of the picture?", place)
    return _Solution(choice, (evidence,), (*place.calls, question), 1, ("frame", "sort:side"))


def _solve_most(draft: Draft, places: Sequence[TaskPlace]) -> _Solution:
    """Find the most numerous of several kinds in a view, or the view that shows the most objects of one kind."""
    kinds = _kinds(draft)
    if len(places) == 1 and len(kinds) > 1:
        compared = [(places[0], kind, plural_noun(kind)) for kind in kinds]
    elif len(kinds) == 1 and len(places) > 1:
        compared = [(place, kinds[0], _preset_of(place)) for place in places]
    else:
        raise DraftRejectedError("'most' must compare several kinds in one view, or one kind in several views")
    if len({name for _, _, name in compared}) < len(compared):
        raise DraftRejectedError("something is compared with itself")
    counts = [_count_objects(place, kind) for place, kind, _ in compared]
    numbers = [number for _, _, number in counts]
    names = [name for _, _, name in compared]
    best = max(numbers)
    if numbers.count(best) > 1:
        raise DraftRejectedError(f"the largest count is not unique: {', '.join(map(str, numbers))}")
    options: dict[str, tuple[str, ...]] = dict.fromkeys(names, ())
    choice = Choice(value=names[numbers.index(best)], options=options, picks=("more", "most"))
    return _Solution(choice, tuple(evidence for _, evidence, _ in counts), _visit_calls(compared), sum(numbers), ("sort:more",))


def _solve_sum(draft: Draft, places: Sequence[TaskPlace]) -> _Solution:
    kind = _only_kind(draft)
    if len(places) < 2:
        raise DraftRejectedError("a sum needs several views")
    counts = [_count_objects(place, kind) for place in places]
    shown = [item.instance for _, evidence, _ in counts for item in evidence.items]
    if len(set(shown)) < len(shown):
        raise DraftRejectedError("an object is visible in two of the views, so a sum would count it twice")
    total = sum(number for _, _, number in counts)
    if not 0 < total <= _MAX_COUNT:
        raise DraftRejectedError(f"the sum must be from 1 to {_MAX_COUNT}, got {total}")
    number = Number(value=float(total), unit=answer_words(kind))
    program = _visit_calls([(place, kind, "") for place in places])
    return _Solution(number, tuple(evidence for _, evidence, _ in counts), program, total, ("sort:sum",))


def _solve_action(draft: Draft, places: Sequence[TaskPlace]) -> _Solution:
    if draft.things or any(place.swept for place in places):
        raise DraftRejectedError("an action must have neither a sweep nor things")
    calls = places[-1].calls
    if not calls or (len(calls) == 1) != (draft.category == "single_call"):
        raise DraftRejectedError("a single call must be one move, and a multi-step command must be several")
    return _Solution(ActionOnly(), program=calls, tags=("sort:action",))


def _visit_calls(visits: Sequence[tuple[TaskPlace, Kind, str]]) -> tuple[ProgramCall, ...]:
    """Return the moves from view to view, with a count call at each view."""
    program, call_count = list[ProgramCall](), 0
    for place, kind, _ in visits:
        program += [*place.calls[call_count:], count_call(plural_noun(kind), place)]
        call_count = len(place.calls)
    return tuple(program)


def _preset_of(place: TaskPlace) -> str:
    last = place.calls[-1] if place.calls else None
    if last is None or last.tool != "go_to_preset" or place.swept:
        raise DraftRejectedError("each of several compared views must be a preset, because answers name presets")
    return str(last.arguments["name"])


_PROGRAMS: dict[str, Callable[[Draft, Sequence[TaskPlace]], _Solution]] = {
    "count": _solve_count,
    "exists": _solve_exists,
    "colour": _solve_colour,
    "text": _solve_text,
    "side": _solve_side,
    "most": _solve_most,
    "sum": _solve_sum,
    "action": _solve_action,
}
