"""Read descriptions of things: noun phrases with determiner, modifiers, head noun and post-modifiers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.english import COLOURS
from scope_ptz.english.grammar.common_nouns import is_common_noun
from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.english.grammar.parts_of_speech import parts_of_speech
from scope_ptz.english.grammar.questions.recognition import looks_like_description
from scope_ptz.planner.grammar.instruction_tree import Thing
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, MARKERS, VERBS, Source, text_of, trimmed
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search

_NEVER = (
    "DEG", "STOP", "QUESTION", "THEN", "UNTIL", "IFNOT", "IFSO", "PAN", "TILT", "ZOOM", "PAN-ING", "TILT-ING", "ZOOM-ING",
    "WRAPPER", "ATMOST", "REPEAT", "COLON",
)  # fmt: skip
"""Classes of words that no description contains."""

_AROUND_NOUN_PHRASE = ("ATLEAST", "MORETHAN", "FEWERTHAN", "EXACTLY", "ADVERB", "VISIBLE", "SELF")
"""Classes of words that a description may contain before or after its noun phrase: "fewer than 20 people", "boats alongside"."""

_COMMANDS = ("TELL", "SWITCH", "TAKE", "SHOW", "FIND", "CARRY", "READ", "COUNT", "SNAP", "AIM", "TRACK", "TURN", "SCAN", "KEEP")
_LEAD = r"(me|us|FILLER|OFNOUN|all of|both of|any of|some of)*"
_DETERMINERS = ("DET", "EVERY", "ANY")
_DEFINITE = frozenset({"the", "that", "this", "these", "those", "all_the", "all_of_the", "each_of_the", "my", "our", "your"})
_PRONOUN = re.compile(r"(?:it|them|they|that|this|those|these|him|her|that one|this one|he|she|one|the one)", re.IGNORECASE)
_POSSESSIVES = frozenset({"its", "his", "her", "their"})
_VAGUE_PLACES = frozenset({"there", "here", "somewhere", "someplace"})
"""Words after a noun phrase that only say that the thing is somewhere in view."""

_WITH_OWN_SENTENCE = (
    "FREE (he|she|it) (ADVERB|FILLER)* (ran|went|came|fell|escaped|wandered|vanished|disappeared|slipped|jumped|flew|looks|"
    "seems|sounds|"
    "(got|HAVEV|broke|keeps) (out|away|loose|lost|stuck|off|running|going|getting|barking|moving))"
)
"""A noun with a sentence of its own, in which the noun has no place: "the dog he ran off", unlike "the box he left"."""

_STRANDED = frozenset({"to", "in", "on", "at", "with", "from", "by", "into", "for", "through", "past", "against"})
"""Prepositions at the end of a relative clause: "the school he went to"."""

_NO_NOUNS = frozenset({"than", "nor", "neither", "minus", "outnumber", "outnumbers", "exceed", "exceeds"})
_RELATIVE = (
    (re.compile(r"\b(?:(?:who|that|which) )?(?:are|is|were|was)(?:n['’]?t| not)\b", re.IGNORECASE), "not"),
    (
        re.compile(
            r"\b(?:who|that|which) (?:don['’]?t|do not|doesn['’]?t|does not|have not|haven['’]?t) (?:have|wear)\b", re.IGNORECASE
        ),
        "without",
    ),
    (re.compile(r"\b(?:who|that|which)(?: (?:are|is)|['’](?:re|s)) (?=\w)", re.IGNORECASE), ""),
    (re.compile(r"(?<!\bthat)(?<!\bwho)(?<!\bwhich) (?:have|has) (?=\w)", re.IGNORECASE), " with "),
    (re.compile(r"^an? (?=little \w)", re.IGNORECASE), ""),
    (re.compile(r"^(?:currently )?visible (?=\w)", re.IGNORECASE), ""),
    (re.compile(r" (?:of|in) the (?:picture|frame|image|view|shot|screen|scene)$", re.IGNORECASE), ""),
    (re.compile(r" (?:in|on) (?:it|them)$", re.IGNORECASE), ""),
    (re.compile(r"^(?:me |us )?(?:all )?(?:of )?(?:the |these |those )?(?=\w)", re.IGNORECASE), ""),
)
"""Patterns in descriptions with their replacements: relative clauses become phrases, and other function words are dropped."""

PROPERTIES = frozenset({
    "colour", "color", "state", "status", "number", "type", "make", "price", "text", "name", "size", "height", "condition", "plate",
    "position", "registration", "reading", "level", "temperature",
})  # fmt: skip
"""Nouns for a property of a thing. They end a shortened question, such as "excavator colour?"."""


def without_function_words(text: str) -> str:
    """Return a description without function words and without the verb of its relative clause.

    For example "people that aren't wearing helmets" becomes "people not wearing helmets".
    """
    for pattern, plain in _RELATIVE:
        text = pattern.sub(plain, text)
    return " ".join(text.split())


def thing_of(source: Source, lexemes: Sequence[Lexeme]) -> Thing | None:
    """Return the thing that lexemes describe, with an empty text for a pronoun; None if they are not a noun phrase."""
    lexemes = trimmed(lexemes, "FILLER", "COMMA", "QUOTE", "AND")
    if not lexemes:
        return None
    if all(x.has("NUM", "SECONDS", "MINUTES", "HOURS") for x in lexemes):
        return None  # "stop after ten seconds"
    if full_match(r"(all|both|each)? (of)? PRON (one|ones|there|here)?", lexemes) and _PRONOUN.fullmatch(
        " ".join(x.word for x in lexemes)
    ):
        return Thing(pronoun=next(x.word for x in lexemes if x.has("PRON")))
    is_list = search("(AND|OR) (the|a|an)|COMMA", lexemes) and not search("between", lexemes)
    if is_list or not is_noun_phrase(lexemes):
        return None  # several things
    while len(lexemes) > 1 and (lexemes[-1].word in _VAGUE_PLACES or (lexemes[-1].word == "in" and lexemes[-2].has("FREE"))):
        lexemes = lexemes[:-1]  # "at least 3 awnings there", "if there is a tanker in"
    if lexemes[0].word == "there" and len(lexemes) > 1:
        lexemes = lexemes[1:]  # "there a van" of "is there a van"
    first = 0
    while first < len(lexemes) - 1 and lexemes[first].has(*_DETERMINERS) and not lexemes[first].has("SOMEONE", "NUM"):
        first += 1
    definite = any(x.word in _DEFINITE for x in lexemes[:first])
    owner = next((x.word for x in lexemes[:first] if x.word in _POSSESSIVES), "")
    text = without_function_words(text_of(source, lexemes[first:]))
    core = without_function_words(text_of(source, trimmed(lexemes[first:], *_AROUND_NOUN_PHRASE)))
    is_read = looks_like_description(text) or looks_like_description(core) or _is_compound_noun(lexemes[first:])
    return Thing(text, definite=definite, owner=owner) if is_read else None


def _is_compound_noun(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes are nouns and adjectives before a noun, all without another meaning: "penalty spot"."""
    known = [parts_of_speech(x.word) for x in lexemes]
    is_modified = all(x.has("FREE") and kinds for x, kinds in zip(lexemes, known, strict=True))
    return len(lexemes) > 1 and is_modified and "NOUN" in known[-1]


