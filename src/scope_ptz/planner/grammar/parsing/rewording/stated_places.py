"""Rewrite statements before a command: "there's a gap in the fence by the crossing, so go there and zoom in on it".

The new text is "go to the crossing. zoom in on the gap in the fence". A statement to be checked becomes a question: "the lights are
out, can you check?" is read as "are the lights out?".
"""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.english import is_plural
from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.asides import may_withdraw
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, MARKERS, VERBS, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import is_noun_phrase
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start
from scope_ptz.planner.grammar.parsing.parts.questions import is_question
from scope_ptz.planner.grammar.parsing.parts.statements import is_statement, subject_of

OTHERS = "((DET)? (FREE|CAMERA|FILLER|STEPNOUN){1,3}?|SOMEONE|they|he|she)"
AUXILIARIES = "(BE|HAVEV|MODAL|been|just|now|also|keeps|keep|still|FILLER)*"
"""Patterns for someone else as the subject of a sentence, and for what can stand between the subject and the verb."""

_MAX_REQUEST = 14  # maximum number of lexemes of a request to check a statement
_ENDS = ("STOP", "QUESTION", "COLON")
_HEARD = (
    "(reckon|reckons|think|thinks|thought|say|says|said|heard|hear|hears|believe|believes|bet|guess|suspect|suspects|fear|swear|swears|"
    "reports|reported|mentioned|noticed|claims|(told|telling|tells) (me|us)?)"
)
_HEARSAY = (
    f"(FILLER|COMMA)* ((({OTHERS}|i|we) {AUXILIARIES} {_HEARD}|(i|we) HAVEV been told|(i|we) (was|were) told) (that)? "
    "((they|he|she) (SEE-ED|spotted|noticed))?|i_think|"
    "(it (looks|seems|sounds) (like|as_if|as_though|that)?|apparently|looks like|seems like|sounds like))"
)
"""Words before a statement that say where it comes from: "my deputy reckons", "it looks like"."""

_PLACE = (
    "(over|FILLER)* (at|into|onto|by|near|on|in|around|round|outside|behind|beside|next_to|close_to) "
    "(DET)? (?P<name>PRESET) PRESETNOUN?"
)
_THERE = (
    "(so|then|and|AND|please|FILLER|COMMA|(can|could|would) you|MODAL SELF)* "
    "(CARRY|SWITCH|TURN) (over|down|up|out|FILLER|straight)* there"
)
_CHECK = (
    "(so|then|and|AND|please|FILLER|COMMA|MODAL SELF|go_and|WRAPPER)* (CARRY (AND|and|over)?)* "
    "(check|verify|confirm|investigate|see|have_a_look|take_a_look|have_a_quick_look|look|double_check|SCAN) "
    "(it|that|this|there|out|up|into|over|around|FILLER|for me|for us|PRON|please)* (STOP|QUESTION|FILLER)*"
)
_STATE = "(FILLER)* (DET)? (?P<name>PRESET) (BE|LOOKSLIKE|looks|seems|sounds|gets) (?P<state>_+)"
"""A statement about a preset: "the main gate looks busy"."""

_THERE_WORDS = frozenset({"there", "over_there", "in_there", "out_there", "up_there", "down_there", "still_there"})
_PRONOUNS = frozenset({"it", "him", "her", "them", "they", "he", "she"})
_VERB_FORMS = tuple(f"{verb}{ending}" for verb in VERBS for ending in ("-ED", "-ING"))
_EXCLUDED = ("NUM", "DEG", "HOME", "QUESTION", "IF", "EVERY", "PRESETNOUN", "WRAPPER", *DIRECTIONS, *MARKERS)


def with_place_first(text: str, presets: tuple[str, ...]) -> str | None:
    """Return the text with the preset of its first statement in front: "go to the crossing. ..."; None for other texts."""
    lexemes = lexemes_of(text, presets)
    end = _statement_end(lexemes)
    said, rest = lexemes[:end], trimmed(lexemes[end:], "STOP", "COMMA", "DASH", "AND", "COLON")
    if not end or not rest or may_withdraw(said) or _may_forbid(said):
        return None
    if (state := full_match(_STATE, said)) is not None:
        name = state["name"][0].preset.replace("-", " ")
        if full_match(_CHECK, rest) is not None:
            return f"is the {name} {_joined(text, state['state'])}?"
        return f"go to the {name}. {text[rest[0].start :]}" if _asks_there(rest) else None
    if not (match_start(_HEARSAY, said) or is_statement(said) or match_start("(DET)? FREE{1,3} ought to", said)):
        return None
    goes_there = match_start(_THERE, rest)
    counts = match_start("(FILLER)* HOWMANY", rest) is not None
    if (placed := _place_in(said, anywhere=goes_there is not None, counted=counts)) is None:
        return _about_subject(text, said, rest) or _checked(text, said, rest)
    before, name, after = placed
    stated = _without_source(before)
    thing = _thing_in(stated)
    go = f"go to the {name}. "
    if goes_there is not None:
        following = trimmed(rest[goes_there.size :], "AND", "COMMA", "THEN", "STOP", "FILLER")
        return f"{go}{_with_thing(text, following, thing)}" if following else go
    if full_match(_CHECK, rest) is not None:
        question = _question_about(text, (*stated, *after), thing)
        return f"{go}{question}" if question else None
    is_asked = rest[-1].has("QUESTION")
    if not is_asked and not any(x.word in {"at", "in", "into", "onto"} for x in said[len(before) :]):
        return None  # "there is a lad by the breakwater, follow him" may be about the current view
    if thing and _refers(rest):
        return f"{go}{_with_thing(text, rest, thing)}"
    if (counted := _count_of(text, rest, thing)) is not None:
        return f"{go}{counted}"
    return f"{go}{text[rest[0].start :]}" if _asks_there(rest) else None


