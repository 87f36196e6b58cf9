"""Location: halves and corners of the frame, left and right of each other, order across the view."""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import combinations

from scope_ptz.bench.authoring.counting import absent, counted
from scope_ptz.bench.authoring.drafts import Draft, Question, ask, count, view
from scope_ptz.bench.authoring.naming import Named, singles
from scope_ptz.bench.authoring.places import Place
from scope_ptz.bench.authoring.words import about, article, listing, noun_of, plural, unit_of
from scope_ptz.bench.expected import Choice, NoneThere, Number, Options, Ordering, YesNo
from scope_ptz.bench.ground import Kind

_SIDES: tuple[tuple[str, str], ...] = (("left", "right"), ("upper", "lower"))
_SIDE_OPTIONS: tuple[Options, Options] = (
    {"left": ("left half", "left-hand side", "left side"), "right": ("right half", "right-hand side", "right side")},
    {"upper": ("upper half", "top half", "top"), "lower": ("lower half", "bottom half", "bottom")},
)


def drafts(place: Place, nouns: frozenset[str], rng: random.Random) -> list[Draft]:
    if place.swept:
        return []
    named = singles(place.sight, coloured=True)
    return [
        *_halves(place, named),
        *_corners(place, named),
        *_relations(place, named),
        *_order(place, named, rng),
        *_in_half(place),
        *_in_half_pairs(place, nouns, rng),
    ]


def _halves(place: Place, named: list[Named]) -> Iterator[Draft]:
    for one in named:
        for axis in (0, 1):
            side = place.sight.side(one.thing, axis)
            if side is None:
                continue
            first, second = _SIDES[axis]
            expected = Choice(value=_SIDES[axis][side], options=_SIDE_OPTIONS[axis])
            yield _about(
                place,
                one,
                f"half-{axis}",
                expected,
                (
                    (
                        f"is the {one.name} in the {first} or the {second} half of the picture?",
                        f"whether the {one.name} is in the {first} or the {second} half of the picture",
                    ),
                    (
                        f"which half of the frame holds the {one.name}, {first} or {second}?",
                        f"which half of the frame holds the {one.name}, {first} or {second}",
                    ),
                    (
                        f"on which side of the view, {first} or {second}, is the {one.name}?",
                        f"on which side of the view the {one.name} is, {first} or {second}",
                    ),
                ),
            )


def _corners(place: Place, named: list[Named]) -> Iterator[Draft]:
    corners: Options = {
        f"{level} {side}": (f"{level}-{side}", f"{other} {side}", f"{other}-{side}")
        for level, other in (("top", "upper"), ("bottom", "lower"))
        for side in ("left", "right")
    }
    for one in named:
        side, level = place.sight.side(one.thing, 0), place.sight.side(one.thing, 1)
        if side is None or level is None:
            continue
        expected = Choice(value=f"{('top', 'bottom')[level]} {('left', 'right')[side]}", options=corners)
        yield _about(
            place,
            one,
            "quarter",
            expected,
            (
                (
                    f"in which quarter of the picture is the {one.name}: top left, top right, bottom left or bottom right?",
                    f"in which quarter of the picture the {one.name} is: top left, top right, bottom left or bottom right",
                ),
                (
                    f"where in the frame is the {one.name}, top left, top right, bottom left or bottom right?",
                    f"which quarter of the frame holds the {one.name}: top left, top right, bottom left or bottom right",
                ),
            ),
        )


def _relations(place: Place, named: list[Named]) -> Iterator[Draft]:
    for one, two in combinations(named, 2):
        order = place.sight.in_order((one.thing, two.thing), 0, 0.08)
        if order is None or one.kind.category == two.kind.category:
            continue
        value = "left" if order[0] is one.thing else "right"
        expected = Choice(value=value, options={"left": ("to the left", "left of"), "right": ("to the right", "right of")})
        asked = Question(
            (
                (
                    f"is the {one.name} to the left or to the right of the {two.name}?",
                    f"whether the {one.name} is to the left or to the right of the {two.name}",
                ),
                (
                    f"on which side of the {two.name} is the {one.name}, left or right?",
                    f"on which side of the {two.name} the {one.name} is, left or right",
                ),
            )
        )
        items = [place.sight.item(n.thing) for n in (one, two)]
        yield Draft(
            category="location",
            kind="beside",
            key=f"beside:{one.thing.instance.id}:{two.thing.instance.id}",
            place=place,
            expected=expected,
            question=asked,
            evidence=(view(place, expected, about(one.kind, two.kind), items, whole=False),),
            looks=(ask(asked.forms[0][0], place),),
            tags=("relation",),
            reads=value,
        )


