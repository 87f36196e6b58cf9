"""Steps that move the camera, go to places, or forbid a move."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from scope_ptz.planner.grammar.instruction_tree.conditions import PresetRef


Axis = Literal["pan", "tilt"]


@dataclass(frozen=True, slots=True)
class Amount:
    """How far to turn: in degrees, "little", "lot", "limit" (all the way), "unspecified", or the "same" as the previous turn.

    Attributes:
        factor: The factor by which the amount is multiplied, as in "half as much".
    """

    kind: Literal["degrees", "little", "lot", "limit", "unspecified", "same"] = "unspecified"
    degrees: float = 0.0
    factor: float = 1.0


@dataclass(frozen=True, slots=True)
class Turn:
    """A relative turn.

    Attributes:
        sign: +1 for right or up, -1 for left or down.
        amount: The total turn; None if the instruction does not mention it.
        step: The size of one step, if the turn is made in steps.
        steps: The number of steps, if the instruction gives it.
        is_signed: Whether the instruction gives an angle with or without a sign instead of a direction ("tilt -17").
    """

    axis: Axis
    sign: int
    amount: Amount | None = None
    step: Amount | None = None
    steps: int | None = None
    is_signed: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class Zoom:
    """A relative change of magnification: by a factor, by a percentage, or all the way "in" or "out"."""

    kind: Literal["factor", "percent", "in", "out"]
    value: float = 0.0


@dataclass(frozen=True, slots=True)
class Aim:
    """An absolute target: degrees for pan and tilt, magnification for zoom.

    Attributes:
        sense: +1 if the instruction says to zoom in to the target, -1 if it says to zoom out to it, 0 if it says neither.
    """

    axis: Literal["pan", "tilt", "zoom"]
    value: float
    sense: int = 0


Part = Turn | Zoom | Aim


@dataclass(frozen=True, slots=True)
class Move:
    """A camera movement on one or more axes.

    Attributes:
        has_verb: Whether the instruction names the move with a verb. "Left 5" has none, so it may belong to the previous move.
    """

    parts: tuple[Part, ...]
    has_verb: bool = True


@dataclass(frozen=True, slots=True)
class Further:
    """Repeat the previous turn with a new amount ("another 15")."""

    amount: Amount


@dataclass(frozen=True, slots=True)
class Back:
    """Return to the previous position, or only to its zoom ("zoom back out").

    Attributes:
        amount: How far to turn back; None to return all the way.
        turn: The direction, if the instruction gives only a direction ("come back down"). It may not undo the previous turn.
        again: Whether the wording can ask for the return trip after a return ("and back again").
        to_start: Whether to return to where the camera was at the beginning of the conversation.
    """

    zoom_only: bool = False
    amount: Amount | None = None
    turn: Turn | None = None
    again: bool = False
    to_start: bool = False


@dataclass(frozen=True, slots=True)
class WiderView:
    """Return to the view before the last close-ups, because the next thing was chosen there; nothing if the camera is at none."""


@dataclass(frozen=True, slots=True)
class Home:
    """Go to the home view.

    Attributes:
        is_start: Whether the words can also mean where the camera was at the beginning of the conversation ("the original view").
    """

    is_start: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class GoToPreset:
    """Go to a preset.

    Attributes:
        how: The verb of the instruction, "bare" for none. After "go" and "use", the words must name a preset; after other verbs,
            they may name an object. After a question, "use" names the preset at which to ask it.
    """

    ref: PresetRef
    how: Literal["go", "show", "look", "bare", "use"] = "go"


@dataclass(frozen=True, slots=True)
class GoThere:
    """Go to the preset that was mentioned last, or to the preset that won a comparison.

    Attributes:
        wanted: Which preset alone is meant: the one that won a comparison ("go to it"), or the one at which an earlier turn counted
            more or fewer things than at the others ("go to the busier one"). Empty if any preset that was mentioned is meant.
    """

    wanted: Literal["", "winner", "more", "fewer"] = ""


@dataclass(frozen=True, slots=True)
class ListPresets:
    """List the presets."""


@dataclass(frozen=True, slots=True)
class Forbid:
    """An instruction not to do something.

    Attributes:
        any_move: Whether the camera must not move at all ("without moving").
    """

    any_move: bool = False
