"""Which things of a view a description means.

Rules, all of them about the picture as the camera sees it:

- *left / right of*: the middle of the box lies further left / right. *Above / below*: the middle lies higher / lower, and the boxes
  overlap sideways or come within a tenth of the frame of it.
- *behind / in front of*: further from / nearer to the camera by half a metre or more, and the boxes overlap sideways (a twentieth of
  the frame is forgiven).
- *near, next to*: no more than 4 m of air between the two in the world.
- *on, in, at, of*: a part of it, or resting inside its outline less than 2 m away, or a fact that says so ("in the left lane").
- *between*: the middle lies between the middles of the two, sideways, and not clearly above, below, before or behind both.
- *on the left*: the middle lies in the left 40% of the frame; *half*: in that half; *corner*: in both 40% bands; *middle*: the
  middle 40%. *In the foreground*, *in the distance*: the nearest and furthest third of the depth in view, on a logarithmic scale.
- Of several matches the one with most pixels comes first, unless a superlative or ordinal orders them; ordinals without a side count
  from the left. Superlatives keep the best only ("the two nearest": two).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import cast

import numpy as np

from scope_ptz.perception.facts import SOFT, bears, canonical, fact_words, facts, fits_noun, fits_words, key_words, wears
from scope_ptz.perception.language import syntax as s
from scope_ptz.perception.language import words as w
from scope_ptz.perception.language.lexicon import lexicon, nouns_in
from scope_ptz.perception.view import Thing, View

NEAR_M = 4.0
ON_M = 2.0
DEPTH_STEP_M = 0.5
SIDE_BAND = 0.4
SIDE_SLACK = 0.05

_SIDES: dict[str, s.OrderKey] = {"left": "left", "right": "right", "top": "top", "bottom": "bottom"}
BACKDROP = frozenset({"surface", "sky"})
"""Concepts that are where things are, rather than things."""


def find(view: View, description: s.Description) -> list[Thing]:
    """Everything that the description means, best first."""
    found: list[Thing] = []
    for phrase in description.phrases:
        found += [t for t in find_phrase(view, phrase) if t not in found]
    return found if len(description.phrases) == 1 else sorted(found, key=_size, reverse=True)


def find_phrase(view: View, phrase: s.Phrase) -> list[Thing]:
    """Everything that one noun phrase means, best first."""
    core, extra, order = _core(view, phrase)
    matches = [t for t in core if all(holds(view, t, test) is True for test in (*phrase.tests, *extra))]
    return _ordered(view, sorted(matches, key=_size, reverse=True), order, phrase)


def noun_of(view: View, words: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The words up to and with the noun, and the words after it (a predicate: "gate open")."""
    spans = nouns_in(words, view.nouns)
    if not spans:
        return (tuple(words[:-1]), tuple(words[-1:])) if len(words) > 1 else (tuple(words), ())
    end = spans[0][1]
    return tuple(words[:end]), tuple(words[end:])


def _core(view: View, phrase: s.Phrase) -> tuple[list[Thing], tuple[s.Test, ...], s.Order | None]:
    """Things that the core words fit, further tests, and the order, where the words hide one ("the left sign")."""
    words = list(phrase.words)
    if phrase.amount is not None and phrase.order is None and words and not w.is_plural(words[-1]) and phrase.amount > 1:
        words.insert(0, str(phrase.amount))
    spans = nouns_in(words, view.nouns)
    carried = any(isinstance(t, s.Relation) and t.kind == "on" for t in phrase.tests)
    for start, end in reversed(spans):
        others = [*words[:start], *words[end:]]
        candidates = _named(view, " ".join(words[start:end]), others, carried)
        literal = [t for t in candidates if _modified(view, t, others)]
        if literal:
            return literal, (), phrase.order
    for start, end in spans:
        sides = [x for x in (*words[:start], *words[end:]) if x in _SIDES or x == "middle"]
        plain = [x for x in (*words[:start], *words[end:]) if x not in sides]
        matches = [t for t in _named(view, " ".join(words[start:end]), plain, carried) if _modified(view, t, plain)]
        if sides and matches:
            return _sided(matches, sides, w.is_plural(words[end - 1]), phrase)
    return [] if spans else [t for t in view.things if _all_words(view, t, words)], (), phrase.order


def _named(view: View, noun: str, others: Sequence[str], carried: bool) -> list[Thing]:
    """Things that a noun names. "The yellow vehicle" may be a machine when no road vehicle is yellow."""
    if lexicon().concept(noun) == "thing":
        return [t for t in view.things if _worth_naming(view, t) or (carried and not t.concepts & BACKDROP)]
    named = [t for t in view.things if fits_noun(view, t, noun)]
    if lexicon().concept(noun) == "vehicle" and others and not any(_modified(view, t, others) for t in named):
        return [t for t in view.things if "machine" in t.concepts]
    return named


