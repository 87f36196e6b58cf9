"""How to name one thing in a view so that nobody can take another for it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

from scope_ptz.bench.tasks.expected import Wordings
from scope_ptz.simulator.truth import Sighting
from scope_ptz.taskgen.authoring.noun_phrases import UNCOUNTED, about, called, noun_of, plain_colour, the
from scope_ptz.taskgen.facts.kinds import COLOUR_WORDS, GROUPS, SIGNS, Kind, Thing, has_colour, near_colours, own_colour
from scope_ptz.taskgen.facts.robust import Sight, with_parts

MADE_OUT_PX = 8.0
"""Capitals of this height are made out by whoever knows what to look for."""


@dataclass(frozen=True)
class Named:
    """A thing and what to call it ("excavator", "leftmost car"), with the kind that the name is made of."""

    thing: Sighting
    name: str
    kind: Kind
    place: bool = False

    @property
    def the(self) -> str:
        """The name with its article."""
        return the(self.name)

    @property
    def words(self) -> Wordings:
        """The words that a look at it mentions."""
        return tuple(dict.fromkeys((*about(self.kind), self.name, self.name.split()[-1])))


@lru_cache(maxsize=2048)
def singles(sight: Sight, *, coloured: bool, min_pixels: int = 350) -> tuple[Named, ...]:
    """Things that are the only ones of their kind in view. ``coloured``: the name may hold the colour."""
    found = []
    categories = sorted({s.instance.category for s in sight.clear})
    for category in categories:
        alone = sight.of(Kind(category))
        if alone is not None and len(alone) == 1 and unrivalled(sight, Kind(category), alone[0]):
            found.append(Named(alone[0], called(category), Kind(category)))
            continue
        if not coloured:
            continue
        own = (own_colour(s.instance) for s in sight.clear if s.instance.category == category)
        colours = sorted({colour for colour in own if colour is not None and " and " not in colour})
        for colour in colours:
            things = sight.of(Kind(category, colour))
            if things is not None and len(things) == 1 and unrivalled(sight, Kind(category, colour), things[0]):
                found.append(Named(things[0], noun_of(Kind(category, colour)), Kind(category, colour)))
    return tuple(n for n in found if n.thing.pixels >= min_pixels and n.kind.category not in UNCOUNTED)


def unrivalled(sight: Sight, kind: Kind, thing: Sighting) -> bool:
    """Whether nothing else shows, however small, that could be meant."""
    return not any(kind.fits(other) or kind.doubtful(other) for other in sight.others(thing))


@lru_cache(maxsize=2048)
def by_name(sight: Sight, min_pixels: int = 350, made_out_px: float = MADE_OUT_PX) -> tuple[Named, ...]:
    """Things that the scene gives a name of their own ("bakery sign", "red hatchback"), which nothing else in view could bear."""
    found = []
    for sighting in sight.clear:
        thing, name = sighting.instance, spoken(sighting.instance.name)
        words = name.lower().split()
        least = max(min_pixels, _PERSON_PX) if thing.category in GROUPS["person"] else min_pixels
        if sighting.pixels < least or sight.parted(sighting) or thing.category in _VAGUE or not 2 <= len(words) <= _LONGEST_NAME:
            continue
        if (
            set(words) & _MISLEADING
            or (set(words) & _HAVING and sighting.share < _HAD_SHARE)
            or (set(words) & COLOUR_WORDS and not has_colour(thing))
            or ("phone" in words and thing.category in GROUPS["person"])
            or not recognised(sight, sighting, name, made_out_px)
            or any(bears(other, name, thing) for other in sight.others(sighting))
        ):
            continue
        found.append(Named(sighting, name, Kind(thing.category)))
    return tuple(found)


def recognised(sight: Sight, sighting: Sighting, name: str, made_out_px: float) -> bool:
    """Whether a person knows a thing by its name from its looks, or can make out in this view what is written on it: a sign that
    is told from others by its words, a bay by its number."""
    thing = sighting.instance
    own = _letters(name) - _LITTLE - _WEAK - _letters(thing.category) - _letters(_head(name))
    by_number, by_words = name[-1].isdigit(), thing.category in _BY_WORDS and not own <= COLOUR_WORDS
    if not by_number and not by_words:
        return True
    family = with_parts(sight.scene, thing.id)
    near = [t for t in sight.first.texts if t.text.parent in family and t.cap_height_px >= made_out_px and t.unhidden_share > 0.9]
    said = {word for t in near for word in _letters(t.text.text)}
    if by_number:
        return name.split()[-1] in said
    return any(a[:_STEM] == b[:_STEM] for a in own for b in said)


_STEM = 4
"""Words that begin alike by so many letters are forms of one ("optician", "opticians")."""

_BY_WORDS = SIGNS | {"shop", "kiosk", "market stall", "door"}
"""What is told from others of its kind by what is written on it."""

_HAVING, _HAD_SHARE = frozenset({"with", "carrying", "pushing", "holding"}), 0.75
"""Where less than so much of a thing shows, what it is told by ("with a pram") may be what is hidden."""

_PERSON_PX = 700
"""What somebody wears or holds is seen on no fewer pixels."""


def _head(name: str) -> str:
    """The noun of a name, empty for a number."""
    head = re.split(r" (?:of|with|in|on|by|for|at) ", name)[0].split()[-1]
    return head if head.isalpha() else ""


def spoken(name: str) -> str:
    """The name of a thing as it is said after "the"."""
    name = re.sub(r"^(\w+) (standing|walking|waiting|sitting)$", r"\2 \1", name)
    return name.removeprefix("The ").replace("price of ", "price card for ").replace("belisha", "Belisha")


def bears(other: Thing, name: str, thing: Thing) -> bool:
    """Whether a person could take something else for the thing that is named: its own name, category and attributes say the same,
    but for words that tell little ("tall") or not enough ("saloon"), and colours that are nearly alike."""
    told = _letters(name) - _LITTLE
    facts = (f"{key} {value}" for key, value in other.attributes.items() if isinstance(value, str))
    borne = _letters(" ".join((other.name, other.category, *facts)))
    if told <= borne:
        return True
    if other.category != thing.category and not Kind(thing.category).doubtful(other):
        return False
    own = told - _WEAK - _letters(thing.category) - _letters(_head(name))
    return all(word in borne or any(near_colours(word, colour) for colour in borne) for word in own)


def _letters(text: str) -> set[str]:
    return set(re.findall(r"[^\W_]+", text.lower()))


_LITTLE = frozenset({"a", "an", "the", "of", "in", "on", "with", "by", "for", "at", "to", "who", "his", "her", "their", "its"})
_WEAK = frozenset({
    "standing", "walking", "waiting", "tall", "small", "large", "wide", "light", "dark", "saloon", "hatchback", "suv", "estate",
    "town", "site", "delivery", "roadside", "lit", "unlit", "round", "worker", "person", "man", "woman", "pedestrian", "customer",
})  # fmt: skip
"""Words by which nobody tells one thing from another for sure."""

_MISLEADING = frozenset({
    "no", "and", "area", "end", "without", "behind", "before", "painted", "name", "by", "under", "at", "near", "beside", "middle",
    "left", "right",
})  # fmt: skip
"""Words that make a name one of two things, of a place that several may be at, or of what is not there."""

_LONGEST_NAME = 5
_VAGUE = frozenset({
    "tree", "bush", "hedge", "hill", "road", "pavement", "surface", "field", "grass", "plant", "shrub", "kerb", "track", "ground",
    "yew", "flower bed", "puddle", "marking", "sky", "fence panel", "guardrail", "pylon", "building", "house", "terrace",
    "townhouse", "gantry", "parking space", "bay number", "dock number", "walkway", "hatched zone", "road marking", "wheel stop",
    "wheel guide", "window", "door sign", "window notice", "fence", "silo", "chimney", "dock leveller", "dock shelter",
    "tram platform", "lane signal", "gate",
})  # fmt: skip
"""Of these nobody knows one from another by its name."""


def distinct(sight: Sight, min_pixels: int = 500, made_out_px: float = MADE_OUT_PX) -> list[Named]:
    """Each thing that has a name which nothing else in view could bear, under its shortest."""
    named = (*by_name(sight, min_pixels, made_out_px), *singles(sight, coloured=True, min_pixels=min_pixels))
    return list({one.thing.instance.id: one for one in named}.values())


def ends(sight: Sight, min_pixels: int = 350) -> Iterator[Named]:
    """The leftmost, rightmost and nearest of several of a kind, where that is beyond doubt."""
    for category in sorted({s.instance.category for s in sight.clear} - UNCOUNTED):
        kind = Kind(category)
        things = sight.of(kind)
        if things is None or not 2 <= len(things) <= 9 or not whole_group(sight, kind):
            continue
        for axis_name, which in (("leftmost", 0), ("rightmost", -1)):
            end = outermost(sight, things, which)
            if end is not None and end.pixels >= min_pixels:
                yield Named(end, f"{axis_name} {called(category)}", kind, place=True)
        near = sorted(things, key=lambda s: s.distance_m)
        if near[1].distance_m > near[0].distance_m * 1.2 and near[0].pixels >= min_pixels:
            yield Named(near[0], f"nearest {called(category)}", kind, place=True)


def boards(sight: Sight, min_pixels: int = 350) -> Iterator[Named]:
    """Boards with lettering, told from others of their own sort by their colour ("navy shop sign")."""
    for sighting in sight.clear:
        thing = sighting.instance
        colour = own_colour(thing)
        if thing.category not in _COLOURED_BOARDS or colour is None or sighting.pixels < min_pixels or sight.parted(sighting):
            continue
        rivals = (other for other in sight.others(sighting) if other.category == thing.category)
        if not any(alike(colour, own_colour(rival)) for rival in rivals):
            kind = Kind(thing.category, colour)
            yield Named(sighting, noun_of(kind), kind)


_COLOURED_BOARDS = frozenset({"shop sign", "hanging sign", "pavement board"})


def alike(one: str, other: str | None) -> bool:
    """Whether two colours could be called the same: by a word, by their family, or because people disagree on them."""
    return (
        other is None
        or bool({*one.split()} & {*other.split()})
        or plain_colour(one) == plain_colour(other)
        or near_colours(one, other)
    )


def whole_group(sight: Sight, kind: Kind) -> bool:
    """Whether no further one of the kind shows in part: someone could take it for the outermost."""
    visible = {s.instance.number for s in sight.of(kind) or ()}
    return not any(kind.fits(s.instance) and s.instance.number not in visible and s.pixels > 30 for s in sight.samples[0].sightings)


def outermost(sight: Sight, things: Sequence[Sighting], which: int) -> Sighting | None:
    """The first (0) or last (-1) from the left, clear of the one beside it."""
    order = sorted(things, key=lambda s: (s.box[0] + s.box[2]) / 2)
    pair = order[:2] if which == 0 else order[-2:]
    return (order[which]) if sight.in_order(pair, 0, 0.05) is not None else None
