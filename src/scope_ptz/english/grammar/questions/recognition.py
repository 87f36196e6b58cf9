"""Test whether text is a noun phrase, without building its meaning."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache, lru_cache
from importlib.resources import files

from scope_ptz.english.grammar.questions.chart_parser import ChartParser
from scope_ptz.english.grammar.questions.typed_tokens import Token, tokenise

_NOUNS_OR_VERBS = frozenset({"face", "faces", "point", "points", "stand", "stands", "show", "hold"})
"""Words that the grammar reads as verbs, although they may be nouns: "the man's face", "the taxi stand"."""

MAX_TOKENS = 40
"""Maximum number of tokens. Longer input is rejected, because it is slow to parse and unlikely to be about a picture."""

MAX_CONNECTIVES = 6
"""Maximum number of connectives ("next to", "with", "that"), each of which multiplies the number of readings."""

_CONNECTIVES = frozenset({"REL", "WITH", "WITHOUT", "WEAR", "HAVE", "OF", "BETWEEN", "THAT", "FROM", "TO", "EXCEPT"})
_PARTICIPLE_PHRASE = re.compile(
    r"(?P<noun>.+?) \w+(?:ing|ed)(?: (?:off|on|to|through|into|onto|up|down|out|away|over|from|at|for|by|past|across|there|here))*"
    r"(?: (?P<object>.+))?",
    re.IGNORECASE,
)
"""The pattern for a noun phrase with a participle: "man pushing the trolley", "bicycle tied to the fence"."""

_CLIMBABLE = (
    "ladder|road|street|hill|steps|stairs|ramp|tree|pole|mast|bank|slope|lane|path|drive|slipway|cliff|rope|escalator|scaffolding"
)
_PREPOSITION_PHRASE = re.compile(
    r"(?P<noun>.+?) (?:"
    r"(?:outside|off|aboard|atop|opposite|amid|within|through|throughout|astride|away from|out of|in between) (?P<object>.+)"
    rf"|(?:up|down|halfway up) (?:a|an|the|that) (?:\w+ )?(?:{_CLIMBABLE}))",
    re.IGNORECASE,
)
"""The pattern for a noun phrase with a preposition that the grammar lacks: "dog off its lead", "men up a ladder"."""

_RELATIVE_CLAUSE = re.compile(
    r"(?P<noun>.+?) (?:who|that|which) (?:look|seem|appear|need|want|keep|move|drive|walk|stand|sit)s?(?: \w+){0,3}", re.I
)
"""The pattern for a noun phrase with a relative clause that the grammar lacks: "person who looks lost"."""


@cache
def parser() -> ChartParser:
    """Return the parser for noun phrases and questions."""
    return ChartParser(files(__package__).joinpath("grammar.lark").read_text("utf-8"))


def is_short_enough(tokens: Sequence[Token]) -> bool:
    """Return whether tokens are few and simple enough to be parsed quickly."""
    return 0 < len(tokens) <= MAX_TOKENS and sum(token.type in _CONNECTIVES for token in tokens) <= MAX_CONNECTIVES


def is_description(text: str) -> bool:
    """Return whether text is a noun phrase that ``parse_description`` can parse completely."""
    tokens = tokenise(text)
    return is_short_enough(tokens) and parser().matches(tokens, "description")


def _may_be_noun(tokens: Sequence[Token], i: int) -> bool:
    """Return whether a token may be part of a noun, although the grammar reads it otherwise: "face", or "side" before "door"."""
    is_before_noun = i + 1 < len(tokens) and tokens[i + 1].type == "W"
    return tokens[i] in _NOUNS_OR_VERBS or (tokens[i].type == "PART" and is_before_noun)


@lru_cache(maxsize=4096)
def looks_like_description(text: str) -> bool:
    """Return whether text looks like a noun phrase, even if ``parse_description`` only splits it into words.

    Examples are phrases with a participle and its object, such as "man pushing the trolley", and with a preposition and a pronoun,
    such as "the vehicles on it".
    """
    tokens = tokenise(text)
    if tokens and tokens[-1].type == "ONIT":
        tokens.pop()
    if 0 < len(tokens) <= MAX_TOKENS:  # the number of readings does not matter here
        if parser().matches(tokens, "description"):
            return True
        words = [Token("W", token) if _may_be_noun(tokens, i) else token for i, token in enumerate(tokens)]
        types = [(token.type, other.type) for token, other in zip(tokens, words, strict=True)]
        if any(a != b for a, b in types) and parser().matches(words, "description"):
            return True
    if (active := _RELATIVE_CLAUSE.fullmatch(text)) is not None and is_description(active["noun"]):
        return True
    for pattern in (_PARTICIPLE_PHRASE, _PREPOSITION_PHRASE):
        match = pattern.fullmatch(text)
        if match is not None and is_description(match["noun"]):
            return not match["object"] or looks_like_description(match["object"])
    return False
