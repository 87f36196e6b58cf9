"""Comparisons: more or fewer, nearer or farther, larger in the picture, in one view or between presets."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from itertools import combinations, pairwise

from scope_ptz.bench.tasks.expected import AnyExpected, Choice, Number, Options, Ordering, Relation, YesNo
from scope_ptz.bench.tasks.task import EvidenceView
from scope_ptz.taskgen.authoring.categories.counting_tasks import apart, counted, plain_counts
from scope_ptz.taskgen.authoring.drafts import Draft, Question, ask, count, same_form, view
from scope_ptz.taskgen.authoring.noun_phrases import about, listing, many_of, unit_of
from scope_ptz.taskgen.authoring.object_names import Named, distinct
from scope_ptz.taskgen.authoring.task_places import Place
from scope_ptz.taskgen.facts.kinds import GROUPS, Kind

SAME = ("the same", "equal", "as many", "equally many")
_NEARER, _LARGER = 1.5, 2.5
"""So many times as far, or as large in the picture, is beyond doubt."""


def drafts(place: Place, rng: random.Random) -> list[Draft]:
    """Comparisons within one view."""
    return [*_of_two(place, rng), *_of_several(place, rng), *_distances(place, rng), *_sizes(place, rng)]


def _of_two(place: Place, rng: random.Random) -> Iterator[Draft]:
    pairs = [
        (a, b)
        for a, b in combinations(counted(place.sight), 2)
        if not a[0].attribute
        and not b[0].attribute
        and bool(a[0].colour) == bool(b[0].colour) == (a[0].category == b[0].category)
        and min(a[1], b[1]) >= 2
        and a[1] + b[1] >= 5
        and apart(place.sight, (a[0], b[0]))
    ]
    rng.shuffle(pairs)
    for n, pair in enumerate(pairs[:14]):
        (one, many), (two, few) = rng.sample(pair, 2)
        first, second = many_of(one), many_of(two)
        seen = tuple(counted_view(place, kind, number) for kind, number in ((one, many), (two, few)))
        kind, expected, asked = (_excess, _more, _fewer, _compare, _whether)[n % 5](first, second, many, few)
        yield Draft(
            category="comparative",
            kind=kind,
            key=f"more:{'/'.join(sorted((first, second)))}",
            place=place,
            expected=expected,
            question=asked,
            evidence=seen,
            looks=(count(first, place), count(second, place)),
            tags=("counts",),
            weight=max(many, few),
            reads=_reads(expected),
        )


_Asked = tuple[str, AnyExpected, Question]


def _reads(expected: AnyExpected) -> str:
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


def _more(first: str, second: str, n: int, m: int) -> _Asked:
    winner = "same" if n == m else first if n > m else second
    expected = Choice(value=winner, options={first: (), second: (), "same": SAME}, picks=("more", "most"))
    forms = (
        (f"are there more {first} or more {second}?", f"whether there are more {first} or more {second}"),
        (f"what do you see more of, {first} or {second}?", f"what you see more of, {first} or {second}"),
        (f"which are more numerous, the {first} or the {second}?", f"which are more numerous, the {first} or the {second}"),
    )
    return "more", expected, Question(forms)


def _fewer(first: str, second: str, n: int, m: int) -> _Asked:
    if n == m:
        return _compare(first, second, n, m)
    expected = Choice(
        value=first if n < m else second, options={first: (), second: (), "same": SAME}, picks=("fewer", "fewest", "less", "least")
    )
    forms = (
        (f"are there fewer {first} or fewer {second}?", f"whether there are fewer {first} or fewer {second}"),
        (f"which are there fewer of, {first} or {second}?", f"which there are fewer of, {first} or {second}"),
    )
    return "fewer", expected, Question(forms)


def _excess(first: str, second: str, n: int, m: int) -> _Asked:
    if n <= m:
        return _compare(first, second, n, m)
    forms = (
        (f"how many more {first} than {second} are there?", f"how many more {first} than {second} there are"),
        (f"by how many do the {first} outnumber the {second}?", f"by how many the {first} outnumber the {second}"),
    )
    # No unit: the numbers of the two kinds must not be taken for what lies between them.
    return "excess", Number(value=n - m), Question(forms)


def _compare(first: str, second: str, n: int, m: int) -> _Asked:
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


def _whether(first: str, second: str, n: int, m: int) -> _Asked:
    expected = YesNo(value=n > m)
    forms = (
        (f"are there more {first} than {second}?", f"whether there are more {first} than {second}"),
        (f"do the {first} outnumber the {second}?", f"whether the {first} outnumber the {second}"),
    )
    return "whether-more", expected, Question(forms)


def counted_view(place: Place, kind: Kind, number: int) -> EvidenceView:
    """A view as evidence that there are so many of a kind."""
    items = [place.sight.item(t, True) for t in place.sight.of(kind) or ()]
    return view(place, Number(value=number, unit=unit_of(kind)), about(kind), items, whole=True)


def _of_several(place: Place, rng: random.Random) -> Iterator[Draft]:
    """What there is most of among four, and the order of three by number."""
    plain = [(kind, n) for kind, n in plain_counts(place.sight) if kind.category not in GROUPS]
    for size, most in ((3, 4), (4, 4)):
        groups = [
            group
            for group in combinations(plain, size)
            if _distinct([n for _, n in group], whole=size == 3) and apart(place.sight, [kind for kind, _ in group])
        ]
        rng.shuffle(groups)
        for group in groups[:most]:
            ranked = tuple(many_of(kind) for kind, _ in sorted(group, key=lambda t: -t[1]))
            shuffled = rng.sample(group, size)
            names = [many_of(kind) for kind, _ in shuffled]
            asked, expected = _ranking(names, ranked) if size == 3 else _most(names, ranked[0])
            yield Draft(
                category="comparative",
                kind="ranking" if size == 3 else "most-of",
                key=f"rank:{'/'.join(sorted(ranked))}",
                place=place,
                expected=expected,
                question=asked,
                evidence=tuple(counted_view(place, kind, n) for kind, n in shuffled),
                looks=tuple(count(name, place) for name in names),
                tags=("counts",),
                weight=sum(n for _, n in group),
                reads=_reads(expected),
            )


def _distinct(numbers: Sequence[int], *, whole: bool) -> bool:
    """Whether all numbers differ (or the greatest at least stands alone)."""
    return len(set(numbers)) == len(numbers) if whole else numbers.count(max(numbers)) == 1


def _ranking(names: list[str], ranked: tuple[str, ...]) -> tuple[Question, Ordering]:
    expected = Ordering(value=ranked, options=dict.fromkeys(ranked, ()), first=("most",), last=("fewest",))
    listed = listing(names)
    forms = (
        (f"how do {listed} rank by number, from most to fewest?", f"how {listed} rank by number, from most to fewest"),
        (f"put {listed} in order of how many there are, the most first.",
         f"the order of {listed} by how many there are, the most first"),
    )  # fmt: skip
    return Question(forms), expected


def _most(names: list[str], winner: str) -> tuple[Question, Choice]:
    listed = listing(names, "or")
    expected = Choice(value=winner, options=dict.fromkeys(names, ()), picks=("most", "more"))
    return Question(same_form(f"what is there most of: {listed}?", f"which are the most numerous: {listed}?")), expected


def _distances(place: Place, rng: random.Random) -> Iterator[Draft]:
    """Which of two to four things is nearest or farthest, and three in the order of their distance."""
    if place.swept:
        return
    named = distinct(place.sight)
    for size in (2, 3, 4):
        for group in _some(named, size, rng):
            ranked = sorted(group, key=lambda n: n.thing.distance_m)
            gaps = [b.thing.distance_m / max(a.thing.distance_m, 0.1) for a, b in pairwise(ranked)]
            if min(gaps if size < 4 else (gaps[0], gaps[-1])) >= _NEARER:
                names = [one.the for one in rng.sample(group, size)]
                yield from _by_distance(place, ranked, names, rng)


def _by_distance(place: Place, ranked: list[Named], names: list[str], rng: random.Random) -> Iterator[Draft]:
    options: Options = {one.name: () for one in ranked}
    either = listing(names, "or")
    near = rng.random() < 0.5
    way, winner = ("closest to", ranked[0]) if near else ("farthest from", ranked[-1])
    if len(ranked) == 2:
        way = "closer to" if near else "farther from"
    picks = ("closest", "closer", "nearest", "nearer") if near else ("farthest", "farther", "furthest", "further")
    choice = Choice(value=winner.name, options=options, picks=picks)
    asked = Question(same_form(f"which is {way} the camera, {either}?", f"what is {way} the camera: {either}?"))
    yield _seen(place, ("nearer" if near else "farther") if len(ranked) == 2 else "nearest-of", choice, asked, ranked, "distance")
    if len(ranked) == 3:
        order = Ordering(
            value=tuple(one.name for one in ranked), options=options, first=("nearest", "closest"), last=("farthest", "furthest")
        )
        listed = listing(names)
        yield _seen(place, "by-distance", order, Question((
            (f"put {listed} in order of distance, the nearest first.", f"the order of {listed} by distance, the nearest first"),
            (f"from nearest to farthest, how are {listed} placed?", f"how {listed} are placed, from nearest to farthest"),
        )), ranked, "distance")  # fmt: skip


def _sizes(place: Place, rng: random.Random) -> Iterator[Draft]:
    """Which of three or four takes up most of the picture: what shows decides, not what the things really measure."""
    if place.swept:
        return
    named = distinct(place.sight)
    for group in (*_some(named, 3, rng), *_some(named, 4, rng)):
        areas = {one.name: place.sight.areas(one.thing) for one in group}
        ranked = sorted(group, key=lambda one: areas[one.name][0], reverse=True)
        if min(areas[ranked[0].name]) < _LARGER * max(max(areas[one.name]) for one in ranked[1:]):
            continue
        either = listing([one.the for one in rng.sample(group, len(group))], "or")
        expected = Choice(value=ranked[0].name, options={one.name: () for one in ranked}, picks=("largest", "biggest", "most"))
        asked = Question(
            same_form(
                f"which looks largest in the picture: {either}?",
                f"which takes up the most room in the picture: {either}?",
                f"which appears biggest in the frame: {either}?",
            )
        )
        yield _seen(place, "largest", expected, asked, ranked, "size")


def _some(named: list[Named], size: int, rng: random.Random) -> list[tuple[Named, ...]]:
    """A few groups of things of different categories."""
    groups = [g for g in combinations(named[:12], size) if len({one.kind.category for one in g}) == size]
    rng.shuffle(groups)
    return groups[:12]


def _seen(place: Place, kind: str, expected: Choice | Ordering, asked: Question, things: list[Named], tag: str) -> Draft:
    """A comparison of things that one look tells."""
    ids = "/".join(sorted(one.thing.instance.id for one in things))
    measures = [one.thing.distance_m if tag == "distance" else float(one.thing.pixels) for one in things]
    items = [place.sight.item(one.thing, measure) for one, measure in zip(things, measures, strict=True)]
    wanted = "how far away is" if tag == "distance" else "where is"
    return Draft(
        category="comparative",
        kind=kind,
        key=f"{tag}:{ids}",
        place=place,
        expected=expected,
        question=asked,
        evidence=(view(place, expected, tuple(word for one in things for word in one.words), items, whole=False),),
        looks=tuple(ask(f"{wanted} {one.the}?", place) for one in things),
        tags=(tag,),
        weight=len(things),
        reads=_reads(expected),
    )
