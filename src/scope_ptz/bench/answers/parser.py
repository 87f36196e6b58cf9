"""The deterministic reader: free text in, a typed value out, or the reason why it cannot be read. It never guesses."""

from __future__ import annotations

from scope_ptz.bench.answers.choices import parse_choice, parse_description, parse_name_set
from scope_ptz.bench.answers.counts import parse_number
from scope_ptz.bench.answers.orders import parse_ordering, parse_relation
from scope_ptz.bench.answers.parsed import Declined, ParsedAnswer, ParsedValue, Unreadable
from scope_ptz.bench.answers.presence import parse_none_there, parse_yes_no
from scope_ptz.bench.answers.strings import parse_text, same_text
from scope_ptz.bench.answers.text import AnswerText, answer_text
from scope_ptz.bench.tasks.expected import (
    ActionOnly,
    AnyExpected,
    Choice,
    Description,
    NameSet,
    NoneThere,
    Number,
    Ordering,
    Relation,
    Text,
    YesNo,
)

_EPSILON = 1e-9


def parse_answer(expected: AnyExpected, answer: str) -> ParsedAnswer:
    """What an answer says, as the type of value that is expected. Which value is expected plays no part in it."""
    said = answer_text(answer)
    reading = _read(expected, said, answer)
    nothing_said = isinstance(expected, Description) and reading == ParsedValue((frozenset[int](), frozenset[int]()))
    if said.declined and (isinstance(reading, Unreadable) or nothing_said):
        return Declined()
    if said.hedged and isinstance(reading, Unreadable):
        return Unreadable("only a guess")
    return reading


def _read(expected: AnyExpected, said: AnswerText, answer: str) -> ParsedAnswer:
    match expected:
        case Number():
            number = Unreadable("only a guess") if said.hedged else parse_number(said, expected.unit, part=expected.part)
            return (
                number if isinstance(number, Unreadable) else Unreadable(number) if isinstance(number, str) else ParsedValue(number)
            )
        case YesNo():
            return parse_yes_no(expected, said)
        case Choice():
            return parse_choice(expected, said)
        case Text():
            return parse_text(expected, said, answer)
        case NameSet():
            return parse_name_set(expected, said)
        case Ordering():
            return parse_ordering(expected, said)
        case Relation():
            return parse_relation(expected, said)
        case Description():
            return parse_description(expected, said)
        case NoneThere():
            return parse_none_there(expected, said)
        case ActionOnly():
            return Unreadable("no answer is wanted")


def agrees(expected: AnyExpected, reading: ParsedAnswer) -> bool | None:
    """Whether a reading is what was expected; None when nothing could be read. Declining is an answer, and a wrong one."""
    if isinstance(reading, Unreadable):
        return None
    if isinstance(reading, Declined):
        return False
    value = reading.value
    match expected:
        case Number():
            return isinstance(value, float) and abs(value - expected.value) <= expected.tolerance + _EPSILON
        case YesNo() | Choice() | Relation():
            return value == expected.value
        case Text():
            return any(same_text(str(value), accepted, ocr=expected.ocr) for accepted in expected.accepted)
        case NameSet():
            return value == frozenset(expected.value)
        case Ordering():
            return value == expected.value
        case Description():
            return value == (frozenset(range(len(expected.facts))), frozenset())
        case NoneThere():
            return value is True
        case ActionOnly():
            return None
