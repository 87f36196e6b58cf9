"""Descriptions of things and places, and the conditions that are tested on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View


Operator = Literal[">=", "<=", ">", "<", "=="]
Sense = Literal["more", "fewer"]


@dataclass(frozen=True, slots=True)
class PresetRef:
    """A preset by name, or by its number in the list (-1 is the last).

    Attributes:
        sure: Whether the instruction says that it is a preset.
        determined: Whether it has an article.
    """

    name: str = ""
    number: int | None = None
    sure: bool = False
    determined: bool = False


@dataclass(frozen=True, slots=True)
class Thing:
    """A described thing. An empty description is a pronoun.

    Attributes:
        definite: Whether it has a definite article.
        odd: Whether its words do not name an object ("times", "closer").
    """

    text: str = ""
    definite: bool = False
    odd: bool = False


@dataclass(frozen=True, slots=True)
class Quantity:
    """A condition on a count."""

    operator: Operator = ">="
    number: float = 1

    def holds(self, count: float) -> bool:
        return {
            ">=": count >= self.number, "<=": count <= self.number, ">": count > self.number,
            "<": count < self.number, "==": count == self.number,
        }[self.operator]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Seen:
    """The condition that a number of things are visible."""

    thing: Thing
    quantity: Quantity = Quantity()
    view: View | None = None


@dataclass(frozen=True, slots=True)
class Readable:
    """The condition that the text on a thing can be read."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class Holds:
    """A yes-or-no question about the scene.

    Attributes:
        wanted: The answer that meets the condition.
        question: The question to ask; empty for "is it so?".
    """

    subject: Thing
    predicate: str
    wanted: bool = True
    question: str = ""


@dataclass(frozen=True, slots=True)
class Outnumbers:
    """The condition that there are more (or fewer) of the first than of the second."""

    first: Thing
    second: Thing
    sense: Sense = "more"


@dataclass(frozen=True, slots=True)
class PresetWins:
    """The condition that one preset shows more (or fewer) of a thing than another."""

    thing: Thing
    first: PresetRef
    second: PresetRef
    sense: Sense = "more"


@dataclass(frozen=True, slots=True)
class Answered:
    """The condition "if so": the last answer was yes, or the last count was not zero."""


@dataclass(frozen=True, slots=True)
class Joined:
    """Conditions joined by "and" (all) or "or" (any)."""

    parts: tuple[Condition, ...]
    mode: Literal["all", "any"]


@dataclass(frozen=True, slots=True)
class Negated:
    """The opposite of a condition."""

    part: Condition


Condition = Answered | PresetWins | Seen | Readable | Holds | Outnumbers | Joined | Negated
