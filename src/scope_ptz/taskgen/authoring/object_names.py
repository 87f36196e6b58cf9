"""Names for single objects in a view that no other object in the view can be mistaken for."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

from scope_ptz.bench.tasks.expected import Wordings
from scope_ptz.simulator.truth import Sighting
from scope_ptz.taskgen.authoring.noun_phrases import UNCOUNTED, about, called, noun_of, plain_colour, the
from scope_ptz.taskgen.facts.kinds import COLOUR_WORDS, GROUPS, SIGNS, Kind, SceneThing, has_colour, near_colours, own_colour
from scope_ptz.taskgen.facts.robust import RobustTruth, with_parts

MADE_OUT_PX = 8.0
"""Minimum height of capitals, in pixels, for a person who knows what to look for to read them."""


@dataclass(frozen=True)
class NamedThing:
    """An object and its name.

    Attributes:
        thing: The object as it shows in the view.
        name: The name without an article ("excavator", "leftmost car").
        kind: The kind that the name is built from.
        positional: Whether the name depends on the position in the view.
    """

    thing: Sighting
    name: str
    kind: Kind
    positional: bool = False

    @property
    def the(self) -> str:
        """The name with its article."""
        return the(self.name)

    @property
    def words(self) -> Wordings:
        """The words that a perception call about the object mentions."""
        return tuple(dict.fromkeys((*about(self.kind), self.name, self.name.split()[-1])))


@lru_cache(maxsize=2048)
def unique_things(truth: RobustTruth, *, coloured: bool, min_pixels: int = 350) -> tuple[NamedThing, ...]:
    """Return the objects that are the only ones of their kind in view. With ``coloured``, a kind may include the colour."""
    found = []
    categories = sorted({s.instance.category for s in truth.clear})
    for category in categories:
        alone = truth.all_of(Kind(category))
        if alone is not None and len(alone) == 1 and is_only_candidate(truth, Kind(category), alone[0]):
            found.append(NamedThing(alone[0], called(category), Kind(category)))
            continue
        if not coloured:
            continue
        own = (own_colour(s.instance) for s in truth.clear if s.instance.category == category)
        colours = sorted({colour for colour in own if colour is not None and " and " not in colour})
        for colour in colours:
            things = truth.all_of(Kind(category, colour))
            if things is not None and len(things) == 1 and is_only_candidate(truth, Kind(category, colour), things[0]):
                found.append(NamedThing(things[0], noun_of(Kind(category, colour)), Kind(category, colour)))
    return tuple(n for n in found if n.thing.pixels >= min_pixels and n.kind.category not in UNCOUNTED)


def is_only_candidate(truth: RobustTruth, kind: Kind, thing: Sighting) -> bool:
    """Whether no other object that shows in the view, however small, could be meant."""
    return not any(kind.fits(other) or kind.ambiguous_with(other) for other in truth.others(thing))


@lru_cache(maxsize=2048)
def named_things(truth: RobustTruth, min_pixels: int = 350, made_out_px: float = MADE_OUT_PX) -> tuple[NamedThing, ...]:
    """Return the objects with a name of their own in the scene ("bakery sign") that fits nothing else in view."""
    found = []
    for sighting in truth.clear:
        thing, name = sighting.instance, spoken(sighting.instance.name)
        words = name.lower().split()
        least = max(min_pixels, _PERSON_PX) if thing.category in GROUPS["person"] else min_pixels
        if (
            sighting.pixels < least
            or truth.split_by_sweep(sighting)
            or thing.category in _VAGUE
            or not 2 <= len(words) <= _LONGEST_NAME
        ):
            continue
        if (
            set(words) & _MISLEADING
            or (set(words) & _HAVING and sighting.share < _HAD_SHARE)
            or (set(words) & COLOUR_WORDS and not has_colour(thing))
            or ("phone" in words and thing.category in GROUPS["person"])
            or not recognised(truth, sighting, name, made_out_px)
            or any(could_bear_name(other, name, thing) for other in truth.others(sighting))
        ):
            continue
        found.append(NamedThing(sighting, name, Kind(thing.category)))
    return tuple(found)


def recognised(truth: RobustTruth, sighting: Sighting, name: str, made_out_px: float) -> bool:
    """Whether a person recognises an object by its name in this view.

    Objects that are known by their lettering, such as signs and numbered bays, must show it large enough to be made out.
    """
    thing = sighting.instance
    own = _letters(name) - _LITTLE - _WEAK - _letters(thing.category) - _letters(_head(name))
    by_number, by_words = name[-1].isdigit(), thing.category in _BY_WORDS and not own <= COLOUR_WORDS
    if not by_number and not by_words:
        return True
    family = with_parts(truth.scene, thing.id)
    near = [t for t in truth.first.texts if t.text.parent in family and t.cap_height_px >= made_out_px and t.unhidden_share > 0.9]
    lettering = {word for t in near for word in _letters(t.text.text)}
    if by_number:
        return name.split()[-1] in lettering
    return any(a[:_STEM] == b[:_STEM] for a in own for b in lettering)


_STEM = 4
"""Words with this many first letters in common are forms of one word ("optician", "opticians")."""

_BY_WORDS = SIGNS | {"shop", "kiosk", "market stall", "door"}
"""Categories whose objects are distinguished by their lettering."""

_HAVING, _HAD_SHARE = frozenset({"with", "carrying", "pushing", "holding"}), 0.75
"""When less than this share of an object shows, the part that it is named after ("with a pram") may be hidden."""

_PERSON_PX = 700
"""Fewest pixels on which clothes and things in the hand can be seen."""


def _head(name: str) -> str:
    """Return the head noun of a name, or an empty string when the name ends in a number."""
    head = re.split(r" (?:of|with|in|on|by|for|at) ", name)[0].split()[-1]
    return head if head.isalpha() else ""


def spoken(name: str) -> str:
    """Return the name of an object as it is used after "the"."""
    name = re.sub(r"^(\w+) (standing|walking|waiting|sitting)$", r"\2 \1", name)
    return name.removeprefix("The ").replace("price of ", "price card for ").replace("belisha", "Belisha")


def could_bear_name(other: SceneThing, name: str, thing: SceneThing) -> bool:
    """Whether a person could mistake another object for the named one.

    That is so when name, category and attributes of the other object agree with the name, apart from words that distinguish
    little ("tall", "saloon") and colours that are nearly alike.
    """
    named = _letters(name) - _LITTLE
    facts = (f"{key} {value}" for key, value in other.attributes.items() if isinstance(value, str))
    borne = _letters(" ".join((other.name, other.category, *facts)))
    if named <= borne:
        return True
    if other.category != thing.category and not Kind(thing.category).ambiguous_with(other):
        return False
    own = named - _WEAK - _letters(thing.category) - _letters(_head(name))
    return all(word in borne or any(near_colours(word, colour) for colour in borne) for word in own)


def _letters(text: str) -> set[str]:
    return set(re.findall(r"[^\W_]+", text.lower()))


_LITTLE = frozenset({"a", "an", "the", "of", "in", "on", "with", "by", "for", "at", "to", "who", "his", "her", "their", "its"})
_WEAK = frozenset({
    "standing", "walking", "waiting", "tall", "small", "large", "wide", "light", "dark", "saloon", "hatchback", "suv", "estate",
    "town", "site", "delivery", "roadside", "lit", "unlit", "round", "worker", "person", "man", "woman", "pedestrian", "customer",
})  # fmt: skip
"""Words that do not reliably distinguish one object from another."""

_MISLEADING = frozenset({
    "no", "and", "area", "end", "without", "behind", "before", "painted", "name", "by", "under", "at", "near", "beside", "middle",
    "left", "right",
})  # fmt: skip
"""Words in names of two objects, of a location that several objects may be at, or of something that is absent."""

_LONGEST_NAME = 5  # words
_VAGUE = frozenset({
    "tree", "bush", "hedge", "hill", "road", "pavement", "surface", "field", "grass", "plant", "shrub", "kerb", "track", "ground",
    "yew", "flower bed", "puddle", "marking", "sky", "fence panel", "guardrail", "pylon", "building", "house", "terrace",
    "townhouse", "gantry", "parking space", "bay number", "dock number", "walkway", "hatched zone", "road marking", "wheel stop",
    "wheel guide", "window", "door sign", "window notice", "fence", "silo", "chimney", "dock leveller", "dock shelter",
    "tram platform", "lane signal", "gate",
})  # fmt: skip
"""Categories whose objects cannot be distinguished by name."""


def nameable_things(truth: RobustTruth, min_pixels: int = 500, made_out_px: float = MADE_OUT_PX) -> list[NamedThing]:
    """Return every object with a name that fits nothing else in view, under its shortest name."""
    named = (*named_things(truth, min_pixels, made_out_px), *unique_things(truth, coloured=True, min_pixels=min_pixels))
    return list({one.thing.instance.id: one for one in named}.values())


def extreme_things(truth: RobustTruth, min_pixels: int = 350) -> Iterator[NamedThing]:
    """Yield the leftmost, rightmost and nearest of several objects of a kind, where there is no doubt which one it is."""
    for category in sorted({s.instance.category for s in truth.clear} - UNCOUNTED):
        kind = Kind(category)
        things = truth.all_of(kind)
        if things is None or not 2 <= len(things) <= 9 or not whole_group(truth, kind):
            continue
        for axis_name, which in (("leftmost", 0), ("rightmost", -1)):
            end = outermost(truth, things, which)
            if end is not None and end.pixels >= min_pixels:
                yield NamedThing(end, f"{axis_name} {called(category)}", kind, positional=True)
        near = sorted(things, key=lambda s: s.distance_m)
        if near[1].distance_m > near[0].distance_m * 1.2 and near[0].pixels >= min_pixels:
            yield NamedThing(near[0], f"nearest {called(category)}", kind, positional=True)


def coloured_boards(truth: RobustTruth, min_pixels: int = 350) -> Iterator[NamedThing]:
    """Yield boards with lettering that differ in colour from others of their category ("navy shop sign")."""
    for sighting in truth.clear:
        thing = sighting.instance
        colour = own_colour(thing)
        if (
            thing.category not in _COLOURED_BOARDS
            or colour is None
            or sighting.pixels < min_pixels
            or truth.split_by_sweep(sighting)
        ):
            continue
        rivals = (other for other in truth.others(sighting) if other.category == thing.category)
        if not any(colours_confusable(colour, own_colour(rival)) for rival in rivals):
            kind = Kind(thing.category, colour)
            yield NamedThing(sighting, noun_of(kind), kind)


_COLOURED_BOARDS = frozenset({"shop sign", "hanging sign", "pavement board"})


def colours_confusable(one: str, other: str | None) -> bool:
    """Whether two colours share a word or a plain colour, or are colours that people disagree on."""
    return (
        other is None
        or bool({*one.split()} & {*other.split()})
        or plain_colour(one) == plain_colour(other)
        or near_colours(one, other)
    )


def whole_group(truth: RobustTruth, kind: Kind) -> bool:
    """Whether no further object of the kind is partly visible. A person could mistake it for the outermost one."""
    visible = {s.instance.number for s in truth.all_of(kind) or ()}
    return not any(kind.fits(s.instance) and s.instance.number not in visible and s.pixels > 30 for s in truth.samples[0].sightings)


def outermost(truth: RobustTruth, things: Sequence[Sighting], which: int) -> Sighting | None:
    """Return the first (0) or last (-1) object from the left, or None if its neighbour is too close."""
    order = sorted(things, key=lambda s: (s.box[0] + s.box[2]) / 2)
    pair = order[:2] if which == 0 else order[-2:]
    return order[which] if truth.in_order(pair, 0, 0.05) is not None else None
