"""The typed syntax tree of an instruction. Names are as the person said them; ``resolve`` binds presets and pronouns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

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
from scope_ptz.planner.grammar.conditions import Thing as Thing
from scope_ptz.planner.grammar.conditions import Wish as Wish
from scope_ptz.tools.arguments import View

Axis = Literal["pan", "tilt"]


@dataclass(frozen=True, slots=True)
class Amount:
    """How far: degrees, or "little", "lot", "limit" (all the way), "unsaid", or the "same" as the turn before."""

    kind: Literal["degrees", "little", "lot", "limit", "unsaid", "same"] = "unsaid"
    degrees: float = 0.0


@dataclass(frozen=True, slots=True)
class Turn:
    """A relative turn. ``sign``: +1 right or up, -1 left or down; ``step``: of a move made in steps, ``steps``: how many."""

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
    """An absolute wish: degrees for pan and tilt, magnification for zoom."""

    axis: Literal["pan", "tilt", "zoom"]
    value: float


Part = Turn | Zoom | Aim


@dataclass(frozen=True, slots=True)
class Move:
    """``verb``: whether the person said a verb for it ("left 5" has none, and may lean on the move before)."""

    parts: tuple[Part, ...]
    verb: bool = True


@dataclass(frozen=True, slots=True)
class Further:
    """ "Another 15": the turn before, by another amount."""

    amount: Amount


@dataclass(frozen=True, slots=True)
class Back:
    """Return to where the camera was; ``zoom_only`` for "zoom back out"."""

    zoom_only: bool = False
    amount: Amount | None = None


@dataclass(frozen=True, slots=True)
class Home:
    pass


@dataclass(frozen=True, slots=True)
class GoPreset:
    """``how``: "go" names a place for certain; "show" and "bare" may mean a thing instead."""

    ref: PresetRef
    how: Literal["go", "show", "look", "bare"] = "go"


@dataclass(frozen=True, slots=True)
class GoThere:
    """Go to the preset just spoken of, or to the winner of a comparison."""


@dataclass(frozen=True, slots=True)
class ListPresets:
    pass


@dataclass(frozen=True, slots=True)
class Snap:
    times: int = 1
    of: Thing | None = None


@dataclass(frozen=True, slots=True)
class Count:
    things: tuple[Thing, ...]
    view: View | None = None


@dataclass(frozen=True, slots=True)
class Ask:
    """``embedded``: said inside another sentence ("tell me if it is open")."""

    question: str
    view: View | None = None
    embedded: bool = False


@dataclass(frozen=True, slots=True)
class Rescope:
    """ "And then in the whole scene": the count or question before, in another view."""

    view: View


@dataclass(frozen=True, slots=True)
class Read:
    thing: Thing
    view: View | None = None


@dataclass(frozen=True, slots=True)
class ZoomTo:
    thing: Thing


@dataclass(frozen=True, slots=True)
class Track:
    thing: Thing
    seconds: float = 10.0


@dataclass(frozen=True, slots=True)
class Bound:
    """The most that a loop may move: a number of moves, or degrees in all."""

    moves: int | None = None
    degrees: float | None = None


@dataclass(frozen=True, slots=True)
class Repeat:
    """``group``: set off by a comma, so that it may cover more than the step before it."""

    body: tuple[Step, ...]
    times: int
    group: bool = False


@dataclass(frozen=True, slots=True)
class DoAgain:
    """ "Do that three times": what came before, ``times`` in all, or ``times`` more."""

    times: int | None = None
    more: bool = False


@dataclass(frozen=True, slots=True)
class Loop:
    body: tuple[Step, ...]
    until: Condition
    bound: Bound | None = None
    otherwise: tuple[Step, ...] = ()


@dataclass(frozen=True, slots=True)
class If:
    condition: Condition
    then: tuple[Step, ...]
    otherwise: tuple[Step, ...] = ()


@dataclass(frozen=True, slots=True)
class EachTime:
    """Something to do after every move of the step before."""

    body: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class Between:
    """Something to do between the repetitions of the step before ("three photos, panning left 10 between each")."""

    body: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class AtIntervals:
    """Something to do every so many degrees of a turn: of ``move``, else of the step before."""

    body: tuple[Step, ...]
    degrees: float
    move: Move | None = None


@dataclass(frozen=True, slots=True)
class ThanBefore:
    """ "Are there more than before?": against the count before the moves just made. No thing: of what was counted."""

    thing: Thing
    wish: Wish = "more"


@dataclass(frozen=True, slots=True)
class Mention:
    """ "I am looking for a yellow van": names a thing that later words refer to."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class AtPlaces:
    """Do the body at each of the places; no places: at every preset."""

    places: tuple[PresetRef, ...]
    body: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class SameAt:
    """What came before, at other places."""

    places: tuple[PresetRef, ...]


@dataclass(frozen=True, slots=True)
class WhichPreset:
    """Count at each place and tell which has most (or fewest). ``go``: and go there. ``any_of``: which show any at all."""

    thing: Thing
    wish: Wish = "more"
    places: tuple[PresetRef, ...] = ()
    go: bool = False
    any_of: bool = False
    yes_no: bool = False


@dataclass(frozen=True, slots=True)
class Compare:
    """Count two kinds of thing in one view."""

    first: Thing
    second: Thing
    wish: Wish = "more"
    view: View | None = None


@dataclass(frozen=True, slots=True)
class BeforeAfter:
    """Count, move, count again."""

    thing: Thing
    moves: tuple[Step, ...]
    wish: Wish = "more"


@dataclass(frozen=True, slots=True)
class Sweep:
    """Look all around: sets the scope of the questions that follow. ``turn``: said so that it may also be a mere turn."""

    turn: bool = False


@dataclass(frozen=True, slots=True)
class Forbid:
    """ "Do not ...": nothing to do."""


@dataclass(frozen=True, slots=True)
class Report:
    """ "Say so", "let me know": the answer does that anyway."""


@dataclass(frozen=True, slots=True)
class CameraState:
    pass


@dataclass(frozen=True, slots=True)
class Help:
    pass


@dataclass(frozen=True, slots=True)
class WhatAbout:
    """ "And the trucks?": the last question again, about another thing."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class Unclear:
    """Understood, but not what is wanted: the question to ask."""

    question: str


Step = (
    Move | Further | Back | Home | GoPreset | GoThere | ListPresets | Snap | Count | Ask | Read | ZoomTo | Track | Repeat | DoAgain
    | Loop | If | EachTime | AtPlaces | SameAt | WhichPreset | Compare | BeforeAfter | Sweep | Forbid | Report | CameraState | Help
    | WhatAbout | Between | AtIntervals | ThanBefore | Mention | Rescope | Unclear
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Linked:
    """A step and what joined it to the one before: "and", "," (","), "then", "." or "" for the first."""

    link: str
    step: Step
