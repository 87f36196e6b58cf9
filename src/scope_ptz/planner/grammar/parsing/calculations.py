"""Read counts that are added or subtracted: "how many cars and vans are there together?"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.instruction_tree import AtPlaces, Count, Difference, Step, Tally, Total
from scope_ptz.planner.grammar.lexing.lexer import Lexeme

_SUM = frozenset({
    "together", "altogether", "total", "in_total", "sum", "combined", "add_up", "add", "sum_up", "add_together", "plus",
    "the_total_of", "the_sum_of", "the_total", "the_sum", "all_together", "taken_together", "put_together",
})  # fmt: skip
_DIFFERENCE = frozenset({"minus", "difference", "the_difference"})


def calculated(lexemes: Sequence[Lexeme], step: Step) -> Step:
    """Return the step that adds or subtracts the counts of a step, if the words of its clause ask for it; otherwise the step."""
    parts = _parts(step)
    words = {x.word for x in lexemes}
    if len(parts) == 2 and words & _DIFFERENCE:
        return Difference(*parts)
    return Total(parts) if len(parts) > 1 and words & _SUM else step


def _parts(step: Step) -> tuple[Tally, ...]:
    """Return the single counts of a count of several things, or of one thing at several presets; none for other steps."""
    match step:
        case Count(things=things, view=view):
            return tuple(Tally(thing, view=view) for thing in things)
        case AtPlaces(places=places, body=(Count(things=(thing,), view=view),)):
            return tuple(Tally(thing, place, view) for place in places)
    return ()
