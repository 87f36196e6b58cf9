"""Location tasks: halves and quarters of the frame, objects to the left or right of others, and order from left to right."""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import combinations

from scope_ptz.bench.tasks.expected import Choice, Number, Options, Ordering, Relation, YesNo
from scope_ptz.taskgen.authoring.categories import location_pairs
from scope_ptz.taskgen.authoring.categories.location_pairs import quarter_options
from scope_ptz.taskgen.authoring.drafts import Question, TaskDraft, count_call, evidence_view, query_call
from scope_ptz.taskgen.authoring.noun_phrases import answer_words, join_names, object_words, plural_noun, singular_noun, with_the
from scope_ptz.taskgen.authoring.object_names import NamedThing, nameable_things
from scope_ptz.taskgen.authoring.task_places import TaskPlace
from scope_ptz.taskgen.authoring.view_contents import countable_kinds

_SIDES: tuple[tuple[str, str], ...] = (("left", "right"), ("upper", "lower"))
_SIDE_OPTIONS: tuple[Options, Options] = (
    {"left": ("left half", "left-hand side", "left side"), "right": ("right half", "right-hand side", "right side")},
    {"upper": ("upper half", "top half", "top", "above"), "lower": ("lower half", "bottom half", "bottom", "below")},
)


def drafts(place: TaskPlace, nouns: frozenset[str], rng: random.Random) -> list[TaskDraft]:
    """Return drafts that ask where objects are in a view; none for a sweep."""
    if place.swept:
        return []
    named = nameable_things(place.truth)
    return [
        *_half_drafts(place, named),
        *_quarter_drafts(place, named),
        *_relation_drafts(place, named, rng),
        *_order_drafts(place, named, rng),
        *_half_count_drafts(place),
        *location_pairs.drafts(place, named, nouns, rng),
    ]


def _half_drafts(place: TaskPlace, named: list[NamedThing]) -> Iterator[TaskDraft]:
    for target in named:
        for axis in (0, 1):
            side = place.truth.side(target.thing, axis)
            if side is None:
                continue
            expected = Choice(value=_SIDES[axis][side], options=_SIDE_OPTIONS[axis])
            yield _location_draft(
                place,
                target,
                f"half-{axis}",
                expected,
                _half_forms(target.with_the, axis),
            )


def _half_forms(name: str, axis: int) -> tuple[tuple[str, str], ...]:
    first, second = _SIDES[axis]
    if axis == 0:
        return (
            (f"on which side of the picture is {name}?", f"on which side of the picture {name} is"),
            (f"in which half of the frame is {name}, {second} or {first}?", f"in which half of the frame {name} is"),
            (f"is {name} in the {first} or the {second} half of the picture?",
             f"whether {name} is in the {first} or the {second} half of the picture"),
        )  # fmt: skip
    return (
        (f"is {name} in the {first} or the {second} half of the picture?",
         f"whether {name} is in the {first} or the {second} half of the picture"),
        (f"is {name} above or below the middle of the frame?", f"whether {name} is above or below the middle of the frame"),
    )  # fmt: skip


def _quarter_drafts(place: TaskPlace, named: list[NamedThing]) -> Iterator[TaskDraft]:
    for target in named:
        side, level = place.truth.side(target.thing, 0), place.truth.side(target.thing, 1)
        if side is None or level is None:
            continue
        expected = Choice(value=f"{('top', 'bottom')[level]} {('left', 'right')[side]}", options=quarter_options())
        yield _location_draft(
            place,
            target,
            "quarter",
            expected,
            (
                (f"in which quarter of the picture is {target.with_the}?", f"in which quarter of the picture {target.with_the} is"),
                (
                    f"where in the frame is {target.with_the}: top left, top right, bottom left or bottom right?",
                    f"which quarter of the frame holds {target.with_the}",
                ),
            ),
        )


def _relation_drafts(place: TaskPlace, named: list[NamedThing], rng: random.Random) -> Iterator[TaskDraft]:
    for target, other in (tuple(rng.sample(pair, 2)) for pair in combinations(named, 2)):
        order = place.truth.sort_by_position((target.thing, other.thing), 0, 0.08)
        if order is None or target.kind.category == other.kind.category:
            continue
        is_left = order[0] is target.thing
        expected: Relation | YesNo
        if rng.random() < 0.6:
            kind, expected = (
                "beside",
                Relation(
                    value="forward" if is_left else "backward",
                    subject=(target.name,),
                    object=(other.name,),
                    forward=("left",),
                    backward=("right",),
                ),
            )
            question = Question(
                (
                    (f"on which side of {other.with_the} is {target.with_the}?",
                     f"on which side of {other.with_the} {target.with_the} is"),
                    (f"is {target.with_the} to the left or to the right of {other.with_the}?",
                     f"whether {target.with_the} is to the left or to the right of {other.with_the}"),
                )
            )  # fmt: skip
        else:
            kind, side = "is-beside", rng.choice(("left", "right"))
            expected = YesNo(value=(side == "left") == is_left)
            question = Question(
                (
                    (f"is {target.with_the} to the {side} of {other.with_the}?",
                     f"whether {target.with_the} is to the {side} of {other.with_the}"),
                    (f"does {target.with_the} appear to the {side} of {other.with_the}?",
                     f"whether {target.with_the} appears to the {side} of {other.with_the}"),
                )
            )  # fmt: skip
        items = [place.truth.item(n.thing) for n in (target, other)]
        yield TaskDraft(
            category="location",
            question_type=kind,
            key=f"beside:{target.thing.instance.id}:{other.thing.instance.id}",
            place=place,
            expected=expected,
            question=question,
            evidence=(evidence_view(place, expected, (*target.words, *other.words), items, whole=False),),
            perception_calls=(query_call(question.forms[0][0], place),),
            tags=("relation",),
            answer_key=("yes" if expected.value else "no") if isinstance(expected, YesNo) else "left" if is_left else "right",
        )


