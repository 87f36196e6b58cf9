"""Search a view for the things that match a description.

- Facts that the scene states ("in the left lane", "in an orange vest") take precedence over the spatial relations of ``relations``.
- *at*: people are at a thing if they are at most 1 m from it.
- *in* a vehicle or a machine: only people whom the scene models as part of it.
- *outside* a building or a vehicle: near it, and not on or in it. Roads and sites have no outside that a picture shows.
- *waiting at* a place: being there, and not walking, because a picture shows no more.
- "*The* car on the left", if no car is in the left band of the frame, is the leftmost car in the left half.
- *between*: the centre lies horizontally between the centres of two things, and the thing is not clearly in front of both or behind
both.
- Matches are sorted by visible pixels, largest first, unless a superlative or an ordinal orders them. Ordinals without a side
count from the left. A superlative keeps only the best match ("the two nearest" keeps two).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import cast

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import lexicon, nouns_in
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.ambiguity import is_person
from scope_ptz.perception.ground_truth.full_names import find_by_full_name
from scope_ptz.perception.ground_truth.relations import (
    BACKGROUND_CONCEPTS,
    NEAR_M,
    OUTSIDE_CONCEPTS,
    distance_to_corner,
    is_facing,
    is_in_region,
    is_outside,
    rank_key,
    relation_holds,
    visible_pixels,
)
from scope_ptz.perception.ground_truth.stated_items import as_worn, is_open_item
from scope_ptz.perception.ground_truth.thing_facts import (
    SEXES,
    colour_of,
    facts,
    fits_noun,
    fits_words,
    has_item,
    has_text,
    is_sexed,
    sex_fits,
    stated_sex,
)
from scope_ptz.perception.ground_truth.view import Thing, View, trades_of
from scope_ptz.perception.ground_truth.vocabulary import FILLER_WORDS, IGNORABLE_WORDS

INSIDE = frozenset({"in", "inside", "inside of", "inside the"})
"""The prepositions of kind "on" that say that a thing is inside another."""
AT_M = 1.0  # maximum gap between a thing and the people who are at it
_SIDES: dict[str, tree.OrderKey] = {"left": "left", "right": "right", "top": "top", "bottom": "bottom"}


def find(view: View, description: tree.Description) -> list[Thing]:
    """Return all things that match a description, best first."""
    matches = find_excluding_wearers(view, description)
    if matches or len(description.phrases) != 1:
        return matches
    (phrase,) = description.phrases
    return find_by_full_name(view, phrase) or _find_wearers(view, phrase)


def find_excluding_wearers(view: View, description: tree.Description) -> list[Thing]:
    """Return the things that match a description, excluding people who wear the described clothes."""
    matches = _find_two_coloured(view, description)
    if matches:
        return matches
    for phrase in description.phrases:
        matches += [t for t in find_phrase(view, phrase) if t not in matches]
    if len(description.phrases) == 1:
        (phrase,) = description.phrases
        return _most_likely(phrase, matches) or _find_compound(view, phrase)
    return sorted(matches, key=visible_pixels, reverse=True)


def find_references(view: View, description: tree.Description) -> list[Thing]:
    """Return the things that a place refers to ("the path" in "on the path"). A part of a surface is enough for that."""
    return find(view.with_surfaces, description)


def _find_compound(view: View, phrase: tree.Phrase) -> list[Thing]:
    """Return "raised barrier arms" for "raised barriers", if only things of a compound name have such a state."""
    head, after = split_after_noun(view, phrase.words)
    states = {*head[:-1], *after, *(x for t in phrase.tests if isinstance(t, tree.Is) for x in t.words)}
    if not states or states & english.COLOURS:
        return []
    for category in compound_categories(view, english.singular(head[-1])):
        if matches := find_phrase(view, replace(phrase, words=(*head[:-1], *category.split(), *after))):
            return matches
    return []


def compound_categories(view: View, noun: str) -> list[str]:
    """Return the categories in view with a compound name that begins with a noun and means it: "barrier arm" for "barrier".

    Most compounds do not: a bus shelter is no bus.
    """
    concept = lexicon().concept(noun)
    return [
        category
        for category in dict.fromkeys(t.category for t in view.things if t.category.startswith(f"{noun} "))
        if (noun, category) in _PARTS_FOR_WHOLES
        or (concept is not None and (kind := lexicon().concept(category)) is not None and concept in lexicon().kinds(kind))
    ]


_PARTS_FOR_WHOLES = frozenset({("barrier", "barrier arm"), ("dock", "dock door")})
"""Things that have the state of the whole, with the parts that scenes model: an open barrier is one with a raised arm."""


def _find_wearers(view: View, phrase: tree.Phrase) -> list[Thing]:
    """Return the people who wear what the phrase describes ("hard hats"), because clothes are not separate things."""
    if phrase.tests or phrase.order or phrase.ordinal or not nouns_in(phrase.words) or is_person(phrase.words):
        return []
    if (concept := lexicon().concept(phrase.words[-1])) in view.concepts and "animal" in lexicon().kinds(concept):
        return []  # a dog walker is no dog, if the scene has dogs
    return sorted(
        (t for t in view.things if "person" in t.concepts and has_item(view, t, phrase.words)), key=visible_pixels, reverse=True
    )


def _find_two_coloured(view: View, description: tree.Description) -> list[Thing]:
    """Find "red and white barriers", which have both colours. If there are none, the caller searches for each colour."""
    phrases = description.phrases
    if len(phrases) != 2 or any(len(p.words) < 2 or p.words[0] not in english.COLOURS for p in phrases):
        return []
    first, second = phrases
    if (first.words[1:], first.tests, first.order) != (second.words[1:], second.tests, second.order):
        return []
    requested = {p.words[0] for p in phrases}
    without_colour = replace(first, words=first.words[1:])
    return [t for t in find_phrase(view, without_colour) if requested <= set(english.letters(colour_of(t) or "").split())]


def find_phrase(view: View, phrase: tree.Phrase) -> list[Thing]:
    """Return all things that match one noun phrase, best first."""
    asked, phrase = phrase, _without_waiting_at_place(phrase)
    core, extra, order = _match_core(view, phrase)
    if phrase is not asked:
        core = [t for t in core if fits_words(view, t, ["walking"]) is not True]
    tests = (*phrase.tests, *extra)
    matches = [t for t in core if all(holds(view, t, test) is True for test in tests)] or _one_on_side(view, phrase, core, tests)
    return _select_by_order(view, sorted(matches, key=visible_pixels, reverse=True), order, phrase)


def _most_likely(phrase: tree.Phrase, matches: list[Thing]) -> list[Thing]:
    """Return the matches that a phrase in the singular most likely means; all of them if none is more likely.

    "The barrier" is the barrier arm, and not a block of concrete beside it. "The woman" is a person who is stated to be one, and
    not one of unknown sex.
    """
    if len(matches) < 2 or not phrase.words or english.is_plural(phrase.words[-1]):
        return matches
    if SEXES.keys() & set(phrase.words):
        return [t for t in matches if stated_sex(t) is not None] or matches
    is_definite = phrase.article != "a" and len(phrase.words) == 1
    return (is_definite and [t for t in matches if _is_barrier_arm_for(t, phrase.words[0])]) or matches


def _is_barrier_arm_for(thing: Thing, noun: str) -> bool:
    """Return whether a thing is the arm of what a noun names, a "barrier arm" for "barriers"."""
    return "boom gate" in thing.concepts and thing.category.startswith(f"{english.singular(noun)} ")


def _one_on_side(view: View, phrase: tree.Phrase, core: Sequence[Thing], tests: Sequence[tree.Test]) -> list[Thing]:
    """Return the thing that "the car on the left" means if none is far to the left: the leftmost of those in the left half."""
    is_one = phrase.article == "the" and not english.is_plural(phrase.words[-1]) and phrase.order is None
    regions = [t for t in tests if isinstance(t, tree.Region) and t.sides in {("left",), ("right",)} and not t.half]
    if not is_one or len(regions) != 1:
        return []
    (side,) = regions[0].sides
    wider = [tree.Region((side,), half=True) if t is regions[0] else t for t in tests]
    candidates = [t for t in core if all(holds(view, t, test) is True for test in wider)]
    return sorted(candidates, key=rank_key(_SIDES[side]))[:1]


def _without_waiting_at_place(phrase: tree.Phrase) -> tree.Phrase:
    """Return "people at the bus stop" for "people waiting at the bus stop": nobody can see more than that they are there."""
    if not any(is_place(test) for test in phrase.tests):
        return phrase
    words = tuple(x for x in phrase.words if x != "waiting")
    if words == phrase.words and tree.Is(("waiting",)) not in phrase.tests:
        return phrase
    return replace(phrase, words=words or phrase.words, tests=without_waiting(phrase.tests))


def is_place(test: tree.Test) -> bool:
    """Return whether a test is for a place beside, on or at other things."""
    return isinstance(test, tree.Relation) and test.kind in {"on", "near", "front", "behind"} and test.preposition not in {"", "of"}


def without_waiting(tests: tuple[tree.Test, ...]) -> tuple[tree.Test, ...]:
    """Return the tests without the word "waiting", if one of the others is for a place."""
    return tuple(t for t in tests if t != tree.Is(("waiting",))) if any(map(is_place, tests)) else tests


def split_after_noun(view: View, words: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Split words after the noun. The words after it form a predicate, as in "gate open"."""
    spans = nouns_in(words, view.nouns)
    if not spans:
        return (tuple(words[:-1]), tuple(words[-1:])) if len(words) > 1 else (tuple(words), ())
    end = spans[0][1]
    return tuple(words[:end]), tuple(words[end:])


