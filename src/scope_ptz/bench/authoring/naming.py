"""How to name one thing in a view so that nobody can take another for it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

from scope_ptz.bench.authoring.words import UNCOUNTED, about, called, noun_of
from scope_ptz.bench.expected import Wordings
from scope_ptz.bench.ground import Sight
from scope_ptz.bench.kinds import Kind, own_colour
from scope_ptz.world.truth import Sighting


@dataclass(frozen=True)
class Named:
    """A thing and what to call it ("excavator", "leftmost car"), with the kind that the name is made of."""

    thing: Sighting
    name: str
    kind: Kind
    place: bool = False

    @property
    def words(self) -> Wordings:
        """The words that a look at it mentions."""
        return tuple(dict.fromkeys((*about(self.kind), self.name, self.name.split()[-1])))


@lru_cache(maxsize=2048)
def singles(sight: Sight, *, coloured: bool, min_pixels: int = 250) -> tuple[Named, ...]:
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
    others = (other for other in sight.traces if other.number != thing.instance.number)
    return not any(kind.fits(other) or kind.doubtful(other) for other in others)


@lru_cache(maxsize=2048)
def by_name(sight: Sight, min_pixels: int = 250) -> tuple[Named, ...]:
    """Things that the scene gives a name of their own ("bakery sign", "red hatchback"), which nothing else in view could bear."""
    found = []
    for sighting in sight.clear:
        thing = sighting.instance
        words = set(thing.name.lower().split())
        rivals = (other for other in sight.traces if other.number != thing.number)
        if sighting.pixels < min_pixels or thing.category in _VAGUE or len(words) > _LONGEST_NAME or len(words) < 2:
            continue
        if any(words <= set(f"{other.name} {other.category}".lower().split()) for other in rivals):
            continue
        if " and " not in thing.name:
            found.append(Named(sighting, thing.name, Kind(thing.category)))
    return tuple(found)


_LONGEST_NAME = 5
_VAGUE = frozenset({
    "tree", "bush", "hedge", "hill", "road", "pavement", "surface", "field", "grass", "plant", "shrub", "kerb", "track", "ground",
    "yew", "flower bed", "puddle", "marking", "sky", "fence panel", "guardrail", "pylon", "building", "house",
    "terrace", "townhouse",
})  # fmt: skip
"""Of these nobody knows one from another by its name."""


def distinct(sight: Sight, min_pixels: int = 250) -> list[Named]:
    """Each thing that has a name which nothing else in view could bear, under its shortest."""
    found = {n.thing.instance.id: n for n in (*by_name(sight, min_pixels), *singles(sight, coloured=True, min_pixels=min_pixels))}
    return list(found.values())


def ends(sight: Sight, min_pixels: int = 250) -> Iterator[Named]:
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


def whole_group(sight: Sight, kind: Kind) -> bool:
    """Whether no further one of the kind shows in part: someone could take it for the outermost."""
    visible = {s.instance.number for s in sight.of(kind) or ()}
    return not any(kind.fits(s.instance) and s.instance.number not in visible and s.pixels > 30 for s in sight.samples[0].sightings)


def outermost(sight: Sight, things: Sequence[Sighting], which: int) -> Sighting | None:
    """The first (0) or last (-1) from the left, clear of the one beside it."""
    order = sorted(things, key=lambda s: (s.box[0] + s.box[2]) / 2)
    pair = order[:2] if which == 0 else order[-2:]
    return (order[which]) if sight.in_order(pair, 0, 0.05) is not None else None
