"""Strip courtesy: the words around a command or question that make it polite but do not change its meaning."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, VERBS
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start

_VERY = "(very|most|ever|so|much|FILLER|ADVERB)*"
_COMMANDS = tuple(verb for verb in VERBS if verb not in {"DOACT", "HELP"})
_JUST = "(FILLER|be able to|kindly|maybe|perhaps|possibly|first|please|ever|now)*"
_I_WOULD = "(SELF MODAL|WRAPPER|SELF)"
_WOULD_YOU = "(MODAL SELF|DOV SELF|do SELF|FILLER|WRAPPER)"
_IF_YOU_WOULD = "(if SELF MODAL|WRAPPER|if_you_could|if_you_would|FILLER)"
GLAD = "grateful|obliged|glad|thankful|delighted|appreciative|happy|pleased|indebted|relieved|interested|keen|curious"
_COURTEOUS = frozenset({
    "sorry", "apologies", "apology", "apologise", "apologize", "pardon", "forgive", "excuse", "thank", "thanks", "thank_you",
    "grateful", "obliged", "appreciated", "appreciate", "kind", "kindly", "kindness", "please", "bother", "trouble", "indulge",
    "convenient", "favour", "favor", "mind", "ask", "beg", "awfully", "cheers", "dear", "afraid", "bothering", "troubling",
    "hassle", "patience", "help",
})  # fmt: skip
_EMPTY = frozenset({"much", "ever", "such", "like", "man", "good", "may"})
_FUNCTION_CLASSES = (
    "SELF", "MODAL", "DET", "PREP", "BE", "DOV", "HAVEV", "ADVERB", "FILLER", "COMMA", "PRON", "LITTLE", "LOT", "WRAPPER",
    "LEADFILLER", "IF", "DOACT", "GLUE",
)  # fmt: skip
_FOR_WHOM = (
    "for (DET|my|our|SELF)* (FREE|DET)? (survey|report|study|log|logbook|records|audit|inventory|stocktake|meeting|paperwork|"
    "newsletter|website|boss|manager|client|police|insurance|statistics|file|girl|lad|lads|team|office|council|foreman|supervisor|handover|"
    "sheet|form|rota|ledger|register|spreadsheet|schedule|invoice|books|minutes)"
)
"""The recipient or purpose of a command: "for the parking survey"."""

_OPENERS = "|".join((
    f"{_FOR_WHOM} COMMA? (?=WRAPPER|COUNT|COUNTNOUN|HOWMANY|SELF (need|want))",
    f"({_I_WOULD}|it (MODAL|BE)) (be|BE)? {_VERY} ({GLAD}|good|nice|helpful|great|lovely|useful) ({_IF_YOU_WOULD}|if SELF)",
    f"{_I_WOULD} appreciate (it|this)? {_VERY} ({_IF_YOU_WOULD}|if SELF)",
    f"{_I_WOULD} {_VERY} (appreciate|welcome) {_VERY} (?=DET|NUM|PICTURE)",
    f"{_I_WOULD} (be|BE)? {_VERY} ({GLAD}) (to (?=know|TELL)|to (learn|hear|see)|for (?=DET|NUM|PICTURE|ANY))",
    f"SELF (MODAL|DOV)? (BE)? (wonder|wondering|wondered) (if|whether|FILLER)* (SELF MODAL|SELF|WRAPPER)? {_JUST}",
    f"{_WOULD_YOU} {_JUST} (trouble|bother|ask|get|persuade|beg|request|invite) SELF (FILLER)* to",
    f"(MODAL|DOV|do) SELF {_JUST} (ask|enquire|inquire|know|learn|hear) (FILLER|COMMA)*"
    " (?=whether|if|IF|what|WHQ|which|who|how|HOWMANY|where)",
    f"{_WOULD_YOU} {_JUST} (happen|chance) to",
    f"be {_VERY} (good|kind|dear) (enough to|and)",
    "it (BE|MODAL be) (possible|feasible|convenient) (for SELF)? to|MODAL it be (possible|feasible|convenient) (for SELF)? to",
    "MODAL SELF (FILLER|be able to|kindly|maybe|perhaps|possibly|be so kind as to|help|mind|not)*"
    " (?!(ADVERB)* (SEE|be |have|READ))",
    "WRAPPER (?!DET? HOME)",
    "you (can|may) (FILLER)* (?=PAN|TILT|ZOOM|TURN|CARRY|SWITCH|TAKE|SNAP|TRACK)",
    "only (?=TAKE|SNAP|PAN|TILT|ZOOM|SWITCH|CARRY)",
    "CAMERA NUM COMMA",
    "make it (?=AIM|TURN|PAN|TILT|ZOOM|FACE)",
    "SELF (BE|am|was|were) (hoping|wondering|asking|FREE) (if|that|whether)? SELF (MODAL)",
    "(DET)? CAMERA (should|must|needs to|has to|ought to)",
    "(DET)? FREE{1,2} (wants|needs|WRAPPER|TAKE-S) (SELF to|to (?=SEE|SHOW|have)|to SEE)?"
    "(?=DET|PRESET|NUM|it|PICTURE|LITTLE|COUNTNOUN|CARRY|PAN|TILT|ZOOM)",
    "SELF (will|would)? (need|want|love|like) (SELF to|to)?(?=DET|NUM|PICTURE|PAN|TILT|ZOOM|TURN|CARRY|SWITCH|SNAP|COUNT)",
    "(all|what) (WRAPPER|SELF (MODAL|BE|need|want|am)* (need|want|like|after|FREE)?) (FILLER|to see|to have|now|next|DOACT)* BE"
    " (for SELF to)?(?! (not|FREE|ADVERB))",
    "DET (FREE|next|MORE)? (job|task|thing|step|order|request) (WRAPPER|for SELF|FILLER)* BE (to)?(?! (not|FREE|ADVERB))",
    "(FILLER|LEADFILLER(?! NUM)|FIRSTLY|COMMA|QUOTE|AND|BUT|INSTEAD|PURPOSE)",
))  # fmt: skip
"""Openers that add nothing to a command: courtesy, the person who wants it, and "what I need is"."""


def is_polite(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes are only polite: "do forgive me", "my apologies for the bother", "if I may ask"."""
    if len(lexemes) < 2 or any(
        x.has(*_COMMANDS, *DIRECTIONS, "IN", "OUT", "NUM", "HOME", "PRESET", "AFTER", "BEFORE") for x in lexemes
    ):
        return False
    if match_start(_WITH_OBJECT, lexemes):
        return False
    words = {part for x in lexemes for part in (x.word, *x.word.split("_"))}
    is_function = all(x.word in _COURTEOUS or x.has(*_FUNCTION_CLASSES) or x.word in _EMPTY for x in lexemes)
    return is_function and bool(_COURTEOUS & words or full_match(_BRIEF, lexemes))


