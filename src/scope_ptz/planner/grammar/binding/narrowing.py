"""Narrow a description by a predicate: cars that are "black", workers that "wear helmets", people "in the right half"."""

from __future__ import annotations

import re

from scope_ptz.english import COLOURS
from scope_ptz.english.grammar.lexicon import lexicon, nouns_in
from scope_ptz.english.grammar.parts_of_speech import parts_of_speech
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.question_parser import parse_description
from scope_ptz.planner.grammar.binding.noun_heads import bare_noun, is_ranked, with_ones_replaced
from scope_ptz.planner.grammar.execution.answer_sentences import head_and_rest, noun

_BOUNDARY = re.compile(
    r"\s(?=(?:(?:not )?(?:in|on|at|near|behind|beside|under|above|between|from|inside|outside|next|with|without|to the|along|"
    r"across|around|opposite|saying|facing|that|which|who)|(?:not )?\w+ing)\b)"
)
_VERBS = {
    "wear": "wearing", "wears": "wearing", "have": "with", "has": "with", "carry": "carrying", "carries": "carrying",
    "hold": "holding", "holds": "holding", "ride": "riding", "sit": "sitting", "stand": "standing", "walk": "walking",
    "say": "saying", "face": "facing",
}  # fmt: skip
_REGION_NOUN = re.compile(r"\b(?P<noun>half|quarter|third|corner|side|part|section)$", re.IGNORECASE)
_REGION_WITHOUT_NOUN = re.compile(
    r"(?:in the )?(?P<sides>(?:top|bottom|upper|lower|middle|centre|left|right)(?:[ -](?:left|right))?)(?: one)?", re.IGNORECASE
)
_SIDES = frozenset({"left", "right", "left-hand", "right-hand", "top", "bottom", "middle", "upper", "lower"})
_ONE_AT = re.compile(r"ones? (?P<place>(?:in|on|at|to) .+)", re.IGNORECASE)
_WEARING = re.compile(r"\b(?:with|without|wearing|in) (?:the |an? )?(.+)$", re.IGNORECASE)
_ITEM = re.compile(r"\b(?:wearing|with|without|carrying|holding) (?:an? |the )?((?:\w+ ){0,2}\w+)$", re.IGNORECASE)
_CLOTHES = frozenset({"hat", "jacket", "vest", "clothes", "hard hat", "trousers", "dress", "skirt", "scarf", "shoes"})
_EXCLUSIVE_STATES = (
    frozenset({"open", "closed", "shut"}), frozenset({"lit", "unlit"}), frozenset({"empty", "full", "loaded"}),
    frozenset({"raised", "lowered"}), frozenset({"moving", "stationary", "parked"}),
)  # fmt: skip
_SYNONYMS = (
    frozenset({"closed", "shut"}), frozenset({"full", "loaded"}), frozenset({"stationary", "parked"}), frozenset({"grey", "gray"}),
    frozenset({"gold", "golden"}),
)  # fmt: skip
"""Words for one colour or state, so that things of both must not be added."""

_RIDDEN = frozenset({"cyclist", "bicycle"})
"""A rider and what is ridden, which may be one thing to perception."""

_OPPOSITE_SIDES = (({"left"}, {"right"}), ({"top", "upper"}, {"bottom", "lower"}))
_POSTURES = frozenset(
    {"sitting", "standing", "walking", "kneeling", "lying", "running", "crouching", "cycling", "parked", "moving"}
)


def as_modifier(predicate: str) -> str:
    """Return a predicate as words for a noun: "wearing helmets" for "wear helmets" and "are wearing helmets"."""
    words = re.sub(r"^(?:is|are|was|were)\s+(?=\w)", "", predicate.strip(), flags=re.IGNORECASE)
    if negated := re.match(r"(?:do|does)(?: not|n['’]t) (?:have|wear) ", words, re.IGNORECASE):
        return f"without {words[negated.end() :]}"
    first, _, rest = words.partition(" ")
    return " ".join(x for x in (_VERBS.get(first.lower(), first), rest) if x)


