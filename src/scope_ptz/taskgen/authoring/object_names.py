"""Choose names that identify exactly one object in a view."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

from scope_ptz.bench.tasks.expected import Wordings
from scope_ptz.simulator.truth import Sighting
from scope_ptz.taskgen.authoring.noun_phrases import (
    UNCOUNTABLE_CATEGORIES,
    everyday_name,
    object_words,
    plain_colour,
    singular_noun,
    with_the,
)
from scope_ptz.taskgen.facts.kinds import COLOUR_WORDS, GROUPS, SIGNS, Kind, SceneThing, are_similar_colours, has_colour, own_colour
from scope_ptz.taskgen.facts.robust import RobustTruth, ids_with_parts

RECOGNISABLE_TEXT_PX = 8.0
"""Minimum height of capital letters, in pixels, for a person to recognise expected text."""


@dataclass(frozen=True)
class NamedThing:
    """An object in a view, with a name that identifies it.

    Attributes:
        thing: The object as it appears in the view.
        name: The name without an article ("excavator", "leftmost car").
        kind: The kind of object in the name, such as "car" in "leftmost car".
        positional: Whether the name compares the object's position with those of others ("leftmost", "nearest").
    """

    thing: Sighting
    name: str
    kind: Kind
    positional: bool = False

    @property
    def with_the(self) -> str:
        """The name with its article."""
        return with_the(self.name)

    @property
    def words(self) -> Wordings:
        """Words for the object. A perception call about the object mentions at least one of them."""
        return tuple(dict.fromkeys((*object_words(self.kind), self.name, self.name.split()[-1])))


@lru_cache(maxsize=2048)
def unique_things(truth: RobustTruth, *, coloured: bool, min_pixels: int = 350) -> tuple[NamedThing, ...]:
    """Return the objects that are the only ones of their kind in view.

    Args:
        truth: The ground truth of the view.
        coloured: Whether a colour may be part of the kind, as in "red car".
        min_pixels: Minimum size of an object in pixels.
    """
    named = []
    categories = sorted({s.instance.category for s in truth.clear_sightings})
    for category in categories:
        only_things = truth.all_of(Kind(category))
        if only_things is not None and len(only_things) == 1 and is_only_candidate(truth, Kind(category), only_things[0]):
            named.append(NamedThing(only_things[0], everyday_name(category), Kind(category)))
            continue
        if not coloured:
            continue
        colours_in_view = (own_colour(s.instance) for s in truth.clear_sightings if s.instance.category == category)
        colours = sorted({colour for colour in colours_in_view if colour is not None and " and " not in colour})
        for colour in colours:
            things = truth.all_of(Kind(category, colour))
            if things is not None and len(things) == 1 and is_only_candidate(truth, Kind(category, colour), things[0]):
                named.append(NamedThing(things[0], singular_noun(Kind(category, colour)), Kind(category, colour)))
    return tuple(n for n in named if n.thing.pixels >= min_pixels and n.kind.category not in UNCOUNTABLE_CATEGORIES)


def is_only_candidate(truth: RobustTruth, kind: Kind, thing: Sighting) -> bool:
    """Return whether no other object in the view, not even a barely visible one, fits a kind or could be taken for it."""
    return not any(kind.fits(other) or kind.is_ambiguous_with(other) for other in truth.other_objects(thing))


@lru_cache(maxsize=2048)
def named_things(truth: RobustTruth, min_pixels: int = 350, min_text_px: float = RECOGNISABLE_TEXT_PX) -> tuple[NamedThing, ...]:
    """Return the objects whose own name in the scene ("bakery sign") matches no other object in view.

    Args:
        truth: The ground truth of the view.
        min_pixels: Minimum size of an object in pixels.
        min_text_px: Minimum height of capital letters, in pixels, if a person needs to read them to recognise the object.
    """
    named = []
    for sighting in truth.clear_sightings:
        thing, name = sighting.instance, name_in_instruction(sighting.instance.name)
        words = name.lower().split()
        required_pixels = max(min_pixels, _PERSON_PX) if thing.category in GROUPS["person"] else min_pixels
        if (
            sighting.pixels < required_pixels
            or truth.is_split_by_sweep(sighting)
            or thing.category in _INDISTINCT_CATEGORIES
            or not 2 <= len(words) <= _MAX_NAME_WORDS
        ):
            continue
        if (
            set(words) & _MISLEADING_WORDS
            or (set(words) & _PART_WORDS and sighting.visible_fraction < _MIN_SHARE_WITH_PART)
            or (set(words) & COLOUR_WORDS and not has_colour(thing))
            or ("phone" in words and thing.category in GROUPS["person"])
            or not is_recognisable(truth, sighting, name, min_text_px)
            or any(name_could_refer_to(other, name, thing) for other in truth.other_objects(sighting))
        ):
            continue
        named.append(NamedThing(sighting, name, Kind(thing.category)))
    return tuple(named)


def is_recognisable(truth: RobustTruth, sighting: Sighting, name: str, min_text_px: float) -> bool:
    """Return whether a person can recognise an object by its name in this view.

    If people know such an object by its lettering, as with signs and numbered bays, the lettering must contain a distinctive word
    (or the number) of the name and be large enough to read.
    """
    thing = sighting.instance
    distinctive = _words_in(name) - _FUNCTION_WORDS - _COMMON_WORDS - _words_in(thing.category) - _words_in(_head_noun(name))
    by_number, by_text = name[-1].isdigit(), thing.category in _LETTERED_CATEGORIES and not distinctive <= COLOUR_WORDS
    if not by_number and not by_text:
        return True
    parts = ids_with_parts(truth.scene, thing.id)
    texts = [
        t
        for t in truth.first_sample.texts
        if t.text.parent in parts and t.cap_height_px >= min_text_px and t.unhidden_fraction > 0.9
    ]
    lettering = {word for t in texts for word in _words_in(t.text.text)}
    if by_number:
        return name.split()[-1] in lettering
    return any(a[:_STEM_CHARS] == b[:_STEM_CHARS] for a in distinctive for b in lettering)


_STEM_CHARS = 4
"""Words that share this many first letters count as forms of the same word ("optician", "opticians")."""

_LETTERED_CATEGORIES = SIGNS | {"shop", "kiosk", "market stall", "door"}
"""Categories whose objects people tell apart by their lettering."""

_PART_WORDS = frozenset({"with", "carrying", "pushing", "holding"})
"""Words in names that mention a part or a carried object, such as "with a pram"."""

_MIN_SHARE_WITH_PART = 0.75
"""Minimum visible fraction of an object whose name mentions a part. Below it, the part itself could be hidden."""

_PERSON_PX = 700
"""Minimum number of pixels of a person for clothes and carried objects to be visible."""


def _head_noun(name: str) -> str:
    """Return the head noun of a name; an empty string if the name ends in a number."""
    head = re.split(r" (?:of|with|in|on|by|for|at) ", name)[0].split()[-1]
    return head if head.isalpha() else ""


def name_in_instruction(name: str) -> str:
    """Return an object's name in the scene, in the form that instructions use after "the"."""
    name = re.sub(r"^(\w+) (standing|walking|waiting|sitting)$", r"\2 \1", name)
    return name.removeprefix("The ").replace("price of ", "price card for ").replace("belisha", "Belisha")


