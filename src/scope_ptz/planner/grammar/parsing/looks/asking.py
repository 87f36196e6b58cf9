"""Parse direct questions and questions introduced by "tell me"."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from scope_ptz.english import COLOURS, is_plural
from scope_ptz.planner.grammar.execution.answer_sentences import with_lower_initial
from scope_ptz.planner.grammar.instruction_tree import (
    Ask,
    AtPlaces,
    Mention,
    Step,
    Unclear,
    WhatAbout,
)
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import ME, SKIP, NotUnderstoodError, Source, text_of, trimmed
from scope_ptz.planner.grammar.parsing.parts.courtesy import completes_question
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import PROPERTIES, is_noun, is_noun_phrase, thing_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import places_of
from scope_ptz.planner.grammar.parsing.parts.questions import is_question
from scope_ptz.planner.grammar.parsing.parts.scopes import has_full_scope, split_trailing_place
from scope_ptz.planner.grammar.parsing.parts.statements import is_statement

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View


_NO_TOPIC = "(PAN|TILT|ZOOM|DEG|THEN|UNTIL|IFSO|IFNOT|IF|WRAPPER|NEGATED|to (CARRY|TURN|FREE))"


_WHAT_ELSE = "(AND|FILLER)* (what|WHQ) else (BE (there|VISIBLE)|(can|DOV|MODAL|do) SELF SEE|SELF SEE)? (VISIBLE|here|FILLER|NOW)*"

_STATES = frozenset({
    "open", "shut", "closed", "locked", "unlocked", "wet", "dry", "lit", "empty", "full", "free", "occupied", "busy", "broken",
    "damaged", "raised", "lowered", "clear", "blocked", "parked", "running", "moving", "on", "off", "clean", "dirty", "ready",
    "present", "missing", "stuck", "flat", "loaded", "unattended", "secure", "flooded", "frozen", "crowded", "up", "down",
    "connected", "attached", "loose",
})  # fmt: skip
"""Words for a state that are the predicate of a question without a verb, such as "barrier up?" and "floor wet by the fountain?"."""

_IDENTITIES = (
    "(((number|licence|license|registration|reg) plate|numberplate|registration) (of|off|on|from)|"
    "(plate|registration|reg|serial|fleet) (number (off|on|from)|number_of))"
)
"""Text that identifies a thing: "I need the number plate of the blue lorry"."""


_SPEAKING = frozenset({"tell", "inform", "ask", "notify", "advise"})
"""Verbs of which the object is the person spoken to."""


def _verbless_question(source: Source, lexemes: Sequence[Lexeme], *, has_question_mark: bool) -> str | None:
    """Return the question that "barrier open?", "driver wearing a helmet?" and "excavator colour?" stand for; None for others."""
    if (question := _identity_question(source, lexemes)) is not None:
        return question
    wanted = full_match("(give (me|us) the)? (?P<what>FREE (of|on) DET _+)", lexemes)
    if wanted and wanted["what"][0].word in PROPERTIES and not search(f"{_NO_TOPIC}|COMMA|BE", lexemes):
        return f"What is the {with_lower_initial(text_of(source, wanted['what']))}?"  # "give me the colour of the van"
    if (
        not has_question_mark
        or search(_NO_TOPIC, lexemes)
        or not match_start("(DET|EVERY)? FREE{1,3}", lexemes)
        or search("SELF|NUM DEG|COMMA", lexemes)
    ):
        return None
    text = text_of(source, lexemes)
    if lexemes[-1].word in PROPERTIES and 1 < len(lexemes) < 6:
        article = "" if lexemes[0].has("DET") else "the "
        return f"What is {article}{with_lower_initial(text)}?"
    if lexemes[0].word in PROPERTIES and match_start("_ (of|on|for) _", lexemes):
        return f"What is the {with_lower_initial(text)}?"
    subject = 1 if lexemes[0].has("DET", "EVERY") else 0
    for x in lexemes[subject + 1 : subject + 4]:
        if x.word in _STATES or (x.word.endswith("ing") and x.has("FREE")) or x.word in {"wearing", "holding", "carrying"}:
            return f"{text}?"
    if full_match("FREE{1,3}", lexemes) and is_plural(lexemes[-1].word) and is_noun_phrase(lexemes):
        return f"Are there any {with_lower_initial(text)}?"  # "people (at the gate)?"
    if full_match("FREE{1,2}", lexemes) and is_noun(lexemes[-1].word) and is_noun_phrase(lexemes):
        return f"Is there any {with_lower_initial(text)}?"  # "queue (at the gate)?"
    return None


def _identity_question(source: Source, lexemes: Sequence[Lexeme]) -> str | None:
    """Return the question that "the number plate of the blue lorry" stands for; None for other clauses."""
    match = full_match(f"(DET)? (?P<what>{_IDENTITIES} (?P<thing>_+))", lexemes)
    if match is None or search(_NO_TOPIC, lexemes) or thing_of(source, match["thing"]) is None:
        return None
    return f"What is the {text_of(source, match['what'])}?"


def _with_options_at_place(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read "barrier at the gate: up or down?" as a question at the preset; None for other clauses."""
    match = full_match("(?P<thing>_+) COLON (?P<options>_+ OR _+)", lexemes)
    rest, places = split_trailing_place(source, match["thing"]) if match else ((), None)
    if match is None or not places or search(_NO_TOPIC, rest):
        return None
    return AtPlaces(places, (Ask(f"{text_of(source, rest)}: {text_of(source, match['options'])}?"),))


