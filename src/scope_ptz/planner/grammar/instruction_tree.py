"""The steps of an instruction as typed data. Names are as the user wrote them; ``binding`` resolves presets and pronouns."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from scope_ptz.planner.grammar.conditions import Answered as Answered
from scope_ptz.planner.grammar.conditions import Comparison as Comparison
from scope_ptz.planner.grammar.conditions import Condition as Condition
from scope_ptz.planner.grammar.conditions import Joined as Joined
from scope_ptz.planner.grammar.conditions import Negated as Negated
from scope_ptz.planner.grammar.conditions import Operator as Operator
from scope_ptz.planner.grammar.conditions import Outnumbers as Outnumbers
from scope_ptz.planner.grammar.conditions import PresetOutnumbers as PresetOutnumbers
from scope_ptz.planner.grammar.conditions import PresetRef as PresetRef
from scope_ptz.planner.grammar.conditions import Quantity as Quantity
from scope_ptz.planner.grammar.conditions import Readable as Readable
from scope_ptz.planner.grammar.conditions import Seen as Seen
from scope_ptz.planner.grammar.conditions import Statement as Statement
from scope_ptz.planner.grammar.conditions import Thing as Thing

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View

Axis = Literal["pan", "tilt"]


@dataclass(frozen=True, slots=True)
class Amount:
    """How far to turn: in degrees, "little", "lot", "limit" (all the way), "unspecified", or the "same" as the previous turn.

    Attributes:
        factor: What the amount is multiplied by, as in "half as much".
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
    """

    axis: Axis
    sign: int
    amount: Amount | None = None
    step: Amount | None = None
    steps: int | None = None


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
    """Repeat the previous turn by another amount ("another 15")."""

    amount: Amount


@dataclass(frozen=True, slots=True)
class Back:
    """Return to the previous position, or only to its zoom ("zoom back out")."""

    zoom_only: bool = False
    amount: Amount | None = None


@dataclass(frozen=True, slots=True)
class Home:
    """Go to the home view."""


@dataclass(frozen=True, slots=True)
class GoToPreset:
    """Go to a preset.

    Attributes:
        how: The verb of the instruction, "bare" for none. After "go" and "use", the words must name a preset; after other verbs,
            they may name an object. "Use" after a question states where to ask it.
    """

    ref: PresetRef
    how: Literal["go", "show", "look", "bare", "use"] = "go"


@dataclass(frozen=True, slots=True)
class GoThere:
    """Go to the preset that was mentioned last, or to the preset that won a comparison."""


@dataclass(frozen=True, slots=True)
class ListPresets:
    """List the presets."""


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
    """

    question: str
    view: View | None = None
    embedded: bool = False


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
class Bound:
    """The limit of a loop: a number of moves, or degrees in total."""

    moves: int | None = None
    degrees: float | None = None


@dataclass(frozen=True, slots=True)
class Repeat:
    """Repeat steps a number of times.

    Attributes:
        group: Whether a comma precedes the number, so that it may also apply to earlier steps.
    """

    body: tuple[Step, ...]
    times: int
    group: bool = False


@dataclass(frozen=True, slots=True)
class DoAgain:
    """Repeat the previous steps.

    Attributes:
        times: How many times the steps run: in total, or in addition if ``more`` is set. None means once more.
    """

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
    """Run steps if a condition is met, and other steps if it is not."""

    condition: Condition
    then: tuple[Step, ...]
    otherwise: tuple[Step, ...] = ()


@dataclass(frozen=True, slots=True)
class EachTime:
    """Run steps after every move of the previous step."""

    body: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class Between:
    """Run steps between the repetitions of the previous step ("three photos, panning left 10 between each")."""

    body: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class AtIntervals:
    """Run steps at regular angular intervals during ``move`` or, if that is None, during the previous step."""

    body: tuple[Step, ...]
    degrees: float
    move: Move | None = None


@dataclass(frozen=True, slots=True)
class CompareWithBefore:
    """Compare a count with the count before the last moves ("are there more than before?").

    Attributes:
        thing: The objects to count; if its text is empty, the objects of the last count.
    """

    thing: Thing
    comparison: Comparison = "more"