def _may_forbid(said: Sequence[Lexeme]) -> bool:
    """Return whether a statement may forbid a command: "he told you not to go to the gate", but not "I don't trust him"."""
    denied = next((i for i, x in enumerate(said) if x.has("NOT", "NEGATED")), len(said))
    forbidden = said[denied + 1 :]
    words = " ".join(x.word.replace("_", " ") for x in said)
    is_act = any(x.has(*VERBS, *_VERB_FORMS) for x in forbidden) or " not to " in f" {words} "
    return is_act and not match_start("there BE", said)


def _count_of(text: str, rest: Sequence[Lexeme], thing: Sequence[Lexeme]) -> str | None:
    """Return "how many guards do you see?" for "how many do you see?" after a statement about guards; None for other words."""
    match = full_match("(FILLER)* (?P<how>HOWMANY) (?P<rest>(do|can|could|DOV|MODAL|BE) (SELF|there) _*)", rest)
    nouns = [x for x in thing if not x.has("DET", "NUM", "ADVERB", "FILLER")]
    if match is None or not nouns:
        return None
    return f"how many {text[nouns[0].start : thing[-1].end]} {text[match['rest'][0].start :]}"


def _about_subject(text: str, said: Sequence[Lexeme], rest: Sequence[Lexeme]) -> str | None:
    """Return "zoom in on the kid" for "a kid just fell over, zoom in on him"; None for other texts."""
    subject = subject_of(said)
    if not subject or not subject[0].has("ANY") or not rest[0].has(*VERBS) or _is_excluded(said):
        return None
    return _with_thing(text, rest, subject) if _refers(rest) else None


def _checked(text: str, said: Sequence[Lexeme], rest: Sequence[Lexeme]) -> str | None:
    """Return the question for a statement without a preset that is to be checked: "the gate should be shut. Is it?"."""
    if _is_excluded(said) or any(
        x.has("PRESET", "NOT", "NEGATED", "CAMERA", "PICTURE", "VIEWNOUN") or x.word == "lens" for x in said
    ):
        return None
    if full_match(_CHECK, rest) is None and full_match("(FILLER)* BE (it|they|he|she|there|that) (FILLER)* QUESTION", rest) is None:
        return None
    stated = _without_source(said)
    is_seen = bool(stated) and (match_start("there", stated) is not None or (len(stated) < len(said) and is_noun_phrase(stated)))
    question = _question_about(text, stated, _thing_in(stated) if is_seen else ())
    everywhere = " anywhere" if any(x.has("SCAN", "AROUND") for x in rest) else ""
    return question.replace("?", f"{everywhere}?") if question else None


