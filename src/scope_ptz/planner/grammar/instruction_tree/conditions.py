"""References to objects and presets, and the conditions of an instruction, such as "until you see three cars"."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View


Operator = Literal[">=", "<=", ">", "<", "=="]
Comparison = Literal["more", "fewer"]


@dataclass(frozen=True, slots=True)
class PresetRef:
    """A reference to a preset.

    Attributes:
        name: The name as it appears in the instruction.
        number: The position in the list of presets, if the instruction gives one: 1 is the first, -1 the last.
        explicit: Whether the wording can only refer to a preset ("preset gate"), and not to an object.
        has_article: Whether the name follows "the", "a" or "an".
        is_first_view: Whether the words can also mean the first view of the conversation ("go back to the first view").
    """

    name: str = ""
    number: int | None = None
    explicit: bool = False
    has_article: bool = False
    is_first_view: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class Thing:
    """A reference to one or more objects.

    Attributes:
        text: The description; empty for a pronoun.
        definite: Whether the description follows a definite article or a demonstrative.
        not_an_object: Whether the words cannot describe an object ("times", "closer").
        pronoun: The pronoun in the user's words ("him"); empty if there is none, or if the thing is not mentioned at all.
        owner: The possessive pronoun before the description ("its" of "its sign"); empty for none.
        predicate: What must hold for the things that the pronoun refers to: "wear helmets" of "how many of them wear helmets?".
    """

    text: str = ""
    definite: bool = False
    not_an_object: bool = False
    pronoun: str = field(default="", compare=False)
    owner: str = field(default="", compare=False)
    predicate: str = ""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A comparison of a count with a number, such as "at least 3"."""

    operator: Operator = ">="
    number: float = 1

    def matches(self, count: float) -> bool:
        """Return whether a count meets the comparison."""
        return {
            ">=": count >= self.number, "<=": count <= self.number, ">": count > self.number,
            "<": count < self.number, "==": count == self.number,
        }[self.operator]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Seen:
    """The condition that a given number of objects is visible."""

    thing: Thing
    quantity: Quantity = Quantity()
    view: View | None = None


@dataclass(frozen=True, slots=True)
class Readable:
    """The condition that the text on an object can be read."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class Statement:
    """The condition that a statement about an object, such as "the gate is open", is true or false.

    Attributes:
        subject: The object.
        predicate: What is stated about the object, such as "open".
        expected: True if the statement must be true to meet the condition, False if it must be false.
        question: The question to ask perception; if it is empty, "is SUBJECT PREDICATE?" is asked.
    """

    subject: Thing
    predicate: str
    expected: bool = True
    question: str = ""


@dataclass(frozen=True, slots=True)
class Outnumbers:
    """The condition that more (or fewer) visible objects match the first description than the second."""

    first: Thing
    second: Thing
    comparison: Comparison = "more"


@dataclass(frozen=True, slots=True)
class PresetOutnumbers:
    """The condition that more (or fewer) objects are visible at the first preset than at the second."""

    thing: Thing
    first: PresetRef
    second: PresetRef
    comparison: Comparison = "more"


@dataclass(frozen=True, slots=True)
class Answered:
    """The condition "if so": the last answer was yes, or the last count was above zero."""


@dataclass(frozen=True, slots=True)
class Joined:
    """Conditions joined by "and" (all must be met) or "or" (at least one must be met)."""

    parts: tuple[Condition, ...]
    mode: Literal["all", "any"]


@dataclass(frozen=True, slots=True)
class Negated:
    """The negation of a condition."""

    part: Condition


Condition = Answered | PresetOutnumbers | Seen | Readable | Statement | Outnumbers | Joined | Negated
