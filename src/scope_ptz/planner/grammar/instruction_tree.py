"""The typed steps of an instruction. Names are as the user wrote them; ``binding`` resolves presets and pronouns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from scope_ptz.planner.grammar.conditions import Answered as Answered
from scope_ptz.planner.grammar.conditions import Condition as Condition
from scope_ptz.planner.grammar.conditions import Holds as Holds
from scope_ptz.planner.grammar.conditions import Joined as Joined
from scope_ptz.planner.grammar.conditions import Negated as Negated
from scope_ptz.planner.grammar.conditions import Operator as Operator
from scope_ptz.planner.grammar.conditions import Outnumbers as Outnumbers
from scope_ptz.planner.grammar.conditions import PresetRef as PresetRef
from scope_ptz.planner.grammar.conditions import PresetWins as PresetWins
from scope_ptz.planner.grammar.conditions import Quantity as Quantity
from scope_ptz.planner.grammar.conditions import Readable as Readable
from scope_ptz.planner.grammar.conditions import Seen as Seen
from scope_ptz.planner.grammar.conditions import Sense as Sense
from scope_ptz.planner.grammar.conditions import Thing as Thing

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View

Axis = Literal["pan", "tilt"]


@dataclass(frozen=True, slots=True)
class Amount:
    """How far: degrees, "little", "lot", "limit" (all the way), "unsaid", or the "same" as the turn before."""

    kind: Literal["degrees", "little", "lot", "limit", "unsaid", "same"] = "unsaid"
    degrees: float = 0.0


@dataclass(frozen=True, slots=True)
class Turn:
    """A relative turn.

    Attributes:
        sign: +1 for right or up, -1 for left or down.
        step: The step size of a turn made in steps.
        steps: The number of these steps.
    """

    axis: Axis
    sign: int
    amount: Amount | None = None
    step: Amount | None = None
    steps: int | None = None


@dataclass(frozen=True, slots=True)
class Zoom:
    """A relative change of magnification."""

    kind: Literal["factor", "percent", "in", "out"]
    value: float = 0.0


@dataclass(frozen=True, slots=True)
class Aim:
    """An absolute target: degrees for pan and tilt, magnification for zoom."""

    axis: Literal["pan", "tilt", "zoom"]
    value: float


Part = Turn | Zoom | Aim


@dataclass(frozen=True, slots=True)
class Move:
    """A move. ``verb`` is whether the instruction has a verb for it; "left 5" has none and may belong to the move before."""

    parts: tuple[Part, ...]
    verb: bool = True


@dataclass(frozen=True, slots=True)
class Further:
    """The turn before, by another amount ("another 15")."""

    amount: Amount


@dataclass(frozen=True, slots=True)
class Back:
    """Return to where the camera was; ``zoom_only`` for "zoom back out"."""

    zoom_only: bool = False
    amount: Amount | None = None


@dataclass(frozen=True, slots=True)
class Home:
    """Go to the home view."""


@dataclass(frozen=True, slots=True)
class GoPreset:
    """Go to a preset. ``how`` is "go" when the words certainly name a place; with "show", "look" and "bare" they may name a
    thing.
    """

    ref: PresetRef
    how: Literal["go", "show", "look", "bare"] = "go"


@dataclass(frozen=True, slots=True)
class GoThere:
    """Go to the preset mentioned last, or to the winner of a comparison."""


@dataclass(frozen=True, slots=True)
class ListPresets:
    """List the presets."""


@dataclass(frozen=True, slots=True)
class Snap:
    """Take pictures, of a thing if one is given."""

    times: int = 1
    of: Thing | None = None


@dataclass(frozen=True, slots=True)
class Count:
    """Count things."""

    things: tuple[Thing, ...]
    view: View | None = None


@dataclass(frozen=True, slots=True)
class Ask:
    """Ask a question about the scene. ``embedded``: it is part of another sentence ("tell me if it is open")."""

    question: str
    view: View | None = None
    embedded: bool = False


@dataclass(frozen=True, slots=True)
class Rescope:
    """Repeat the count or question before in another view ("and then in the whole scene")."""

    view: View


@dataclass(frozen=True, slots=True)
class Read:
    """Read the text on a thing."""

    thing: Thing
    view: View | None = None


@dataclass(frozen=True, slots=True)
class ZoomTo:
    """Zoom in on a thing."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class Track:
    """Follow a thing."""

    thing: Thing
    seconds: float = 10.0


