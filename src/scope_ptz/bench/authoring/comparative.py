"""Comparisons: more or fewer, nearer or farther, taller, in one view or between two."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from itertools import combinations

from scope_ptz.bench.authoring.counting import counted
from scope_ptz.bench.authoring.drafts import Draft, Question, ask, count, view
from scope_ptz.bench.authoring.naming import singles
from scope_ptz.bench.authoring.places import Place, elsewhere, go
from scope_ptz.bench.authoring.words import about, listing, noun_of, plural, unit_of
from scope_ptz.bench.expected import Choice, Number, Options, Ordering
from scope_ptz.bench.ground import Kind
from scope_ptz.bench.tasks import EvidenceView
from scope_ptz.world.models import SceneInstance

SAME = ("the same", "equal", "as many", "equally many")


def drafts(place: Place, rng: random.Random) -> list[Draft]:
    """Comparisons within one view."""
    return [*_more(place, rng), *_ranking(place, rng), *_nearer(place), *_taller(place)]


def options(names: Sequence[str]) -> Options:
    return {**dict.fromkeys(names, ()), "same": SAME}


def _more(place: Place, rng: random.Random) -> Iterator[Draft]:
    pairs = [
        (a, b)
        for a, b in combinations(counted(place.sight), 2)
        if (a[0].category != b[0].category or (a[0].colour and b[0].colour)) and a[1] + b[1] >= 3
    ]
    rng.shuffle(pairs)
    for (one, n), (two, m) in pairs[:12]:
        first, second = plural(noun_of(one)), plural(noun_of(two))
        fewer = rng.random() < 0.4 and n != m
        word, best = ("fewer", "fewest") if fewer else ("more", "most")
        winner = "same" if n == m else first if (n > m) != fewer else second
        expected = Choice(value=winner, options={first: (), second: (), "same": SAME}, picks=(word, best))
        asked = Question(
            (
                (
                    f"are there {word} {first} or {word} {second}?",
                    f"whether there are {word} {first} or {word} {second}",
                ),
                (
                    f"which are there {word} of, {first} or {second}?",
                    f"which there are {word} of, {first} or {second}",
                ),
                (f"do you see {word} {first} or {second}?", f"if there are {word} {first} or {second}"),
            )
        )
        yield Draft(
            category="comparative",
            kind=f"{word}-around" if place.swept else word,
            key=f"more:{'/'.join(sorted((first, second)))}",
            place=place,
            expected=expected,
            question=asked,
            evidence=tuple(_counted_view(place, kind, number) for kind, number in ((one, n), (two, m))),
            looks=(count(first, place), count(second, place)),
            tags=("counts",),
            weight=max(n, m),
            reads=winner,
        )


def _counted_view(place: Place, kind: Kind, number: int) -> EvidenceView:
    items = [place.sight.item(t, True) for t in place.sight.of(kind) or ()]
    return view(place, Number(value=number, unit=unit_of(kind)), about(kind), items, whole=True)


def _ranking(place: Place, rng: random.Random) -> Iterator[Draft]:
    plain = [(kind, n) for kind, n in counted(place.sight) if kind.colour is None]
    threes = [three for three in combinations(plain, 3) if len({n for _, n in three}) == 3]
    rng.shuffle(threes)
    for three in threes[:4]:
        ranked = sorted(three, key=lambda t: -t[1])
        value = tuple(plural(noun_of(kind)) for kind, _ in ranked)
        names = [plural(noun_of(kind)) for kind, _ in three]
        expected = Ordering(value=value, options=dict.fromkeys(value, ()), first=("most",), last=("fewest",))
        asked = Question(
            (
                (
                    f"how do {listing(names)} rank by number, from most to fewest?",
                    f"how {listing(names)} rank by number, from most to fewest",
                ),
                (
                    f"what is the order of {listing(names)} by how many there are, the most first?",
                    f"the order of {listing(names)} by how many there are, the most first",
                ),
            )
        )
        yield Draft(
            category="comparative",
            kind="ranking",
            key=f"rank:{'/'.join(sorted(value))}",
            place=place,
            expected=expected,
            question=asked,
            evidence=tuple(_counted_view(place, kind, n) for kind, n in three),
            looks=tuple(count(name, place) for name in names),
            tags=("counts",),
            weight=sum(n for _, n in three),
            reads=value[0],
        )


def _nearer(place: Place) -> Iterator[Draft]:
    if place.swept:
        return
    for one, two in combinations(singles(place.sight, coloured=True), 2):
        near, far = sorted((one, two), key=lambda n: n.thing.distance_m)
        if far.thing.distance_m < near.thing.distance_m * 1.35 or one.kind.category == two.kind.category:
            continue
        for word, value in (("closer to", near.name), ("farther from", far.name)):
            asked = Question(
                (
                    (
                        f"which is {word} the camera, the {one.name} or the {two.name}?",
                        f"which is {word} the camera, the {one.name} or the {two.name}",
                    ),
                    (
                        f"what stands {word} the camera: the {one.name} or the {two.name}?",
                        f"what stands {word} the camera, the {one.name} or the {two.name}",
                    ),
                )
            )
            expected = Choice(
                value=value,
                options={one.name: (), two.name: ()},
                picks=("closer", "nearer") if value == near.name else ("farther", "further"),
            )
            yield Draft(
                category="comparative",
                kind="nearer" if value == near.name else "farther",
                key=f"distance:{one.thing.instance.id}:{two.thing.instance.id}",
                place=place,
                expected=expected,
                question=asked,
                evidence=(
                    view(
                        place,
                        expected,
                        about(one.kind, two.kind),
                        [place.sight.item(n.thing, n.thing.distance_m) for n in (one, two)],
                        whole=False,
                    ),
                ),
                looks=(ask(asked.forms[0][0], place),),
                tags=("distance",),
                weight=2,
                reads=value,
            )


def _taller(place: Place) -> Iterator[Draft]:
    if place.swept:
        return
    for one, two in combinations(singles(place.sight, coloured=True), 2):
        a, b = one.thing.instance, two.thing.instance
        if not isinstance(a, SceneInstance) or not isinstance(b, SceneInstance) or a.category == b.category:
            continue
        heights = [t.box_max_m[2] - t.box_min_m[2] for t in (a, b)]
        if max(heights) < 1.6 * min(heights) or a.parent or b.parent:
            continue
        value = (one if heights[0] > heights[1] else two).name
        asked = Question(
            (
                (
                    f"which is taller in reality, the {one.name} or the {two.name}?",
                    f"which is taller in reality, the {one.name} or the {two.name}",
                ),
                (
                    f"what is the higher thing, the {one.name} or the {two.name}?",
                    f"which is the higher thing, the {one.name} or the {two.name}",
                ),
            )
        )
        expected = Choice(value=value, options={one.name: (), two.name: ()}, picks=("taller", "higher"))
        yield Draft(
            category="comparative",
            kind="taller",
            key=f"taller:{a.id}:{b.id}",
            place=place,
            expected=expected,
            question=asked,
            evidence=(
                view(place, expected, about(one.kind, two.kind), [place.sight.item(n.thing) for n in (one, two)], whole=False),
            ),
            looks=(ask(asked.forms[0][0], place),),
            tags=("size",),
            weight=2,
            reads=value,
        )


def between(one: Place, two: Place, rng: random.Random) -> list[Draft]:
    """The same kind at two presets: where are there more?"""
    p, q = one.preset, two.preset
    if p is None or q is None or p == q:
        return []
    there = dict(counted(two.sight))
    found = []
    for kind, n in counted(one.sight):
        m = there.get(kind)
        if m is None:
            continue
        many = plural(noun_of(kind))
        value = "same" if n == m else p if n > m else q
        expected = Choice(
            value=value,
            options={p: (p.replace("-", " "),) if "-" in p else (), q: (q.replace("-", " "),) if "-" in q else (), "same": SAME},
            picks=("more", "most"),
        )
        start = elsewhere(one, two)
        orders = tuple(text.format(many=many, p=p, q=q) for text in _BETWEEN)
        found.append(
            Draft(
                category="comparative",
                kind="between",
                key=f"between:{p}:{q}:{many}",
                place=start,
                expected=expected,
                orders=orders,
                evidence=(_counted_view(one, kind, n), _counted_view(two, kind, m)),
                program=(go(p), count(many, one), go(q), count(many, two)),
                needs=("preset",),
                tags=("two-views",),
                weight=n + m,
                reads=value,
            )
        )
    rng.shuffle(found)
    return found


_BETWEEN = (
    "Are there more {many} at the {p} preset or at {q}?",
    "Compare the presets {p} and {q}: which shows more {many}?",
    "Which view has more {many}, {p} or {q}?",
    "Look at {p} and then at {q}. Where can you see more {many}?",
    "Between the {p} and the {q} preset, which one has more {many} in it?",
    "Go to {p}, then to {q}, and say which shows more {many}.",
)
