"""Resolve the steps that calculate with counts or compare them, in one view or at several presets."""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace

from scope_ptz.english import listing
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.earlier_comparison import EarlierCount, counts_of_tour, counts_to_add, last_two_presets
from scope_ptz.planner.grammar.binding.focus import latest_counts, things_to_add
from scope_ptz.planner.grammar.binding.followup_steps import FollowUpSteps
from scope_ptz.planner.grammar.binding.names import UnresolvedError
from scope_ptz.planner.grammar.binding.preset_matching import match_exactly
from scope_ptz.planner.grammar.execution.comparison_sentences import presets_of_rank

_VACANT = re.compile(r"\b(?:empty|free|vacant|unoccupied|spare|available|spaces?|no|without)\b", re.IGNORECASE)
"""Words with which the preset that shows more things is not the busier one: "which has more empty tables?"."""


@dataclass(slots=True)
class CountingSteps(FollowUpSteps):
    """Resolves sums, differences, rankings and comparisons of counts.

    Attributes:
        has_compared: Whether an earlier step compares presets.
        compared_for: Whether the winner of that comparison has more or fewer things; empty if it may be neither.
        has_counted: Whether an earlier step counts something.
    """

    has_compared: bool = False
    compared_for: str = ""
    has_counted: bool = False

    @abstractmethod
    def bind(self, steps: Sequence[ast.Step]) -> tuple[ast.Step, ...]:
        """Return steps with all names resolved."""

    def _preset_with(self, comparison: str) -> str:
        """Return the preset at which the last turn that counted found more, or fewer, things than at the others.

        Raises:
            UnresolvedError: Nothing was counted at several presets, or the counts are equal.
        """
        counts = {count.preset: count.number for count in counts_of_tour(self.earlier_counts)}
        ranked = presets_of_rank(counts, "more" if comparison == "more" else "fewer", 1)
        if not ranked:
            raise UnresolvedError("What shall I count to tell which is busier: vehicles or people?")
        if len(ranked) > 1:
            raise UnresolvedError(f"Which one do you mean? {listing(ranked, 'and')} show the same number.")
        return ranked[0]

    def _tally(self, part: ast.Tally) -> ast.Tally:
        place = self.place(part.place) if part.place else None
        return ast.Tally(self.thing(part.thing), place, self._view(part.view))

    def _tallies(self, parts: Sequence[ast.Tally]) -> tuple[ast.Tally, ...]:
        """Return the parts of a calculation, with a part that is counted everywhere split into one part for each preset."""
        every = [
            replace(part, place=place, everywhere=False)
            for part in parts
            for place in (self._places(()) if part.everywhere else (part.place,))
        ]
        return tuple(self._tally(part) for part in every)

    def only_count(self) -> str:
        """Return what the latest turns counted if it is a single thing, so that nothing can be added; otherwise empty."""
        latest = latest_counts(self.conversation)
        return latest[0] if len(latest) == 1 and not counts_to_add(self.earlier_counts) else ""

    def _total(self, step: ast.Total) -> Sequence[ast.Step]:
        self.has_counted = True
        if not step.parts:
            counted = things_to_add(self.conversation)
            if len(counted) > 1:
                return [ast.Total(tuple(ast.Tally(ast.Thing(description), None, self._view(None)) for description in counted))]
            if at_presets := counts_to_add(self.earlier_counts):
                parts = [ast.Tally(ast.Thing(c.description), ast.PresetRef(c.preset, explicit=True)) for c in at_presets]
                return [ast.Total(tuple(parts), tuple(count.number for count in at_presets))]
            raise UnresolvedError("What shall I add up? Please name the things to count.")
        return [ast.Total(self._tallies(step.parts))]

    def _difference(self, step: ast.Difference) -> Sequence[ast.Step]:
        self.has_counted = True
        return [ast.Difference(self._tally(step.first), self._tally(step.second))]

    def _rankcounts(self, step: ast.RankCounts) -> Sequence[ast.Step]:
        self.has_counted = True
        return [replace(step, parts=self._tallies(step.parts))]

    def _earlier_comparison(self, comparison: ast.Comparison) -> ast.WhichPreset | ast.Compare:
        """Return the comparison of what was counted last: two things in one view, or the same thing at several presets."""
        if len(two_things := things_to_add(self.conversation)) == 2:
            return ast.Compare(ast.Thing(two_things[0]), ast.Thing(two_things[1]), comparison)
        if tour := counts_of_tour(self.earlier_counts):
            return _with_counts(ast.WhichPreset(ast.Thing(tour[0].description), comparison), tour)
        if self.earlier_counts and (two := last_two_presets(self.earlier_counts)) is not None:
            places = tuple(ast.PresetRef(name, explicit=True) for name in two)
            return ast.WhichPreset(ast.Thing(self.earlier_counts[-1].description), comparison, places)
        raise UnresolvedError("Which presets shall I compare, and what shall I count there?")

    def _whichpreset(self, step: ast.WhichPreset) -> Sequence[ast.Step]:
        self.has_compared = True
        thing = self.thing(step.thing)
        is_busy = not _VACANT.search(thing.text)
        self.compared_for = step.comparison if is_busy and step.rank == 1 else ""
        counted = [count for count in self.earlier_counts if count.description == thing.text]
        if step.of_two and not step.places and counted and (two := last_two_presets(counted)) is not None:
            return [replace(step, thing=thing, places=tuple(ast.PresetRef(name, explicit=True) for name in two))]
        tour = counts_of_tour(self.earlier_counts)
        is_last = bool(tour) and not any(turn.exchanges for turn in self.conversation[tour[0].turn + 1 :])
        if not step.places and is_last and tour[0].description == thing.text:
            is_every = self.presets is None or {count.preset for count in tour} == set(self.presets)
            if is_every and not (step.any_of or step.yes_no):
                return [_with_counts(replace(step, thing=thing), tour)]
        return [replace(step, thing=thing, places=self._places(step.places))]

    def _firstwith(self, step: ast.FirstWith) -> Sequence[ast.Step]:
        self.has_compared, self.compared_for = True, ""
        places = self._places(step.places)
        return [replace(step, thing=self.thing(step.thing), places=places[::-1] if step.last else places)]

    def _compare(self, step: ast.Compare) -> Sequence[ast.Step]:
        if step.second_place is not None:
            thing, place = self.thing(step.first), self.place(step.second_place)
            return [replace(step, first=thing, second=thing, second_place=place)]
        places = [None if step.yes_no else match_exactly(thing.text, self.presets or ()) for thing in (step.first, step.second)]
        if all(places) and not self.topic:
            raise UnresolvedError(f"What shall I count at {places[0]} and {places[1]}?")
        if all(places):
            return self._whichpreset(ast.WhichPreset(ast.Thing(), step.comparison, tuple(ast.PresetRef(p or "") for p in places)))
        first, second = self.thing(step.first), self.thing(step.second)
        return [replace(step, first=first, second=second, view=self._view(step.view))]

    def _beforeafter(self, step: ast.BeforeAfter) -> Sequence[ast.Step]:
        return [replace(step, thing=self.thing(step.thing), moves=self.bind(step.moves))]


def _with_counts(step: ast.WhichPreset, counts: Sequence[EarlierCount]) -> ast.WhichPreset:
    """Return a comparison that uses the counts of an earlier turn, so that the camera need not move."""
    return replace(
        step,
        places=tuple(ast.PresetRef(count.preset, explicit=True) for count in counts),
        numbers=tuple(count.number for count in counts),
        lower_bounds=frozenset(count.preset for count in counts if not count.complete),
    )
