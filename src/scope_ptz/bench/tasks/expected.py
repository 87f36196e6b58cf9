"""Expected answers: typed values with the wordings in which an answer may give them.

A wording is one word or a few. The answer parser handles plurals, capitals and spelling, so the data need not list them. The
docstrings of these models are part of the published JSON schema of tasks and change only with its version.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, SerializerFunctionWrapHandler, model_serializer, model_validator

Wording = Annotated[str, Field(min_length=1, pattern=r"\w")]
Wordings = tuple[Wording, ...]
Options = Annotated[dict[Wording, Wordings], Field(min_length=1)]
"""The other wordings of each option, by the option's name. The name is also a wording."""


class _Expected(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    @model_serializer(mode="wrap")
    def _with_kind(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Serialize ``kind`` even if defaults are excluded, because a file cannot be loaded without it."""
        kind = type(self).model_fields.get("kind")
        return {**({} if kind is None else {"kind": kind.default}), **handler(self)}


_T = TypeVar("_T", bound=_Expected)


class Number(_Expected):
    """How many or how much. ``tolerance`` is what "about" allows; ``unit``: the task's own words for what is counted.

    ``part``: a part of something is asked for, so that "5 of the 7 cones" means 5; otherwise it is not a readable number.
    """

    kind: Literal["number"] = "number"
    value: Annotated[float, Field(allow_inf_nan=False)]
    tolerance: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    unit: Wordings = ()
    part: bool = False


class YesNo(_Expected):
    """Whether something is so. ``affirms``: what is so, or is there, if the answer is yes; ``denies``: what is so if it is no."""

    kind: Literal["yes_no"] = "yes_no"
    value: bool
    affirms: Wordings = ()
    denies: Wordings = ()


class Choice(_Expected):
    """One of several. Give every option that an answer could sensibly name, so that a wrong one is read as wrong.

    ``picks``: words that tell which is chosen ("most") where an answer names several. ``subject``: what the question asks after,
    where there might be none: an answer that says so names no option, whatever else it says.
    """

    kind: Literal["choice"] = "choice"
    value: Wording
    options: Options
    picks: Wordings = ()
    subject: Wordings = ()

    @model_validator(mode="after")
    def _check_value(self) -> Choice:
        return _check_options(self, (self.value,), self.options)


class Text(_Expected):
    """What is written somewhere. ``ocr``: look-alikes (0/O, 1/I/l, 5/S, 8/B) count as the same letter.

    Texts that stand apart are written "A482 / Harrowfield" and may be given in any order.
    """

    kind: Literal["text"] = "text"
    accepted: Annotated[Wordings, Field(min_length=1)]
    ocr: bool = False


class NameSet(_Expected):
    """All of those that fit, in any order; none at all when ``value`` is empty."""

    kind: Literal["name_set"] = "name_set"
    value: Wordings
    options: Options

    @model_validator(mode="after")
    def _check_value(self) -> NameSet:
        return _check_options(self, self.value, self.options)


class Ordering(_Expected):
    """All of them in order. ``first``/``last``: words for the two ends ("most", "fewest"); an answer may begin at either."""

    kind: Literal["ordering"] = "ordering"
    value: Annotated[Wordings, Field(min_length=2)]
    options: Options
    first: Wordings = ()
    last: Wordings = ()

    @model_validator(mode="after")
    def _check_value(self) -> Ordering:
        if sorted(self.value) != sorted(self.options):
            raise ValueError("the value of an ordering must contain every option exactly once")
        return self


class Relation(_Expected):
    """How ``subject`` stands to ``object``: ``forward`` ("more", "left of"), ``backward`` ("fewer", "right of"), or the same."""

    kind: Literal["relation"] = "relation"
    value: Literal["forward", "backward", "same"]
    subject: Annotated[Wordings, Field(min_length=1)]
    object: Annotated[Wordings, Field(min_length=1)]
    forward: Annotated[Wordings, Field(min_length=1)]
    backward: Wordings = ()
    same: Wordings = ()


class Fact(_Expected):
    """One thing that a description may state, in any of these wordings."""

    any_of: Annotated[Wordings, Field(min_length=1)]


class Description(_Expected):
    """An open answer: all ``facts`` must be stated, none of the ``contradictions``."""

    kind: Literal["description"] = "description"
    facts: Annotated[tuple[Fact, ...], Field(min_length=1)]
    contradictions: tuple[Fact, ...] = ()


class NoneThere(_Expected):
    """That there is none. ``subject``: the words for what is not there. ``claims``: what could only be said of one that is there
    (colours, quarters): an answer that says so as well does not say that there is none."""

    kind: Literal["none_there"] = "none_there"
    subject: Annotated[Wordings, Field(min_length=1)]
    claims: Wordings = ()


class ActionOnly(_Expected):
    """No answer is wanted: what the camera did decides alone."""

    kind: Literal["action_only"] = "action_only"


Expected = Annotated[
    Number | YesNo | Choice | Text | NameSet | Ordering | Relation | Description | NoneThere | ActionOnly,
    Field(discriminator="kind"),
]
AnyExpected = Number | YesNo | Choice | Text | NameSet | Ordering | Relation | Description | NoneThere | ActionOnly


def _check_options(expected: _T, values: Wordings, options: dict[Wording, Wordings]) -> _T:
    unknown = [value for value in values if value not in options]
    if unknown:
        raise ValueError(f"value must be one of the options {', '.join(options)}; got {', '.join(unknown)}")
    return expected
