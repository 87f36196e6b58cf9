"""Entry points of the answer parser: parse an answer as the expected type, and compare it with the expected answer."""

from __future__ import annotations

from scope_ptz.bench.answers.choices import parse_choice, parse_description, parse_name_set
from scope_ptz.bench.answers.counts import parse_number
from scope_ptz.bench.answers.hedges import hedge_reason
from scope_ptz.bench.answers.orders import parse_ordering, parse_relation
from scope_ptz.bench.answers.parsed import Declined, ParsedAnswer, ParsedValue, Unreadable
from scope_ptz.bench.answers.presence import parse_none_there, parse_yes_no
from scope_ptz.bench.answers.refusals import declines_to_answer
from scope_ptz.bench.answers.strings import parse_text, same_text
from scope_ptz.bench.answers.text import AnswerText, answer_text, remove_withdrawn
from scope_ptz.bench.answers.tokenizer import clean
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
"""Margin for rounding errors in comparisons of numbers."""


def parse_answer(expected: AnyExpected, answer: str) -> ParsedAnswer:
    """Parse an answer as a value of the type that a task expects.

    The expected value itself is not used, so right and wrong answers are parsed in the same way. Ambiguous answers are unreadable.

    Args:
        expected: The task's expected answer. Only its type and its wordings are used.
        answer: The agent's final answer.

    Returns:
        The parsed value; ``Declined`` if the answer declines to give a value; otherwise ``Unreadable`` with a reason.
    """
    text = answer_text(answer)
    parsed = _parse(expected, text, answer)
    states_nothing = isinstance(expected, Description) and parsed == ParsedValue((frozenset[int](), frozenset[int]()))
    if text.declined and (isinstance(parsed, Unreadable) or states_nothing):
        return Declined()
    if text.hedged and isinstance(parsed, Unreadable):
        return Unreadable("only a guess")
    if isinstance(parsed, ParsedValue):
        stated = remove_withdrawn(clean(answer))
        if declines_to_answer(expected, stated):
            return Declined()
        if (reason := hedge_reason(expected, stated)) is not None:
            return Unreadable(reason)
    return parsed


def _parse(expected: AnyExpected, text: AnswerText, answer: str) -> ParsedAnswer:
    match expected:
        case Number():
            return _parse_number(expected, text)
        case YesNo():
            return parse_yes_no(expected, text)
        case Choice():
            return parse_choice(expected, text)
        case Text():
            return parse_text(expected, text, answer)
        case NameSet():
            return parse_name_set(expected, text)
        case Ordering():
            return parse_ordering(expected, text)
        case Relation():
            return parse_relation(expected, text)
        case Description():
            return parse_description(expected, text)
        case NoneThere():
            return parse_none_there(expected, text)
        case ActionOnly():
            return Unreadable("the task expects no answer")


def _parse_number(expected: Number, text: AnswerText) -> ParsedAnswer:
    if text.hedged:
        return Unreadable("only a guess")
    number = parse_number(text, expected.unit, asks_for_part=expected.part)
    return Unreadable(number) if isinstance(number, str) else ParsedValue(number)


def agrees(expected: AnyExpected, parsed: ParsedAnswer) -> bool | None:
    """Compare a parsed answer with the expected one.

    Args:
        expected: The task's expected answer.
        parsed: The result of ``parse_answer``.

    Returns:
        Whether the answer is right. None if it is unreadable or the task expects no answer. A declined answer is wrong.
    """
    if isinstance(parsed, Unreadable):
        return None
    if isinstance(parsed, Declined):
        return False
    value = parsed.value
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
