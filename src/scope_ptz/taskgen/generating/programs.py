"""What is right is worked out here: programs over the predicates of the ground truth, one for each sort of question.

A program tells only what is sure (see ``bench.ground``); what is not makes no task.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from scope_ptz.bench.answers import Declined, Unreadable, agrees, names_any, parse_answer
from scope_ptz.bench.tasks.expected import ActionOnly, AnyExpected, Choice, NoneThere, Number, Text, YesNo
from scope_ptz.bench.tasks.task import Behaviour, EvidenceView, ProgramCall, Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import Sighting
from scope_ptz.taskgen.authoring.drafts import ask, count, difficulty, view
from scope_ptz.taskgen.authoring.places import Place
from scope_ptz.taskgen.authoring.words import about, colour_options, many_of, noun_of, plain_colour, unit_of
from scope_ptz.taskgen.facts.kinds import Kind
from scope_ptz.taskgen.generating.places import Refused, places_of
from scope_ptz.taskgen.generating.schema import ALLOWED, Draft

MOST_COUNTED = 15
TAG = "generated"


@dataclass(frozen=True)
class _Worked:
    """What a program found: the right answer, where it shows, the looks that tell it; ``size``: how much is to be told apart."""

    expected: AnyExpected
    evidence: tuple[EvidenceView, ...] = ()
    program: tuple[ProgramCall, ...] = ()
    size: int = 1
    tags: tuple[str, ...] = ()


def task_of(draft: Draft, scene: Scene, name: str, dataset: str) -> Task:
    """The task that a draft makes, its expected value worked out anew. Raises ``Refused`` with the reason."""
    if draft.program not in ALLOWED[draft.category]:
        raise Refused(f"'{draft.program}' makes no task of the category {draft.category}")
    places = places_of(draft, scene)
    known = {thing.category for thing in scene.things} | set(scene.file.absent)
    for kind in _kinds(draft):
        if kind.category not in known:
            raise Refused(f"the inventory has no '{kind.category}'")
        if not names_any(draft.instruction, about(kind)):
            raise Refused(f"the instruction does not name the {kind.category}")
        if kind.colour is not None and kind.colour not in draft.instruction.lower():
            raise Refused(f"the instruction does not say {kind.colour}")
    worked = _PROGRAMS[draft.program](draft, places)
    _compare(draft, worked.expected)
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
        difficulty=difficulty(worked.program, worked.size, swept=last.swept),
        expected=worked.expected,
        # Views that are compared or summed may be visited in any order.
        behaviour=Behaviour(final=last.final if len(places) == 1 or draft.program == "action" else None),
        evidence=worked.evidence,
        reference=worked.program,
        needs=tuple(dict.fromkeys(need for place in places for need in place.needs)),
        tags=(TAG, *worked.tags),
    )


def _compare(draft: Draft, expected: AnyExpected) -> None:
    """Hold what the model takes the answer to be against what is right. Raises ``Refused``."""
    if isinstance(expected, ActionOnly):
        return
    reading = parse_answer(expected, draft.expected)
    if isinstance(reading, Unreadable | Declined) or not agrees(expected, reading):
        right = expected.model_dump(include={"value", "accepted", "subject"})
        raise Refused(f"the draft expects '{draft.expected}', the ground truth says {right or expected.kind}")
    if isinstance(expected, Text) and any(text.lower() in draft.instruction.lower() for text in expected.accepted):
        raise Refused("the instruction holds its answer")


def _kinds(draft: Draft) -> list[Kind]:
    return [Kind(thing.category, thing.colour) for thing in draft.things]


def _one(draft: Draft) -> Kind:
    if len(draft.things) != 1:
        raise Refused("this program is about one kind of thing")
    return _kinds(draft)[0]


def _single(places: Sequence[Place]) -> Place:
    if len(places) != 1:
        raise Refused("this program is about one view")
    return places[0]


def _counted(place: Place, kind: Kind) -> tuple[Number | NoneThere, EvidenceView, int]:
    """How many there surely are in a view, as evidence."""
    things = place.sight.of(kind)
    if things is None:
        raise Refused(f"how many {many_of(kind)} there are is not sure in that view")
    if not things:
        if not place.sight.lacks(kind):
            raise Refused(f"whether there is a {noun_of(kind)} is not sure in that view")
        none = NoneThere(subject=unit_of(kind))
        return none, view(place, none, about(kind), whole=True), 0
    if len(things) > MOST_COUNTED:
        raise Refused(f"there are more than {MOST_COUNTED} {many_of(kind)}: people would not count alike")
    number = Number(value=float(len(things)), unit=unit_of(kind))
    return number, view(place, number, about(kind), [place.sight.item(t, True) for t in things], whole=True), len(things)


def _alone(place: Place, kind: Kind) -> Sighting:
    things = place.sight.of(kind)
    if not things or len(things) > 1:
        raise Refused(f"there is not surely one {noun_of(kind)} in that view")
    return things[0]


def _count(draft: Draft, places: Sequence[Place]) -> _Worked:
    place, kind = _single(places), _one(draft)
    expected, seen, number = _counted(place, kind)
    tag = "sort:none" if not number else "sort:count"
    return _Worked(expected, (seen,), (*place.calls, count(many_of(kind), place)), number, (tag,))


def _exists(draft: Draft, places: Sequence[Place]) -> _Worked:
    place, kind = _single(places), _one(draft)
    expected, seen, number = _counted(place, kind)
    there = YesNo(value=True, affirms=unit_of(kind)) if number else expected
    seen = seen.model_copy(update={"shows": there})
    return _Worked(there, (seen,), (*place.calls, count(many_of(kind), place)), 1, ("sort:exists",))


def _colour(draft: Draft, places: Sequence[Place]) -> _Worked:
    place, kind = _single(places), _one(draft)
    thing = _alone(place, kind)
    colour = plain_colour(thing.instance.attributes.get("colour"))
    if colour is None or kind.colour is not None:
        raise Refused(f"the {kind.category} has no plain colour to be asked after")
    if colour in draft.instruction.lower():
        raise Refused("the instruction holds its answer")
    choice = Choice(value=colour, options=colour_options())
    seen = view(place, choice, about(kind), [place.sight.item(thing, colour)], whole=False)
    question = ask(f"what colour is the {noun_of(kind)}?", place)
    return _Worked(choice, (seen,), (*place.calls, question), 1, ("attribute", "sort:colour"))


def _text(draft: Draft, places: Sequence[Place]) -> _Worked:
    place, kind = _single(places), _one(draft)
    thing = _alone(place, kind)
    texts = place.sight.texts_on(thing.instance)
    if not texts:
        raise Refused(f"what is written on the {noun_of(kind)} cannot surely be read in that view")
    words = " / ".join(dict.fromkeys(t.text.text.strip() for t in texts))
    text = Text(accepted=(words,), ocr=True)
    seen = view(place, text, about(kind), [place.sight.text_item(t) for t in texts], whole=False)
    question = ask(f"what does the {noun_of(kind)} say?", place)
    return _Worked(text, (seen,), (*place.calls, question), len(texts), ("sort:text",))


def _side(draft: Draft, places: Sequence[Place]) -> _Worked:
    place, kind = _single(places), _one(draft)
    if draft.axis is None or place.swept:
        raise Refused("a half is asked of one view, across or down")
    thing = _alone(place, kind)
    names = ("left", "right") if draft.axis == "across" else ("upper", "lower")
    side = place.sight.side(thing, 0 if draft.axis == "across" else 1)
    if side is None:
        raise Refused(f"in which half the {noun_of(kind)} is, is not sure")
    further = {"upper": ("top", "above"), "lower": ("bottom", "below")}
    choice = Choice(value=names[side], options={name: further.get(name, ()) for name in names})
    seen = view(place, choice, about(kind), [place.sight.item(thing, names[side])], whole=False)
    question = ask(f"is the {noun_of(kind)} in the {names[0]} or the {names[1]} half of the picture?", place)
    return _Worked(choice, (seen,), (*place.calls, question), 1, ("frame", "sort:side"))


def _most(draft: Draft, places: Sequence[Place]) -> _Worked:
    """Which of several kinds in a view, or in which of several views one kind, there is most of."""
    kinds = _kinds(draft)
    if len(places) == 1 and len(kinds) > 1:
        pairs = [(places[0], kind, many_of(kind)) for kind in kinds]
    elif len(kinds) == 1 and len(places) > 1:
        pairs = [(place, kinds[0], _preset_of(place)) for place in places]
    else:
        raise Refused("'most' compares several kinds in one view, or one kind in several views")
    if len({name for _, _, name in pairs}) < len(pairs):
        raise Refused("the same is compared with itself")
    found = [_counted(place, kind) for place, kind, _ in pairs]
    numbers = [number for _, _, number in found]
    names = [name for _, _, name in pairs]
    best = max(numbers)
    if numbers.count(best) > 1:
        raise Refused(f"there is no single most: {', '.join(map(str, numbers))}")
    options: dict[str, tuple[str, ...]] = dict.fromkeys(names, ())
    choice = Choice(value=names[numbers.index(best)], options=options, picks=("more", "most"))
    return _Worked(choice, tuple(seen for _, seen, _ in found), _visits(pairs), sum(numbers), ("sort:more",))


def _sum(draft: Draft, places: Sequence[Place]) -> _Worked:
    kind = _one(draft)
    if len(places) < 2:
        raise Refused("a sum is taken over several views")
    found = [_counted(place, kind) for place in places]
    shown = [item.instance for _, seen, _ in found for item in seen.items]
    if len(set(shown)) < len(shown):
        raise Refused("one thing shows in two of the views: its sum would be counted twice")
    total = sum(number for _, _, number in found)
    if not 0 < total <= MOST_COUNTED:
        raise Refused(f"the sum is {total}")
    number = Number(value=float(total), unit=unit_of(kind))
    visits = _visits([(place, kind, "") for place in places])
    return _Worked(number, tuple(seen for _, seen, _ in found), visits, total, ("sort:sum",))


def _action(draft: Draft, places: Sequence[Place]) -> _Worked:
    if draft.things or any(place.swept for place in places):
        raise Refused("an action looks at nothing and names no things")
    calls = places[-1].calls
    if not calls or (len(calls) == 1) != (draft.category == "single_call"):
        raise Refused("a single call is one move, a command of several steps is more")
    return _Worked(ActionOnly(), program=calls, tags=("sort:action",))


def _visits(pairs: Sequence[tuple[Place, Kind, str]]) -> tuple[ProgramCall, ...]:
    """The moves from view to view, with a count at each."""
    program, done = list[ProgramCall](), 0
    for place, kind, _ in pairs:
        program += [*place.calls[done:], count(many_of(kind), place)]
        done = len(place.calls)
    return tuple(program)


def _preset_of(place: Place) -> str:
    last = place.calls[-1] if place.calls else None
    if last is None or last.tool != "go_to_preset" or place.swept:
        raise Refused("views are compared by the names of their presets: each must be one")
    return str(last.arguments["name"])


_PROGRAMS: dict[str, Callable[[Draft, Sequence[Place]], _Worked]] = {
    "count": _count, "exists": _exists, "colour": _colour, "text": _text, "side": _side, "most": _most, "sum": _sum,
    "action": _action,
}  # fmt: skip
