"""Put the names of things, and their positions in the frame, into words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
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
    """List things in words, in the given order: "a white van, 2 traffic cones and a worker"."""
    counts = Counter(coloured_name(t) for t in things)
    parts = [english.article(n) if c == 1 else f"{c} {english.plural(n)}" for n, c in counts.items()]
    if len(parts) > MAX_NAMED:
        more = sum(list(counts.values())[MAX_NAMED:])
        parts = [*parts[:MAX_NAMED], f"{more} more thing{'s' if more > 1 else ''}"]
    return english.listing(parts)


def names_with_positions(things: Sequence[Thing]) -> str:
    """List things with their positions: "a white van on the left and a red car in the middle"."""
    return english.listing([f"{english.article(coloured_name(t))} {position_words(t)}" for t in things])


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
