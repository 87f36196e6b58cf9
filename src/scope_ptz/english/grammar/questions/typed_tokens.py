"""Split text into typed tokens: closed-class phrases, numbers, ordinals, quoted text and other words."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from scope_ptz import english
from scope_ptz.english.grammar.closed_class import question_phrases
from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.english.grammar.numbers import read_number
from scope_ptz.english.grammar.questions.word_splitting import split


class Token(str):
    """A token whose value is its words. Its type is one from ``closed_class.txt`` or NUM, ORD, TEXT, or W for other words."""

    __slots__ = ("type",)
    type: str

    def __new__(cls, type_: str, words: str) -> Token:
        token = super().__new__(cls, words)
        token.type = type_
        return token


_FRAME_WORDS = frozenset({
    "frame", "picture", "image", "view", "screen", "shot", "photo", "photograph", "scene", "panorama", "footage", "video",
    "camera", "surroundings", "sight",
})  # fmt: skip
_FRAME_FILLERS = frozenset({
    "the", "this", "that", "your", "our", "current", "entire", "whole", "full", "present", "camera", "visible", "given", "overall",
    "same",
})  # fmt: skip
_PLACE_WORDS = frozenset(["site", "area", "place", "premises", "property", "worksite"])
_FRAME_PREPOSITIONS = frozenset(["in", "of", "from", "on", "across", "within", "throughout", "inside", "around", "for"])
_NO_OBJECTS = frozenset({"lane", "lanes", "?"})  # words after an "outside" that is no preposition
_LITERAL_TERMINATORS = frozenset({"visible", "there", "?"})  # words that end the literal after "says"
_PARTICLES = frozenset(
    ["on", "off", "up", "down", "in", "out"]
)  # adverbs, not prepositions, at the end of a text ("is the light on")


@cache
def _phrases() -> tuple[Mapping[tuple[str, ...], tuple[str, str]], int]:
    """Return every closed-class phrase with its type and value, and the length of the longest."""
    mention: dict[tuple[str, ...], tuple[str, str]] = {(word,): ("SAYS", word) for word in ("mention", "mentions", "mentioning")}
    outside = dict.fromkeys((("outside",), ("outside", "of"), ("just", "outside")), ("REL", "near"))
    table = {**question_phrases(), **mention, **outside, (",",): ("COMMA", ","), (";",): ("COMMA", ";")}
    return table, max(map(len, table))


def tokenise(text: str) -> list[Token]:
    """Return the typed tokens of a description or question."""
    words = _without_there(_without_frame_phrases(split(text)))
    table, _ = _phrases()
    tokens: list[Token] = []
    i = 0
    while i < len(words):
        if size := _noun_length(words, i, table):
            tokens += [Token("W", word) for word in words[i : i + size]]
            i += size
        elif size := _numeral_length(words, i):
            tokens.append(Token("NUM", str(round(read_number(words[i : i + size]).value))))
            i += size
        elif size := _closed_class_length(words, i, is_first=not tokens):
            i = _add_closed_class(tokens, words, i, size)
        else:
            is_number = words[i] == "one" and i + 1 < len(words) and (words[i + 1],) not in table
            tokens.append(Token("NUM", "1") if is_number else _open_class(words[i]))
            i += 1
    while tokens and tokens[0].type == "COMMA":
        tokens.pop(0)
    if [t.type for t in tokens[:2]] == ["WHAT", "IS"] and (tokens[-1].type, str(tokens[-1])) == ("SAYS", "say"):
        tokens[1] = Token("DOES", "does")  # "what's the sign say?"
    if [t.type for t in tokens[-2:]] == ["W", "THERE"] and tokens[0].type != "IS":
        tokens.pop()  # "the cars parked there", unlike "is anyone there"
    return tokens


def _numeral_length(words: list[str], start: int) -> int:
    """Return the length of a whole number written as several words at ``start`` ("twenty five", "a dozen"), or 0."""
    phrase = words[start : start + _LONGEST_NUMERAL]
    number = read_number(phrase)
    is_numeral = number.kind == "NUM" and number.used > 1 and number.value == round(number.value) > 0
    return number.used if is_numeral and phrase[0].isalpha() and "couple" not in phrase[: number.used] else 0


def _closed_class_length(words: list[str], start: int, *, is_first: bool) -> int:
    """Return the number of words in the closed-class phrase at ``start``, or 0. ``is_first`` is True if no token precedes it."""
    table, longest = _phrases()
    for size in range(min(longest, len(words) - start), 0, -1):
        entry = table.get(tuple(words[start : start + size]))
        if entry and not (is_first and entry[0] == "THAT"):
            return size
    return 0


def _add_closed_class(tokens: list[Token], words: list[str], i: int, size: int) -> int:
    """Append the token of a closed-class phrase. Return the index of the next word."""
    kind, value = _phrases()[0][tuple(words[i : i + size])]
    raw = " ".join(words[i : i + size])
    before = tokens[-1].type if tokens else ""
    if _is_ordinal(words, i, kind, before):
        tokens.append(Token("ORD", str(english.ordinal(raw))))
    elif (kind == "METRES" and before != "NUM") or (kind == "LIST" and before in {"W", "TEXTNOUN"}):
        tokens += [Token("W", word) for word in words[i : i + size]]  # "the meter", "the price list"
    elif kind == "RANK" and before == "W" and i + size < len(words) and lexicon().concept(words[i + size]) is not None:
        tokens.append(Token("W", raw))  # "the taxi rank sign"
    elif raw == "outside" and (i + size == len(words) or words[i + size] in _NO_OBJECTS):
        tokens.append(Token("W", raw))  # "is anyone outside?", "the outside lane"
    elif raw in _PARTICLES and i + size == len(words):
        if not tokens or tokens[0].type not in {"WHAT", "WHICH", "WHERE"}:
            tokens.append(Token("W", raw))
    elif kind != "SKIP":
        if kind in {"WHICH", "WHAT"} and [t.type for t in tokens] == ["REL"]:
            tokens.pop()  # "in which lane is ..."
        tokens.append(Token(kind, f"{value}:{raw}" if kind == "REL" else raw if kind in {"SAYS", "READ"} else value))
    i += size
    if kind == "SAYS" and not (tokens[0].type == "WHAT" and any(t.type == "DOES" for t in tokens)):
        literal, i = _literal(words, i)
        if literal:
            tokens.append(Token("TEXT", literal))
    return i


def _is_ordinal(words: list[str], i: int, kind: str, before: str) -> bool:
    """Return whether a word such as "third" is an ordinal ("the third window"), not a part ("the left third of the picture")."""
    after = words[i + 1] if i + 1 < len(words) else ""
    is_noun_next = after[:1].isalnum() and after not in {"of", "is", "are", "and", "or"}
    return kind == "PART" and english.ordinal(words[i]) is not None and before not in {"SIDE", "W"} and is_noun_next


def _noun_length(words: list[str], start: int, table: Mapping[tuple[str, ...], tuple[str, str]]) -> int:
    """Return the number of words in a known noun at ``start`` that contains a closed-class word ("charging points"), or 0."""
    for size in range(min(_LONGEST_NOUN, len(words) - start), 1, -1):
        phrase = words[start : start + size]
        is_known = any((word,) in table for word in phrase) and lexicon().concept(" ".join(phrase)) is not None
        if is_known and (phrase[0] == "no" or (phrase[0],) not in table):
            return size  # "no entry sign" is a noun
    return 0


_LONGEST_NOUN = 4
_LONGEST_NUMERAL = 6


def _open_class(word: str) -> Token:
    """Return the token of a word that belongs to no closed-class phrase."""
    if word[0] in "\"'" and len(word) > 2:
        return Token("TEXT", word[1:-1])
    if english.ordinal(word) is not None:
        return Token("ORD", str(english.ordinal(word)))
    if english.cardinal(word) is not None and word != "one":
        return Token("NUM", word)
    return Token("W", word)


def _literal(words: list[str], start: int) -> tuple[str, int]:
    """Return the text after "says" (the quoted string, or everything up to the end) and the index of the next word."""
    if start < len(words) and words[start][0] in "\"'":
        return words[start].strip("\"'"), start + 1
    if words[start : start + 2] in (["anything", "about"], ["something", "about"]):
        start += 2
    end = start
    while end < len(words) and words[end] not in _LITERAL_TERMINATORS:
        end += 1
    while end > start + 1 and tuple(words[end - 2 : end]) in {("on", "it"), ("on", "them")}:
        end -= 2
    return " ".join(words[start:end]), end + (2 if words[end : end + 2] in (["on", "it"], ["on", "them"]) else 0)


def _without_frame_phrases(words: list[str]) -> list[str]:
    """Drop phrases such as "in the picture" and "of the whole scene", because every question is about the picture."""
    result: list[str] = []
    i = 0
    while i < len(words):
        end = i + 1
        if words[i] in _FRAME_PREPOSITIONS and (i > 0 or "," in words):
            while (
                end < len(words) and words[end] in _FRAME_FILLERS and not (words[end] in _FRAME_WORDS and _ends_phrase(words, end))
            ):
                end += 1
            if _ends_with_place(words, end) or (
                end < len(words) and words[end] in _FRAME_WORDS and _ends_phrase(words, end) and end > i + 1
            ):
                i = end + 1
                continue
        result.append(words[i])
        i += 1
    return result


def _without_there(words: list[str]) -> list[str]:
    """Drop "there" and "up there" where they mean the picture: "are the people there wearing helmets?".

    It is kept after a form of "be" ("is there a van?", "who is there?"), and where it is the predicate ("is anyone there?").
    """
    kept: list[str] = []
    last = len([word for word in words if word != "?"]) - 1
    for i, word in enumerate(words):
        is_existential = i == 0 or words[i - 1] in _BE or (i < last and words[i + 1] in _BE)
        is_predicate = i == last and words[0] in _BE and "there" not in kept
        if word != "there" or is_existential or is_predicate:
            kept.append(word)
            continue
        while len(kept) > 1 and kept[-1] in _BEFORE_THERE:
            kept.pop()
    return kept


_BE = frozenset({"is", "are", "was", "were", "be", "isn't", "aren't", "not", "and", "if", "whether", "that", ","})
"""Words after which "there" says that something exists."""

_BEFORE_THERE = frozenset({"up", "down", "over", "out", "in", "from", "along", "back"})


def _ends_with_place(words: list[str], index: int) -> bool:
    """Return whether the text ends at this index with a word such as "site" ("on site", but not "on the site office")."""
    return index < len(words) and words[index] in _PLACE_WORDS and words[index + 1 :] in ([], ["?"])


def _ends_phrase(words: list[str], index: int) -> bool:
    """Return whether the frame word at this index is the last of its phrase ("camera view")."""
    return index + 1 >= len(words) or words[index + 1] not in _FRAME_WORDS