def narrowed(description: str, predicate: str) -> str:
    """Return a description of those things for which a predicate also holds.

    What the predicate contradicts is replaced: of "people in the left half", "in the right half" leaves "people in the right half".
    """
    modifier = as_modifier(predicate)
    if modifier.lower() in COLOURS and (recoloured := _recoloured(description, modifier)):
        return recoloured
    head, rest = head_and_rest(description)
    kind = _kind(modifier)
    parts = [part for part in _BOUNDARY.split(rest.strip()) if part and _kind(part) != kind] if rest else []
    words = head.split(" ")
    if modifier.lower() in COLOURS or _is_adjective(modifier):
        front = [word for word in words[:-1] if not _says_the_same_of(word.lower(), modifier.lower())]
        return " ".join([modifier, *front, words[-1], *parts])
    if kind == "posture":
        words = [word for word in words if word.lower() not in _POSTURES] or words
    if kind == "place":
        return " ".join([*words, modifier, *parts])  # "wearing helmets in the left half" would be a place of the helmets
    return " ".join([*words, *parts, modifier])


def _excludes(one: str, other: str) -> bool:
    """Return whether nothing can be described by both of two adjectives: two colours, or "open" and "closed"."""
    return _says_the_same_of(one, other) and not any({one, other} <= words for words in _SYNONYMS)


def _says_the_same_of(one: str, other: str) -> bool:
    """Return whether two adjectives both state the colour of a thing, or both whether it is open, lit, empty, raised or moving."""
    return {one, other} <= COLOURS or any({one, other} <= states for states in _EXCLUSIVE_STATES)


def is_state(word: str) -> bool:
    """Return whether a word names a state that excludes another one: "open", "parked"."""
    return any(word in states for states in _EXCLUSIVE_STATES)


def without_contradicted(description: str, question: str) -> str:
    """Return a description without words that a question contradicts: "doors" if it asks which open doors are closed."""
    asked = re.findall(r"[\w-]+", question.lower())
    head, rest = head_and_rest(description)
    return " ".join(w for w in head.split(" ") if not any(_excludes(w.lower(), a) for a in asked if a != w.lower())) + rest


def are_exclusive(one: str, other: str) -> bool:
    """Return whether nothing can fit both of two descriptions, so that their counts can be added.

    These are things of different kinds, none of which contains the other, and things of one kind in opposite parts of the picture,
    of different colours or in opposite states.
    """
    (head, rest), (other_head, other_rest) = head_and_rest(one.lower()), head_and_rest(other.lower())
    kinds, other_kinds = _concepts(head), _concepts(other_head)
    if kinds | other_kinds == _RIDDEN:
        return False
    if kinds and other_kinds and not kinds & other_kinds:
        return not any(kind & _concepts_above(names) for kind, names in ((kinds, other_kinds), (other_kinds, kinds)))
    words, other_words = head.split(" ")[:-1], other_head.split(" ")[:-1]
    if any(_excludes(a, b) for a in words for b in other_words if a != b):
        return True
    sides = {*rest.split(" ")} if is_region(rest) else set()
    other_sides = {*other_rest.split(" ")} if is_region(other_rest) else set()
    return any((sides & a and other_sides & b) or (sides & b and other_sides & a) for a, b in _OPPOSITE_SIDES)


def _concepts(head: str) -> frozenset[str]:
    """Return the concept of a head noun; nothing for an unknown one."""
    concept = lexicon().concept(bare_noun(head))
    return frozenset() if concept is None else frozenset({concept})


def _concepts_above(concepts: frozenset[str]) -> frozenset[str]:
    return frozenset().union(*(lexicon().kinds(concept) for concept in concepts))