def _order(place: Place, named: list[Named], rng: random.Random) -> Iterator[Draft]:
    distinct = list({n.kind.category: n for n in named}.values())
    for three in list(combinations(distinct, 3))[:6]:
        order = place.sight.in_order([n.thing for n in three], 0, 0.06)
        if order is None:
            continue
        names = {n.thing.instance.id: n.name for n in three}
        value = tuple(names[s.instance.id] for s in order)
        shuffled = list(value)
        rng.shuffle(shuffled)
        listed = listing([f"the {name}" for name in shuffled])
        items = [place.sight.item(n.thing) for n in three]
        sets: list[tuple[str, Ordering | Choice, Question]] = [
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
                Choice(value=value[0], options=dict.fromkeys(value, ())),
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
        for kind, expected, asked in sets:
            yield Draft(
                category="location",
                kind=kind,
                key=f"{kind}:{'/'.join(sorted(value))}",
                place=place,
                expected=expected,
                question=asked,
                evidence=(view(place, expected, about(*(n.kind for n in three)), items, whole=False),),
                looks=(ask(asked.forms[0][0], place),),
                tags=("order",),
                weight=3,
                reads=value[0],
            )


def _in_half(place: Place) -> Iterator[Draft]:
    for kind, total in counted(place.sight):
        sides = [place.sight.side(t, 0, 0.03) for t in place.sight.of(kind) or ()]
        if total < 2 or None in sides or len(set(sides)) == 1:
            continue
        for side, name in enumerate(_SIDES[0]):
            many, number = plural(noun_of(kind)), sides.count(side)
            expected = Number(value=number, unit=unit_of(kind), part=True)
            things = [t for t, s in zip(place.sight.of(kind) or (), sides, strict=True) if s == side]
            yield Draft(
                category="location",
                kind="count-half",
                key=f"half-count:{noun_of(kind)}:{name}",
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
                evidence=(view(place, expected, about(kind), [place.sight.item(t, True) for t in things], whole=True),),
                looks=(count(f"{many} in the {name} half", place),),
                tags=("half",),
                weight=number,
                reads=str(number),
            )


def _in_half_pairs(place: Place, nouns: frozenset[str], rng: random.Random) -> Iterator[Draft]:
    here = [
        (k, s)
        for k, _ in counted(place.sight)
        if len(s := {place.sight.side(t, 0) for t in place.sight.of(k) or ()}) == 1 and None not in s
    ]
    gone = list(absent(place.sight, nouns))
    rng.shuffle(gone)
    for (kind, sides), missing in zip(here, gone, strict=False):
        side = _SIDES[0][next(iter(sides)) or 0]
        yield _half_pair(place, missing, side, there=False, twin=_half_pair(place, kind, side, there=True))


def _half_pair(place: Place, kind: Kind, side: str, *, there: bool, twin: Draft | None = None) -> Draft:
    one, many = noun_of(kind), plural(noun_of(kind))
    expected = YesNo(value=True, affirms=unit_of(kind)[:2]) if there else NoneThere(subject=unit_of(kind)[:2])
    items = [place.sight.item(t, True) for t in (place.sight.of(kind) or ())[:1]] if there else []
    return Draft(
        category="location",
        kind="half-there" if there else "half-none",
        key=f"half-there:{one}:{side}",
        place=place,
        expected=expected,
        question=Question(
            (
                (
                    f"is there {article(one)} in the {side} half of the picture?",
                    f"whether there is {article(one)} in the {side} half of the picture",
                ),
                (
                    f"are there any {many} on the {side} side of the frame?",
                    f"whether there are any {many} on the {side} side of the frame",
                ),
            )
        ),
        evidence=(view(place, expected, about(kind), items, whole=not there),),
        looks=(ask(f"are there any {many} in the {side} half of the picture?", place),),
        tags=("presence",) if there else ("none-there",),
        twin=twin,
        reads="yes" if there else "none",
    )


def _about(place: Place, one: Named, kind: str, expected: Choice, forms: tuple[tuple[str, str], ...]) -> Draft:
    return Draft(
        category="location",
        kind=kind,
        key=f"{kind}:{one.thing.instance.id}",
        place=place,
        expected=expected,
        question=Question(forms),
        evidence=(view(place, expected, about(one.kind), [place.sight.item(one.thing, expected.value)], whole=False),),
        looks=(ask(forms[0][0], place),),
        tags=("frame",),
        reads=expected.value,
    )