def _order_drafts(place: TaskPlace, named: list[NamedThing], rng: random.Random) -> Iterator[TaskDraft]:
    one_per_category = list({n.kind.category: n for n in named}.values())
    for triple in list(combinations(one_per_category, 3))[:6]:
        order = place.truth.sort_by_position([n.thing for n in triple], 0, 0.06)
        if order is None:
            continue
        names = {n.thing.instance.id: n.name for n in triple}
        value = tuple(names[s.instance.id] for s in order)
        shuffled = list(value)
        rng.shuffle(shuffled)
        listed = join_names([with_the(name) for name in shuffled])
        items = [place.truth.item(n.thing) for n in triple]
        variants: list[tuple[str, Ordering | Choice, Question]] = [
            (
                "row",
                Ordering(value=value, options=dict.fromkeys(value, ()), first=("left", "leftmost"), last=("right", "rightmost")),
                Question(
                    (
                        (
                            f"from left to right, in which order do {listed} appear?",
                            f"in which order {listed} appear from left to right",
                        ),
                        (f"what is the order of {listed}, going from left to right?", f"the order of {listed} from left to right"),
                    )
                ),
            ),
            (
                "furthest",
                Choice(
                    value=value[0], options=dict.fromkeys(value, ()), picks=("leftmost", "furthest left", "furthest to the left")
                ),
                Question(
                    (
                        (
                            f"which is furthest to the left: {listed.replace(' and ', ' or ')}?",
                            f"which is furthest to the left: {listed.replace(' and ', ' or ')}",
                        ),
                        (f"out of {listed}, which one is the furthest left?", f"which one of {listed} is the furthest left"),
                    )
                ),
            ),
        ]
        for kind, expected, question in variants:
            yield TaskDraft(
                category="location",
                question_type=kind,
                key=f"{kind}:{'/'.join(sorted(value))}",
                place=place,
                expected=expected,
                question=question,
                evidence=(evidence_view(place, expected, tuple(w for n in triple for w in n.words), items, whole=False),),
                perception_calls=tuple(query_call(f"where is {n.with_the}?", place) for n in triple),
                tags=("order",),
                object_count=3,
                answer_key="/".join(value) if kind == "row" else value[0],
            )


def _half_count_drafts(place: TaskPlace) -> Iterator[TaskDraft]:
    for kind, total in countable_kinds(place.truth):
        sides = [place.truth.side(t, 0, 0.03) for t in place.truth.all_of(kind) or ()]
        if total < 2 or kind.attribute or None in sides or len(set(sides)) == 1:
            continue
        for side, name in enumerate(_SIDES[0]):
            many, number = plural_noun(kind), sides.count(side)
            expected = Number(value=number, unit=answer_words(kind), part=True)
            things = [t for t, s in zip(place.truth.all_of(kind) or (), sides, strict=True) if s == side]
            yield TaskDraft(
                category="location",
                question_type="count-half",
                key=f"half-count:{singular_noun(kind)}:{name}",
                place=place,
                expected=expected,
                question=Question(
                    (
                        (
                            f"how many {many} are in the {name} half of the picture?",
                            f"how many {many} are in the {name} half of the picture",
                        ),
                        (
                            f"how many {many} do you see on the {name} side of the frame?",
                            f"how many {many} there are on the {name} side of the frame",
                        ),
                    )
                ),
                evidence=(
                    evidence_view(place, expected, object_words(kind), [place.truth.item(t, True) for t in things], whole=True),
                ),
                perception_calls=(count_call(f"{many} in the {name} half", place),),
                tags=("half",),
                object_count=number,
                answer_key=str(number),
            )


def _location_draft(
    place: TaskPlace, target: NamedThing, question_type: str, expected: Choice, forms: tuple[tuple[str, str], ...]
) -> TaskDraft:
    return TaskDraft(
        category="location",
        question_type=question_type,
        key=f"{question_type}:{target.thing.instance.id}",
        place=place,
        expected=expected,
        question=Question(forms),
        evidence=(evidence_view(place, expected, target.words, [place.truth.item(target.thing, expected.value)], whole=False),),
        perception_calls=(query_call(forms[0][0], place),),
        tags=("frame",),
        answer_key=expected.value,
    )
