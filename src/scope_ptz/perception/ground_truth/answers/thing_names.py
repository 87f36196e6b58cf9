"""Put the names of things, and their positions in the frame, into words."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from scope_ptz import english
from scope_ptz.perception.ground_truth.relations import SIDE_BAND
from scope_ptz.perception.ground_truth.thing_facts import colour_of
from scope_ptz.perception.ground_truth.view import Thing

MAX_NAMED = 8
"""Maximum number of names in a list of things."""


class TruthAnswer(NamedTuple):
    """An answer in words. ``known`` is False if the question cannot be answered."""

    text: str
    known: bool = True


def known_answer(text: str) -> TruthAnswer:
    """Return a known answer."""
    return TruthAnswer(english.sentence(text))


def unknown_answer(text: str) -> TruthAnswer:
    """Return an answer that states why the question cannot be answered."""
    return TruthAnswer(english.sentence(text), known=False)


def coloured_name(thing: Thing) -> str:
    """Return a thing's name, preceded by its colour if the name contains no colour."""
    colour = colour_of(thing)
    words = english.letters(thing.name).split()
    is_proper = thing.name[:2].isupper() or any(word[:1].isupper() for word in thing.name.split()[1:])  # "Hartley & Sons sign"
    shown = thing.name if is_proper else thing.name[:1].lower() + thing.name[1:]
    return shown if colour is None or set(english.letters(colour).split()) & set(words) else f"{colour} {shown}"


def list_names(things: Iterable[Thing]) -> str:
    """List things in words: "a white van, 2 traffic cones, dock doors 2 and 3 and a worker".

    The given order is kept if all things can be named; otherwise, those that look largest are named.
    """
    things = list(things)
    parts = _names(things)
    if len(parts) <= MAX_NAMED:
        return english.listing(parts)
    largest_first = sorted(things, key=lambda t: -t.sighting.pixels)
    return english.listing([*_names(largest_first)[:MAX_NAMED], "smaller things"])


def _names(things: Iterable[Thing]) -> list[str]:
    """Return the names of things with their counts, in the given order."""
    counts = Counter(coloured_name(t) for t in things)
    return [_counted_name(name, count) for name, count in _with_numbers_together(counts).items()]


def _with_numbers_together(counts: Mapping[str, int]) -> dict[str, int]:
    """Return names with their counts, where "dock door 2" and "dock door 3" have become "dock doors 2 and 3"."""
    numbers: dict[str, list[int]] = {}
    for name in counts:
        if match := _NUMBERED.fullmatch(name):
            numbers.setdefault(match["kind"], []).append(int(match["number"]))
    together: dict[str, int] = {}
    for name, count in counts.items():
        match = _NUMBERED.fullmatch(name)
        if match is not None and len(series := numbers[match["kind"]]) > 1:
            together[f"{english.plural(match['kind'])} {english.listing([str(n) for n in sorted(series)])}"] = 1
        else:
            together[name] = count
    return together


_NUMBERED = re.compile(r"(?P<kind>.*[a-z]) (?P<number>\d+)")


def _counted_name(name: str, count: int) -> str:
    return english.article(name) if count == 1 else f"{count} {english.plural(name)}"


def names_with_positions(things: Sequence[Thing]) -> str:
    """List things with their positions: "a white van on the left and 2 red cars in the middle"."""
    counts = Counter((coloured_name(t), position_words(t)) for t in things)
    return english.listing([f"{_counted_name(name, count)} {place}" for (name, place), count in counts.items()])


def position_words(thing: Thing) -> str:
    """Describe a thing's position in the frame: "on the left", "at the top right", "in the middle"."""
    x, y = thing.box.centre
    side = "left" if x < SIDE_BAND else "right" if x > 1 - SIDE_BAND else ""
    level = "top" if y < SIDE_BAND * 0.75 else "bottom" if y > 1 - SIDE_BAND * 0.75 else ""
    if side and not level:
        return f"on the {side}"
    return f"at the {' '.join(x for x in (level, side) if x)}" if level else "in the middle"


def distance_words(distance_m: float) -> str:
    """Return a distance in words. Longer distances are rounded more coarsely."""
    if distance_m < 3:
        return f"{distance_m:.1f} m"
    step = 1 if distance_m < 20 else 5 if distance_m < 100 else 10
    return f"{round(distance_m / step) * step:g} m"


def is_or_are(count: int) -> str:
    """Return "is" or "are" to match a count."""
    return "is" if count == 1 else "are"
