"""Read questions, direct or after "tell me"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar.instruction_tree import (
    Ask,
    Mention,
    Step,
    Unclear,
    WhatAbout,
)
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import ME, SKIP, NotUnderstoodError, Source, text_of, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.questions import is_question
from scope_ptz.planner.grammar.parsing.parts.scopes import has_full_scope

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View


_NO_TOPIC = "(PAN|TILT|ZOOM|DEG|THEN|UNTIL|IFSO|IFNOT|IF|WRAPPER|NEGATED|to (CARRY|TURN|FREE))"


def _is_personal(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a question is about the one who is asked: "how are you?", unlike "what do you see?"."""
    perception = ("SEE", "READ", "TELL", "COUNT", "SHOW", "AIM-ING", "AIM", "FIND", "SEE-ING", "TRACK", "SCAN")
    return any(x.word in {"you", "your"} for x in lexemes) and not any(x.has(*perception) for x in lexemes)


def question_step(
    source: Source, lexemes: Sequence[Lexeme], bare: Sequence[Lexeme], view: View | None, *, asked: bool
) -> Step | tuple[Step, ...] | None:
    """Read questions, direct or after "tell me"."""
    lexemes = trimmed(lexemes, "COMMA", "FILLER", "QUOTE")
    while lexemes and lexemes[0].has("FIRSTLY", "COMMA", "NOW") and len(lexemes) > 1:
        lexemes = lexemes[1:]
    if not lexemes:
        return None
    scope: View | None = "full" if has_full_scope(lexemes) else view
    end = "?" if asked else ""
    if match := full_match(rf"(DESCRIBE|DESCRIBE-ING|list) {ME} (?P<rest>_*)", lexemes):
        return Ask(text_of(source, lexemes) + end, scope)
    if match := full_match(
        rf"{SKIP} (CARRY|TAKE|SHOW|give) (me|us)? DET (description|overview|summary|rundown|account) of (?P<rest>_+)", lexemes
    ):
        return Ask(f"describe {text_of(source, match['rest'])}", scope)
    told = full_match(
        (
            rf"{SKIP} (TELL|TELL-ING|know|READ|SHOW (?=(me|us)* (what|where|which|who|how|WHQ))) "
            rf"((?!(on|for|to) (what|which|whose)) (TELL|me|us|FILLER|and|"
            rf"for|COMMA|again|out|on|back|to))* (?P<rest>_+)"
        ),
        lexemes,
    )
    if told:
        rest = told["rest"]
        if (
            rest[0].has("IF", "IFSO", "WHEN", "WHQ", "REL")
            or rest[0].word in {"whether", "if", "that", "about"}
            or is_question(rest)
            or match_start("(in|at|on|from|to) (which|what|whose)", rest)
        ):
            return Ask(text_of(source, rest) + end, scope, embedded=True)
        if match_start("(if|whether|IF)", rest):
            return Ask(text_of(source, rest) + end, scope, embedded=True)
        if (
            match_start("(DET|PRON) _*? BE _", rest)
            and not search("REL|who|that|which|HOWMANY", rest)
            and not search(_NO_TOPIC, rest)
        ):
            return Ask("whether " + text_of(source, rest) + end, scope, embedded=True)  # "make sure the gate is shut"
        if not search(_NO_TOPIC, rest) and rest[0].word in {"the", "its", "their", "his", "her", "this", "that"}:
            if lexemes[0].has("SHOW", "FIND", "SWITCH") and not lexemes[0].has("TELL"):
                return None
            return Ask(text_of(source, rest) + end, scope, embedded=True)
        if match_start("about", rest):
            return Ask(text_of(source, rest) + end, scope, embedded=True)
    if search("between (DET)? PRESET (PRESETNOUN)? and (DET)? PRESET", lexemes) and is_question(lexemes):
        return Unclear("I can look at one place after the other, but not answer that about both. What shall I look for?")
    if is_question(lexemes) and not _is_personal(lexemes):
        return Ask(text_of(source, lexemes) + end, scope)
    if asked and (search("COLON", lexemes) or match_start("(DET)? FREE+ of ", lexemes)) and not search(_NO_TOPIC, lexemes):
        return Ask(text_of(source, lexemes) + "?", scope)  # "display case: open or shut?"
    if match := full_match(r"(what|how) about (?P<thing>_+)|(and) (?P<other>_+)", bare):
        thing = thing_of(source, match["thing"] or match["other"])
        return WhatAbout(thing) if thing and asked else None
    if match := full_match(
        (
            r"(i|we) (am|are) (FIND-ING|looking for) (?P<thing>_+)|there (should|must|might|ought to|has to) be "
            r"(?P<other>_+)|(i|we) (saw|think i saw|think there is|believe there is) (?P<third>_+)"
        ),
        bare,
    ):
        thing = thing_of(source, match["thing"] or match["other"] or match["third"])
        return Mention(thing) if thing else None
    if search("PAN|TILT|ZOOM", lexemes):
        raise NotUnderstoodError([])
    return None
