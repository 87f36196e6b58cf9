"""Shorter versions of an instruction that was not understood: without the remarks before and after its request."""

from __future__ import annotations

import re
from collections.abc import Iterator

from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.parts.clause import VERBS
from scope_ptz.planner.grammar.parsing.parts.compound_nouns import with_compound_nouns
from scope_ptz.planner.grammar.parsing.parts.courtesy import bare_clause, is_polite
from scope_ptz.planner.grammar.parsing.parts.questions import is_question
from scope_ptz.planner.grammar.parsing.parts.statements import is_comment, is_statement
from scope_ptz.planner.grammar.parsing.remark_detection.remark_forms import (
    EXCLAMATION,
    EXEMPT,
    NOUN_SUBJECT,
    REFUSAL,
    REPORT,
    RETURN,
    SUBJECT,
    gives_reason_for_return,
)
from scope_ptz.planner.grammar.parsing.remark_detection.surrounding_remarks import (
    AMOUNT,
    DURATION,
    FOLLOWING,
    NUMBER,
    asks_for_something,
    names_command,
)

MAX_SHORTENED_CHARS = 500  # longer texts are not shortened: each version is parsed again
_MAX_VERSIONS = 10
_MIN_WORDS = 2

_LINKS = r"(?:(?:and so|so|and|but|anyway|as|since|because|for)\b,? )?"
_BOUNDARY = re.compile(
    rf"(?:[,;.!?]+|:| -+| –| —)\s+{_LINKS}"
    r"| (?:so|but|and) (?=(?:i|we|i['’]d|could|can|would|will|please|tell|what|which|how|is|are|just|swing|get|give|go|zoom|pan"
    r"|tilt|count|take|turn|find|follow|read|check|show)\b)"
    rf"| (?=(?:{SUBJECT}|go ahead and|looks (?:a bit|like|as)|please|can you|could you)\b)"
    rf"| (?:as|since|because|cos|coz|so|for) (?=(?:{SUBJECT})\b)",
    re.IGNORECASE,
)
"""Where a sentence, a clause, or a subject with its verb begins: people who dictate leave punctuation out."""

_RELAYED_QUESTION = re.compile(
    r".*\b(?:to know|(?:is|are|was|were|keeps?|been) (?:asking|wondering)(?: me)?|asks?(?: me)?|wonders?) "
    r"(?=(?:how|whether|if|what|which|where|who|is|are)\b)",
    re.IGNORECASE,
)
"""The words before the question that somebody asks: "the committee would like to know how many people there are"."""

_PURPOSE = re.compile(r",? (?:for|so that|so|in case|as|because|since)(?= (?:i|we|the|my|our|an?|his|her|us|he|she|they)\b)")
_EXTENT = re.compile(
    r"\b(?:while|moments?|seconds?|secs?|minutes?|mins?|hours?|length|width|height|rest|whole|entire|way|times?|distance|long|ages"
    r"|bit|touch|whatever|as)\b",
    re.IGNORECASE,
)
"""Words which show that a phrase with "for" or "as" says how long or how far to go, so that it must be kept."""

UNFINISHED = re.compile(
    r"\b(?:until|till|til|if|when|once|unless|while|as|that|which|who|where|what|whether|how|and|or|but|to|the|an?|of|for|at|on|in|by|with"
    r"|(?:how|what|who|where)['’]s|than|like|before|after|whatever|because|so|is|are|was|were|not|only|just|every|each|time)\W*$",
    re.IGNORECASE,
)
"""The end of a text that is incomplete without the words after it: "pan right until" before "something moves"."""

_FINISHED = re.compile(r"\b(?:(?:zoom|right|way|further|closer|a bit) in|where (?:we|i|it) (?:was|were))\W*$", re.IGNORECASE)
"""Exceptions, if the words after them are a remark in a known form: "zoom in, I like this one"."""

_REFERENCE = re.compile(r"\b(?:it|its|they|their|them|him|his|her|he|she|those|these|ones?|both|same)\b", re.IGNORECASE)
_INTERJECTION = re.compile(r"^(?:oo+h|oh|ah|argh|well|hey|right|ok|okay|now)\b,? (?!no\b|wait\b)", re.IGNORECASE)
_REPEATS = re.compile(r"\b(?:back|again|same|that much|as before|undo|twice that|half that)\b", re.IGNORECASE)


