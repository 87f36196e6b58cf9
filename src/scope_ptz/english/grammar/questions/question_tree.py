"""Data classes for descriptions and questions. Words are in lower case and are not yet resolved against a scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

RelationKind = Literal["left", "right", "above", "below", "front", "behind", "near", "on", "facing"]
Side = Literal["left", "right", "top", "bottom", "middle", "near", "far"]
OrderKey = Literal[
    "left", "right", "top", "bottom", "nearest", "furthest", "biggest", "smallest", "tallest", "widest", "looks biggest",
    "looks smallest",
]  # fmt: skip
Words = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Phrase:
    """One noun phrase. ``words`` is its core ("red car", "cars parked"); the search for matches decides where the noun ends."""

    words: Words
    tests: tuple[Test, ...] = ()
    order: Order | None = None
    ordinal: int | None = None
    """The position among the matches: 1 for the first, -1 for the last."""
    amount: int | None = None
    """The number of things ("the two nearest cones")."""
    article: Literal["the", "a", ""] = ""
    """The type of article with which the phrase begins: "the" for definite, "a" for indefinite, "" for none."""


@dataclass(frozen=True, slots=True)
class Description:
    """Phrases joined by "and" or "or". It matches everything that any of the phrases matches."""

    phrases: tuple[Phrase, ...]
    by_and: bool = field(default=False, compare=False)
    """Whether the phrases were joined by "and", for questions that ask whether there are all of them."""


@dataclass(frozen=True, slots=True)
class Order:
    """A superlative ("the tallest"). The nearest and furthest are relative to ``reference``, or to the camera if it is None."""

    key: OrderKey
    reference: Description | None = None


@dataclass(frozen=True, slots=True)
class Relation:
    """A test for a relation to other things. One kind covers several prepositions, so ``preposition`` stores the original one."""

    kind: RelationKind
    other: Description
    preposition: str = ""


@dataclass(frozen=True, slots=True)
class Between:
    """A test for a place between two things."""

    first: Description
    second: Description


@dataclass(frozen=True, slots=True)
class Region:
    """A test for a part of the frame: one or two sides. A side is a band ("on the left"); with ``half``, a half ("left half")."""

    sides: tuple[Side, ...]
    half: bool = False


@dataclass(frozen=True, slots=True)
class Has:
    """A test for parts, clothing and goods ("with a yellow helmet", "wearing orange vests", "selling fish").

    ``worn`` is True for clothing, ``sold`` for goods.
    """

    what: Description
    worn: bool = False
    sold: bool = False


@dataclass(frozen=True, slots=True)
class Says:
    """A test for text on a thing: these words, or any text if ``words`` is empty."""

    words: Words


@dataclass(frozen=True, slots=True)
class Is:
    """A test for a state, as free text: "parked", "lit", "in use"."""

    words: Words


@dataclass(frozen=True, slots=True)
class Faces:
    """A test for the side that a thing faces: "facing left"."""

    side: Side


@dataclass(frozen=True, slots=True)
class Measured:
    """A test that compares size, distance or position ("closer than the van", "bigger than the car")."""

    key: OrderKey
    other: Description


@dataclass(frozen=True, slots=True)
class Within:
    """A test for a distance of at most ``metres`` (with ``beyond``, of more than ``metres``) from the camera or ``other``."""

    metres: float
    other: Description | None = None
    beyond: bool = False


@dataclass(frozen=True, slots=True)
class Not:
    """A test that passes if another test fails."""

    test: Test


@dataclass(frozen=True, slots=True)
class Any:
    """A test that passes if at least one of several tests passes ("red or blue")."""

    tests: tuple[Test, ...]


Test = Relation | Between | Region | Has | Says | Is | Faces | Measured | Within | Not | Any | Order


# Questions


@dataclass(frozen=True, slots=True)
class Exists:
    """Ask whether something is in view.

    Attributes:
        negated: Whether the question is "is there no ...".
        least: The minimum number of things.
        most: The maximum number of things; None if there is no maximum.
    """

    what: Description
    negated: bool = False
    least: int = 1
    most: int | None = None


@dataclass(frozen=True, slots=True)
class Count:
    """Ask how many things there are, or how many of them pass the tests."""

    what: Description
    tests: tuple[Test, ...] = ()


@dataclass(frozen=True, slots=True)
class CountKinds:
    """Ask how many colours or kinds of a thing there are."""

    attribute: Words
    what: Description


@dataclass(frozen=True, slots=True)
class YesNo:
    """Ask whether tests hold for a subject. Without tests, the subject's words include the predicate."""

    subject: Description
    tests: tuple[Test, ...]
    scope: Literal["the", "all", "any", "none"] = "the"