def _choice(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read "floor by the drain, wet or dry?" as a question that names a thing and its possible states; None for other clauses."""
    match = full_match("(DET)? (?P<thing>(FREE|PRESET) _*) COMMA (?P<options>(?P<one>_) OR (?P<other>_))", lexemes)
    if match is None or not all(x.word in _STATES | COLOURS for x in (*match["one"], *match["other"])):
        return None
    rest, places = split_trailing_place(source, match["thing"])
    if search(f"{_NO_TOPIC}|COMMA|BE|HAVEV", rest) or thing_of(source, rest) is None:
        return None
    head = next((x.word for x, after in zip(rest, (*rest[1:], None), strict=True) if after is None or after.has("PREP")), "")
    subject, options = with_lower_initial(text_of(source, rest)), text_of(source, match["options"])
    asked = Ask(f"{'Are' if is_plural(head) else 'Is'} the {subject} {options}?")
    return AtPlaces(places, (asked,)) if places else asked


def _described(source: Source, lexemes: Sequence[Lexeme], view: View | None) -> Step:
    """Return the request to describe something, or everything in view at a preset."""
    if places := places_of(source, lexemes):
        return AtPlaces(places, (Ask("describe", view),))
    return Ask(f"describe {text_of(source, lexemes)}", view)


def _is_followed_by_statement(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a statement by somebody follows a comma."""
    return any(
        x.has("COMMA") and lexemes[i + 1 : i + 2] and lexemes[i + 1].has("SELF", "PRON") and is_statement(lexemes[i + 1 :])
        for i, x in enumerate(lexemes)
    )


def _is_personal(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a question is about the planner itself: "how are you?", unlike "what do you see?"."""
    perception = ("SEE", "READ", "TELL", "COUNT", "SHOW", "AIM-ING", "AIM", "FIND", "SEE-ING", "TRACK", "SCAN")
    return any(x.word in {"you", "your"} for x in lexemes) and not any(x.has(*perception) for x in lexemes)


def question_step(
    source: Source, lexemes: Sequence[Lexeme], bare: Sequence[Lexeme], view: View | None, *, has_question_mark: bool
) -> Step | tuple[Step, ...] | None:
    """Read questions, direct or after "tell me"."""
    lexemes = tuple(lexemes) if completes_question(lexemes) else trimmed(lexemes, "COMMA", "FILLER", "QUOTE")
    while lexemes and lexemes[0].has("FIRSTLY", "COMMA", "NOW") and len(lexemes) > 1:
        lexemes = lexemes[1:]
    if not lexemes:
        return None
    if any(x.has("PRESETNOUN") for x in lexemes) and _is_followed_by_statement(lexemes):
        raise NotUnderstoodError(lexemes)  # "tell me which views you have saved, I never wrote them down"
    scope: View | None = "full" if has_full_scope(lexemes) else view
    end = "?" if has_question_mark else ""
    if match := full_match(rf"(DESCRIBE|DESCRIBE-ING|list) {ME} (?P<rest>_*)", lexemes):
        if lexemes[0].has("DESCRIBE", "DESCRIBE-ING") and places_of(source, match["rest"]):
            return _described(source, match["rest"], scope)
        return Ask(text_of(source, lexemes) + end, scope)
    if match := full_match(
        rf"{SKIP} (CARRY|TAKE|SHOW|give) (me|us)? DET (description|overview|summary|rundown|account) of (?P<rest>_+)", lexemes
    ):
        return _described(source, match["rest"], scope)
    if match := full_match(
        rf"{SKIP} (TELL|SHOW|DESCRIBE|LISTING|give) {ME} (about)? (?P<all>(everything|anything|"
        rf"all|WHOLETHING) (that)? SELF (can)? SEE _*)",
        lexemes,
    ):
        return Ask("describe", scope)
    if match := full_match(
        rf"{SKIP} (CARRY|TAKE|SHOW|give|DOACT) {ME} DET (FREE)? (description|overview|summary|"
        rf"rundown|account) of (?P<rest>_+)",
        lexemes,
    ):
        return _described(source, match["rest"], scope)
    match = full_match(
        rf"{SKIP} (name|list) {ME} (?P<some>(NUM|ANY|SEVERAL|EVERY|DET)+ (things|items|objects|"
        rf"WHOLETHING|FREE)) (?P<where>PREP _+)",
        lexemes,
    )
    if match and not search(_NO_TOPIC, lexemes) and not search("PRESETNOUN|PRESET", match["some"]):
        return Ask(text_of(source, lexemes) + end, scope)  # "name two things on the table"
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
        if lexemes[0].word == "ask" and rest[0].has("DET"):
            raise NotUnderstoodError(lexemes)  # "ask the sound guy whether he has had dinner"
        if lexemes[0].word in _SPEAKING and match_start("DET FREE{1,3} (that|to|not|about|whether|if) _", rest):
            raise NotUnderstoodError(lexemes)  # "tell the driver that he is late"
        if rest[0].has("HOWMANY") and _is_followed_by_statement(rest):
            raise NotUnderstoodError(lexemes)  # "tell me how many there are, I still have books to hand out"
        nobody = full_match("(that)? NOONE BE (?P<where>_*)", rest)
        if nobody is not None and not search(_NO_TOPIC, rest):
            return Ask(f"Is anyone {text_of(source, nobody['where']) or 'there'}?", scope)  # "make sure nobody is on the track"
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
            match_start("(DET|PRON|PRESET) _*? BE _|FREE{1,2} BE _", rest)
            and not search("REL|who|that|which|HOWMANY", rest)
            and not search(_NO_TOPIC, rest)
        ):
            return Ask("whether " + text_of(source, rest) + end, scope, embedded=True)  # "make sure the gate is shut"
        if match_start("there BE (not)? (NONE|no|ANY|DET) _", rest) and not search(_NO_TOPIC, rest[3:]):
            return Ask("whether " + text_of(source, rest) + end, scope, embedded=True)  # "confirm there are no vehicles"
        if rest[0].word in PROPERTIES and match_start("_ (of|on|for)", rest) and not search(_NO_TOPIC, rest):
            return Ask(f"the {text_of(source, rest)}{end}", scope, embedded=True)  # "confirm colour of the beacon"
        if not search(_NO_TOPIC, rest) and rest[0].word in {"the", "its", "their", "his", "her", "this", "that"}:
            is_property = any(x.word in PROPERTIES for x in rest[:3])
            if (lexemes[0].word == "see" and not is_property) or (
                lexemes[0].has("SHOW", "FIND", "SWITCH") and not lexemes[0].has("TELL")
            ):
                return None
            return Ask(text_of(source, rest) + end, scope, embedded=True)
        if match_start("about", rest):
            return Ask(text_of(source, rest) + end, scope, embedded=True)
    return _question_without_tell_me(source, lexemes, bare, scope, has_question_mark=has_question_mark)


def _question_without_tell_me(
    source: Source, lexemes: Sequence[Lexeme], bare: Sequence[Lexeme], scope: View | None, *, has_question_mark: bool
) -> Step | tuple[Step, ...] | None:
    """Read questions without "tell me", whole or shortened: "is it open?", "over five trucks in view?", "barrier open?"."""
    end = "?" if has_question_mark else ""
    if lexemes[0].word == "see":
        return None  # "(would it be possible to) see the orchard at full zoom?" is a command
    if full_match(_WHAT_ELSE, lexemes):
        return Ask("describe", scope)
    if lexemes[0].word == "whether" and not search(_NO_TOPIC, lexemes):
        return Ask(text_of(source, lexemes) + end, scope, embedded=True)  # "I was wondering whether it is open"
    if has_question_mark and match_start("(SOMEONE|NOONE|everyone|everybody|nothing|something) _", lexemes):
        return Ask(text_of(source, lexemes) + end, scope)
    if (
        has_question_mark
        and match_start("(ATLEAST|MORETHAN|FEWERTHAN|ATMOST|EXACTLY) NUM _", lexemes)
        and not search(_NO_TOPIC, lexemes)
    ):
        return Ask(f"Are there {with_lower_initial(text_of(source, lexemes))}?", scope)  # "over five trucks in view?"
    if search("between (DET)? PRESET (PRESETNOUN)? and (DET)? PRESET", lexemes) and is_question(lexemes):
        return Unclear(
            "I can look at one place and then the other, but I cannot answer that for both at once. What shall I look for?"
        )
    if not has_question_mark and match_start("(FILLER|COMMA)* (NOONE|nothing)", lexemes):
        raise NotUnderstoodError(lexemes)  # "nothing moving over there" is a remark or a condition, not a question
    if not has_question_mark and full_match(
        "how _{1,3} (CARRY|HAVEV|DOV|had|did|left|liked|wanted|set) (it|this|that|them)", lexemes
    ):
        raise NotUnderstoodError(lexemes)  # "it was better how Margaret had it" refers to a way of doing it
    if is_question(lexemes) and not _is_personal(lexemes):
        is_indirect = not has_question_mark and (lexemes[0].has("WHQ") or lexemes[0].word == "how")
        return Ask(text_of(source, lexemes) + end, scope, embedded=is_indirect)  # "I need to know what colour it is"
    tag = (
        full_match("(?P<statement>_+) COMMA (BE|DOV|HAVEV|MODAL|can|do) (not)? (PRON|it|there|they)", lexemes)
        if has_question_mark
        else None
    )
    if tag and tag["statement"][0].word != "it" and not search(f"NOT|not|{_NO_TOPIC}", tag["statement"]):
        return Ask(f"whether {text_of(source, tag['statement'])}?", scope, embedded=True)  # "the gate is open, isn't it?"
    if has_question_mark and (placed := _with_options_at_place(source, lexemes)) is not None:
        return placed
    if (
        has_question_mark
        and (search("COLON", lexemes) or match_start("(DET)? FREE+ of ", lexemes))
        and not search(_NO_TOPIC, lexemes)
    ):
        return Ask(text_of(source, lexemes) + "?", scope)  # "display case: open or shut?"
    if (choice := _choice(source, lexemes)) is not None:
        return choice
    if (yes_or_no := full_match("(?P<body>_+) (COMMA)? OR (not|NOT)", lexemes)) and yes_or_no["body"][-1].word in _STATES:
        lexemes, has_question_mark = tuple(yes_or_no["body"]), True  # "skip full or not?"
    is_choice = len(lexemes) > 3 and lexemes[-2].has("OR") and lexemes[-1].word in _STATES and lexemes[-3].word in _STATES
    question = _verbless_question(source, lexemes, has_question_mark=has_question_mark or is_choice)
    if question is not None:
        return Ask(question, scope)
    if match := full_match(r"(what|how) about (?P<thing>_+)|(and|or) (?P<other>_+)", bare):
        thing = thing_of(source, match["thing"] or match["other"])
        return WhatAbout(thing) if thing and has_question_mark else None
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