def is_noun_phrase(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes are one noun phrase, or several joined by "and", "or" or commas."""
    if any((x.has("LIMIT", "INTURN") and "_" in x.word) or x.word in _NO_NOUNS for x in lexemes):
        return False
    if any(x.has(*_NEVER) or (x.has(*MARKERS) and not x.has("DET", "PREP", "REL", "SOMEONE")) for x in lexemes):
        return False
    if lexemes[0].has("REL", "AND", "OR", "BUT", "BE", "MODAL", "HAVEV", "NOT", "DOV", "REASON") and not lexemes[0].has("DET"):
        return False
    if lexemes[0].has("PREP", "SELF") and not lexemes[0].has("DET", "ADVERB", "ANY", "FREE"):
        return False
    if (len(lexemes) > 1 and lexemes[0].word in {"they", "he", "she"}) or search("FREE LEFT (one|ones|it|them)", lexemes):
        return False  # "they left one" and "the builders left one out" are statements
    if lexemes[0].has("EXCEPT") or match_start("(on|in|at|by|off) (the|a|an|DET)? (FREE|PRESET)", lexemes):
        return False  # "on the boardwalk"
    if lexemes[-1].word == "can" and len(lexemes) > 1 and lexemes[-2].has("FREE"):
        return is_noun_phrase(lexemes[:-1])  # "the trash can"
    if lexemes[-1].has("DET", "PREP", "REL", "AND", "OR", "MODAL", "BE", "HAVEV", "DOV") and not lexemes[-1].has(
        "ADVERB", "PRON", "ANY", "VISIBLE", *DIRECTIONS
    ):
        return False
    if lexemes[-1].word not in _STRANDED and search(_WITH_OWN_SENTENCE, lexemes):
        return False  # "find the black dog he ran off again"
    if search("as (PRON|SELF)", lexemes) or match_start("NUM OR NUM|NUM DEG? (the|a|an)|(it|them|him|her) PREP", lexemes):
        return False
    if search("(ZOOM-ED|PAN-ED|TILT-ED) (LIMIT|LITTLE|LOT|RIGHT)? (IN|OUT|LEFT|RIGHT|UP|DOWN)|instead_of", lexemes):
        return False  # "the gate zoomed in" says how the camera is set
    if search(r"EVERY (of)? (DET)* PRESETNOUN", lexemes):
        return False
    if not has_noun(tuple(lexemes)):
        return False
    relative = next((i for i, x in enumerate(lexemes) if x.has("REL") and i), len(lexemes))
    if any(x.has("BE", "MODAL", "DOV", "HAVEV") and not x.has("DET") for x in lexemes[:relative]):
        return False
    return not any(_is_command(lexemes, i) for i in range(len(lexemes))) and not _ends_in_direction(lexemes)


def has_noun(lexemes: tuple[Lexeme, ...]) -> bool:
    """Return whether lexemes contain a word that can name a thing."""
    for before, x in pairwise(lexemes):
        after = lexemes[lexemes.index(x) + 1 : lexemes.index(x) + 2]
        if x.word in {"one", "ones"} and (
            (after[:1] and after[0].has("PREP", "REL")) or (not after and not before.has("DET", "EVERY"))
        ):
            return True
        if (
            before.has("DET")
            and not x.has("PRON", "DET", "HOME", "NUM", *DIRECTIONS, "FRACTION")
            and (not after or after[0].has("PREP", "REL", "AND"))
        ):
            return True
    if any(x.has("DET") for x in lexemes[:-1]) and lexemes[-1].has(*VERBS) and not lexemes[-1].has("PRON", "HOME", *DIRECTIONS):
        return True  # "a wide load"
    return any(
        x.has(
            "FREE",
            "PRESET",
            "PICTURE",
            "CAMERA",
            "SOMEONE",
            "STEPNOUN",
            "TURNNOUN",
            "PRESETNOUN",
            "VIEWNOUN",
            "WHOLETHING",
            "SECONDS",
            "MINUTES",
            "RIGHTSIDE",
        )
        or is_noun(x.word)
        for x in lexemes
        if not (x.has("PRON", "DET", "FILLER", "AMOUNTISH", "AND") and not x.has("FREE", "SOMEONE"))
    )


def is_noun(word: str) -> bool:
    """Return whether the English lexicon or the list of common nouns contains a word."""
    words = word.replace("_", " ")
    return lexicon().concept(words) is not None or is_common_noun(words)


def _is_command(lexemes: Sequence[Lexeme], i: int) -> bool:
    """Return whether the word at a position is an imperative verb that does not follow a determiner."""
    lexeme = lexemes[i]
    if not lexeme.has(*_COMMANDS) or lexeme.has("FREE", "PREP", "DET") or is_noun(lexeme.word):
        return False
    if i == 0:
        begins_clause = len(lexemes) > 1 and lexemes[1].has("DET", "PRON", "WHQ")
        return (begins_clause or lexeme.has("TELL", "SWITCH", "TAKE")) and not lexeme.has("PICTURE")
    if any(x.has("DET") for x in lexemes[max(0, i - 2) : i]):
        return False
    if lexemes[i - 1].has("COMMA", "AND", "OR"):
        return True
    verbal = lexeme.has("TAKE", "SWITCH", "FIND", "SNAP", "COUNT") and not lexeme.has("HAVEV")
    return verbal and not lexemes[i - 1].has("DET", "REL", "FREE", "PREP", "MODAL", "NOT", "BE", "HAVEV")


def _ends_in_direction(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a bare direction ends the words: "the van left", unlike "the van on the left"."""
    last = lexemes[-1]
    if not last.has(*DIRECTIONS) or len(lexemes) < 2:
        return False
    before = lexemes[-2]
    return not (before.has("DET", "PREP", "BE", "AND", "OR", "ADVERB") or before.word.endswith("ing"))


def things_of(source: Source, lexemes: Sequence[Lexeme]) -> tuple[Thing, ...] | None:
    """Return the things of a list: "cars and trucks". None if a part is not a noun phrase.

    A list that belongs to one noun ("people with hats and bags") is one thing.
    """
    lexemes = trimmed(lexemes, "FILLER", "COMMA", "QUOTE")
    if any(x.word in {"i_mean", "i_meant", "er", "erm", "oops", "sorry"} for x in lexemes):
        return None  # "the cows, I mean the sheep"
    if search("COMMA (DET)? PRESET (first|FIRSTLY|ORDINAL)", lexemes):
        return None  # "count the cars, gate first" lists places
    parts: list[list[Lexeme]] = [[]]
    for i, x in enumerate(lexemes):
        after = lexemes[i + 1] if i + 1 < len(lexemes) else None
        if (
            x.has("AND", "COMMA")
            and parts[-1]
            and after is not None
            and not after.has("AND", "REL", "VERB")
            and _is_separate(parts[-1], lexemes[i + 1 :])
        ):
            parts.append([])
        elif x.has("AND", "COMMA") and not parts[-1]:
            continue
        else:
            parts[-1].append(x)
    things = [thing_of(source, part) for part in parts if part]
    if any(thing is None for thing in things):
        whole = thing_of(source, lexemes)
        return (whole,) if whole else None
    return tuple(thing for thing in things if thing)


def _is_separate(before: Sequence[Lexeme], after: Sequence[Lexeme]) -> bool:
    """Return whether "and" joins two things, rather than two parts of one description."""
    if match_start(r"(DET|HOWMANY|EVERY|the)", after):
        return not any(x.has("REL") for x in before) and not (
            any(x.word == "between" for x in before) and not any(x.has("AND") for x in before)
        )
    if not after or (after[0].has("PREP", "ADVERB", "NOT") and not after[0].has("DET")):
        return False
    if after[0].word in COLOURS and all(x.word in COLOURS for x in before if not x.has("DET")):
        return False  # "red and white barriers"
    return not any(x.has("PREP", "REL") or x.word.endswith("ing") for x in before[1:])


def people_description(source: Source, rest: Sequence[Lexeme]) -> Thing:
    """Return "people in the lane" for "anyone in the lane"."""
    rest = trimmed(rest, "VISIBLE", "FILLER", "BE")
    return Thing(without_function_words(" ".join(["people", text_of(source, rest)]).strip()))
