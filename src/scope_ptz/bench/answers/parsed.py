"""The possible results of parsing an answer: a typed value, a declined answer or an unreadable answer."""

from __future__ import annotations

from dataclasses import dataclass

AnswerValue = float | bool | str | frozenset[str] | tuple[str, ...] | tuple[frozenset[int], frozenset[int]]
"""The parsed value of an answer. Its type depends on the kind of expected answer."""


@dataclass(frozen=True, slots=True)
class ParsedValue:
    """The value that an answer states.

    For a description, it is a pair of index sets: the stated facts and the stated contradictions.
    """

    value: AnswerValue


@dataclass(frozen=True, slots=True)
class Declined:
    """An answer that declines to give a value, such as "I cannot tell"."""


@dataclass(frozen=True, slots=True)
class Unreadable:
    """An answer from which no single value could be parsed.

    Attributes:
        reason: Why no value could be parsed.
    """

    reason: str


ParsedAnswer = ParsedValue | Declined | Unreadable
