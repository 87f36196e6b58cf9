"""Recognise remarks that accompany a command: reasons, things that are pointed out, courtesy, and conditions without "if"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.instruction_tree.conditions import Condition, Seen, Thing
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.conditions import condition_of
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, VERBS, Clause, Source
from scope_ptz.planner.grammar.parsing.parts.courtesy import is_polite
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.statements import is_comment, is_past_event, is_statement, without_future_time
from scope_ptz.planner.grammar.parsing.segments.clause_starts import STATEMENT

_WISH = (
    r"(WRAPPER|SELF (want|need|wish|MODAL like) to) (see|look at|check|SEE|READ|have_a_look at|inspect|examine|study|view|watch) _+"
)
_FAILING = r"(SELF|PRON) (MODAL|DOV) (not|hardly|barely|only|just) _+|SELF (be|HAVEV|BE|LOWER-ED) _+"
_STATE = (
    r"only DET? FREE{1,3} SELF (MODAL|HAVEV)? (SEE|SEE-ED|get|have|HAVEV) (VISIBLE|here|NOW|FILLER)*|"
    r"all SELF (MODAL|HAVEV)? (SEE|SEE-ED|get|have|HAVEV) (BE|VISIBLE)+ _+|"
    r"(it|PRON|DET FREE|DET VIEWNOUN|DET PICTURE|there) (BE|looks|MODAL) (AMOUNTISH)* (too|so|very|ADVERB|not|FREE|in|DET|LOT) _*"
)
_POINTED_OUT = (
    (
        r"(FILLER)* SELF (MODAL|DOV|FILLER)* (think|believe|reckon|fear|suspect|understand|gather|hear) (that)? "
        r"(?P<thing>(DET|NUM) _+?) (BE|HAVEV|MODAL) _+"
    ),
    (
        r"(FILLER)* (SELF (MODAL|DOV|HAVEV|think|believe|reckon)* (SEE|SEE-ED|SHOW)|(SELF (think|believe|"
        r"reckon))? there (BE|HAVEV been)) (?P<thing>_+)"
    ),
    r"(FILLER)* (?P<thing>_+?) (BE|HAVEV) _+",
    r"(FILLER)* (?P<thing>_+)",
)
_NEED = r"(WRAPPER|need be|needed|necessary|required|(SELF) (have to|must|need to|need|want|like)|possible)"
_FINE = (
    r"(it|that|this) (BE)? (not)? (all_right|FILLER|okay|ok|fine|convenient|possible|too much trouble|too "
    r"much|no trouble|a problem) _*|SELF (DOV|do) not mind _*|_{0,1} FILLER"
)
_WITHDRAWAL = re.compile(
    r"\bchang\w+ (?:my|our|his|her|their) minds?\b|\bdecided (?:against|not)\b|\bsa(?:ys|id|y) no\b"
    r"|\b(?:joke|joking|kidding|mistake|forbidden|prohibited|off limits)\b"
    r"|\b(?:it|that|this) (?:is|was|has been|would be) (?:all )?(?:wrong|an error|banned|unnecessary|cancell?ed|called off)\b"
    r"|\b(?:not|never|no longer) (?:be(?:en|ing)? )?(?:allowed|permitted|needed|necessary|required|supposed|wanted|meant)\b"
    r"|\b(?:not|nobody|no one) (?:wants?|needs?|asked for) (?:it|that|this|you|them|any)\b"
    r"|\bdo(?:es)? not want (?:to|it|that|this)\b|\b(?:which|that|this) (?:is|was) (?:wrong|an? (?:error|mistake))\b"
    r"|\bcancell?ed$|\bcall(?:ed|ing|s)? (?:it|that|this) off\b|\bsecond thoughts\b|\bagainst (?:it|that|this)\b|\ban error\b"
    r"|\b(?:unnecessary|pointless|unwise|illegal|too (?:risky|dangerous))\b|\b(?:they|he|she|i|we) object(?:s|ed)?\b"
    r"|\bnever to\b|\b(?:say|says|said|told \w+ to) (?:hold on|hang on|wait|stop)\b|\b(?:have|has|had) to wait\b"
    r"|\b(?:has|have) already been done\b|\balready did (?:it|that)\b"
)
"""Wordings that may withdraw or forbid a command."""

_DROPPED = "(forget|scrap|scratch|cancel|disregard|belay|drop) (it|that|this|PRON)"
_TAKEN_BACK = (
    "(no|nah|nope|wait|oh|ah|hang on|hold on|hang_on|hold_on|actually|BUT|FILLER|COMMA|DASH|QUOTE)* ("
    "(DOV|do|MODAL)? (not|never|NOT|(?!no_more) NEGATED|do_not|do_not_bother|no_need) "
    "(mind|bother|worry|need|DOACT|yet|now|REPEAT|SELF dare|WRAPPER|(do|go|with) (it|that|there))?|"
    "(no|nah|nope) (wait|hang on|hold on|hang_on|hold_on|stop)+|(hang on|hold on|hang_on|hold_on|wait)|"
    f"{_DROPPED}) "
    "(FILLER|yet|now|then|COMMA|after all)*"
)
"""Words after a command that take it back, as in "no, don't", "no need" and "hang on"."""

_PLAINLY_TAKEN_BACK = (
    "(no|nah|nope|wait|oh|ah|hang_on|hold_on|actually|please|BUT|FILLER|COMMA|DASH|STOP)* "
    "(((DOV|do) not|do_not|(?!no_more) NEGATED) (do (it|that))?|do_not_bother|no_need) (please|FILLER|after all)*"
)

_MOVE_AT_THE_END = (
    f"COMMA (NOW|FILLER|AND|BUT|COMMA)* ({'|'.join(DIRECTIONS)}|IN|OUT|CLOSER|WIDER) (LITTLE|LOT|LIMIT|MORE|FILLER)* (COMMA|\\Z)"
)
"""A move without a verb after a remark, as in "that has it, left a bit". It must not be ignored."""

_NOT_A_REASON = frozenset({"must", "should", "never", "both"})
_WISHES_FOR_RESULT = (
    "(FILLER|COMMA|AND|THEN)* (WRAPPER|(i|we|SELF) (MODAL|ADVERB|FILLER)* (like|love|want|need|prefer|appreciate)) "
    "(ADVERB|FILLER|to|have|get|SELF)* (DET|NUM|ANY|LITTLE)? _{0,2} (PICTURE|SNAP|CLOSER|COUNTNOUN|close_up|count|number)"
)
"""The beginning of a wish for a picture, a close view or a count, which asks for one: "I'd also like a photo"."""


def is_reason(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a clause only gives a reason: "I want to see the roof", "we cannot see the doors"."""
    return bool(full_match(f"(FILLER|COMMA)* ({_WISH}|{_FAILING}|{_STATE})", lexemes))