_WITH_OBJECT = "(in|on|onto|upon|at|to|into|towards|over)+ (all|both|each|of)* PRON"
"""The object of a command such as "zoom in on him please", which courtesy must not swallow."""

_BRIEF = "(FILLER|COMMA)* (if)? SELF (may|MODAL) (FILLER)*|like DET good (FREE)|in fact|eh"
"""Polite and empty phrases without a word of courtesy: "if I may", "like a good man"."""


_MEANT_IN_QUESTIONS = frozenset({
    "today", "tonight", "morning", "evening", "afternoon", "good", "great", "nice", "lovely", "perfect", "excellent",
    "brilliant", "quick", "slow", "smooth", "quickly", "slowly", "careful", "control", "fine", "cool", "sure", "fair",
    "ok", "okay", "all_right", "alright", "well",
})  # fmt: skip


def completes_question(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether the last word matters in a question, although it adds nothing to a command: "is it open today?"."""
    if len(lexemes) < 3 or lexemes[-1].word not in _MEANT_IN_QUESTIONS or lexemes[-2].has("COMMA", "DASH"):
        return False
    words = [x for x in lexemes if not x.has("FILLER", "COMMA", "TELL", "SELF", "FIRSTLY")]
    return bool(words) and words[0].has("BE", "DOV", "HAVEV", "WHQ", "MODAL", "IF") and not words[0].has("HOWMANY", "TAKE")


def bare_clause(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Return a clause without courtesy at either end."""
    lexemes = tuple(lexemes)
    while lexemes:
        match = match_start(_OPENERS, lexemes)
        if not match or not match.size or match.size >= len(lexemes):
            break
        lexemes = lexemes[match.size :]
    if (match := full_match(f"(?P<body>_+?) (with DET CAMERA|{_FOR_WHOM})", lexemes)) is not None:
        lexemes = tuple(match["body"])
    while (
        len(lexemes) > 1
        and (
            lexemes[-1].has("FILLER", "COMMA", "QUOTE", "AND", "DASH", "OPEN", "CLOSE", "PURPOSE", "INSTEAD")
            or (lexemes[-1].has("LEADFILLER") and lexemes[-2].has("COMMA", "DASH"))
        )
        and not lexemes[-1].has("NOW", "VISIBLE", "FULL", "AGAINWORD", "INTURN")
        and not completes_question(lexemes)
    ):
        lexemes = lexemes[:-1]
    return lexemes
