"""Counting: how many of a kind there are in a view or all around, and where there are none."""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import lru_cache

from scope_ptz.bench.tasks.expected import NoneThere, Number
from scope_ptz.taskgen.authoring.drafts import Draft, Question, count, scope_of, view
from scope_ptz.taskgen.authoring.noun_phrases import UNCOUNTED, about, many_of, noun_of, unit_of
from scope_ptz.taskgen.authoring.task_places import Place
from scope_ptz.taskgen.facts.kinds import Kind, kinds_in, own_colour
from scope_ptz.taskgen.facts.robust import Sight

MOST, MOST_AROUND = 15, 8
"""More than this nobody counts alike, in one view and all around."""

_COUNTED_SHARE = 0.5
"""Of what more is hidden or cut off, people disagree whether it was there to be counted."""

_COUNTED_PX, _COUNTED_PX_AROUND = 220, 450
"""What covers less of one view, or of all around, is passed over by careful people too."""


def question(kind: Kind) -> Question:
    many = many_of(kind)
    return Question(
        (
            (f"how many {many} are there?", f"how many {many} there are"),
            (f"how many {many} can you see?", f"how many {many} you can see"),
            (f"what is the number of {many}?", f"the number of {many}"),
            (f"how many {many} are visible?", f"how many {many} are visible"),
            (f"what's the count of {many}?", f"the count of {many}"),
        )
    )


@lru_cache(maxsize=512)
def counted(sight: Sight) -> tuple[tuple[Kind, int], ...]:
    """Kinds in a view that can be counted surely, with how many there are (at least one)."""
    found = []
    for kind in kinds_in(s.instance for s in sight.clear):
        if kind.category in UNCOUNTED:
            continue
        things = sight.of(kind)
        most, least = (MOST_AROUND, _COUNTED_PX_AROUND) if sight.pose is None else (MOST, _COUNTED_PX)
        if things and len(things) <= most and all(t.pixels >= least and t.share >= _COUNTED_SHARE for t in things):
            special = kind.colour is not None or kind.attribute is not None
            alone = special and len(things) == len(sight.of(Kind(kind.category)) or ())
            if not alone:  # "red cars" among red cars only is the same question as "cars"
                found.append((kind, len(things)))
    return tuple(found)


def apart(sight: Sight, kinds: Sequence[Kind]) -> bool:
    """Whether nothing in view is of two of these kinds, nor could be called so ("people" and "workers")."""
    return not any(sum(kind.fits(thing) or kind.doubtful(thing) for kind in kinds) > 1 for thing in sight.traces)


def plain_counts(sight: Sight) -> list[tuple[Kind, int]]:
    """Those of them that are a whole category."""
    return [(kind, n) for kind, n in counted(sight) if kind.colour is None and kind.attribute is None]


@lru_cache(maxsize=512)
def absent(sight: Sight, nouns: frozenset[str]) -> tuple[Kind, ...]:
    """Kinds of which nothing at all shows: other categories of the scenes, and colours that a category comes in here."""
    kinds = [Kind(noun) for noun in sorted(nouns - _ODD)]
    categories = sorted({s.instance.category for s in sight.clear if own_colour(s.instance) is not None} - UNCOUNTED)
    colours = {(t.category, own_colour(t)) for t in sight.scene.things if t.category in categories}
    kinds += [Kind(category, colour) for category, colour in sorted(colours, key=str) if colour in _ABSENT_COLOURS]
    return tuple(kind for kind in kinds if kind.category not in UNCOUNTED and sight.lacks(kind))


def likely_first(place: Place, kinds: Sequence[Kind], rng: random.Random) -> list[Kind]:
    """Kinds by lot, those that the scene has elsewhere first: that a noun is asked about must not tell that there is none."""
    elsewhere = {thing.category for thing in place.scene.things}
    drawn = rng.sample(kinds, len(kinds))
    return sorted(drawn, key=lambda kind: kind.category not in elsewhere)


_ABSENT_COLOURS = frozenset({"red", "blue", "green", "yellow", "black", "white", "orange", "purple"})

_ODD = frozenset({
    "cross", "price card", "plinth", "cow", "swimming pool", "tree grate", "stallholder", "cup", "notice", "ball",
    "tram platform", "manhole cover", "drain", "clock", "timetable", "planter", "plate compactor", "marker post", "camera pole",
    "sign", "person", "liquid container", "parking space", "driver", "security guard", "beacon", "gas cage", "lane signal",
    "spill kit", "wheel stop", "hose reel", "loaf", "ham", "cake", "book", "bottle", "teapot", "table lamp", "mannequin",
    "door sign", "window notice", "wall sign", "manhole", "belisha beacon", "dock light", "barrier arm", "plate", "hanging sign",
    "street name sign", "gantry", "flower bucket", "headline board", "tram shelter", "tram stop sign", "tram pole", "map board",
    "taxi sign", "departures board", "gatehouse", "charging point", "wall lamp", "pavement board", "shop sign", "luggage trolley",
    "estate agent board", "hanging basket",
})  # fmt: skip
"""What nobody would ask after, or nobody could be sure that there is none of."""


def drafts(place: Place, nouns: frozenset[str], rng: random.Random) -> list[Draft]:
    """Everything to be counted at a place, and absences, each with a presence of like wording."""
    sight = place.sight
    present = [_number(place, kind, n) for kind, n in counted(sight)]
    twins = list(present)
    rng.shuffle(twins)
    missing = likely_first(place, absent(sight, nouns), rng)
    none = [
        Draft(
            category="counting",
            kind="none",
            key=f"count:{noun_of(kind)}",
            place=place,
            expected=(expected := NoneThere(subject=unit_of(kind)[:2])),
            question=question(kind),
            evidence=(view(place, expected, about(kind), whole=True),),
            looks=(count(many_of(kind), place),),
            tags=("none-there", scope_of(place)),
            twin=twin,
            reads="none",
        )
        for kind, twin in zip(missing, twins, strict=False)
    ]
    return [*present, *none]


def _number(place: Place, kind: Kind, number: int) -> Draft:
    things = place.sight.of(kind) or ()
    expected = Number(value=number, unit=unit_of(kind))
    return Draft(
        category="counting",
        kind="all-around" if place.swept else "coloured" if kind.colour else "in-state" if kind.attribute else "count",
        key=f"count:{noun_of(kind)}",
        place=place,
        expected=expected,
        question=question(kind),
        evidence=(view(place, expected, about(kind), [place.sight.item(t, True) for t in things], whole=True),),
        looks=(count(many_of(kind), place),),
        tags=(scope_of(place),),
        weight=number,
        reads=str(number),
    )