def is_wish(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a clause says what the user wants to see."""
    return bool(full_match(f"(FILLER|COMMA)* ({_WISH})", lexemes))


def may_withdraw(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes contain words that may take back or forbid something: "off limits", "a mistake"."""
    return _WITHDRAWAL.search(" ".join(x.word.replace("_", " ") for x in lexemes)) is not None


def is_withdrawal_statement(clause: Clause) -> bool:
    """Return whether a statement may withdraw or forbid a command: "I changed my mind", "that is not allowed".

    Unlike other statements, it must not be ignored.
    """
    if clause.is_question or not may_withdraw(clause.lexemes):
        return False
    openers = match_start("(no|wait|oh|hang_on|hold_on|FILLER|COMMA|HALT)*", clause.lexemes)
    return is_statement(clause.lexemes) or is_statement(clause.lexemes[openers.size if openers else 0 :])


def takes_back(clause: Clause) -> bool:
    """Return whether a clause after a command takes it back: "... no, don't", "... no need", "... hang on"."""
    return not clause.is_question and full_match(_TAKEN_BACK, clause.lexemes) is not None


def plainly_takes_back(clause: Clause) -> bool:
    """Return whether a clause says that a command must not be carried out: "no, don't", unlike "hang on" and "not yet"."""
    return full_match(_PLAINLY_TAKEN_BACK, clause.lexemes) is not None


def drops_everything(clause: Clause) -> bool:
    """Return whether a clause cancels everything said before it: "no, forget it"."""
    return (
        not clause.is_question
        and full_match(f"(no|nah|nope|oh|ah|actually|BUT|FILLER|COMMA)* {_DROPPED} (FILLER)*", clause.lexemes) is not None
    )


def reports_event(clause: Clause) -> bool:
    """Return whether a clause says that something has happened: "something just banged", "somebody is on the phone"."""
    subject = next((x for x in clause.lexemes if not x.has("FILLER", "COMMA", "BUT")), None)
    is_vague = subject is not None and subject.word in {"someone", "somebody", "something"}
    return is_vague and not clause.is_question and is_statement(clause.lexemes)


def appeals_to_shared_knowledge(clause: Clause) -> bool:
    """Return whether a clause only appeals to what the listener knows: "... and you know how that goes", "who knows why"."""
    knows = "(FILLER|COMMA|AND|BUT)* (you_know|SELF know|who knows|god knows|heaven knows)"
    return not clause.is_question and full_match(f"{knows} (how|what|why|where|WHQ) _{{1,4}}", clause.lexemes) is not None


def only_gives_reason(clause: Clause, clause_count: int) -> bool:
    """Return whether a clause that cannot be parsed only gives the reason for the other clauses.

    It must not state an angle, a place or a repetition.

    Args:
        clause: The clause.
        clause_count: The number of clauses in the instruction.
    """
    if clause_count > 1 and is_polite(clause.lexemes):
        return True
    if clause.is_question or clause_count < 2:
        return False
    clause = replace(clause, lexemes=without_future_time(clause.lexemes))
    if not (match_start(STATEMENT, clause.lexemes) or is_statement(clause.lexemes) or is_comment(clause.lexemes)):
        return False
    knows = match_start("(FILLER|COMMA|NOW)* SELF know (this|it|that|you|DET)", clause.lexemes)  # "I know this sounds picky"
    is_lost = match_start("(FILLER|COMMA|NOW)* SELF DOV not know (what|how|why) (i|we)", clause.lexemes)  # "... what I've pressed"
    asks = frozenset({"tell", "whether"} if knows or is_lost else {"know", "tell", "whether"})
    if any(x.has("HOWMANY") or x.word in asks or x.word == "ones" for x in clause.lexemes):
        return False  # "I need to know how the bins are placed"
    denies = any(x.has("NOT") for x in clause.lexemes)
    if not denies and any(x.has("EACHTIME", "COUNT-ED", "COUNT", "TRACK", "READ") for x in clause.lexemes):
        return False
    if search(_MOVE_AT_THE_END, clause.lexemes) or match_start(_WISHES_FOR_RESULT, clause.lexemes):
        return False
    if _NOT_A_REASON & {x.word for x in clause.lexemes} and not match_start("(FILLER)* (i|we) (MODAL)? never FREE", clause.lexemes):
        return False
    return not any(x.has("NUM", "DEG", "PAN", "TILT", "ZOOM", "PRESET", "HOME") for x in clause.lexemes)


def thing_pointed_out(source: Source, clause: Clause, after: Clause | None) -> Thing | None:
    """Return the thing that a clause points out for the next clause: "there is a man by the van. Follow him."; otherwise None."""
    if (
        after is None
        or clause.is_question
        or not after.lexemes
        or after.marker
        or not search("(it|them|him|her|PRON)", after.lexemes)
    ):
        return None
    excluded = ("NUM", "DEG", "NOT", "NONE", "IF", "HOME", "EXCEPT", "WHOLETHING")
    if any(x.has(*excluded) for x in clause.lexemes) or clause.lexemes[0].has(*VERBS):
        return None
    is_bare = not is_statement(clause.lexemes)
    for pattern in _POINTED_OUT if is_bare else _POINTED_OUT[:-1]:
        match = full_match(pattern, clause.lexemes)
        if match and (thing := thing_of(source, match["thing"])) is not None and thing.text:
            return thing
    return None


def elliptical_condition(source: Source, clause: Clause, after: Clause | None) -> Condition | None:
    """Return the condition of "more than five cars? Zoom out", "see a fox, follow it" and "any smoke, go home"; None for others."""
    is_followed = after is not None and not after.marker and after.link in {",", ".", "and"} and not after.is_question
    if not is_followed or after is None or not after.lexemes or not _is_command(after.lexemes):
        return None
    lexemes = clause.lexemes
    if full_match("(ATLEAST|MORETHAN|FEWERTHAN|EXACTLY|ATMOST) NUM _+", lexemes):
        return condition_of(source, lexemes)
    if search("|".join(VERBS), lexemes[1:]) or lexemes[0].has("WHQ"):
        return None
    if (match := full_match("(SEE|spot) (ANY|SOMEONE) (?P<thing>_*)|(ANY|any) (?P<thing>_+)", lexemes)) is not None:
        if not clause.is_question and lexemes[0].word not in {"any", "see", "spot", "notice", "detect"}:
            return None
        if full_match("(FILLER)* (SCAN|FULL) (FILLER|FULL)*", after.lexemes):
            return None  # "see a van anywhere? Check all around"
        thing = thing_of(source, match["thing"]) if match["thing"] else Thing("people")
        return Seen(thing) if thing is not None and thing.text else None
    if lexemes[0].has("SOMEONE") and ((len(lexemes) > 2 and lexemes[1].has("TELL-ED", "TELL-S")) or is_past_event(lexemes)):
        return None  # "somebody said they saw a fox", "someone rang"
    if lexemes[0].has("SOMEONE", "NOONE") or (lexemes[0].word == "no" and clause.link != ","):
        return condition_of(source, lexemes)
    return None


def _is_command(lexemes: Sequence[Lexeme]) -> bool:
    first = next((x for x in lexemes if not x.has("FILLER", "FIRSTLY")), None)
    return first is not None and first.has(*VERBS, "HOME", "LEFT", "RIGHT", "UP", "DOWN")


def is_courtesy_condition(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether the words after "if" are only polite: "it's not too much trouble", "you don't mind"."""
    if any(x.has("PRESET", "HOME", "NUM", "DEG", *DIRECTIONS) for x in lexemes):
        return False
    return bool(full_match(_FINE, lexemes))


def is_ability_condition(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether the words after "if" only admit that a question may be too hard: "you can read it"."""
    return bool(
        full_match("SELF (MODAL|can|BE able to)? (READ|make|make_out|TELL|SEE) (it|them|that|PRON)? (out|from here)*", lexemes)
    )


def is_necessity_condition(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether the words after "if" leave the decision to the planner: "needed", "you have to"."""
    return bool(full_match(f"(FILLER)* {_NEED} (FILLER)*", lexemes))