def name_could_refer_to(other: SceneThing, name: str, thing: SceneThing) -> bool:
    """Return whether a name could also refer to another object.

    This is the case if the other object's name, category and attributes contain the words of the name. Common words ("tall",
    "saloon") need not match, and similar colours count as equal.

    Args:
        other: The other object.
        name: The name.
        thing: The object that the name belongs to.
    """
    named = _words_in(name) - _FUNCTION_WORDS
    facts = (f"{key} {value}" for key, value in other.attributes.items() if isinstance(value, str))
    described = _words_in(" ".join((other.name, other.category, *facts)))
    if named <= described:
        return True
    if other.category != thing.category and not Kind(thing.category).is_ambiguous_with(other):
        return False
    distinctive = named - _COMMON_WORDS - _words_in(thing.category) - _words_in(_head_noun(name))
    return all(word in described or any(are_similar_colours(word, colour) for colour in described) for word in distinctive)


def _words_in(text: str) -> set[str]:
    """Return the words and numbers in text, in lower case."""
    return set(re.findall(r"[^\W_]+", text.lower()))


_FUNCTION_WORDS = frozenset(
    {"a", "an", "the", "of", "in", "on", "with", "by", "for", "at", "to", "who", "his", "her", "their", "its"}
)
_COMMON_WORDS = frozenset({
    "standing", "walking", "waiting", "tall", "small", "large", "wide", "light", "dark", "saloon", "hatchback", "suv", "estate",
    "town", "site", "delivery", "roadside", "lit", "unlit", "round", "worker", "person", "man", "woman", "pedestrian", "customer",
})  # fmt: skip
"""Words that do not reliably distinguish two objects."""

