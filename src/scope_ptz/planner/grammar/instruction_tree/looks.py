"""Looks at the picture: counts, questions, close-ups and photos."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from scope_ptz.planner.grammar.instruction_tree.conditions import PresetRef, Thing
    from scope_ptz.tools.arguments import View


@dataclass(frozen=True, slots=True)
class Snap:
    """Take one or more pictures: of an object if one is given, otherwise of the current view."""

    times: int = 1
    of: Thing | None = None


@dataclass(frozen=True, slots=True)
class Count:
    """Count the objects of each description."""

    things: tuple[Thing, ...]
    view: View | None = None


@dataclass(frozen=True, slots=True)
class Ask:
    """Ask a question about the scene.

    Attributes:
        embedded: Whether the question is part of another sentence ("tell me if it is open").
        otherwise_at: The preset to go to, and to ask again at, if the current view does not show what is asked about.
    """

    question: str
    view: View | None = None
    embedded: bool = False
    otherwise_at: PresetRef | None = None


@dataclass(frozen=True, slots=True)
class Rescope:
    """Repeat the previous count or question in another view ("and then in the whole scene")."""

    view: View


@dataclass(frozen=True, slots=True)
class Read:
    """Read the text on an object."""

    thing: Thing
    view: View | None = None


@dataclass(frozen=True, slots=True)
class LookCloser:
    """Zoom in on an object, ask a question about it, and put the camera back."""

    thing: Thing
    question: str


@dataclass(frozen=True, slots=True)
class ZoomTo:
    """Zoom in on an object."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class Track:
    """Follow an object."""

    thing: Thing
    seconds: float = 10.0


@dataclass(frozen=True, slots=True)
class Mention:
    """Name an object that later pronouns refer to ("I am looking for a yellow van")."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class WhatAbout:
    """Repeat the last question about another object ("and the trucks?")."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class Sweep:
    """Look all around, so that the following questions are about the whole scene.

    Attributes:
        turn: Whether the wording could also mean a full turn of the camera.
    """

    turn: bool = False


@dataclass(frozen=True, slots=True)
class CameraState:
    """Report the camera's pose."""


@dataclass(frozen=True, slots=True)
class Help:
    """Report what the planner can do."""


@dataclass(frozen=True, slots=True)
class Reply:
    """Reply to words that ask for nothing, such as thanks or a greeting."""

    text: str


@dataclass(frozen=True, slots=True)
class Report:
    """A request to report ("let me know"). It adds nothing, because every run ends with an answer.

    Attributes:
        calculation: What to do with the previous counts: add them ("and add them up") or subtract them ("report the difference").
    """

    calculation: Literal["none", "total", "difference"] = "none"


@dataclass(frozen=True, slots=True)
class Unclear:
    """A step that is only partly understood, with the question to ask the user."""

    question: str
