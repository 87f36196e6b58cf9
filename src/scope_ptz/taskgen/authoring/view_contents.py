"""Kinds of objects in a view: those that can be counted for certain, and those that are certainly absent."""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import lru_cache

from scope_ptz.taskgen.authoring.noun_phrases import UNCOUNTED
from scope_ptz.taskgen.authoring.task_places import TaskPlace
from scope_ptz.taskgen.facts.kinds import Kind, kinds_in, own_colour
from scope_ptz.taskgen.facts.robust import RobustTruth

_MOST_COUNTED, _MOST_COUNTED_IN_SWEEP = 15, 8
"""People count larger numbers differently, in one view and in a sweep."""

_LEAST_SHARE = 0.5
"""People disagree whether to count an object if less than this share of it is visible."""

_LEAST_PX, _LEAST_PX_IN_SWEEP = 220, 450
"""Even careful people overlook objects that cover fewer pixels of a view, or of a sweep."""

_ABSENT_COLOURS = frozenset({"red", "blue", "green", "yellow", "black", "white", "orange", "purple"})

_UNASKED_NOUNS = frozenset({
    "cross", "price card", "plinth", "cow", "swimming pool", "tree grate", "stallholder", "cup", "notice", "ball",
    "tram platform", "manhole cover", "drain", "clock", "timetable", "planter", "plate compactor", "marker post", "camera pole",
    "sign", "person", "liquid container", "parking space", "driver", "security guard", "beacon", "gas cage", "lane signal",
    "spill kit", "wheel stop", "hose reel", "loaf", "ham", "cake", "book", "bottle", "teapot", "table lamp", "mannequin",
    "door sign", "window notice", "wall sign", "manhole", "belisha beacon", "dock light", "barrier arm", "plate", "hanging sign",
    "street name sign", "gantry", "flower bucket", "headline board", "tram shelter", "tram stop sign", "tram pole", "map board",
    "taxi sign", "departures board", "gatehouse", "charging point", "wall lamp", "pavement board", "shop sign", "luggage trolley",
    "estate agent board", "hanging basket",
})  # fmt: skip
"""Nouns that are unnatural to ask about, or whose absence is never certain."""


@lru_cache(maxsize=512)
def countable(truth: RobustTruth) -> tuple[tuple[Kind, int], ...]:
    """Return the kinds in a view that can be counted for certain, with their numbers (at least one)."""
    found = []
    for kind in kinds_in(s.instance for s in truth.clear):
        if kind.category in UNCOUNTED:
            continue
        things = truth.all_of(kind)
        most, least = (_MOST_COUNTED_IN_SWEEP, _LEAST_PX_IN_SWEEP) if truth.pose is None else (_MOST_COUNTED, _LEAST_PX)
        if things and len(things) <= most and all(t.pixels >= least and t.share >= _LEAST_SHARE for t in things):
            special = kind.colour is not None or kind.attribute is not None
            alone = special and len(things) == len(truth.all_of(Kind(kind.category)) or ())
            if not alone:  # when all cars are red, "red cars" asks the same as "cars"
                found.append((kind, len(things)))
    return tuple(found)


def plain_counts(truth: RobustTruth) -> list[tuple[Kind, int]]:
    """Return those countable kinds that are a whole category, without a colour or another attribute."""
    return [(kind, n) for kind, n in countable(truth) if kind.colour is None and kind.attribute is None]


@lru_cache(maxsize=512)
def absent_kinds(truth: RobustTruth, nouns: frozenset[str]) -> tuple[Kind, ...]:
    """Return kinds of which nothing shows: other nouns of the scenes, and colours that a visible category has in this scene."""
    kinds = [Kind(noun) for noun in sorted(nouns - _UNASKED_NOUNS)]
    categories = sorted({s.instance.category for s in truth.clear if own_colour(s.instance) is not None} - UNCOUNTED)
    colours = {(t.category, own_colour(t)) for t in truth.scene.things if t.category in categories}
    kinds += [Kind(category, colour) for category, colour in sorted(colours, key=str) if colour in _ABSENT_COLOURS]
    return tuple(kind for kind in kinds if kind.category not in UNCOUNTED and truth.lacks(kind))


def disjoint(truth: RobustTruth, kinds: Sequence[Kind]) -> bool:
    """Whether no object in view belongs, or could be said to belong, to two of these kinds ("people" and "workers")."""
    return not any(sum(kind.fits(thing) or kind.ambiguous_with(thing) for kind in kinds) > 1 for thing in truth.traces)


def scene_kinds_first(place: TaskPlace, kinds: Sequence[Kind], rng: random.Random) -> list[Kind]:
    """Shuffle kinds, those that the scene has elsewhere first, so that a noun does not reveal that the answer is none."""
    elsewhere = {thing.category for thing in place.scene.things}
    shuffled = rng.sample(kinds, len(kinds))
    return sorted(shuffled, key=lambda kind: kind.category not in elsewhere)
