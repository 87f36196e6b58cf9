"""Say why a question has no answer in a picture: people's names and property, the time, and what is still to come."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.english import letters
from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.parts.courtesy import bare_clause
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match

_LEAD = "(do|DOV|know|TELL|SELF|and|so|FILLER|COMMA)*"
_OWNING = (
    rf"{_LEAD} who (own|owns|owned) _+"
    rf"|{_LEAD} (who DOV (DET|PRON)? _*? (belong|belongs) (to)?|who is the owner of _+)"
    rf"|{_LEAD} whose (FREE){{1,3}} BE (PRON|that|this|it|they|those|these|there)+"
)
_NAMING = (
    rf"{_LEAD} (WHQ BE)? (his|her|their) (name|names)"
    rf"|{_LEAD} (WHQ BE)? (DET)? (?P<owner>(FREE){{1,3}}) 's name"
    rf"|{_LEAD} (WHQ BE)? (DET)? name of (DET)? (?P<owner2>(FREE){{1,3}}?) (there|over_there)?"
    r"|what BE (?P<called>(he|she|they|DET (FREE){1,3})) (called|named)"
)
_COMING = (
    r"how long (till|until|til|UNTIL|to|before|BEFORE) _+"
    r"|(when|WHEN) (DOV|BE|MODAL|will|is|do) (DET)? (next|THEN|first|last) _+"
    r"|(when|WHEN) (MODAL|will|'ll) _+"
    r"|(when|WHEN) (BE|'s) _+? (finished|done|complete|completed|ready|over|going to _+)"
    r"|how long (MODAL|will|'ll) _+"
)

_WHO = f"{_LEAD} who (BE|'s) (that|this|he|she|they|those|these|DET) (?P<person>(FREE){{0,2}}) (there|over_there)?"
_GOING = (
    f"{_LEAD} where (BE|'s) (PRON|it|he|she|they|that|this|DET FREE{{1,3}}) (CARRY-ING|going|heading|headed|off|bound) (to|FILLER)*"
)

_OF_CLOCKS = frozenset({"time", "day", "date", "year"})

_OWNERS = "A picture does not show who owns something. If there is writing on it, I can read that."
_NAMES = "I cannot know people's names. If there is something with a name on it in view, such as a badge, I can read that."
_GOALS = 'I cannot tell where somebody or something is going. I can follow it if you tell me to, for example: "follow the van".'
_TIMES = "I cannot know when something will happen. If there is a timetable or a departure board in view, I can read that."
_CLOCKS = "I have no clock or calendar of my own. If there is a clock in view, ask me what time it shows."


def why_unknowable(instruction: str) -> str:
    """Return why no picture answers the question that an instruction consists of; empty for other instructions."""
    lexemes = bare_clause([x for x in lexemes_of(instruction) if not x.has("STOP", "QUESTION")])
    if not lexemes:
        return ""
    if full_match(_OWNING, lexemes):
        return _OWNERS
    if full_match(_COMING, lexemes):
        return _TIMES
    if full_match(_GOING, lexemes):
        return _GOALS
    if (match := full_match(_WHO, lexemes)) is not None:
        is_ranked = any(x.word.endswith("est") for x in match["person"])  # "who is the tallest person?" can be seen
        return _NAMES if _is_person(match["person"]) and not is_ranked else ""
    if (match := full_match(_NAMING, lexemes)) is not None:
        owner = next((match[name] for name in ("owner", "owner2", "called") if name in match.names and match[name]), ())
        return _NAMES if _is_person(owner) else ""
    return ""


def why_not_about_the_scene(question: str) -> str:
    """Return the reply to a question that is not about what the camera sees."""
    if _OF_CLOCKS & set(letters(question).split()):
        return _CLOCKS
    return "I can only move the camera and answer questions about what it sees. What shall I look at?"


def _is_person(owner: Sequence[Lexeme]) -> bool:
    """Return whether words name a person: "the man", unlike "the shop". No words stand for a pronoun such as "his"."""
    if not owner or owner[-1].has("PRON") or owner[-1].word in {"he", "she", "they"}:
        return True
    concept = lexicon().concept(owner[-1].word)
    return concept is not None and "person" in lexicon().kinds(concept)
