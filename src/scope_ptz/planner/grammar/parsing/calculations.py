"""Read counts that are added or subtracted: "how many cars and vans are there together?"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.instruction_tree import AtPlaces, Count, Difference, Report, Step, Tally, Total
from scope_ptz.planner.grammar.lexing.lexer import Lexeme

_SUM = frozenset({
    "together", "altogether", "total", "in_total", "sum", "combined", "add_up", "add", "sum_up", "add_together", "plus",
    "the_total_of", "the_sum_of", "the_total", "the_sum", "all_together", "taken_together", "put_together", "total_number_of",
    "total_of", "total_count_of", "combined_number_of", "overall_number_of", "total_amount_of", "in_all", "overall",
})  # fmt: skip
_SUM_AT_END = frozenset({"together", "altogether", "all_together", "in_total", "combined", "in_all", "overall", "total"})
_BEFORE_TOGETHER = frozenset({"put", "taken", "added", "all", "counted", "and", "when"})
"""Words that can precede "together" in a request for a sum, as in "put together"."""

_DIFFERENCE = frozenset({"minus", "difference", "the_difference"})


def with_calculation(lexemes: Sequence[Lexeme], step: Step) -> Step:
    """Return a step with its counts added or subtracted if its clause asks for that; otherwise the step itself."""
    parts = _single_counts(step)
    words = {x.word for x in lexemes}
    if len(parts) == 2 and words & _DIFFERENCE:
        return Difference(*parts)
    return Total(parts) if (len(parts) > 1 or any(part.everywhere for part in parts)) and words & _SUM else step


def without_sum(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Return the lexemes of a count without the words at its end that ask for a sum: "cars and vans in total", "put together"."""
    lexemes = tuple(lexemes)
    while len(lexemes) > 1 and lexemes[-1].has("FILLER"):
        lexemes = lexemes[:-1]
    if not lexemes or lexemes[-1].word not in _SUM_AT_END:
        return lexemes
    while len(lexemes) > 1 and (lexemes[-1].word in _SUM_AT_END or lexemes[-1].word in _BEFORE_TOGETHER):
        lexemes = lexemes[:-1]
    return lexemes


def with_later_calculations(steps: Sequence[Step]) -> list[Step]:
    """Return steps, with counts combined if "... and add them up" or "... report the difference" follows them."""
    out: list[Step] = []
    for step in steps:
        if not isinstance(step, Report) or step.calculation == "none":
            out.append(step)
            continue
        first = len(out)
        while first and _single_counts(out[first - 1]):
            first -= 1
        parts = tuple(part for counted in out[first:] for part in _single_counts(counted))
        if step.calculation == "difference" and len(parts) == 2:
            out[first:] = [Difference(*parts)]
        elif step.calculation == "total" and (len(parts) > 1 or any(part.everywhere for part in parts)):
            out[first:] = [Total(parts)]
        else:
            out.append(step)
    return out


def _single_counts(step: Step) -> tuple[Tally, ...]:
    """Split a count of several things, or of one thing at several presets, into single counts; other steps yield none."""
    match step:
        case Count(things=things, view=view):
            return tuple(Tally(thing, view=view) for thing in things)
        case AtPlaces(places=(), body=(Count(things=(thing,), view=view),)):
            return (Tally(thing, view=view, everywhere=True),)
        case AtPlaces(places=places, body=(Count(things=(thing,), view=view),)):
            return tuple(Tally(thing, place, view) for place in places)
    return ()
