"""Steps that count more than once, and compare, add, subtract or rank the counts."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING

from scope_ptz import english
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.execution import answer_sentences as phrases
from scope_ptz.planner.grammar.execution import comparison_sentences as sentences
from scope_ptz.planner.grammar.execution.condition_evaluation import ConditionEvaluation
from scope_ptz.planner.grammar.execution.run_state import CallGenerator
from scope_ptz.planner.grammar.execution.visible_counts import VisibleCount, are_complete, number_text

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View


class ComparisonSteps(ConditionEvaluation):
    """The part of a run with steps that count more than once, with one method for each step type."""

    @abstractmethod
    def _run_steps(self, steps: Sequence[ast.Step]) -> CallGenerator:
        """Run steps."""

    @abstractmethod
    def _gothere(self, step: ast.GoThere) -> CallGenerator:
        """Go to the preset that won the last comparison."""

    @abstractmethod
    def _record_position(self, preset: str | None, home: bool = False) -> None:
        """Record the camera's position, so that later steps can return to it."""

    def _count_at(self, thing: ast.Thing, place: ast.PresetRef | None, view: View | None = None) -> CallGenerator:
        """Go to a preset, if one is given, and return the number of objects that are visible there."""
        if place is not None:
            yield from self._survey(place)
        return (yield from self._visible_count(thing.text, view))

    def _survey(self, place: ast.PresetRef) -> CallGenerator:
        """Go to a preset of several, without a sentence that says so."""
        before = self.surveyed
        yield from self._camera_call("go_to_preset", name=place.name)
        self._record_position(place.name)
        self.surveyed = (*before, place.name)

    def _tour(self, stops: Sequence[Stop]) -> CallGenerator:
        """Count the same objects at several presets, and report the counts together."""
        seen: list[tuple[ast.Tally, int]] = []
        unclear: dict[str, list[str]] = {}
        for place, thing in stops:
            yield from self._survey(place)
            result = yield from self._perception_call("count_objects", description=thing.text, view="current")
            self._last_was_yes = result["count"] > 0 if result is not None else None
            if result is not None and not result["count"] and not result.get("complete", True):
                unclear.setdefault(thing.text, []).append(place.name)
            elif result is not None:
                count = VisibleCount(int(result["count"]), complete=bool(result.get("complete", True)))
                seen.append((ast.Tally(thing, place), count))
        if seen:
            self._note(sentences.counts_text([part for part, _ in seen], [count for _, count in seen]))
        for text, names in unclear.items():
            self._note(phrases.not_made_out(text, f"at {english.listing(names, 'or')}"))

    # Calculations ------------------------------------------------------------------------------------------------------
    def _tallies(self, parts: Sequence[ast.Tally]) -> CallGenerator:
        """Return the count of each part."""
        counts: list[int] = []
        for part in parts:
            counts.append((yield from self._count_at(part.thing, part.place, part.view)))
        return counts

    def _total(self, step: ast.Total) -> CallGenerator:
        counts = list(step.numbers) or (yield from self._tallies(step.parts))
        self._last_was_yes = sum(counts) > 0
        if step.numbers:
            counted = sentences.counts_text(step.parts, counts).replace("I can see", "I counted", 1)
            self._note(f"{counted}, which makes {sum(counts)} altogether")
            return
        total = VisibleCount(sum(counts), complete=are_complete(counts))
        self._note(f"{sentences.counts_text(step.parts, counts)}, which makes {number_text(total) if total else 0} altogether")

    def _difference(self, step: ast.Difference) -> CallGenerator:
        parts = (step.first, step.second)
        first, second = yield from self._tallies(parts)
        self._last_was_yes = first > second
        if sentences.is_one_kind_at_two_presets(*parts):
            self._note(sentences.counts_and_difference_text(parts, (first, second)))
            return
        self._note(sentences.counts_text(parts, (first, second)))
        self._note(sentences.difference_text(step.first, step.second, (first, second)))

    def _rankcounts(self, step: ast.RankCounts) -> CallGenerator:
        counts = yield from self._tallies(step.parts)
        if step.winner:
            self._note(sentences.counts_text(step.parts, counts))
            self._note(sentences.winner_text(step.parts, counts, step.first))
        else:
            self._note(sentences.ranking_text(step.parts, counts, step.first))

    # Comparisons -------------------------------------------------------------------------------------------------------
    def _compare(self, step: ast.Compare) -> CallGenerator:
        parts = (ast.Tally(step.first, view=step.view), ast.Tally(step.second, step.second_place, step.view))
        first, second = yield from self._tallies(parts)
        met = first > second if step.comparison == "more" else first < second
        self._last_was_yes = met
        seen = sentences.counts_text(parts, (first, second))
        if step.yes_no:
            self._note(f"{'Yes' if met else 'No'}: {seen}")
            return
        self._note(seen)
        if step.second_place is not None:
            self._note(sentences.here_or_there_text(parts, (first, second), step.comparison))
            return
        greater, lesser = parts if first >= second else reversed(parts)
        numbers = (first, second) if first >= second else (second, first)
        self._note(sentences.difference_text(greater, lesser, numbers))

    def _beforeafter(self, step: ast.BeforeAfter) -> CallGenerator:
        text = step.thing.text
        before = yield from self._visible_count(text, "current")
        yield from self._run_steps(step.moves)
        after = yield from self._visible_count(text, "current")
        self._note(f"I can see {phrases.counted(text, before)} before the move and {phrases.counted(text, after)} after it")
        if before == after:
            self._note("The number is the same before and after")
        else:
            when = "before" if (before > after) == (step.comparison == "more") else "after"
            self._note(f"There are {step.comparison} {phrases.noun(text, 2)} {when} the move")

    def _whichpreset(self, step: ast.WhichPreset) -> CallGenerator:
        counts = dict[str, int]()
        for place in step.places if not step.numbers else ():
            counts[place.name] = yield from self._count_at(step.thing, place)
        counts.update((place.name, number) for place, number in zip(step.places, step.numbers, strict=False))
        if step.any_of:
            showing = [name for name, count in counts.items() if count]
            self._last_was_yes, self._best_preset = bool(showing), showing[0] if showing else None
            self._note(sentences.any_of_text(step, counts))
            return
        ranked = sentences.presets_of_rank(counts, step.comparison, step.rank)
        seen = sentences.counts_at_presets(step.thing.text, counts)
        if step.yes_no:
            self._last_was_yes = ranked == [step.places[0].name]
            self._best_preset = ranked[0] if len(ranked) == 1 or self.assume_met else None
            self._note(f"{'Yes' if self._last_was_yes else 'No'}: {seen}")
            return
        if not step.numbers:
            self._note(seen)
        self._best_preset = ranked[0] if len(ranked) == 1 or (ranked and self.assume_met) else None
        self._note(sentences.best_preset_text(step, counts, ranked))
        if step.go:
            yield from self._gothere(ast.GoThere())

    def _firstwith(self, step: ast.FirstWith) -> CallGenerator:
        for place in step.places:
            count = yield from self._count_at(step.thing, place)
            if count or self.assume_met:
                self._best_preset, self._last_was_yes, self.surveyed = place.name, True, ()
                counted = phrases.counted(step.thing.text, count)
                self._note(f"The {'last' if step.last else 'first'} is {place.name}, where I can see {counted}")
                return
        self._best_preset, self._last_was_yes = None, False
        names = english.listing([place.name for place in step.places])
        self._note(f"I can see {phrases.counted(step.thing.text, 0)} at {names}")


Stop = tuple[ast.PresetRef, ast.Thing]
"""A preset, and the objects to count there."""


def stops_of_tour(steps: Sequence[ast.Step]) -> list[Stop]:
    """Return the stops at the beginning of the steps: pairs of going to a preset and counting, all with the same objects."""
    stops: list[Stop] = []
    for go, count in zip(steps[::2], steps[1::2], strict=False):
        if not (isinstance(go, ast.GoToPreset) and isinstance(count, ast.Count) and count.view in (None, "current")):
            break
        if len(count.things) != 1 or (stops and count.things[0].text != stops[0][1].text):
            break
        stops.append((go.ref, count.things[0]))
    return stops
