"""How to name one thing in a view so that nobody can take another for it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from scope_ptz.bench.authoring.words import UNCOUNTED, noun_of
from scope_ptz.bench.ground import Kind, Sight
from scope_ptz.world.truth import Sighting


@dataclass(frozen=True)
class Named:
    """A thing and what to call it ("excavator", "leftmost car"), with the kind that the name is made of."""

    thing: Sighting
    name: str
    kind: Kind
    place: bool = False


def singles(sight: Sight, *, coloured: bool, min_pixels: int = 250) -> list[Named]:
    """Things that are the only ones of their kind in view. ``coloured``: the name may hold the colour."""
    found = []
    categories = sorted({s.instance.category for s in sight.clear})
    for category in categories:
        alone = sight.of(Kind(category))
        if alone is not None and len(alone) == 1:
            found.append(Named(alone[0], category, Kind(category)))
            continue
        if not coloured:
            continue
        colours = sorted(
            {
                str(s.instance.attributes["colour"])
                for s in sight.clear
                if s.instance.category == category and "colour" in s.instance.attributes
            }
        )
        for colour in colours:
            things = sight.of(Kind(category, colour))
            if things is not None and len(things) == 1:
                found.append(Named(things[0], noun_of(Kind(category, colour)), Kind(category, colour)))
    return [n for n in found if n.thing.pixels >= min_pixels and n.kind.category not in UNCOUNTED]


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
                yield Named(end, f"{axis_name} {category}", kind, place=True)
        near = sorted(things, key=lambda s: s.distance_m)
        if near[1].distance_m > near[0].distance_m * 1.2 and near[0].pixels >= min_pixels:
            yield Named(near[0], f"nearest {category}", kind, place=True)


def whole_group(sight: Sight, kind: Kind) -> bool:
    """Whether no further one of the kind shows in part: someone could take it for the outermost."""
    visible = {s.instance.number for s in sight.of(kind) or ()}
    return not any(kind.fits(s.instance) and s.instance.number not in visible and s.pixels > 30 for s in sight.samples[0].sightings)


def outermost(sight: Sight, things: Sequence[Sighting], which: int) -> Sighting | None:
    """The first (0) or last (-1) from the left, clear of the one beside it."""
    order = sorted(things, key=lambda s: (s.box[0] + s.box[2]) / 2)
    pair = order[:2] if which == 0 else order[-2:]
    return (order[which]) if sight.in_order(pair, 0, 0.05) is not None else None
