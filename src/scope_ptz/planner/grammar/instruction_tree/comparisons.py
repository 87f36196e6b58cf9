"""Calculations with counts: comparisons, totals, differences and rankings."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scope_ptz.planner.grammar.instruction_tree.conditions import Comparison, PresetRef, Thing
    from scope_ptz.tools.arguments import View


@dataclass(frozen=True, slots=True)
class CompareWithBefore:
    """Compare a count with the count before the last moves ("are there more than before?").

    Attributes:
        thing: The objects to count; if its text is empty, the objects of the last count.
    """

    thing: Thing
    comparison: Comparison = "more"


@dataclass(frozen=True, slots=True)
class WhichPreset:
    """Count objects at each of several presets, and report which preset shows the most (or fewest).

    Attributes:
        go: Whether to go to that preset afterwards.
        any_of: Whether to report which presets show any of the objects, instead of the preset with the most.
        yes_no: Whether the answer is yes or no. The question is then whether the first preset shows the most, or with ``any_of``,
            whether any of the presets shows any of the objects.
        rank: The requested place in the order: 1 for the most, 2 for the second most.
        numbers: How many objects earlier turns have counted at each of the presets, so that the camera need not move; empty if they
            must be counted.
        lower_bounds: The presets at which more of the objects may be than ``numbers`` says.
        of_two: Whether the wording compares two presets: "which preset has more cars?", unlike "... the most cars?".
    """

    thing: Thing
    comparison: Comparison = "more"
    places: tuple[PresetRef, ...] = ()
    go: bool = False
    any_of: bool = False
    yes_no: bool = False
    rank: int = 1
    numbers: tuple[int, ...] = ()
    lower_bounds: frozenset[str] = frozenset()
    of_two: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True)
class FirstWith:
    """Go to presets one after another, and stay at the first that shows an object. If ``places`` is empty, try every preset.

    Attributes:
        last: Whether to begin with the last preset, so that the camera stays at the last one that shows an object.
    """

    thing: Thing
    places: tuple[PresetRef, ...] = ()
    last: bool = False


@dataclass(frozen=True, slots=True)
class Compare:
    """Compare the counts of two descriptions in one view, or in the current view and at a preset.

    Attributes:
        yes_no: Whether the question is whether there are more (or fewer) of the first than of the second.
        second_place: The preset to count the second at; None for the same view.
    """

    first: Thing
    second: Thing
    comparison: Comparison = "more"
    view: View | None = None
    yes_no: bool = False
    second_place: PresetRef | None = None


@dataclass(frozen=True, slots=True)
class Tally:
    """One number of a calculation: how many objects there are at a preset or, if ``place`` is None, in the current position.

    Attributes:
        everywhere: Whether to count at every preset instead, which gives one number for each.
    """

    thing: Thing
    place: PresetRef | None = None
    view: View | None = None
    everywhere: bool = False


@dataclass(frozen=True, slots=True)
class Total:
    """Count objects of several kinds, or at several presets, and add the counts.

    Attributes:
        parts: What to count; nothing for the counts of the turns before.
        numbers: The counts, if earlier turns have made them, so that the camera need not move; empty if they must be made.
    """

    parts: tuple[Tally, ...]
    numbers: tuple[int, ...] = ()


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