def _without_source(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return a statement without the words that say where it comes from."""
    source = match_start(_HEARSAY, lexemes)
    return lexemes[source.size :] if source else lexemes


def _question_about(text: str, stated: Sequence[Lexeme], thing: Sequence[Lexeme]) -> str | None:
    """Return the question that tests a statement: "are the lights out?", "is there a dog?"; None for other statements."""
    if not thing and match_start("(there BE)? (SOMEONE|NOONE) (BE|HAVEV|'s|\\Z)", stated):
        return "is there anyone?"
    is_or_should_be = "((MODAL|should|ought to) (FILLER)* be|BE)"
    match = full_match(f"(FILLER)* (?P<subject>(DET)? FREE{{1,3}}?) {is_or_should_be} (?P<state>(?!being) _+?) (by? NOW)?", stated)
    if match is not None and is_noun_phrase(match["subject"]):
        subject = _without_capital(_joined(text, match["subject"]))
        return f"{'are' if is_plural(match['subject'][-1].word) else 'is'} {subject} {_joined(text, match['state'])}?"
    return f"is there {_without_capital(_joined(text, thing))}?" if thing else None


def _statement_end(lexemes: Sequence[Lexeme]) -> int:
    """Return the length of the statement at the beginning, which ends at a full stop or after a preset; 0 if there is none."""
    for i, x in enumerate(lexemes):
        if x.has("QUESTION"):
            return 0
        is_break = x.has("COMMA", "DASH") or x.word == "so"
        has_preset = any(y.has("PRESET") for y in lexemes[:i]) or (lexemes[0].has("ANY") and is_statement(lexemes[:i]))
        is_request = len(lexemes) - i <= _MAX_REQUEST and full_match(_CHECK, lexemes[i:]) is not None
        if x.has("STOP") or (is_break and (has_preset or is_request)):
            return i
    return 0


def _asks_there(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes are one question that names no preset: "how many people are there?"."""
    ends = [i for i, x in enumerate(lexemes) if x.has(*_ENDS)]
    is_one = not ends or ends[0] == len(lexemes) - 1
    is_there = any(x.word in _THERE_WORDS for x in lexemes)
    return is_one and is_there and is_question(lexemes) and not any(x.has("PRESET") for x in lexemes)


def _place_in(
    lexemes: Sequence[Lexeme], *, anywhere: bool = False, counted: bool = False
) -> tuple[Sequence[Lexeme], str, Sequence[Lexeme]] | None:
    """Return the words before the only preset of a statement, its name, and the words after it; None for other statements."""
    kept = [x for x in lexemes if not (counted and x.has("NUM"))]
    if sum(x.has("PRESET") for x in lexemes) != 1 or _is_excluded(kept):
        return None
    for start in range(len(lexemes)):
        match = match_start(_PLACE, lexemes[start:])
        if match is None and anywhere:
            match = match_start("(about|with|to|from|of|PREP)? (DET)? (?P<name>PRESET) PRESETNOUN?", lexemes[start:])
        if match is not None and start:
            return lexemes[:start], match["name"][0].preset.replace("-", " "), lexemes[start + match.size :]
    return None


def _is_excluded(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether a statement contains a number, a direction, a condition or the like, none of which may be lost."""
    for i, x in enumerate(lexemes):
        before = lexemes[i - 1] if i else None
        after = lexemes[i + 1] if i + 1 < len(lexemes) else None
        if not x.has(*_EXCLUDED) or x.has("PRESET") or before is None:
            continue
        is_verb = (
            x.word == "left"
            and before.has("SELF", "PRON", "SOMEONE", "FREE", "HAVEV", "BE")
            and after is not None
            and after.has("DET")
        )
        is_state = x.has("UP", "DOWN") and before.has("BE") and after is None
        is_modal = x.word == "should" and after is not None and after.has("BE")
        if not (is_verb or is_state or is_modal):
            return True
    return bool(lexemes) and lexemes[0].has(*_EXCLUDED) and not lexemes[0].has("PRESET")


def _joined(text: str, *parts: Sequence[Lexeme]) -> str:
    return " ".join(text[part[0].start : part[-1].end] for part in parts if part)


def _with_thing(text: str, lexemes: Sequence[Lexeme], thing: Sequence[Lexeme]) -> str:
    """Return the text from the first lexeme on, with the thing in place of the first pronoun."""
    pronoun = next((x for x in lexemes if x.word in _PRONOUNS), None)
    if pronoun is None or not thing or not _refers(lexemes):
        return text[lexemes[0].start :]
    named = thing[1:] if thing[0].has("DET") and len(thing) > 1 else thing
    words = "the person" if thing[0].has("SOMEONE") else f"the {_without_capital(_joined(text, named))}"
    return f"{text[lexemes[0].start : pronoun.start]}{words}{text[pronoun.end :]}"


def _without_capital(text: str) -> str:
    return text[:1].lower() + text[1:] if text[1:2].islower() or text[1:2] == " " else text


def _refers(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether the first clause names the thing of the statement by a pronoun, and names no preset."""
    clause: list[Lexeme] = []
    for x in lexemes:
        if x.has(*_ENDS):
            break
        clause.append(x)
    return any(x.word in _PRONOUNS for x in clause) and not any(x.has("PRESET") for x in lexemes)


def _thing_in(lexemes: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return the thing that a statement is about: "a dog" in "we had a call about a dog"; empty if it is unclear."""
    for pattern in ("there (MODAL)? (BE|be|HAVEV been)+ (?P<thing>_+)", "(?P<thing>_+?) (MODAL)? (BE|be|been|HAVEV)+ _*"):
        is_someone = bool(lexemes) and lexemes[0].has("SOMEONE") and len(lexemes) > 2
        if not is_someone and (match := full_match(pattern, lexemes)) is not None and is_noun_phrase(match["thing"]):
            return match["thing"]
    if lexemes and lexemes[0].has("DET") and is_noun_phrase(lexemes) and not is_statement(lexemes):
        return lexemes
    for start in range(1, len(lexemes)):
        last = lexemes[start - 1]
        begins = last.word in {"of", "about"} or (lexemes[start].has("DET") and not last.has("PREP"))
        tail = lexemes[start:]
        if begins and is_noun_phrase(tail) and not any(x.word in {"of", "about"} for x in tail):
            return tail
    return ()
