"""Read short follow-ups, which leave out what the last look was about: "and in the right half?", "now the silver one", "where?"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.english import COLOURS
from scope_ptz.english.grammar.common_nouns import is_common_noun
from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.english.grammar.parts_of_speech import parts_of_speech
from scope_ptz.english.grammar.questions.recognition import is_description
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.parts.clause import Source, text_of, trimmed
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, search

_LEAD = "(FILLER|COMMA|AND|BUT|NOW|LEADFILLER|FIRSTLY|now|ok|okay|then|so|also|what_about|how_about)*"
_END = "(FILLER|COMMA|QUESTION|STOP|NOW|then|VISIBLE)*"
_DETERMINER = "(DET|EVERY)"
_PREPOSITIONS = frozenset({
    "in", "on", "at", "near", "behind", "beside", "under", "above", "below", "between", "inside", "outside", "with", "without",
    "by", "to", "next",
})  # fmt: skip
_MAX_LEXEMES = 12  # longer texts are not short follow-ups


def followup_of(text: str, presets: tuple[str, ...]) -> tuple[ast.Step, ...] | None:
    """Return the step of a short follow-up; None for other texts.

    Args:
        text: The user's text, which is no instruction on its own.
        presets: The camera's presets.
    """
    lexemes = trimmed(lexemes_of(text, presets), "STOP", "QUESTION")
    if not 0 < len(lexemes) <= _MAX_LEXEMES:
        return None
    step = _followup(Source(text, presets), lexemes)
    return (step,) if step is not None else None


def _followup(source: Source, lexemes: Sequence[Lexeme]) -> ast.Step | None:
    if full_match(f"{_LEAD} (where|where_is) (PRON|exactly|BE)* {_END}", lexemes):
        return ast.Ask("where are they?")
    if full_match(f"{_LEAD} READ (them|those|these|both|all) (of|all|both|them|those|these|out|aloud)* {_END}", lexemes):
        return ast.Read(ast.Thing(pronoun="them"))
    if search("one of (them|those|these)", lexemes):
        return ast.Unclear("Which one do you mean? Please describe it.")
    if any_of := full_match(
        f"{_LEAD} any (of them|of those)? (?P<predicate>(PREP|in|with|without|wearing|not)? _+) {_END}", lexemes
    ):
        predicate = text_of(source, any_of["predicate"])
        return ast.Ask(f"any of them {predicate}?") if is_predicate(predicate) else None
    match = full_match(f"(?P<lead>{_LEAD}) (?P<what>_+?) {_END}", lexemes)
    if match is None:
        return None
    what, is_led = match["what"], match.has("lead") and any(not x.has("FILLER", "COMMA") for x in match["lead"])
    if full_match("(all|both|each)? (of)? PRON (all|both)?|(both|all|each)", what):
        pronoun = next((x.word for x in what if x.has("PRON")), "them")
        return ast.WhatAbout(ast.Thing(pronoun=pronoun if is_led else "both")) if is_led or len(what) > 1 else None
    phrase = full_match(f"{_DETERMINER} (?P<noun>_+)", what)
    if phrase is not None:
        noun_phrase = text_of(source, phrase["noun"])
        has_one = any(x.word in {"one", "ones"} for x in phrase["noun"])
        if noun_phrase.lower() in {"other one", "other ones", "other", "others"}:
            return ast.Unclear("Which other one do you mean? Please describe it.")
        return ast.WhatAbout(ast.Thing(noun_phrase, definite=True)) if has_one or (is_led and is_description(noun_phrase)) else None
    predicate = text_of(source, what)
    return ast.WhatAbout(ast.Thing(predicate=predicate)) if is_led and is_predicate(predicate) else None


def is_predicate(text: str) -> bool:
    """Return whether text says something about a thing without naming one: "in the right half", "standing", "blue"."""
    words = text.lower().split(" ")
    if words[0] in {"one", "ones"}:
        return False
    if len(words) == 1:
        return words[0] in COLOURS or words[0].endswith("ing") or is_adjective(words[0])
    is_modifier = words[0].endswith("ing") or words[0] in _PREPOSITIONS or words[0] == "not"
    return is_modifier and is_description(f"thing {text}")


def is_adjective(word: str) -> bool:
    """Return whether a word can only be an adjective, and names no thing."""
    is_noun = lexicon().concept(word) is not None or is_common_noun(word)
    return word in COLOURS or ("ADJ" in parts_of_speech(word) and not is_noun)
