"""Words for states with their synonyms and opposites, and words that say nothing about a thing."""

from __future__ import annotations

from collections.abc import Set

_STATES = [
    "open: opened ajar",
    "closed: shut locked",
    "lit: illuminated glowing flashing alight",
    "unlit: dark",
    "moving: driving travelling traveling",
    "stationary: parked stopped still standstill idle",
    "empty: unloaded unoccupied vacant free",
    "full: loaded occupied laden",
    "raised: up lifted",
    "lowered: down",
    "walking: strolling",
    "sitting: seated",
    "upright: standing",
    "fallen: toppled overturned lying knocked",
    "working: operating operational active running",
]
"""States with their synonyms, in the form ``state: synonyms``."""
_CANONICAL_FORMS = {word: line.partition(":")[0] for line in _STATES for word in line.replace(":", "").split()} | {
    "gray": "grey", "amber": "orange", "violet": "purple", "golden": "gold", "metallic": "metal", "steel": "metal",
    "standing": "upright", "stand": "upright", "wood": "wooden", "timber": "wooden", "male": "man", "female": "woman",
}  # fmt: skip
_OPPOSITES = [
    ("open", "closed"), ("lit", "unlit"), ("lit", "off"), ("on", "off"), ("moving", "stationary"), ("empty", "full"),
    ("raised", "lowered"),
    ("sitting", "upright"), ("upright", "fallen"), ("walking", "upright"), ("walking", "stationary"), ("walking", "sitting"),
    ("working", "off"), ("waiting", "moving"), ("waiting", "walking"),
]  # fmt: skip
IGNORABLE_WORDS = frozenset({
    "big", "large", "small", "little", "huge", "tiny", "tall", "short", "long", "wide", "narrow", "whole", "entire", "main",
    "other", "visible", "nearby", "actual", "particular", "present", "current", "certain", "same", "real", "single", "lone",
    "only", "different", "various", "individual", "standing", "sitting", "hanging", "lying", "placed", "full-size", "mounted",
    "shown", "displayed", "there", "located", "parked", "stationary", "moving",
})  # fmt: skip
"""Words in a description that are ignored if the scene states no fact about them."""
FILLER_WORDS = frozenset({
    "the", "a", "an", "is", "are", "it", "its", "of", "in", "on", "at", "and", "be", "being", "with", "very", "quite",
    "really", "currently", "colour", "color", "coloured", "colored", "one", "ones", "parts",
})  # fmt: skip
"""Words that say nothing about a thing and are skipped. "On" and "in" are tested if no other word remains ("is it on?")."""


def canonical_form(word: str) -> str:
    """Return the canonical synonym of a word, or the word itself."""
    return _CANONICAL_FORMS.get(word, word)


def are_opposites(a: str, b: str) -> bool:
    """Return whether two words are mutually exclusive."""
    return (a, b) in _OPPOSITES or (b, a) in _OPPOSITES


def opposites_of(words: Set[str]) -> set[str]:
    """Return the words that are the opposite of any of some words."""
    return {b for pair in _OPPOSITES for a, b in (pair, pair[::-1]) if a in words}