@dataclass(frozen=True, slots=True)
class IsA:
    """Ask whether something is of a kind ("is the red vehicle a bus?")."""

    subject: Description
    what: Description


@dataclass(frozen=True, slots=True)
class Ask:
    """Ask for the value of an attribute ("what colour is the van?").

    ``what`` is None if any thing may have the attribute ("which lane is closed?").
    """

    attribute: Words
    what: Description | None


@dataclass(frozen=True, slots=True)
class Read:
    """Ask for the text on something, or for all text when ``what`` is None. With ``plate``, ask only for the number plate."""

    what: Description | None
    plate: bool = False


@dataclass(frozen=True, slots=True)
class Price:
    """Ask what something costs."""

    what: Description


@dataclass(frozen=True, slots=True)
class Time:
    """Ask when something opens, closes or happens. The description may end in a predicate: "pharmacy close"."""

    what: Description


@dataclass(frozen=True, slots=True)
class TextExists:
    """Ask whether there is any text, or whether it can be read."""

    what: Description | None


@dataclass(frozen=True, slots=True)
class Where:
    """Ask where something is."""

    what: Description


@dataclass(frozen=True, slots=True)
class Quarter:
    """Ask in which quarter of the frame something is."""

    what: Description


@dataclass(frozen=True, slots=True)
class InOrder:
    """Ask for the order of several things by place or distance, or of several kinds by how many things they have."""

    key: OrderKey | Literal["most", "fewest"]
    options: Description


@dataclass(frozen=True, slots=True)
class What:
    """Ask for the names of all things that match ("what is behind the barrier?", "which cars are parked?")."""

    what: Description
    tests: tuple[Test, ...] = ()


@dataclass(frozen=True, slots=True)
class Present:
    """Ask which of several things are in view ("which of these can be seen: a clock, a ladder or a bench?")."""

    options: Description


@dataclass(frozen=True, slots=True)
class KindOf:
    """Ask what kind of thing something is ("what type of bicycle is the purple bicycle?")."""

    what: Description


@dataclass(frozen=True, slots=True)
class Identify:
    """Ask what something is ("what is the thing on the left?", "what kind of vehicle is behind the fence?")."""

    what: Description


@dataclass(frozen=True, slots=True)
class Which:
    """Ask which of several things ranks first ("which is closer, the van or the lorry?")."""

    key: OrderKey
    options: Description


@dataclass(frozen=True, slots=True)
class HowFar:
    """Ask how far away something is, from the camera or from ``other``."""

    what: Description
    other: Description | None = None


@dataclass(frozen=True, slots=True)
class Compare:
    """Ask whether one thing ranks before another ("is the van bigger than the lorry?")."""

    key: OrderKey
    first: Description
    second: Description


@dataclass(frozen=True, slots=True)
class CompareCount:
    """Compare the numbers of two kinds: "are there more cars than vans?". With ``which``, ask which kind has more things."""

    sense: Literal["more", "fewer", "same"]
    first: Description
    second: Description
    which: bool = False


@dataclass(frozen=True, slots=True)
class Difference:
    """Ask how many more things of one kind there are than of another."""

    first: Description
    second: Description


@dataclass(frozen=True, slots=True)
class MostCommon:
    """Ask for the most or least common colour or kind."""

    attribute: Words
    what: Description
    least: bool = False


@dataclass(frozen=True, slots=True)
class Describe:
    """Ask for a description of the view, of a part of it, or of a thing."""

    tests: tuple[Test, ...] = ()
    what: Description | None = None


@dataclass(frozen=True, slots=True)
class Happening:
    """Ask what is happening."""


Question = (
    Exists | Count | CountKinds | YesNo | IsA | Ask | Read | TextExists | Where | What | Identify | Which | HowFar | Compare
    | CompareCount | MostCommon | Describe | Happening | Quarter | InOrder | Present | KindOf | Difference | Price | Time
)  # fmt: skip