def split_after_numbered_noun(view: View, words: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Split words as ``split_after_noun`` does, but keep a number after the noun with it: "bay 14" and "empty"."""
    head, after = split_after_noun(view, words)
    size = 1 if after and english.cardinal(after[0]) is not None else 0
    return (*head, *after[:size]), after[size:]


def _match_core(view: View, phrase: tree.Phrase) -> tuple[list[Thing], tuple[tree.Test, ...], tree.Order | None]:
    """Return three values: the things that match the core words, the additional tests that they must pass, and the order.

    Words for sides among the core words add a test ("the left signs") or set the order ("the left sign").
    """
    words = list(phrase.words)
    if phrase.amount is not None and phrase.order is None and words and not english.is_plural(words[-1]) and phrase.amount > 1:
        words.insert(0, str(phrase.amount))
    spans = nouns_in(words, view.nouns)
    include_parts = any(isinstance(t, tree.Relation) and t.kind == "on" for t in phrase.tests)
    for start, end in reversed(spans):
        others = [*words[:start], *words[end:]]
        candidates = _find_by_noun(view, " ".join(words[start:end]), others, include_parts)
        literal_matches = [t for t in candidates if _modifiers_hold(view, t, others)]
        if literal_matches:
            return literal_matches, (), phrase.order
    for start, end in spans:
        sides = [x for x in (*words[:start], *words[end:]) if x in _SIDES or x == "middle"]
        other_words = [x for x in (*words[:start], *words[end:]) if x not in sides]
        matches = [
            t
            for t in _find_by_noun(view, " ".join(words[start:end]), other_words, include_parts)
            if _modifiers_hold(view, t, other_words)
        ]
        if sides and matches:
            return _apply_sides(matches, sides, english.is_plural(words[end - 1]), phrase)
    return [] if spans else [t for t in view.things if _all_words_hold(view, t, words)], (), phrase.order


def _find_by_noun(view: View, noun: str, others: Sequence[str], include_parts: bool) -> list[Thing]:
    """Return the things that a noun names. If no vehicle matches the other words ("yellow vehicle"), machines count as vehicles.

    "Thing" names all independent objects and, if ``include_parts`` is set ("the things on the van"), their parts.
    """
    if lexicon().concept(noun) == "thing":
        return [t for t in view.things if _is_object(view, t) or (include_parts and not t.concepts & BACKGROUND_CONCEPTS)]
    named = [t for t in view.things if fits_noun(view, t, noun) or _is_barrier_arm_for(t, noun)]
    if lexicon().concept(noun) == "vehicle" and others and not any(_modifiers_hold(view, t, others) for t in named):
        return [t for t in view.things if "machine" in t.concepts]
    return named


def _apply_sides(
    matches: list[Thing], sides: list[str], plural: bool, phrase: tree.Phrase
) -> tuple[list[Thing], tuple[tree.Test, ...], tree.Order | None]:
    """Apply words for sides.

    "The left sign" is the left-most one, "the left signs" are on the left, and "the top right sign" is nearest to that corner.
    """
    if plural:
        return matches, (tree.Region(cast("tuple[tree.Side, ...]", tuple(sides))),), phrase.order
    if len(sides) == 1 and sides[0] in _SIDES and phrase.order is None:
        return matches, (), tree.Order(_SIDES[sides[0]])
    return sorted(matches, key=lambda t: distance_to_corner(t, sides))[:1], (), phrase.order


def _is_object(view: View, thing: Thing) -> bool:
    """Return whether a thing is an independent object: neither background nor a part of something else in view."""
    return not thing.concepts & BACKGROUND_CONCEPTS and (thing.parent is None or thing.parent not in view.by_id)


def _modifiers_hold(view: View, thing: Thing, others: Sequence[str]) -> bool:
    """Return whether the words of a phrase other than its noun hold for a thing."""
    if not others:
        return True
    return (
        all(fits_words(view, thing, [x]) is True or _is_ignorable(view, thing, x) for x in others)
        or fits_words(view, thing, others) is True
    )


def _is_ignorable(view: View, thing: Thing, word: str) -> bool:
    """Return whether a word such as "big" is ignored because the scene has no fact about it."""
    return (
        word in IGNORABLE_WORDS
        and fits_words(view, thing, [word]) is None
        and not any(word in values for values in view.values.values())
    )


def _all_words_hold(view: View, thing: Thing, words: Sequence[str]) -> bool:
    """Return whether a thing matches a phrase with an unknown noun: every word must hold for it."""
    return not set(words) <= FILLER_WORDS and all(fits_words(view, thing, [x]) is True for x in words)


def holds(view: View, thing: Thing, test: tree.Test) -> bool | None:
    """Return whether a test holds for a thing; None if the scene does not state that."""
    match test:
        case tree.Not(test=inner):
            answer = holds(view, thing, inner)
            return None if answer is None else not answer
        case tree.Any(tests=tests):
            answers = [holds(view, thing, t) for t in tests]
            return True if True in answers else None if None in answers else False
        case tree.Is(words=words) if "person" in thing.concepts and is_sexed(words):
            return sex_fits(thing, next(x for x in words if x not in FILLER_WORDS))
        case tree.Is(words=words):
            answer = fits_words(view, thing, words)
            return True if answer is None and all(_is_ignorable(view, thing, x) for x in words) else answer
        case tree.Says(words=words):
            if has_text(thing, words) or (len(words) == 1 and is_facing(thing, words[0]) is True):
                return True
            return None if any(not t.legible for t in view.texts_on(thing)) else False
        case tree.Has(what=what, worn=worn):
            is_open = is_open_item(view, thing, what, worn or ("person" in thing.concepts and as_worn(test) is not None))
            return _has(view, thing, what) or (None if is_open else False)
        case tree.Relation() if "person" in thing.concepts and (clothes := as_worn(test)) is not None:
            return _holds_in_space(view, thing, test) or holds(view, thing, clothes)
        case tree.Faces(side=side):
            return is_facing(thing, side)
        case tree.Order():
            return None
        case _:
            return _holds_in_space(view, thing, test)


def _holds_in_space(
    view: View, thing: Thing, test: tree.Region | tree.Between | tree.Relation | tree.Measured | tree.Within
) -> bool:
    """Return whether a test about place, distance or size holds for a thing."""
    match test:
        case tree.Region():
            return is_in_region(view, thing, test)
        case tree.Between(first=first, second=second):
            return _is_between(view, thing, first, second)
        case tree.Relation(kind=kind, other=other, preposition=preposition):
            return has_relation(view, thing, kind, other, preposition)
        case tree.Measured(key=key, other=other):
            rank = rank_key(key)
            return any(rank(thing) < rank(o) for o in find(view, other)[:1] if o is not thing)
        case tree.Within(metres=metres, other=other, beyond=beyond):
            gaps = [thing.distance_m] if other is None else [thing.gap_m(o) for o in find(view, other) if o is not thing]
            return bool(gaps) and (min(gaps) <= metres) is not beyond


def _has(view: View, thing: Thing, what: tree.Description) -> bool:
    """Return whether a thing has everything in a list ("with a vest and a helmet")."""
    return all(
        has_item(view, thing, phrase.words, phrase.amount)
        and all(not isinstance(t, tree.Is | tree.Says) or has_item(view, thing, (*phrase.words, *t.words)) for t in phrase.tests)
        for phrase in what.phrases
    )


def has_relation(view: View, thing: Thing, kind: tree.RelationKind, other: tree.Description, preposition: str = "") -> bool:
    """Return whether a thing has a relation to any thing that matches ``other``."""
    others = find_excluding_wearers(view.with_surfaces, other)
    if is_outside(preposition):
        fronts = [o for o in others if o is not thing and not relation_holds(view, thing, "on", o)]
        return has_outside(view, other) and any(relation_holds(view, thing, "near", o) for o in fronts)
    if kind == "on" and not preposition and thing in others and trades_of(thing.sighting.instance):
        return True  # "the chemist's shop" is the chemist
    if preposition in INSIDE and "person" in thing.concepts and _names_vehicle(view, other):
        return any(view.belongs(thing.id, o.id) for o in others)  # a lorry driver is not always in the lorry
    if _is_only_colour(other) and "person" in thing.concepts:
        return kind == "on" and has_item(view, thing, other.phrases[0].words)
    if kind == "on" and thing not in others and _is_stated(view, thing, other):
        return True
    if preposition == "at" and "person" in thing.concepts:  # people stand in front of a counter, not on it
        return any(relation_holds(view, thing, kind, o) or thing.gap_m(o) <= AT_M for o in others if o is not thing)
    return any(relation_holds(view, thing, kind, o) for o in others if o is not thing)


def has_outside(view: View, place: tree.Description) -> bool:
    """Return whether a picture shows what is outside a place: that of a building or a vehicle, and not that of "the site"."""
    spans = [p.words[start:end] for p in place.phrases for start, end in nouns_in(p.words, view.nouns)]
    concepts = [c for words in spans if (c := lexicon().concept(" ".join(words))) is not None]
    kinds = [lexicon().kinds(c) for c in concepts]
    things = find(view.with_surfaces, place) if spans else []
    return any(x & OUTSIDE_CONCEPTS for x in (*kinds, *(t.concepts for t in things)))


def _is_only_colour(other: tree.Description) -> bool:
    """Return whether a description has no noun: "a man in red" is a person in red clothes, and not in a red thing."""
    return all(x in english.COLOURS for phrase in other.phrases for x in phrase.words)


def _names_vehicle(view: View, other: tree.Description) -> bool:
    """Return whether the noun of a description is a vehicle or a machine."""
    phrase = other.phrases[0]
    return bool(nouns_in(phrase.words, view.nouns)) and any(t.concepts & {"vehicle", "machine"} for t in find_phrase(view, phrase))


def _is_stated(view: View, thing: Thing, other: tree.Description) -> bool:
    """Return whether a fact or clothing states the relation: "in the left lane", "in an orange vest"."""
    words = [x for p in other.phrases for x in p.words]
    names = english.letters(_ELSEWHERE.sub("", thing.name.lower())).split()
    if any(set(words) <= set(stated) for stated in (names, *_fact_words(thing))):
        return True
    return has_item(view, thing, words)


_ELSEWHERE = re.compile(r"\b(?:for|to|by|beside|near|behind) .*")
"""The end of a name or fact that says what a thing is beside, and not in: "visitor beside a car"."""

# Words for lanes, by lane number.
_LANES = {1: "left inside slow nearside first", 2: "middle centre second", 3: "right outside fast third overtaking"}


def _fact_words(thing: Thing) -> Iterable[list[str]]:
    """Yield the words in each fact about a thing."""
    for key, value in facts(thing):
        yield english.letters(f"{key.replace('_', ' ')} {_ELSEWHERE.sub('', str(value).lower())}").split()
        if key == "lane" and isinstance(value, int):
            yield ["lane", *_LANES.get(value, "").split()]


def _is_between(view: View, thing: Thing, first: tree.Description, second: tree.Description) -> bool:
    """Return whether a thing is between any two things that match the descriptions."""
    first_things, second_things = find(view, first), find(view, second)
    x = thing.box.centre[0]
    for a in first_things:
        for b in second_things:
            if a is b or thing in (a, b):
                continue
            low, high = sorted((a.box.centre[0], b.box.centre[0]))
            near, far = sorted((a.distance_m, b.distance_m))
            if low < x < high and near - NEAR_M <= thing.distance_m <= far + NEAR_M:
                return True
    return False


def _select_by_order(view: View, matches: list[Thing], order: tree.Order | None, phrase: tree.Phrase) -> list[Thing]:
    """Return the matches that a superlative, an ordinal and an amount select, in their order."""
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
    index = phrase.ordinal - 1 if phrase.ordinal > 0 else phrase.ordinal
    return [matches[index]] if -len(matches) <= index < len(matches) else []
