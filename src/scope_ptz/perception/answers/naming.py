"""How things, places and descriptions are put into words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from scope_ptz.perception.facts import colour_of
from scope_ptz.perception.language import syntax as s
from scope_ptz.perception.language import words as w
from scope_ptz.perception.matching import SIDE_BAND, noun_of
from scope_ptz.perception.view import Thing, View


class Reply(NamedTuple):
    """``known`` is False for "I cannot tell"."""

    text: str
    known: bool = True


def reply(text: str) -> Reply:
    return Reply(w.sentence(text))


def unknown(text: str) -> Reply:
    return Reply(w.sentence(text), known=False)


def name(thing: Thing) -> str:
    """What to call a thing: its name, with its colour where the name has none."""
    colour = colour_of(thing)
    words = w.letters(thing.name).split()
    shown = thing.name if thing.name.isupper() else thing.name[:1].lower() + thing.name[1:]
    return shown if colour is None or set(w.letters(colour).split()) & set(words) else f"{colour} {shown}"


def names(things: Iterable[Thing]) -> str:
    """ "a white van, 2 traffic cones and a worker", in the order given."""
    counts = Counter(name(t) for t in things)
    return w.listing([w.article(n) if c == 1 else f"{c} {w.plural(n)}" for n, c in counts.items()])


def place(thing: Thing) -> str:
    """Where in the frame: "on the left", "at the top right", "in the middle"."""
    x, y = thing.box.centre
    side = "left" if x < SIDE_BAND else "right" if x > 1 - SIDE_BAND else ""
    level = "top" if y < SIDE_BAND * 0.75 else "bottom" if y > 1 - SIDE_BAND * 0.75 else ""
    if side and not level:
        return f"on the {side}"
    return f"at the {' '.join(x for x in (level, side) if x)}" if level else "in the middle"


def metres(distance_m: float) -> str:
    """Rounded as a person would say it."""
    step = 1 if distance_m < 20 else 5 if distance_m < 100 else 10
    if distance_m < 3:
        return f"{distance_m:.1f} m"
    return f"{round(distance_m / step) * step:g} m"


def noun(view: View, description: s.Description, many: bool = False) -> str:
    """A description in words again, without articles: "red cars behind the barrier"."""
    return w.listing([_phrase(view, p, many) for p in description.phrases], "or" if not many else "and")


def _phrase(view: View, phrase: s.Phrase, many: bool) -> str:
    head, after = noun_of(view, phrase.words)
    stem = " ".join(head)
    one = " ".join([*head[:-1], w.singular(head[-1])]) if head else "thing"
    if phrase.order:
        stem = one = f"{_SUPERLATIVES[phrase.order.key]} {one}"
    shown = w.plural(one) if many and not phrase.order else one
    parts = [shown or stem, *after, *(said for said in (test_words(view, t) for t in phrase.tests) if said)]
    return " ".join(parts)


_SUPERLATIVES = {
    "left": "left-most", "right": "right-most", "top": "top-most", "bottom": "lowest", "nearest": "nearest", "furthest": "furthest",
    "biggest": "biggest", "smallest": "smallest", "tallest": "tallest", "widest": "widest",
}  # fmt: skip
_RELATIONS = {
    "left": "to the left of", "right": "to the right of", "above": "above", "below": "below", "front": "in front of",
    "behind": "behind", "near": "next to", "on": "on", "facing": "facing",
}  # fmt: skip


def the(view: View, description: s.Description, many: bool = False) -> str:
    return f"the {noun(view, description, many)}"


def test_words(view: View, test: s.Test) -> str:
    """A test as what follows a noun: "behind the barrier", "with a helmet"."""
    match test:
        case s.Relation(kind=kind, other=other):
            return f"{_RELATIONS[kind]} {the(view, other, plural(other))}"
        case s.Between(first=first, second=second):
            return (
                f"between {the(view, first)} and {the(view, second)}"
                if first != second
                else f"between {the(view, first, True)}"
            )
        case s.Region(sides=sides, half=half):
            return region_words(sides, half)
        case s.Has(what=what, worn=worn):
            items = w.listing([w.article(" ".join(p.words)) for p in what.phrases])
            return f"{'wearing' if worn else 'with'} {items}"
        case s.Says(words=words):
            return f'saying "{" ".join(words).upper()}"'
        case s.Is(words=words):
            return " ".join(words)
        case s.Not(test=s.Has(what=what)):
            return f"without {w.listing([w.article(' '.join(p.words)) for p in what.phrases])}"
        case s.Not(test=s.Any(tests=tests)):
            return f"other than {w.listing([test_words(view, t) for t in tests])}"
        case s.Not(test=inner):
            return f"not {test_words(view, inner)}"
        case s.Any(tests=tests):
            return w.listing([test_words(view, t) for t in tests], "or")
        case s.Order(key=key, reference=reference):
            return f"{_SUPERLATIVES[key]} to {the(view, reference)}" if reference else _SUPERLATIVES[key]


def region_words(sides: Sequence[str], half: bool) -> str:
    if sides == ("near",):
        return "in the foreground"
    if sides == ("far",):
        return "in the distance"
    if half:
        return f"in the {' '.join(sides)} half" if len(sides) == 1 else f"in the {' '.join(sides)} quarter"
    if len(sides) > 1:
        return f"in the {' '.join(sides)}"
    return {"middle": "in the middle", "top": "at the top", "bottom": "at the bottom"}.get(
        sides[0], f"on the {sides[0]}"
    )


def plural(description: s.Description) -> bool:
    """Whether the asker spoke of several."""
    return len(description.phrases) > 1 or any(w.is_plural(x) for p in description.phrases for x in p.words[-1:])


def none_of(view: View, description: s.Description) -> str:
    """ "there is no red car in view"."""
    many = plural(description)
    return f"there {'are' if many else 'is'} no {noun(view, description, many).replace(' and ', ' or ')} in view"


def are(count: int) -> str:
    return "is" if count == 1 else "are"


def several(things: Sequence[Thing]) -> str:
    """Things told apart by where they are: "a white van on the left and a red car in the middle"."""
    return w.listing([f"{w.article(name(t))} {place(t)}" for t in things])
