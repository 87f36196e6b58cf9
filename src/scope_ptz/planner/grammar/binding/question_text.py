"""Recognise and rewrite the wording of a question, before it is passed to perception."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Literal

from scope_ptz.planner.grammar.binding.embedded_questions import direct_question
from scope_ptz.planner.grammar.binding.noun_heads import is_ranked
from scope_ptz.planner.grammar.binding.preset_matching import match_exactly
from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, search

_BARE_WHO_OR_WHAT = re.compile(r"(?:who|what)(?:['’]s| is| are)\?*", re.IGNORECASE)
_WAITING = re.compile(r"(when(?!(?:['’]s| (?:do|does|did|is|are|will|was|were))\b)|once|as soon as|whenever)\b", re.IGNORECASE)
_FUTURE = re.compile(r"Is it true that (?:an?|any\w*|some\w*) ", re.IGNORECASE)  # "let me know if anything moves"
_TWO_QUESTIONS = re.compile(
    r"(?P<seen>(?:can you see|do you see|is there|are there|do we have|have we got) (?:an?|any|some) [^,?]+?)"
    r",? and (?:if so,? )?(?P<more>(?:what|which|where|how)\b.+)",
    re.IGNORECASE,
)
_HAS_MORE = (
    r"which (?:one |preset |view |of them |place |side |half |part |of the two )?(?:has|have|shows|had) (?:the )?"
    r"(most|fewest|more|fewer|least)\W*"
)
_WINNER = re.compile(
    r"what(?:['’]s| is) the (?:total|sum|difference|result|answer)\W*|how many (?:is that|are there) (?:in total|"
    r"altogether|together)\W*"
    r"|where (?:there )?(?:are|is) (?:the )?(?:most|fewest|least)\W*"
    rf"|{_HAS_MORE}",
    re.IGNORECASE,
)
_PREDICATE = re.compile(
    r"how many (?:of (?:them|those|these) )?(?P<predicate>(?!in (?:view|sight|total|all)\b)"
    r"(?:(?:are|were|have|wear|carry|hold|in|on|near|with|without|wearing|carrying) |do(?: not|n['’]t) (?:have|wear) )"
    r"(?!there\b|you\b|we\b|visible\b|in (?:view|sight|total|all)\b)[^?]+)\?*",
    re.IGNORECASE,
)
_SUPERLATIVE = re.compile(
    r"(?:and )?which(?: of (?:them|those|these))?(?: is|['’]s) (?:the )?(?P<rank>[\w-]+)(?: one)?\?*", re.IGNORECASE
)
_WHICH_HAS = re.compile(_HAS_MORE, re.IGNORECASE)
_ANY_THERE = re.compile(
    r"(?:is there|are there|(?:can|do) you see|do we have|have we got|is|are) "
    r"(?:one|any|it|them|some|there any)(?: there| visible| anywhere)?\W*",
    re.IGNORECASE,
)
_DESCRIBE = re.compile(r"describe(?: each(?: one| view| of them)?)?\W*", re.IGNORECASE)
_BEFORE_CAMERA = "(FILLER)* what BE (in_front_of_you|in_front_of_us|in_front_of_the_camera) (FILLER|NOW|QUESTION|STOP)*"
_TOTAL = (
    "(FILLER|AND|COMMA|so|then|ok|okay)* (HOWMANY|both|all) (BE|DET|PRON|there|that|of|two)* "
    "(altogether|together|in_total|in_all|in total|in all|combined|total) (FILLER|then|QUESTION|STOP)*"
)
_AT_PRESET = re.compile(r"(.+?) (at|from|in) (the )?([\w -]+?)( preset| view| position)?\?*", re.IGNORECASE)


def with_subject(question: str) -> str:
    """Return "who's there?" for a bare "who's?"."""
    return f"{question.strip(' ?')} there?" if _BARE_WHO_OR_WHAT.fullmatch(question.strip()) else question


def is_answered_by_counts(question: str) -> bool:
    """Return whether earlier counts answer the question, such as "which has the most?", so that it need not be asked."""
    return bool(_WINNER.fullmatch(question.strip()) or _ANY_THERE.fullmatch(question.strip()))


def bare_comparison(question: str) -> Literal["more", "fewer"] | None:
    """Return the comparison of a question that names no objects, such as "which has more?"; None for other questions."""
    match = _WHICH_HAS.fullmatch(question.strip())
    return None if match is None else "more" if match[1].lower().startswith("mo") else "fewer"


def how_many_predicate(question: str) -> str:
    """Return "are sitting down" for "how many are sitting down?", which asks about the objects counted last; empty for others."""
    match = _PREDICATE.fullmatch(question.strip())
    return match["predicate"] if match else ""


def bare_superlative(question: str) -> str:
    """Return "farthest" for "which is farthest?", which asks about things named before; empty for other questions."""
    match = _SUPERLATIVE.fullmatch(question.strip())
    return match["rank"] if match is not None and is_ranked(f"{match['rank']} thing") else ""


def is_request_to_describe(question: str) -> bool:
    """Return whether the question is the bare request "describe", "describe each view", "what is in front of you?" or the like."""
    return bool(_DESCRIBE.fullmatch(question.strip()) or full_match(_BEFORE_CAMERA, lexemes_of(question)))


def lacks_noun(text: str) -> bool:
    """Return whether a count at a place names no things, but the sentence before may: "birds again. How many on the taxiway?"."""
    return search("(STOP|COLON|DASH) (FILLER|COMMA)* HOWMANY (FILLER)* (on|in|at) (DET)? _", lexemes_of(text)) is not None


def is_request_for_total(question: str) -> bool:
    """Return whether the question only asks for a total: "so how many in total?", "how many altogether?"."""
    return full_match(_TOTAL, lexemes_of(question)) is not None


def is_about_the_future(question: str, *, embedded: bool) -> bool:
    """Return whether the question is about something that may happen later, as in "let me know if anything moves".

    Args:
        question: The question.
        embedded: Whether it is part of another sentence.
    """
    return bool(_WAITING.match(question) or (embedded and _FUTURE.match(direct_question(question))))


def two_questions(question: str) -> tuple[str, str] | None:
    """Split "is there a van, and if so, what colour is it?" into its two questions; None for a single question."""
    match = _TWO_QUESTIONS.fullmatch(question.strip())
    return (f"{match['seen']}?", match["more"]) if match else None


def split_at_preset(question: str, presets: Sequence[str]) -> tuple[str, str] | None:
    """Split a question that ends with a preset ("is it open at gate?") into the question and the name of the preset.

    Returns:
        The question without the place, and the preset's name; None if the question does not end with one of the presets.
    """
    match = _AT_PRESET.fullmatch(question.strip())
    if not match or not (match[5] or (not match[3] and match[2].lower() != "in")):
        return None
    name = match_exactly(match[4], presets)
    return (f"{match[1]}?", name) if name else None
