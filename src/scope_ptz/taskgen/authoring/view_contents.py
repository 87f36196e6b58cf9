"""Kinds of objects in a view: those with an unambiguous count, and those that are certainly absent."""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import lru_cache

from scope_ptz.taskgen.authoring.noun_phrases import UNCOUNTABLE_CATEGORIES
from scope_ptz.taskgen.authoring.task_places import TaskPlace
from scope_ptz.taskgen.facts.kinds import Kind, kinds_in, own_colour
from scope_ptz.taskgen.facts.robust import RobustTruth

_MAX_COUNT, _MAX_COUNT_IN_SWEEP = 15, 8
"""Maximum count in a view and in a sweep. People disagree about larger counts."""

_MIN_SHARE = 0.5
"""Minimum visible fraction of a counted object. People disagree on whether to count objects that are less visible."""

_MIN_PX, _MIN_PX_IN_SWEEP = 220, 450
"""Minimum size of a counted object in a view and in a sweep, in pixels. People overlook smaller objects."""

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
"""Nouns that would make an unnatural question, or whose absence is never certain."""


@lru_cache(maxsize=512)
def countable_kinds(truth: RobustTruth) -> tuple[tuple[Kind, int], ...]:
    """Return the kinds in a view whose count is unambiguous, each with its count (at least one)."""
    counts = []
    for kind in kinds_in(s.instance for s in truth.clear_sightings):
        if kind.category in UNCOUNTABLE_CATEGORIES:
            continue
        things = truth.all_of(kind)
        max_count, min_px = (_MAX_COUNT_IN_SWEEP, _MIN_PX_IN_SWEEP) if truth.pose is None else (_MAX_COUNT, _MIN_PX)
        if things and len(things) <= max_count and all(t.pixels >= min_px and t.visible_fraction >= _MIN_SHARE for t in things):
            is_specific = kind.colour is not None or kind.attribute is not None
            is_redundant = is_specific and len(things) == len(truth.all_of(Kind(kind.category)) or ())
            if not is_redundant:  # if all cars are red, "red cars" asks the same as "cars"
                counts.append((kind, len(things)))
    return tuple(counts)


def category_counts(truth: RobustTruth) -> list[tuple[Kind, int]]:
    """Return the countable kinds that are defined by their category alone, with their counts."""
    return [(kind, n) for kind, n in countable_kinds(truth) if kind.colour is None and kind.attribute is None]


@lru_cache(maxsize=512)
def absent_kinds(truth: RobustTruth, nouns: frozenset[str]) -> tuple[Kind, ...]:
    """Return kinds that are certainly absent from a view.

    The candidates are all ``nouns``, and each category in view combined with the colours that its objects have anywhere in this
    scene ("red car" in a view with white cars only).
    """
    kinds = [Kind(noun) for noun in sorted(nouns - _UNASKED_NOUNS)]
    categories = sorted(
        {s.instance.category for s in truth.clear_sightings if own_colour(s.instance) is not None} - UNCOUNTABLE_CATEGORIES
    )
    colours = {(t.category, own_colour(t)) for t in truth.scene.things if t.category in categories}
    kinds += [Kind(category, colour) for category, colour in sorted(colours, key=str) if colour in _ABSENT_COLOURS]
    return tuple(kind for kind in kinds if kind.category not in UNCOUNTABLE_CATEGORIES and truth.certainly_lacks(kind))


def are_disjoint(truth: RobustTruth, kinds: Sequence[Kind]) -> bool:
    """Return whether no object in view could belong to two of these kinds, as with "people" and "workers"."""
    return not any(
        sum(kind.fits(thing) or kind.is_ambiguous_with(thing) for kind in kinds) > 1 for thing in truth.discernible_objects
    )


def scene_kinds_first(place: TaskPlace, kinds: Sequence[Kind], rng: random.Random) -> list[Kind]:
    """Shuffle kinds, and put first those that the scene has in other views.

    The noun in a question then does not reveal that the answer is "there is none".
    """
    scene_categories = {thing.category for thing in place.scene.things}
    shuffled = rng.sample(kinds, len(kinds))
    return sorted(shuffled, key=lambda kind: kind.category not in scene_categories)
