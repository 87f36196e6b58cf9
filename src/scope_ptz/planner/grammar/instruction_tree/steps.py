"""Steps that contain other steps, such as repetitions, loops and branches, and the union of all steps."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar.instruction_tree.comparisons import (
    Compare,
    CompareWithBefore,
    Difference,
    FirstWith,
    RankCounts,
    Total,
    WhichPreset,
)
from scope_ptz.planner.grammar.instruction_tree.looks import (
    Ask,
    CameraState,
    Count,
    Help,
    LookCloser,
    Mention,
    Read,
    Reply,
    Report,
    Rescope,
    Snap,
    Sweep,
    Track,
    Unclear,
    WhatAbout,
    ZoomTo,
)
from scope_ptz.planner.grammar.instruction_tree.moves import (
    Back,
    Forbid,
    Further,
    GoThere,
    GoToPreset,
    Home,
    ListPresets,
    Move,
    WiderView,
)

if TYPE_CHECKING:
    from scope_ptz.planner.grammar.instruction_tree.conditions import Comparison, Condition, PresetRef, Thing


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
        times: How many times the steps run in total or, if ``more`` is set, in addition. None means once more.
    """

    times: int | None = None
    more: bool = False


@dataclass(frozen=True, slots=True)
class Instead:
    """Run steps in place of the previous command, as if it had not been carried out ("no, I meant 30")."""

    steps: tuple[Step, ...]


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
class AtPlaces:
    """Run the body at each of several presets. If ``places`` is empty, run it at every preset.

    ``is_fronted`` is True if the presets are named before the body, as in "at each preset, zoom out".
    """

    places: tuple[PresetRef, ...]
    body: tuple[Step, ...]
    is_fronted: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class SameAt:
    """Repeat the previous steps at other presets. With ``or_go``, go to the preset if there is nothing to repeat."""

    places: tuple[PresetRef, ...]
    or_go: bool = False


@dataclass(frozen=True, slots=True)
class BeforeAfter:
    """Compare the counts before and after moves."""

    thing: Thing
    moves: tuple[Step, ...]
    comparison: Comparison = "more"


Step = (
    Move | Further | Back | Home | GoToPreset | GoThere | ListPresets | Snap | Count | Ask | Read | ZoomTo | Track | Repeat
    | DoAgain | Loop | If | EachTime | AtPlaces | SameAt | WhichPreset | FirstWith | Compare | BeforeAfter | Sweep | Forbid | Report
    | CameraState | Help | Reply | WhatAbout | Between | AtIntervals | CompareWithBefore | LookCloser | Total
    | Difference | RankCounts | Mention | Rescope | Instead | Unclear | WiderView
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Linked:
    """A step with its link to the previous step: "and", ",", "then", "." or "" for the first step."""

    link: str
    step: Step