def shorter_versions(text: str, presets: tuple[str, ...]) -> Iterator[str]:
    """Yield shorter versions of an instruction, the longest first.

    Only remarks are left out: statements, exclamations and courtesy without any word that may ask for something, restrict it or
    take it back, without a preset, and without an amount after another number. What comes after a remark must begin like a request,
    and must not refer to the remark ("there is a van by the fence, follow it").
    """
    if len(text) > MAX_SHORTENED_CHARS:
        return
    if relay := _RELAYED_QUESTION.match(text):
        question = text[relay.end() :]
        if _is_harmless(_without_relaying(relay[0]), presets, may_be_empty=True) and not refers_back(question):
            yield f"tell me {question}"
    cuts = [(0, 0), *((match.start(), match.end()) for match in _BOUNDARY.finditer(text))]
    begins = [end for start, end in cuts if _can_drop_lead(text[:start], text[end:], presets)]
    ends = sorted({len(text), *_ends(text, presets)})
    versions = sorted(((begin, end) for begin in begins for end in ends if begin < end), key=lambda cut: cut[0] - cut[1])
    for begin, end in versions[:_MAX_VERSIONS]:
        kept = text[begin:end]
        if kept != text and (len(kept.split()) >= _MIN_WORDS or RETURN.fullmatch(kept)):
            yield kept + ("?" if text[end : end + 1] == "?" else "")


def _can_drop_lead(lead: str, rest: str, presets: tuple[str, ...]) -> bool:
    """Return whether the words before a request are only remarks, or there are none."""
    if not lead:
        return True
    if not opens_request(rest, presets) or refers_back(rest):
        return False
    if REPORT.fullmatch(lead.strip(" ,.;!")) and not _REPEATS.search(rest):
        return True
    parts = [part for part in _BOUNDARY.split(lead) if part.strip()]
    return all(_is_harmless(part, presets) for part in parts) or _is_harmless(lead, presets)


def _ends(text: str, presets: tuple[str, ...]) -> Iterator[int]:
    """Yield each index at which a text may end because only remarks follow."""
    for match in _BOUNDARY.finditer(text):
        said, tail = text[: match.start()], text[match.end() :].rstrip(" .!?")
        is_known = EXEMPT.fullmatch(tail) is not None or gives_reason_for_return(said, tail)
        is_whole = UNFINISHED.search(said) is None or (is_known and _FINISHED.search(said) is not None)
        if is_whole and (is_known or is_remark(tail, presets)) and not is_amount(said, tail):
            yield match.start()
    for match in _PURPOSE.finditer(text):
        tail = text[match.end() :]
        if not (asks_for_something(tail, presets) or NUMBER.search(tail) or _EXTENT.search(tail)):
            yield match.start()


def is_amount(said: str, tail: str) -> bool:
    """Return whether a number in the words after a command may be the amount of a move or how long to follow a thing."""
    corrects = NUMBER.search(said) is not None and AMOUNT.search(tail) is not None
    return corrects or (DURATION.search(tail) is not None and FOLLOWING.search(said) is not None)


def is_remark(tail: str, presets: tuple[str, ...]) -> bool:
    """Return whether all clauses of a text are remarks. Only the first must be recognised by its form."""
    first, *others = [part for part in _BOUNDARY.split(tail) if part.strip()] or [""]
    return _is_harmless(first, presets) and all(_asks_for_nothing(part, presets) for part in others)


def opens_request(text: str, presets: tuple[str, ...]) -> bool:
    """Return whether a text begins with a command or question."""
    lexemes = bare_clause(lexemes_of(text, presets))
    return bool(lexemes) and (lexemes[0].has(*VERBS, "TELL", "HOWMANY") or is_question(lexemes))


def refers_back(text: str) -> bool:
    """Return whether the first clause of a text may refer to something that was said before it."""
    return _REFERENCE.search(_BOUNDARY.split(text)[0]) is not None


def _asks_for_nothing(text: str, presets: tuple[str, ...]) -> bool:
    plain = text.replace("’", "'").strip(" .,!?;")
    lexemes = lexemes_of(plain, presets)
    if is_polite(lexemes) and not names_command(plain):
        return True
    return not lexemes or not (asks_for_something(plain, presets) or REFUSAL.match(plain))


def _is_harmless(text: str, presets: tuple[str, ...], *, may_be_empty: bool = False) -> bool:
    """Return whether a text is a remark that asks for nothing."""
    plain = _INTERJECTION.sub("", text.replace("’", "'").strip(" .,!?;"))
    if not plain:
        return may_be_empty
    lexemes = with_compound_nouns(lexemes_of(plain, presets))
    if (is_polite(lexemes) and not names_command(plain)) or EXEMPT.fullmatch(plain):
        return True
    if asks_for_something(plain, presets) or REFUSAL.match(plain):
        return False
    if EXCLAMATION.fullmatch(plain) or re.match(rf"(?:{SUBJECT}|{NOUN_SUBJECT}) ", plain, re.IGNORECASE):
        return True
    if is_question(lexemes) or lexemes[0].has(*VERBS):
        return False
    return is_statement(lexemes) or is_comment(lexemes)


def _without_relaying(text: str) -> str:
    """Return the words before the subject of "would like to know"."""
    return re.sub(r"(?:^|(?<=, )|(?<=\bbut )|(?<=\band ))[^,;.]*$", "", text)