@dataclass(frozen=True, slots=True)
class Bound:
    """The most that a loop may move: a number of moves, or degrees in total."""

    moves: int | None = None
    degrees: float | None = None


@dataclass(frozen=True, slots=True)
class Repeat:
    """Repeat steps. ``group``: it is set off by a comma, so it may cover more than the step before."""

    body: tuple[Step, ...]
    times: int
    group: bool = False


@dataclass(frozen=True, slots=True)
class DoAgain:
    """Repeat the steps before, ``times`` in total, or ``times`` more."""

    times: int | None = None
    more: bool = False


@dataclass(frozen=True, slots=True)
class Loop:
    """Repeat steps until a condition is met."""

    body: tuple[Step, ...]
    until: Condition
    bound: Bound | None = None
    otherwise: tuple[Step, ...] = ()


@dataclass(frozen=True, slots=True)
class If:
    """Do steps when a condition is met, and others when it is not."""

    condition: Condition
    then: tuple[Step, ...]
    otherwise: tuple[Step, ...] = ()


@dataclass(frozen=True, slots=True)
class EachTime:
    """Do something after every move of the step before."""

    body: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class Between:
    """Do something between the repetitions of the step before ("three photos, panning left 10 between each")."""

    body: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class AtIntervals:
    """Do something at regular intervals of a turn: of ``move``, or of the step before."""

    body: tuple[Step, ...]
    degrees: float
    move: Move | None = None


@dataclass(frozen=True, slots=True)
class ThanBefore:
    """Compare a count with the count before the moves just made ("are there more than before?").

    An empty thing means what was counted last.
    """

    thing: Thing
    sense: Sense = "more"


@dataclass(frozen=True, slots=True)
class Mention:
    """Name a thing that later words refer to ("I am looking for a yellow van")."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class AtPlaces:
    """Do the body at each of the places; no places means every preset."""

    places: tuple[PresetRef, ...]
    body: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class SameAt:
    """Repeat the steps before at other places."""

    places: tuple[PresetRef, ...]


@dataclass(frozen=True, slots=True)
class WhichPreset:
    """Count at each place and report which shows most (or fewest).

    Attributes:
        go: Whether to go there.
        any_of: Whether to report which places show any at all.
    """

    thing: Thing
    sense: Sense = "more"
    places: tuple[PresetRef, ...] = ()
    go: bool = False
    any_of: bool = False
    yes_no: bool = False


@dataclass(frozen=True, slots=True)
class Compare:
    """Count two kinds of thing in one view."""

    first: Thing
    second: Thing
    sense: Sense = "more"
    view: View | None = None


@dataclass(frozen=True, slots=True)
class BeforeAfter:
    """Count, move and count again."""

    thing: Thing
    moves: tuple[Step, ...]
    sense: Sense = "more"


@dataclass(frozen=True, slots=True)
class Sweep:
    """Look all around, which sets the scope of the questions that follow.

    Attributes:
        turn: Whether the words may also mean a mere turn of the camera.
    """

    turn: bool = False


@dataclass(frozen=True, slots=True)
class Forbid:
    """Something not to do, which leaves nothing to do."""


@dataclass(frozen=True, slots=True)
class Report:
    """A request to report ("let me know"), which the answer fulfils anyway."""


@dataclass(frozen=True, slots=True)
class CameraState:
    """Report the camera's pose."""


@dataclass(frozen=True, slots=True)
class Help:
    """Report what the planner can do."""


@dataclass(frozen=True, slots=True)
class WhatAbout:
    """The last question again, about another thing ("and the trucks?")."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class Unclear:
    """A step that is understood only in part, with the question to ask."""

    question: str


Step = (
    Move | Further | Back | Home | GoPreset | GoThere | ListPresets | Snap | Count | Ask | Read | ZoomTo | Track | Repeat | DoAgain
    | Loop | If | EachTime | AtPlaces | SameAt | WhichPreset | Compare | BeforeAfter | Sweep | Forbid | Report | CameraState | Help
    | WhatAbout | Between | AtIntervals | ThanBefore | Mention | Rescope | Unclear
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Linked:
    """A step with the link to the step before: "and", ",", "then", "." or "" for the first."""

    link: str
    step: Step