def _recoloured(description: str, colour: str) -> str:
    """Return a description with another colour for what the things have or are at; empty if it names no such colour.

    After "people with red jackets" and "sign on the green cabin", another colour is that of the jackets and of the cabin.
    """
    head, rest = head_and_rest(description)
    colours = [word for word in rest.split(" ") if word.lower() in COLOURS]
    if len(colours) != 1 or any(word.lower() in COLOURS for word in head.split(" ")):
        return ""
    return head + " ".join(colour if word == colours[0] else word for word in rest.split(" "))


def names_region(noun_phrase: str) -> bool:
    """Return whether a noun phrase names a part of the picture: "left half", "bottom right quarter"."""
    return _REGION_NOUN.search(noun_phrase) is not None and is_region(f"in the {noun_phrase}")


def is_region(predicate: str) -> bool:
    """Return whether a predicate only says in which part of the picture things are: "in the left half", "on the right"."""
    return _kind(as_modifier(predicate)) == "place"


def with_region_noun(predicate: str, description: str) -> str:
    """Complete a predicate that leaves out the noun of a part of the picture.

    After "people in the top left quarter", "in the bottom right one" means "in the bottom right quarter".
    """
    left_out = _REGION_WITHOUT_NOUN.fullmatch(predicate.strip())
    region = _REGION_NOUN.search(description)
    if left_out is None or region is None:
        return predicate
    return f"in the {left_out['sides']} {region['noun']}"


def _is_adjective(text: str) -> bool:
    """Return whether text is one word that can stand before a noun, as in "broken windows"."""
    return " " not in text and not text.endswith("ing") and "ADJ" in parts_of_speech(text.lower())


def _kind(modifier: str) -> str:
    """Return what a modifier says: "place", "clothes", "posture", or the modifier itself for anything else."""
    first = modifier.removeprefix("not ").split(" ")[0].lower()
    if first in _POSTURES:
        return "posture"
    tests = {type(test) for phrase in parse_description(f"thing {modifier}").phrases for test in phrase.tests}
    return "place" if tree.Region in tests else "clothes" if tree.Has in tests and first in {"wearing", "in"} else modifier


def last_item(description: str) -> str:
    """Return what each of several people wears or carries: "helmet" for "workers wearing helmets"; empty for nothing."""
    matches = list(_ITEM.finditer(description))
    return noun(matches[-1][1], 1) if matches else ""


def with_noun(phrase: str, description: str, *, is_group: bool = False) -> str:
    """Replace "one" by the noun of a description: "blue one" becomes "blue taxi" after "how many black taxis are there?".

    Args:
        phrase: The phrase.
        description: The description.
        is_group: Whether it describes several things that were named together. "The nearest one" is then one of these, so that it
            stays "the nearest black taxi".
    """
    colour, _, one = phrase.rpartition(" ")
    stands_for_noun, number = one in {"one", "ones"}, 2 if one == "ones" else 1
    if stands_for_noun and colour.lower() in COLOURS and (recoloured := _recoloured(description, colour)):
        return noun(recoloured, number)
    if is_group and stands_for_noun and _tells_apart(colour):
        return f"{colour} {noun(description, number)}"
    if is_group and (place := _ONE_AT.fullmatch(phrase)) is not None and is_region(place["place"]):
        return narrowed(noun(description, number), place["place"])
    head = bare_noun(description)
    return with_ones_replaced(phrase, lambda one: noun(head, 2 if one == "ones" else 1)) if head else phrase


def _tells_apart(words: str) -> bool:
    """Return whether words before "one" only say which of several things is meant: "leftmost", "nearest", "second"."""
    return is_ranked(f"{words} thing") or words.lower() in _SIDES


def is_worn(phrase: str) -> bool:
    """Return whether a phrase says what somebody wears: "one with the blue helmet", "one in the red coat"."""
    match = _WEARING.search(phrase)
    if match is None:
        return False
    words = tuple(match[1].lower().split(" "))
    concepts = (lexicon().concept(" ".join(words[start:end])) for start, end in nouns_in(words))
    return any(concept is not None and lexicon().kinds(concept) & _CLOTHES for concept in concepts)
