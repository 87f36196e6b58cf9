"""Read a thing that is named before the question about it: "barrels, how many?", "the blue van: is it locked?"."""

from __future__ import annotations

from dataclasses import replace

from scope_ptz.planner.grammar.execution.answer_sentences import noun, with_lower_initial
from scope_ptz.planner.grammar.instruction_tree import Ask, Mention, Step
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.calculations import without_sum
from scope_ptz.planner.grammar.parsing.parts.clause import VERBS, Clause, Source, text_of, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of, things_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import places_of
from scope_ptz.planner.grammar.parsing.parts.scopes import split_trailing_place, without_view

_BARE_COUNT = (
    r"(FILLER|FIRSTLY|COMMA|and|AND|TELL|me|us|FULL)* (HOWMANY|"
    r"(DET|EXACTLY)* (NUMBERWORD|number|count|total) (only|alone)|(what|which|WHQ) (number|total|count)|"
    r"COUNT (EVERY|PRON|FREE)* (kind|sort|type)?|"
    r"(WHQ BE)? (DET)? (count|number|total|headcount|tally)) "
    r"(of (PRON|those|each)|PRON|EVERY|BE there|there BE|are there|VISIBLE|SELF|SEE|can|do|would|say|TELL|reckon|"
    r"FILLER|INTURN|DET|together|"
    r"altogether|combined|have|HAVEV|get|make|'s|that|all|total|in|TOTAL|FULL|NOW|COMMA|LEADFILLER)*"
)
"""A count that does not name what it counts."""

_BARE_QUESTION = r"(FILLER|COMMA|FIRSTLY)* (?P<asked>(WHQ|which|what) (FREE{1,2}|one|colour|SIDE)) (BE PRON)? (FILLER)*"
_HOW_MANY = Lexeme("how_many", 0, 0, frozenset({"HOWMANY"}))
_SUMS = frozenset({"together", "altogether", "in_total", "combined", "total", "in_all"})


def topic_count(source: Source, clause: Clause, after: Clause | None) -> Clause | None:
    """Return one clause for "barrels, how many?": "how many barrels"; None if the clauses are not a thing and a count."""
    if after is None or not _is_topic(source, clause) or not full_match(_BARE_COUNT, after.lexemes):
        return None
    whole = without_sum(clause.lexemes)
    added = clause.lexemes[len(whole) :]  # "cones and barriers put together, how many?"
    bare, _ = without_view(whole)
    words, _ = split_trailing_place(source, bare)
    if things_of(source, words) is None:
        return None
    scope = tuple(x for x in (*clause.lexemes, *after.lexemes) if x.has("FULL"))
    sums = tuple(x for x in (*added, *after.lexemes) if x.word in _SUMS)
    return replace(clause, lexemes=(_HOW_MANY, *bare, *scope, *sums), is_question=False)


def topic_step(source: Source, clause: Clause, after: Clause | None) -> tuple[Step, bool] | None:
    """Return the step for a thing that the next clause asks about, and whether the step covers that clause; None for others."""
    if after is None or not _is_topic(source, clause) or after.marker or not after.lexemes:
        return None
    thing = thing_of(source, clause.lexemes)
    if thing is None or not thing.text:
        return None
    if after.is_question and (asked := full_match(_BARE_QUESTION, after.lexemes)) is not None:
        article = "" if clause.lexemes[0].has("DET") else "the "
        subject = f"{article}{with_lower_initial(text_of(source, clause.lexemes))}"
        verb = "are" if noun(subject, 2) == subject else "is"
        return Ask(f"{text_of(source, asked['asked'])} {verb} {subject}?"), True
    if after.is_question and full_match("(FILLER)* what BE (it|that|this) (FILLER)*", after.lexemes):
        article = "" if clause.lexemes[0].has("DET") else "the "
        return Ask(f"What is {article}{with_lower_initial(text_of(source, clause.lexemes))}?"), True
    is_asked = match_start(
        "(FILLER|COMMA|AND|TELL|if|whether|me)* (BE|DOV|HAVEV|MODAL|can|WHQ _{1,4}) (it|they|them|PRON)", after.lexemes
    )
    if is_asked and after.is_question:
        return Mention(replace(thing, text=with_lower_initial(thing.text))), False
    return None


def _is_topic(source: Source, clause: Clause) -> bool:
    """Return whether a clause is only a thing: no command, no question, no preset."""
    lexemes = trimmed(clause.lexemes, "FILLER", "COMMA", "FIRSTLY")
    if clause.marker or clause.is_question or not lexemes or lexemes[0].has("WHQ", "HOWMANY", "BE", "DOV", "SELF"):
        return False
    if places_of(source, lexemes) or search("NUM DEG|BE|HAVEV|PAN|TILT|ZOOM|WRAPPER", lexemes):
        return False
    return not (lexemes[0].has(*VERBS) and not lexemes[0].has("FREE"))
