"""Say which questions can be answered, after one that was not understood."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.english.nouns import UNCOUNTABLE
from scope_ptz.planner.grammar.lexing.lexer import lexemes_of

_MIN_SHARE = 0.7
"""Minimum share of the words of an instruction that a quotation must contain to name nothing in particular."""
_MIN_WORDS = 3


def is_whole_question(text: str, quotations: Sequence[str]) -> bool:
    """Return whether the words that were not understood are nearly all words of a question."""
    words, quoted = text.split(), " ".join(quotations).removesuffix(" ...").split()
    is_truncated = any(quotation.endswith(" ...") for quotation in quotations)
    is_most = len(quoted) >= _MIN_WORDS and (is_truncated or len(quoted) >= _MIN_SHARE * len(words))
    return is_most and _is_question(text)


def _is_question(text: str) -> bool:
    lexemes = [x for x in lexemes_of(text) if not x.has("FILLER", "COMMA")]
    if any(x.has("NEGATED") for x in lexemes[:2]):
        return False  # "don't follow anyone"
    return bool(lexemes) and (lexemes[-1].has("QUESTION") or lexemes[0].has("WHQ", "HOWMANY", "BE", "DOV", "HAVEV"))


def answerable_questions(question: str) -> str:
    """Return a sentence with two questions that can be answered, about a thing in the question if it names one."""
    first, second = _questions_about(_thing_in(question))
    return f'I can answer, for example: "{first}" or "{second}".'


def _questions_about(thing: str) -> tuple[str, str]:
    """Return two questions about a kind of thing, given as a noun in the singular."""
    if thing in UNCOUNTABLE:
        return f"is there any {thing}?", f"where is the {thing}?"
    kinds = lexicon().kinds(lexicon().concept(thing) or "thing")
    if "person" in kinds:
        second = f"what is the {thing} doing?"
    elif "sign" in kinds:
        second = f"what does the {thing} say?"
    else:
        second = f"where is the {thing}?"
    return f"how many {english.plural(thing)} are there?", second


def _thing_in(question: str) -> str:
    """Return the first word of a question that names a kind of thing, in the singular; "sign" if there is none."""
    for word in english.letters(question).split():
        concept = lexicon().concept(word)
        if concept is not None and concept not in _TOO_GENERAL:
            return english.singular(word)
    return "sign"


_TOO_GENERAL = frozenset({"thing", "person", "text", "surface", "part"})
