"""Descriptions of things and places, and the conditions that are tested on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from scope_ptz.tools.arguments import View

Operator = Literal[">=", "<=", ">", "<", "=="]
Wish = Literal["more", "fewer"]


@dataclass(frozen=True, slots=True)
class PresetRef:
    """A preset by name, or by its number in the list (-1: the last). ``sure``: the person said that it is a preset;
    ``determined``: said with "the" or "a"."""

    name: str = ""
    number: int | None = None
    sure: bool = False
    determined: bool = False


@dataclass(frozen=True, slots=True)
class Thing:
    """A described thing; an empty description is a pronoun. ``odd``: made of words that name no thing ("times", "closer")."""

    text: str = ""
    definite: bool = False
    odd: bool = False


@dataclass(frozen=True, slots=True)
class Quantity:
    operator: Operator = ">="
    number: float = 1

    def holds(self, count: float) -> bool:
        return {
            ">=": count >= self.number, "<=": count <= self.number, ">": count > self.number,
            "<": count < self.number, "==": count == self.number,
        }[self.operator]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Seen:
    """So many of a thing are visible."""

    thing: Thing
    quantity: Quantity = Quantity()
    view: View | None = None


@dataclass(frozen=True, slots=True)
class Readable:
    thing: Thing


@dataclass(frozen=True, slots=True)
class Holds:
    """A yes-or-no question about the scene; ``wanted``: the answer that meets the condition. ``question``:
    where it is not "is it so?"."""

    subject: Thing
    predicate: str
    wanted: bool = True
    question: str = ""


@dataclass(frozen=True, slots=True)
class Outnumbers:
    """There are more (or fewer) of the first than of the second."""

    first: Thing
    second: Thing
    wish: Wish = "more"


@dataclass(frozen=True, slots=True)
class PresetWins:
    """One preset shows more (or fewer) of a thing than another."""

    thing: Thing
    first: PresetRef
    second: PresetRef
    wish: Wish = "more"


@dataclass(frozen=True, slots=True)
class Answered:
    """ "If so": the last question was answered with yes, or the last count was not zero."""


@dataclass(frozen=True, slots=True)
class Joined:
    """Conditions with "and" (all) or "or" (any) between them."""

    parts: tuple[Condition, ...]
    mode: Literal["all", "any"]


@dataclass(frozen=True, slots=True)
class Negated:
    part: Condition


Condition = Answered | PresetWins | Seen | Readable | Holds | Outnumbers | Joined | Negated