@dataclass(frozen=True, slots=True)
class Mention:
    """Name an object that later pronouns refer to ("I am looking for a yellow van")."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class AtPlaces:
    """Run the body at each of several presets. If ``places`` is empty, run it at every preset.

    ``is_fronted`` states that the presets are named before the body, as in "at each preset, zoom out".
    """

    places: tuple[PresetRef, ...]
    body: tuple[Step, ...]
    is_fronted: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class SameAt:
    """Repeat the previous steps at other presets."""

    places: tuple[PresetRef, ...]


@dataclass(frozen=True, slots=True)
class WhichPreset:
    """Count objects at each of several presets, and report which preset shows the most (or fewest).

    Attributes:
        go: Whether to go to that preset afterwards.
        any_of: Whether to report which presets show any of the objects, instead of the preset with the most.
        yes_no: Whether the answer is yes or no. The question is then whether the first preset shows the most, or with ``any_of``,
            whether any of the presets shows any of the objects.
        rank: The requested place in the order: 1 for the most, 2 for the second most.
    """

    thing: Thing
    comparison: Comparison = "more"
    places: tuple[PresetRef, ...] = ()
    go: bool = False
    any_of: bool = False
    yes_no: bool = False
    rank: int = 1


@dataclass(frozen=True, slots=True)
class FirstWith:
    """Go to one preset after the other, and stay at the first that shows an object. If ``places`` is empty, try every preset.

    Attributes:
        last: Whether to begin with the last preset, so that the camera stays at the last one that shows an object.
    """

    thing: Thing
    places: tuple[PresetRef, ...] = ()
    last: bool = False


@dataclass(frozen=True, slots=True)
class Compare:
    """Compare the counts of two descriptions in one view.

    Attributes:
        yes_no: Whether the question is whether there are more (or fewer) of the first than of the second.
    """

    first: Thing
    second: Thing
    comparison: Comparison = "more"
    view: View | None = None
    yes_no: bool = False


@dataclass(frozen=True, slots=True)
class Tally:
    """One number of a calculation: how many objects there are at a preset or, if ``place`` is None, in the current position.

    Attributes:
        everywhere: Whether the number stands for one number at each preset.
    """

    thing: Thing
    place: PresetRef | None = None
    view: View | None = None
    everywhere: bool = False


@dataclass(frozen=True, slots=True)
class Total:
    """Count objects of several kinds, or at several presets, and add the counts."""

    parts: tuple[Tally, ...]


@dataclass(frozen=True, slots=True)
class Difference:
    """Count twice, and report how many more objects there are in the first count than in the second."""

    first: Tally
    second: Tally


@dataclass(frozen=True, slots=True)
class RankCounts:
    """Count objects of several kinds, or at several presets, and list them in the order of their counts.

    Attributes:
        first: Whether the list begins with the kind or preset with the most ("more") or the fewest objects.
        winner: Whether only the first is asked for ("which are there most of?").
    """

    parts: tuple[Tally, ...]
    first: Comparison = "more"
    winner: bool = False


@dataclass(frozen=True, slots=True)
class BeforeAfter:
    """Compare the counts before and after moves."""

    thing: Thing
    moves: tuple[Step, ...]
    comparison: Comparison = "more"


@dataclass(frozen=True, slots=True)
class Sweep:
    """Look all around: the following questions are about the whole scene.

    Attributes:
        turn: Whether the wording could also mean a full turn of the camera.
    """

    turn: bool = False


@dataclass(frozen=True, slots=True)
class Forbid:
    """An instruction not to do something.

    Attributes:
        any_move: Whether the camera must not move at all ("without moving").
    """

    any_move: bool = False


@dataclass(frozen=True, slots=True)
class Report:
    """A request to report ("let me know"). It adds nothing, because every run ends with an answer.

    Attributes:
        calculation: What to do with the previous counts: add them ("and add them up") or subtract them ("report the difference").
    """

    calculation: Literal["none", "total", "difference"] = "none"


@dataclass(frozen=True, slots=True)
class CameraState:
    """Report the camera's pose."""


@dataclass(frozen=True, slots=True)
class Help:
    """Report what the planner can do."""


@dataclass(frozen=True, slots=True)
class WhatAbout:
    """Repeat the last question about another object ("and the trucks?")."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class Unclear:
    """A step that is only partly understood, with the question to ask the user."""

    question: str


Step = (
    Move | Further | Back | Home | GoToPreset | GoThere | ListPresets | Snap | Count | Ask | Read | ZoomTo | Track | Repeat
    | DoAgain | Loop | If | EachTime | AtPlaces | SameAt | WhichPreset | FirstWith | Compare | BeforeAfter | Sweep | Forbid | Report
    | CameraState | Help | WhatAbout | Between | AtIntervals | CompareWithBefore | LookCloser | Total
    | Difference | RankCounts | Mention | Rescope | Unclear
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Linked:
    """A step with its link to the previous step: "and", ",", "then", "." or "" for the first step."""

    link: str
    step: Step