def _sided(
    matches: list[Thing], sides: list[str], many: bool, phrase: s.Phrase
) -> tuple[list[Thing], tuple[s.Test, ...], s.Order | None]:
    """ "The left sign" is the left-most, "the left signs" are those on the left, "the top right sign" is nearest that corner."""
    if many:
        return matches, (s.Region(cast("tuple[s.Side, ...]", tuple(sides))),), phrase.order
    if len(sides) == 1 and sides[0] in _SIDES and phrase.order is None:
        return matches, (), s.Order(_SIDES[sides[0]])
    return sorted(matches, key=lambda t: _from_corner(t, sides))[:1], (), phrase.order


def _from_corner(thing: Thing, sides: Sequence[str]) -> float:
    """How far from a corner or the middle of the frame, in frames."""
    x, y = thing.box.centre
    to_x = 0.0 if "left" in sides else 1.0 if "right" in sides else 0.5
    to_y = 0.0 if "top" in sides else 1.0 if "bottom" in sides else 0.5
    return float(np.hypot(x - to_x, y - to_y))


def _worth_naming(view: View, thing: Thing) -> bool:
    """Road, grass and sky are no "objects", and neither is a part of something that is itself in view."""
    return not thing.concepts & BACKDROP and (thing.parent is None or thing.parent not in view.by_id)


def _modified(view: View, thing: Thing, others: Sequence[str]) -> bool:
    if not others:
        return True
    return (
        all(fits_words(view, thing, [x]) is True or _soft(view, thing, x) for x in others)
        or fits_words(view, thing, others) is True
    )


def _soft(view: View, thing: Thing, word: str) -> bool:
    """Whether a word like "big" may be passed over: the scene has no fact about it."""
    return word in SOFT and fits_words(view, thing, [word]) is None and not any(word in values for values in view.values.values())


def _all_words(view: View, thing: Thing, words: Sequence[str]) -> bool:
    """An unknown noun: every word must be found in the thing's own words."""
    return bool(words) and all(
        {canonical(x), canonical(w.singular(x))} & fact_words(thing) or bears(view, thing, [x]) for x in words
    )


def holds(view: View, thing: Thing, test: s.Test) -> bool | None:
    """Whether a test holds for a thing; None where the scene does not say."""
    match test:
        case s.Not(test=inner):
            answer = holds(view, thing, inner)
            return None if answer is None else not answer
        case s.Any(tests=tests):
            answers = [holds(view, thing, t) for t in tests]
            return True if True in answers else None if None in answers else False
        case s.Is(words=words):
            answer = fits_words(view, thing, words)
            return True if answer is None and all(_soft(view, thing, x) for x in words) else answer
        case s.Says(words=words):
            return bears(view, thing, words) or (len(words) == 1 and _faces(thing, words[0]) is True)
        case s.Has(what=what):
            return _has(view, thing, what)
        case s.Region():
            return in_region(view, thing, test)
        case s.Between(first=first, second=second):
            return _between(view, thing, first, second)
        case s.Relation(kind=kind, other=other):
            return related(view, thing, kind, other)
        case s.Measured(key=key, other=other):
            rank = rank_key(key)
            return any(rank(thing) < rank(o) for o in find(view, other)[:1] if o is not thing)
        case s.Within(metres=metres, other=other, beyond=beyond):
            gaps = [thing.distance_m] if other is None else [thing.gap_m(o) for o in find(view, other) if o is not thing]
            return bool(gaps) and (min(gaps) <= metres) is not beyond
        case s.Faces(side=side):
            return _faces(thing, side)
        case s.Order():
            return None


def _faces(thing: Thing, side: str) -> bool | None:
    """Which way a thing points, where the scene says so."""
    for key, value in thing.attributes.items():
        if set(key_words(key)) & {"direction", "facing", "heading", "pointing", "orientation", "arrow"}:
            return side in w.letters(str(value)).split()
    return None


def _has(view: View, thing: Thing, what: s.Description) -> bool:
    """All of the listed things: "with a vest and a helmet"."""
    return all(
        wears(view, thing, phrase.words, phrase.amount)
        and all(not isinstance(t, s.Is | s.Says) or wears(view, thing, (*phrase.words, *t.words)) for t in phrase.tests)
        for phrase in what.phrases
    )


def in_region(view: View, thing: Thing, region: s.Region) -> bool:
    x, y = thing.box.centre
    band = 0.5 if region.half else SIDE_BAND
    checks: dict[str, Callable[[], bool]] = {
        "left": lambda: x < band,
        "right": lambda: x > 1 - band,
        "top": lambda: y < band,
        "bottom": lambda: y > 1 - band,
        "middle": lambda: abs(x - 0.5) <= SIDE_BAND / 2 and (len(region.sides) > 1 or abs(y - 0.5) <= SIDE_BAND),
        "near": lambda: thing.distance_m <= _depth(view, 1 / 3),
        "far": lambda: thing.distance_m >= _depth(view, 2 / 3),
    }
    return all(checks[side]() for side in region.sides)


