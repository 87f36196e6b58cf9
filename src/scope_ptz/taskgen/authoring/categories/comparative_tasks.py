"""Comparative tasks within one view: more or fewer, nearer or farther, larger in the picture."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from itertools import combinations, pairwise

from scope_ptz.bench.tasks.expected import AnyExpected, Choice, Number, Options, Ordering, Relation, YesNo
from scope_ptz.bench.tasks.task import EvidenceView
from scope_ptz.taskgen.authoring.drafts import Question, TaskDraft, count_call, evidence_view, identical_forms, query_call
from scope_ptz.taskgen.authoring.noun_phrases import answer_words, join_names, object_words, plural_noun
from scope_ptz.taskgen.authoring.object_names import NamedThing, nameable_things
from scope_ptz.taskgen.authoring.task_places import TaskPlace
from scope_ptz.taskgen.authoring.view_contents import are_disjoint, category_counts, countable_kinds
from scope_ptz.taskgen.facts.kinds import GROUPS, Kind

SAME = ("the same", "equal", "as many", "equally many")
_MIN_DISTANCE_RATIO, _MIN_AREA_RATIO = 1.5, 2.5
"""Minimum ratio between distances, and between areas in the picture, for an unambiguous comparison."""


def drafts(place: TaskPlace, rng: random.Random) -> list[TaskDraft]:
    """Return drafts that compare objects within one view."""
    return [
        *_two_kind_drafts(place, rng),
        *_several_kind_drafts(place, rng),
        *_distance_drafts(place, rng),
        *_size_drafts(place, rng),
    ]


def _two_kind_drafts(place: TaskPlace, rng: random.Random) -> Iterator[TaskDraft]:
    """Yield drafts that compare the counts of two kinds."""
    pairs = [
        (a, b)
        for a, b in combinations(countable_kinds(place.truth), 2)
        if not a[0].attribute
        and not b[0].attribute
        and bool(a[0].colour) == bool(b[0].colour) == (a[0].category == b[0].category)
        and min(a[1], b[1]) >= 2
        and a[1] + b[1] >= 5
        and are_disjoint(place.truth, (a[0], b[0]))
    ]
    rng.shuffle(pairs)
    for n, pair in enumerate(pairs[:14]):
        (first_kind, first_count), (second_kind, second_count) = rng.sample(pair, 2)
        first, second = plural_noun(first_kind), plural_noun(second_kind)
        evidence_views = tuple(
            count_evidence(place, kind, number) for kind, number in ((first_kind, first_count), (second_kind, second_count))
        )
        question_type, expected, question = (
            _excess_question,
            _more_question,
            _fewer_question,
            _relation_question,
            _whether_more_question,
        )[n % 5](first, second, first_count, second_count)
        yield TaskDraft(
            category="comparative",
            question_type=question_type,
            key=f"more:{'/'.join(sorted((first, second)))}",
            place=place,
            expected=expected,
            question=question,
            evidence=evidence_views,
            perception_calls=(count_call(first, place), count_call(second, place)),
            tags=("counts",),
            object_count=max(first_count, second_count),
            answer_key=_answer_key(expected),
        )


_TypedQuestion = tuple[str, AnyExpected, Question]


def _answer_key(expected: AnyExpected) -> str:
    match expected:
        case YesNo():
            return "yes" if expected.value else "no"
        case Choice() | Relation():
            return expected.value
        case Ordering():
            return "/".join(expected.value)
        case Number():
            return f"{expected.value:g}"
    return expected.kind


def _more_question(first: str, second: str, n: int, m: int) -> _TypedQuestion:
    winner = "same" if n == m else first if n > m else second
    expected = Choice(value=winner, options={first: (), second: (), "same": SAME}, picks=("more", "most"))
    forms = (
        (f"are there more {first} or more {second}?", f"whether there are more {first} or more {second}"),
        (f"what do you see more of, {first} or {second}?", f"what you see more of, {first} or {second}"),
        (f"which are more numerous, the {first} or the {second}?", f"which are more numerous, the {first} or the {second}"),
    )
    return "more", expected, Question(forms)


def _fewer_question(first: str, second: str, n: int, m: int) -> _TypedQuestion:
    if n == m:
        return _relation_question(first, second, n, m)
    expected = Choice(
        value=first if n < m else second, options={first: (), second: (), "same": SAME}, picks=("fewer", "fewest", "less", "least")
    )
    forms = (
        (f"are there fewer {first} or fewer {second}?", f"whether there are fewer {first} or fewer {second}"),
        (f"which are there fewer of, {first} or {second}?", f"which there are fewer of, {first} or {second}"),
    )
    return "fewer", expected, Question(forms)


def _excess_question(first: str, second: str, n: int, m: int) -> _TypedQuestion:
    if n <= m:
        return _relation_question(first, second, n, m)
    forms = (
        (f"how many more {first} than {second} are there?", f"how many more {first} than {second} there are"),
        (f"by how many do the {first} outnumber the {second}?", f"by how many the {first} outnumber the {second}"),
    )
    # The answer has no unit, so that a reply with the two counts is not parsed as their difference.
    return "excess", Number(value=n - m), Question(forms)


def _relation_question(first: str, second: str, n: int, m: int) -> _TypedQuestion:
    expected = Relation(
        value="same" if n == m else "forward" if n > m else "backward", subject=(first,), object=(second,),
        forward=("more", "greater", "higher"), backward=("fewer", "smaller", "lower", "less"), same=SAME,
    )  # fmt: skip
    forms = (
        (f"how does the number of {first} compare with that of {second}?",
         f"how the number of {first} compares with that of {second}"),
        (f"are there more {first} than {second}, fewer, or just as many?",
         f"whether there are more {first} than {second}, fewer, or just as many"),
    )  # fmt: skip
    return "compare", expected, Question(forms)


def _whether_more_question(first: str, second: str, n: int, m: int) -> _TypedQuestion:
    expected = YesNo(value=n > m)
    forms = (
        (f"are there more {first} than {second}?", f"whether there are more {first} than {second}"),
        (f"do the {first} outnumber the {second}?", f"whether the {first} outnumber the {second}"),
    )
    return "whether-more", expected, Question(forms)


def count_evidence(place: TaskPlace, kind: Kind, number: int) -> EvidenceView:
    """Return a view as evidence for the number of objects of a kind."""
    items = [place.truth.item(t, True) for t in place.truth.all_of(kind) or ()]
    return evidence_view(place, Number(value=number, unit=answer_words(kind)), object_words(kind), items, whole=True)


def _several_kind_drafts(place: TaskPlace, rng: random.Random) -> Iterator[TaskDraft]:
    """Yield questions about the most numerous of four kinds, and about the order of three kinds by number."""
    plain = [(kind, n) for kind, n in category_counts(place.truth) if kind.category not in GROUPS]
    for size, max_groups in ((3, 4), (4, 4)):
        groups = [
            group
            for group in combinations(plain, size)
            if _is_unambiguous([n for _, n in group], full_ranking=size == 3)
            and are_disjoint(place.truth, [kind for kind, _ in group])
        ]
        rng.shuffle(groups)
        for group in groups[:max_groups]:
            ranked = tuple(plural_noun(kind) for kind, _ in sorted(group, key=lambda t: -t[1]))
            shuffled = rng.sample(group, size)
            names = [plural_noun(kind) for kind, _ in shuffled]
            question, expected = _ranking_question(names, ranked) if size == 3 else _most_question(names, ranked[0])
            yield TaskDraft(
                category="comparative",
                question_type="ranking" if size == 3 else "most-of",
                key=f"rank:{'/'.join(sorted(ranked))}",
                place=place,
                expected=expected,
                question=question,
                evidence=tuple(count_evidence(place, kind, n) for kind, n in shuffled),
                perception_calls=tuple(count_call(name, place) for name in names),
                tags=("counts",),
                object_count=sum(n for _, n in group),
                answer_key=_answer_key(expected),
            )


def _is_unambiguous(numbers: Sequence[int], *, full_ranking: bool) -> bool:
    """Return whether all numbers differ (with ``full_ranking``), or whether the greatest number occurs only once."""
    return len(set(numbers)) == len(numbers) if full_ranking else numbers.count(max(numbers)) == 1


def _ranking_question(names: list[str], ranked: tuple[str, ...]) -> tuple[Question, Ordering]:
    expected = Ordering(value=ranked, options=dict.fromkeys(ranked, ()), first=("most",), last=("fewest",))
    listed = join_names(names)
    forms = (
        (f"how do {listed} rank by number, from most to fewest?", f"how {listed} rank by number, from most to fewest"),
        (f"put {listed} in order of how many there are, the most first.",
         f"the order of {listed} by how many there are, the most first"),
    )  # fmt: skip
    return Question(forms), expected


def _most_question(names: list[str], winner: str) -> tuple[Question, Choice]:
    listed = join_names(names, "or")
    expected = Choice(value=winner, options=dict.fromkeys(names, ()), picks=("most", "more"))
    return Question(identical_forms(f"what is there most of: {listed}?", f"which are the most numerous: {listed}?")), expected


def _distance_drafts(place: TaskPlace, rng: random.Random) -> Iterator[TaskDraft]:
    """Yield questions about the nearest or farthest of two to four objects, and about the order of three by distance."""
    if place.swept:
        return
    named = nameable_things(place.truth)
    for size in (2, 3, 4):
        for group in _groups(named, size, rng):
            ranked = sorted(group, key=lambda n: n.thing.distance_m)
            gaps = [b.thing.distance_m / max(a.thing.distance_m, 0.1) for a, b in pairwise(ranked)]
            if min(gaps if size < 4 else (gaps[0], gaps[-1])) >= _MIN_DISTANCE_RATIO:
                names = [target.with_the for target in rng.sample(group, size)]
                yield from _drafts_by_distance(place, ranked, names, rng)


def _drafts_by_distance(place: TaskPlace, ranked: list[NamedThing], names: list[str], rng: random.Random) -> Iterator[TaskDraft]:
    options: Options = {target.name: () for target in ranked}
    alternatives = join_names(names, "or")
    near = rng.random() < 0.5
    phrase, winner = ("closest to", ranked[0]) if near else ("farthest from", ranked[-1])
    if len(ranked) == 2:
        phrase = "closer to" if near else "farther from"
    picks = ("closest", "closer", "nearest", "nearer") if near else ("farthest", "farther", "furthest", "further")
    choice = Choice(value=winner.name, options=options, picks=picks)
    question = Question(
        identical_forms(f"which is {phrase} the camera, {alternatives}?", f"what is {phrase} the camera: {alternatives}?")
    )
    yield _comparison_draft(
        place, ("nearer" if near else "farther") if len(ranked) == 2 else "nearest-of", choice, question, ranked, "distance"
    )
    if len(ranked) == 3:
        order = Ordering(
            value=tuple(target.name for target in ranked),
            options=options,
            first=("nearest", "closest"),
            last=("farthest", "furthest"),
        )
        listed = join_names(names)
        yield _comparison_draft(place, "by-distance", order, Question((
            (f"put {listed} in order of distance, the nearest first.", f"the order of {listed} by distance, the nearest first"),
            (f"from nearest to farthest, how are {listed} placed?", f"how {listed} are placed, from nearest to farthest"),
        )), ranked, "distance")  # fmt: skip


def _size_drafts(place: TaskPlace, rng: random.Random) -> Iterator[TaskDraft]:
    """Yield questions about which of three or four objects looks largest in the picture."""
    if place.swept:
        return
    named = nameable_things(place.truth)
    for group in (*_groups(named, 3, rng), *_groups(named, 4, rng)):
        areas = {target.name: place.truth.areas(target.thing) for target in group}
        ranked = sorted(group, key=lambda target: areas[target.name][0], reverse=True)
        if min(areas[ranked[0].name]) < _MIN_AREA_RATIO * max(max(areas[target.name]) for target in ranked[1:]):
            continue
        alternatives = join_names([target.with_the for target in rng.sample(group, len(group))], "or")
        expected = Choice(
            value=ranked[0].name, options={target.name: () for target in ranked}, picks=("largest", "biggest", "most")
        )
        question = Question(
            identical_forms(
                f"which looks largest in the picture: {alternatives}?",
                f"which takes up the most room in the picture: {alternatives}?",
                f"which appears biggest in the frame: {alternatives}?",
            )
        )
        yield _comparison_draft(place, "largest", expected, question, ranked, "size")


def _groups(named: list[NamedThing], size: int, rng: random.Random) -> list[tuple[NamedThing, ...]]:
    """Return up to twelve groups of objects from different categories."""
    groups = [g for g in combinations(named[:12], size) if len({target.kind.category for target in g}) == size]
    rng.shuffle(groups)
    return groups[:12]


def _comparison_draft(
    place: TaskPlace, question_type: str, expected: Choice | Ordering, question: Question, things: list[NamedThing], tag: str
) -> TaskDraft:
    """Return a draft that compares single objects in one view."""
    ids = "/".join(sorted(target.thing.instance.id for target in things))
    measures = [target.thing.distance_m if tag == "distance" else float(target.thing.pixels) for target in things]
    items = [place.truth.item(target.thing, measure) for target, measure in zip(things, measures, strict=True)]
    lookup = "how far away is" if tag == "distance" else "where is"
    return TaskDraft(
        category="comparative",
        question_type=question_type,
        key=f"{tag}:{ids}",
        place=place,
        expected=expected,
        question=question,
        evidence=(evidence_view(place, expected, tuple(word for target in things for word in target.words), items, whole=False),),
        perception_calls=tuple(query_call(f"{lookup} {target.with_the}?", place) for target in things),
        tags=(tag,),
        object_count=len(things),
        answer_key=_answer_key(expected),
    )
