"""Shorter versions of an instruction that was not understood: without the remarks before its request and after it."""

from __future__ import annotations

import re
from collections.abc import Iterator

from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.parts.clause import VERBS
from scope_ptz.planner.grammar.parsing.parts.courtesy import bare_clause, is_polite
from scope_ptz.planner.grammar.parsing.parts.questions import is_question
from scope_ptz.planner.grammar.parsing.parts.statements import is_comment, is_statement
from scope_ptz.planner.grammar.parsing.rewording.compound_nouns import with_compound_nouns
from scope_ptz.planner.grammar.parsing.rewording.surrounding_remarks import NUMBER, asks_for_something

_MAX_CHARS = 500  # longer texts are not shortened: each version is parsed again
_MAX_VERSIONS = 8
_MIN_WORDS = 2

_BOUNDARY = re.compile(
    r"(?:[,;.!?]+|:| -+| –| —)\s+(?:(?:and so|so|and|but|anyway)\b,? )?"
    r"| (?:so|but|and) (?=(?:i|we|i['’]d|could|can|would|will|please|tell|what|which|how|is|are|just|swing|get|give|go|zoom|pan|tilt|count|take|turn"
    r"|find|follow|read|check|show)\b)"
    r"| (?=(?:i['’]?m|we['’]?re|they['’]?re|(?:it|he|she|that|there|some(?:one|body|thing)|nobody)['’]s|(?:some(?:one|body)|nobody) "
    r"(?:just|has|is|was)|its (?:fine|ok|good|too|been|just)|i can['’]?t|go ahead and|looks (?:a bit|like|as)|please|can you|could you)\b)",
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
"""Words of a phrase with "for" or "as" that says how long or how far to go, which must not be left out."""

_REFUSAL = re.compile(
    r"\b(?:no|nah|nope|wait|hang on|hold on|stop|actually|instead|undo|never ?mind|forget|not|before|leave|skip|don['’]?t)\b",
    re.IGNORECASE,
)
"""Words that may take back what was said, or say when not to do it."""

_EXCLAMATION = re.compile(
    r"(?:(?:oh|ah|well|my|gosh|goodness|now|and|just) )*(?:how \w+|what an? [\w ]+|(?:lovely|beautiful|nice|gorgeous|terrible"
    r"|dreadful|horrible|awful|rotten|cold|busy|quiet|funny|miserable|glorious|proper|typical) [\w ]+"
    r"|hear(?:ing)? (?:reports?|complaints?) [\w ]+|(?:had|got|getting|having) (?:an? )?(?:reports?|complaints?|calls?|word|news)"
    r"\b[\w' ]*|(?:good )?(?:morning|afternoon|evening)(?: \w+)?|hiya|hello(?: \w+){0,2}|hi(?: \w+){0,2}"
    r"|(?:many |so many )?thanks\b[\w' ]*|thank you\b[\w' ]*|(?:i )?(?:think|reckon|bet|guess) (?:its?|it['’]s|he|she|they|that|the)\b[\w' ]*"
    r"|(?:i |we )?(?:need|want|have) to (?:know|be sure|make sure) (?:that )?(?:i|we|it|they|he|she)\b[\w' ]*"
    r"|(?:the )?(?:sun|wind|light|glare|rain|dust|fog|mist|snow)s? \w+ing\b[\w' ]*|looks? (?:an? (?:bit|little)|like|as|to be)\b[\w' ]*|bless (?:him|her|them|you)|as (?:usual|ever|always)"
    r"|(?:i['’]?m|i am) (?:ever |so |very |terribly )*sorry\b[\w' ]*|sorry\b[\w' ]*|forgive [\w' ]+|pardon me\b[\w' ]*)",
    re.IGNORECASE,
)
"""Remarks that are no statements: "how romantic", "lovely day for it", "many thanks from all of us"."""

_REFERENCE = re.compile(r"\b(?:it|its|they|their|them|him|his|her|he|she|those|these|ones?|both|same)\b", re.IGNORECASE)


def shorter_versions(text: str, presets: tuple[str, ...]) -> Iterator[str]:
    """Yield shorter versions of an instruction, the longest first.

    Only remarks are left out: statements, exclamations and courtesy without any word that may ask for something, restrict it or
    take it back, without a preset, and without a number after another number. What comes after a remark must begin like a request, and
    must not refer to the remark ("there is a van by the fence, follow it").
    """
    if len(text) > _MAX_CHARS:
        return
    if relay := _RELAYED_QUESTION.match(text):
        question = text[relay.end() :]
        if _is_harmless(_without_relaying(relay[0]), presets, may_be_empty=True) and not _refers_back(question):
            yield f"tell me {question}"
    cuts = [(0, 0), *((match.start(), match.end()) for match in _BOUNDARY.finditer(text))]
    begins = [end for start, end in cuts if _is_lead(text[:start], text[end:], presets)]
    ends = [len(text), *(end for end in _ends(text, presets))]
    versions = sorted(((begin, end) for begin in begins for end in ends if begin < end), key=lambda cut: cut[0] - cut[1])
    for begin, end in versions[:_MAX_VERSIONS]:
        kept = text[begin:end]
        if kept != text and len(kept.split()) >= _MIN_WORDS:
            yield kept + ("?" if text[end : end + 1] == "?" else "")


def _is_lead(lead: str, rest: str, presets: tuple[str, ...]) -> bool:
    """Return whether the words before a request are remarks; true of no words."""
    if not lead:
        return True
    if not _opens_request(rest, presets) or _refers_back(rest):
        return False
    parts = [part for part in _BOUNDARY.split(lead) if part.strip()]
    return all(_is_harmless(part, presets) for part in parts) or _is_harmless(lead, presets)


def _ends(text: str, presets: tuple[str, ...]) -> Iterator[int]:
    """Yield each index at which a text may end because only remarks follow."""
    for match in _BOUNDARY.finditer(text):
        said, tail = text[: match.start()], text[match.end() :].rstrip(" .!?")
        parts = [part for part in _BOUNDARY.split(tail) if part.strip()]
        if all(_is_harmless(part, presets) for part in parts) and not (NUMBER.search(said) and NUMBER.search(tail)):
            yield match.start()
    for match in _PURPOSE.finditer(text):
        tail = text[match.end() :]
        if not (asks_for_something(tail, presets) or NUMBER.search(tail) or _EXTENT.search(tail)):
            yield match.start()


def _opens_request(text: str, presets: tuple[str, ...]) -> bool:
    """Return whether a text begins with a command or question."""
    lexemes = bare_clause(lexemes_of(text, presets))
    return bool(lexemes) and (lexemes[0].has(*VERBS, "TELL", "HOWMANY") or is_question(lexemes))


def _refers_back(text: str) -> bool:
    """Return whether the first clause of a text may refer to something that was said before it."""
    return _REFERENCE.search(_BOUNDARY.split(text)[0]) is not None


def _is_harmless(text: str, presets: tuple[str, ...], *, may_be_empty: bool = False) -> bool:
    """Return whether a text is a remark that asks for nothing."""
    plain = text.replace("’", "'").strip(" .,!?;")
    if not plain:
        return may_be_empty
    lexemes = with_compound_nouns(lexemes_of(plain, presets))
    if is_polite(lexemes):
        return True
    if asks_for_something(plain, presets) or _REFUSAL.match(plain):
        return False
    if _EXCLAMATION.fullmatch(plain):
        return True
    if is_question(lexemes) or lexemes[0].has(*VERBS):
        return False
    return is_statement(lexemes) or is_comment(lexemes)


def _without_relaying(text: str) -> str:
    """Return the words before the subject of "would like to know"."""
    return re.sub(r"(?:^|(?<=, )|(?<=\bbut )|(?<=\band ))[^,;.]*$", "", text)