def _depth(view: View, share: float) -> float:
    """A distance between the nearest and the furthest thing in view: so far along, on a logarithmic scale."""
    distances = [t.distance_m for t in view.top_level() if not t.concepts & BACKDROP]
    near, far = min(distances), max(distances)
    return float(near * (far / near) ** share)


def related(view: View, thing: Thing, kind: s.RelationKind, other: s.Description) -> bool:
    """Whether a thing stands in a relation to any thing that fits ``other``."""
    if kind == "on" and _said(view, thing, other):
        return True
    return any(relation_holds(view, thing, kind, o) for o in find(view, other) if o is not thing)


def _said(view: View, thing: Thing, other: s.Description) -> bool:
    """ "in the left lane", "in an orange vest": a fact or an outfit that says so."""
    words = [x for p in other.phrases for x in p.words]
    if any(set(words) <= set(said) for said in (w.letters(thing.name).split(), *_values(thing))):
        return True
    return wears(view, thing, words)


def _values(thing: Thing) -> Iterable[list[str]]:
    for key, value in facts(thing):
        yield [*w.letters(f"{key.replace('_', ' ')} {value}").split()]


def relation_holds(view: View, a: Thing, kind: s.RelationKind, b: Thing) -> bool:
    """The relations of the picture between two things."""
    (ax, ay), (bx, by) = a.box.centre, b.box.centre
    part = view.belongs(a.id, b.id) or view.belongs(b.id, a.id)
    match kind:
        case "left":
            return ax < bx and not part
        case "right":
            return ax > bx and not part
        case "above":
            return ay < by and _sideways(a, b, 0.1)
        case "below":
            return ay > by and _sideways(a, b, 0.1)
        case "front":
            return not part and a.distance_m <= b.distance_m - DEPTH_STEP_M and _sideways(a, b, SIDE_SLACK)
        case "behind":
            return not part and a.distance_m >= b.distance_m + DEPTH_STEP_M and _sideways(a, b, SIDE_SLACK)
        case "near" | "facing":
            return not part and a.gap_m(b) <= NEAR_M
        case "on":
            return view.belongs(a.id, b.id) or _rests_on(a, b)


def _sideways(a: Thing, b: Thing, slack: float) -> bool:
    return a.box.x_min <= b.box.x_max + slack and b.box.x_min <= a.box.x_max + slack


def _rests_on(a: Thing, b: Thing) -> bool:
    """Its foot inside the outline of the other in the picture, and close to it in the world."""
    x = a.box.centre[0]
    inside = b.box.x_min <= x <= b.box.x_max and b.box.y_min - 0.02 <= a.box.y_max <= b.box.y_max + 0.02
    return inside and a.gap_m(b) <= ON_M and _size(a) < _size(b)


def _between(view: View, thing: Thing, first: s.Description, second: s.Description) -> bool:
    ones, others = find(view, first), find(view, second)
    x = thing.box.centre[0]
    for a in ones:
        for b in others:
            if a is b or thing in (a, b):
                continue
            low, high = sorted((a.box.centre[0], b.box.centre[0]))
            near, far = sorted((a.distance_m, b.distance_m))
            if low < x < high and near - NEAR_M <= thing.distance_m <= far + NEAR_M:
                return True
    return False


def _size(thing: Thing) -> int:
    return thing.sighting.pixels


def rank_key(key: s.OrderKey) -> Callable[[Thing], float]:
    """What a superlative sorts by, best first."""
    keys: dict[str, Callable[[Thing], float]] = {
        "left": lambda t: t.box.centre[0],
        "right": lambda t: -t.box.centre[0],
        "top": lambda t: t.box.centre[1],
        "bottom": lambda t: -t.box.centre[1],
        "nearest": lambda t: t.distance_m,
        "furthest": lambda t: -t.distance_m,
        "biggest": lambda t: -_volume(t),
        "smallest": _volume,
        "tallest": lambda t: -float(t.high_m[2] - t.low_m[2]),
        "widest": lambda t: -float(max(t.high_m[:2] - t.low_m[:2])),
    }
    return keys[key]


def _volume(thing: Thing) -> float:
    """Size in the world: the diagonal of the box, which also orders flat things."""
    return float(((thing.high_m - thing.low_m) ** 2).sum() ** 0.5)


def _ordered(view: View, matches: list[Thing], order: s.Order | None, phrase: s.Phrase) -> list[Thing]:
    if order is None and phrase.ordinal is None:
        return matches
    key = order.key if order else "left"
    if order is not None and order.reference is not None:
        anchors = find(view, order.reference)
        matches = [t for t in matches if t not in anchors]
        if not anchors:
            return []
        sign = 1 if key == "nearest" else -1
        matches.sort(key=lambda t: sign * min(t.gap_m(a) for a in anchors))
    else:
        matches.sort(key=rank_key(key))
    if phrase.ordinal is None:
        return matches[: phrase.amount or 1]
    place = phrase.ordinal - 1 if phrase.ordinal > 0 else phrase.ordinal
    return [matches[place]] if -len(matches) <= place < len(matches) else []