_MISLEADING_WORDS = frozenset({
    "no", "and", "area", "end", "without", "behind", "before", "painted", "name", "by", "under", "at", "near", "beside", "middle",
    "left", "right",
})  # fmt: skip
"""Words that make a name ambiguous: the name may refer to two objects, to a location, or to something absent."""

_MAX_NAME_WORDS = 5
_INDISTINCT_CATEGORIES = frozenset({
    "tree", "bush", "hedge", "hill", "road", "pavement", "surface", "field", "grass", "plant", "shrub", "kerb", "track", "ground",
    "yew", "flower bed", "puddle", "marking", "sky", "fence panel", "guardrail", "pylon", "building", "house", "terrace",
    "townhouse", "gantry", "parking space", "bay number", "dock number", "walkway", "hatched zone", "road marking", "wheel stop",
    "wheel guide", "window", "door sign", "window notice", "fence", "silo", "chimney", "dock leveller", "dock shelter",
    "tram platform", "lane signal", "gate",
})  # fmt: skip
"""Categories whose objects people cannot tell apart by name."""


def nameable_things(truth: RobustTruth, min_pixels: int = 500, min_text_px: float = RECOGNISABLE_TEXT_PX) -> list[NamedThing]:
    """Return all objects that can be identified by a name, each with one name.

    The arguments are those of ``named_things``. Names from ``unique_things`` are preferred, because they are shorter.
    """
    named = (*named_things(truth, min_pixels, min_text_px), *unique_things(truth, coloured=True, min_pixels=min_pixels))
    return list({thing.thing.instance.id: thing for thing in named}.values())


def extreme_things(truth: RobustTruth, min_pixels: int = 350) -> Iterator[NamedThing]:
    """Yield the leftmost, rightmost and nearest of several objects of a kind, if they are unambiguous."""
    for category in sorted({s.instance.category for s in truth.clear_sightings} - UNCOUNTABLE_CATEGORIES):
        kind = Kind(category)
        things = truth.all_of(kind)
        if things is None or not 2 <= len(things) <= 9 or not is_complete_group(truth, kind):
            continue
        for adjective, index in (("leftmost", 0), ("rightmost", -1)):
            outermost = find_outermost(truth, things, index)
            if outermost is not None and outermost.pixels >= min_pixels:
                yield NamedThing(outermost, f"{adjective} {everyday_name(category)}", kind, positional=True)
        by_distance = sorted(things, key=lambda s: s.distance_m)
        if by_distance[1].distance_m > by_distance[0].distance_m * 1.2 and by_distance[0].pixels >= min_pixels:
            yield NamedThing(by_distance[0], f"nearest {everyday_name(category)}", kind, positional=True)


def coloured_boards(truth: RobustTruth, min_pixels: int = 350) -> Iterator[NamedThing]:
    """Yield boards with lettering that can be identified by their colour ("navy shop sign")."""
    for sighting in truth.clear_sightings:
        thing = sighting.instance
        colour = own_colour(thing)
        if (
            thing.category not in _COLOURED_BOARDS
            or colour is None
            or sighting.pixels < min_pixels
            or truth.is_split_by_sweep(sighting)
        ):
            continue
        rivals = (other for other in truth.other_objects(sighting) if other.category == thing.category)
        if not any(are_confusable_colours(colour, own_colour(rival)) for rival in rivals):
            kind = Kind(thing.category, colour)
            yield NamedThing(sighting, singular_noun(kind), kind)


_COLOURED_BOARDS = frozenset({"shop sign", "hanging sign", "pavement board"})


def are_confusable_colours(one: str, other: str | None) -> bool:
    """Return whether people could confuse two colours: they share a word or a plain colour, or are similar."""
    return (
        other is None
        or bool({*one.split()} & {*other.split()})
        or plain_colour(one) == plain_colour(other)
        or are_similar_colours(one, other)
    )


def is_complete_group(truth: RobustTruth, kind: Kind) -> bool:
    """Return whether every object of a kind that is in view is clearly visible.

    If one were partly hidden, people could disagree about which object is the outermost.
    """
    visible = {s.instance.number for s in truth.all_of(kind) or ()}
    return not any(kind.fits(s.instance) and s.instance.number not in visible and s.pixels > 30 for s in truth.samples[0].sightings)


def find_outermost(truth: RobustTruth, things: Sequence[Sighting], index: int) -> Sighting | None:
    """Return the leftmost object (``index`` is 0) or the rightmost one (-1); None if its neighbour is too close to it."""
    order = sorted(things, key=lambda s: (s.box[0] + s.box[2]) / 2)
    pair = order[:2] if index == 0 else order[-2:]
    return order[index] if truth.sort_by_position(pair, 0, 0.05) is not None else None
