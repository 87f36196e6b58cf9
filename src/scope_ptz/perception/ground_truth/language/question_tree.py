"""What a description or a question says, as plain data. Words are lower case; nothing is resolved against a scene yet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

RelationKind = Literal["left", "right", "above", "below", "front", "behind", "near", "on", "facing"]
Side = Literal["left", "right", "top", "bottom", "middle", "near", "far"]
OrderKey = Literal["left", "right", "top", "bottom", "nearest", "furthest", "biggest", "smallest", "tallest", "widest"]
Words = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Phrase:
    """One noun phrase. ``words`` is its core as said ("red car", "cars parked"); where the noun ends is decided with the scene."""

    words: Words
    tests: tuple[Test, ...] = ()
    order: Order | None = None
    ordinal: int | None = None
    amount: int | None = None
    """How many are meant ("the two nearest cones"); matters only beside ``order``."""


@dataclass(frozen=True, slots=True)
class Description:
    """Phrases joined by "and" or "or": everything that fits any of them."""

    phrases: tuple[Phrase, ...]


@dataclass(frozen=True, slots=True)
class Order:
    """A superlative; with ``reference`` nearest or furthest from that ("closest to the van"), else from the camera."""

    key: OrderKey
    reference: Description | None = None


@dataclass(frozen=True, slots=True)
class Relation:
    """``said``: the preposition as it was said, where several mean one kind."""

    kind: RelationKind
    other: Description
    said: str = ""


@dataclass(frozen=True, slots=True)
class Between:
    first: Description
    second: Description


@dataclass(frozen=True, slots=True)
class Region:
    """A part of the frame: one or two sides; ``half`` means the half ("left half"), else a third ("on the left")."""

    sides: tuple[Side, ...]
    half: bool = False


@dataclass(frozen=True, slots=True)
class Has:
    """ "with a yellow helmet", "wearing orange vests". ``worn`` when only a person can be meant."""

    what: Description
    worn: bool = False


@dataclass(frozen=True, slots=True)
class Says:
    """Bears a text: these words, or any text at all when there are none."""

    words: Words


@dataclass(frozen=True, slots=True)
class Is:
    """Loose words: "parked", "lit", "in use"."""

    words: Words


@dataclass(frozen=True, slots=True)
class Faces:
    """Points to one side: "facing left"."""

    side: Side


@dataclass(frozen=True, slots=True)
class Measured:
    """ "Closer than the van", "bigger than the car"."""

    key: OrderKey
    other: Description


@dataclass(frozen=True, slots=True)
class Within:
    """Closer than so many metres to the camera or to ``other``; ``beyond``: further."""

    metres: float
    other: Description | None = None
    beyond: bool = False


@dataclass(frozen=True, slots=True)
class Not:
    test: Test


@dataclass(frozen=True, slots=True)
class Any:
    """At least one of the tests holds ("red or blue")."""

    tests: tuple[Test, ...]


Test = Relation | Between | Region | Has | Says | Is | Faces | Measured | Within | Not | Any | Order


# Questions


@dataclass(frozen=True, slots=True)
class Exists:
    """ "Is there ..."; ``negated``: "is there no ..."; ``least``/``most``: how many there must be."""

    what: Description
    negated: bool = False
    least: int = 1
    most: int | None = None


@dataclass(frozen=True, slots=True)
class Count:
    """ "How many ... (are ...)"."""

    what: Description
    tests: tuple[Test, ...] = ()


@dataclass(frozen=True, slots=True)
class CountKinds:
    """ "How many colours/kinds of car are there?" """

    attribute: Words
    what: Description


@dataclass(frozen=True, slots=True)
class YesNo:
    """ "Is/are/does SUBJECT TEST?". ``tests`` may be empty: then the predicate hides in the words of the subject."""

    subject: Description
    tests: tuple[Test, ...]
    scope: Literal["the", "all", "any", "none"] = "the"


@dataclass(frozen=True, slots=True)
class IsA:
    """ "Is the red vehicle a bus?" """

    subject: Description
    what: Description


@dataclass(frozen=True, slots=True)
class Ask:
    """ "What colour is the van?", "which lane is closed?": the value of an attribute. ``what`` None: of anything."""

    attribute: Words
    what: Description | None


@dataclass(frozen=True, slots=True)
class Read:
    """Text on something, or all text (``what`` None). ``plate``: the number plate only."""

    what: Description | None
    plate: bool = False


@dataclass(frozen=True, slots=True)
class TextExists:
    """ "Is there any text (on the van)?", "can you read the sign?" """

    what: Description | None


@dataclass(frozen=True, slots=True)
class Where:
    what: Description


@dataclass(frozen=True, slots=True)
class What:
    """ "What is behind the barrier?", "which cars are parked?", "who is next to the van?": name all that fit."""

    what: Description
    tests: tuple[Test, ...] = ()


@dataclass(frozen=True, slots=True)
class Identify:
    """ "What is the thing on the left?", "what kind of vehicle is behind the fence?" """

    what: Description


@dataclass(frozen=True, slots=True)
class Which:
    """ "Which is closer, the van or the lorry?" """

    key: OrderKey
    options: Description


@dataclass(frozen=True, slots=True)
class HowFar:
    what: Description
    other: Description | None = None


@dataclass(frozen=True, slots=True)
class Compare:
    """ "Is the van bigger/closer/further left than the lorry?" """

    key: OrderKey
    first: Description
    second: Description


@dataclass(frozen=True, slots=True)
class CompareCount:
    """ "Are there more/fewer/as many cars than vans?"; with ``which`` "which are there more of, cars or vans?" """

    sense: Literal["more", "fewer", "same"]
    first: Description
    second: Description
    which: bool = False


@dataclass(frozen=True, slots=True)
class MostCommon:
    """ "Which colour of car is most common?", "what is the most common vehicle?" """

    attribute: Words
    what: Description
    least: bool = False


@dataclass(frozen=True, slots=True)
class Describe:
    """ "What do you see (on the left)?", "describe the van"."""

    tests: tuple[Test, ...] = ()
    what: Description | None = None


@dataclass(frozen=True, slots=True)
class Happening:
    """ "What is happening?" """


Question = (
    Exists | Count | CountKinds | YesNo | IsA | Ask | Read | TextExists | Where | What | Identify | Which | HowFar | Compare
    | CompareCount | MostCommon | Describe | Happening
)  # fmt: skip
