"""What reading an answer can come to: a typed value, "I cannot tell", or something that cannot be read and is never guessed."""

from __future__ import annotations

from dataclasses import dataclass

AnswerValue = float | bool | str | frozenset[str] | tuple[str, ...] | tuple[frozenset[int], frozenset[int]]


@dataclass(frozen=True, slots=True)
class ParsedValue:
    """The answer says this. Of a description: the numbers of the facts stated and of the contradictions stated."""

    value: AnswerValue


@dataclass(frozen=True, slots=True)
class Declined:
    """The answer says that it cannot tell."""


@dataclass(frozen=True, slots=True)
class Unreadable:
    """The answer cannot be read as a value, and why."""

    reason: str


ParsedAnswer = ParsedValue | Declined | Unreadable
