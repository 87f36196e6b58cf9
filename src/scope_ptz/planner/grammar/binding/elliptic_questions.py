"""Complete questions that leave out what they are about: "what colour?", "which ones?", "nearest person?"."""

from __future__ import annotations

from scope_ptz.planner.grammar.binding.focus import Focus
from scope_ptz.planner.grammar.binding.followups import WHERE
from scope_ptz.planner.grammar.binding.narrowing import last_item
from scope_ptz.planner.grammar.binding.noun_heads import names_person, names_several
from scope_ptz.planner.grammar.execution.answer_sentences import noun
from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, search

_LEAD = "(FILLER|COMMA|AND|BUT|so|then|ok|okay)*"
_END = "(FILLER|QUESTION|STOP)*"
_COLOUR = f"{_LEAD} (what|which|in what|in which) (colour|color|colours|colors) {_END}"
_WHICH = f"{_LEAD} (which|which_one|which_ones|which one|which ones|what ones) (of (them|those|these))? {_END}"
_MOST_COMMON = (
    f"{_LEAD} (what|which) (colour|color) (is|BE) (the_most|most) (common|frequent) {_END}"
    f"|{_LEAD} (what|which) (is|BE) (the_most|most) (common|frequent) (colour|color) {_END}"
)
_ASKS_COLOUR = "(what|which) (colour|color|colours|colors)"


def completed_question(question: str, last: Focus) -> str:
    """Return a question with what it leaves out: "what colours are the helmets?" for "what colours?"; unchanged if complete.

    Args:
        question: The question.
        last: What the turn before was about.
    """
    if question == WHERE:
        thing = last.one if last.number == 1 else last.description
        return f"where {'are' if names_several(thing) else 'is'} the {thing}?"
    lexemes = lexemes_of(question)
    if full_match(_COLOUR, lexemes):
        worn = last_item(last.question.rstrip("?!. ")) if names_person(last.description) else ""
        if worn:
            return f"what colour is the {worn} of the {last.one}?"
        thing = item_of(last) or last.description
        return f"what colour {'are' if names_several(thing) else 'is'} the {thing}?"
    if full_match(_MOST_COMMON, lexemes) and names_several(last.description):
        return f"which colour of the {last.description} is most common?"
    if full_match(_WHICH, lexemes) and (names_several(last.description) or last.is_several):
        return f"which {noun(last.description, 2)} are there?"
    return question


def asks_colour(question: str) -> bool:
    """Return whether a question asks for a colour."""
    return search(_ASKS_COLOUR, lexemes_of(question)) is not None


def item_of(focus: Focus) -> str:
    """Return what the people of an earlier turn wear or carry: "umbrellas" for "people with umbrellas"; empty for nothing."""
    item = last_item(focus.description) if names_person(focus.description) else ""
    return noun(item, 2 if focus.is_several else 1) if item else ""
