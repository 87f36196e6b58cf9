"""Conditions and comparisons: steps whose course depends on what is visible."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.execution import answer_sentences as say
from scope_ptz.planner.grammar.execution.run_state import Run, RunState

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View


class Judging(RunState):
    """The part of a run that tests conditions and compares counts."""

    # Conditions --------------------------------------------------------------------------------------------------------

    def _test(self, condition: ast.Condition) -> Run:
        """Return whether a condition holds, and the sentence that states what was seen."""
        met, why = yield from self._judge(condition)
        return (met or self.assume_met), why

    def _judge(self, condition: ast.Condition) -> Run:
        if isinstance(condition, ast.Answered):
            return self._last_yes, ""
        if isinstance(condition, ast.Negated):
            met, why = yield from self._judge(condition.part)
            return not met, why
        if isinstance(condition, ast.Joined):
            return (yield from self._joined(condition))
        if isinstance(condition, ast.Seen):
            count = yield from self._counted(condition.thing.text, condition.view)
            self._last_count = count
            return condition.quantity.holds(count), f"I can see {say.counted(condition.thing.text, count)} now"
        if isinstance(condition, ast.Outnumbers):
            first = yield from self._counted(condition.first.text, "current")
            second = yield from self._counted(condition.second.text, "current")
            met = first > second if condition.sense == "more" else first < second
            return met, f"I can see {say.counted(condition.first.text, first)} and {say.counted(condition.second.text, second)}"
        if isinstance(condition, ast.Readable):
            result = yield from self._needed("query_answer", question=reading(condition.thing.text), view="current")
            return bool(result.get("known")), result["answer"]
        if isinstance(condition, ast.PresetWins):
            counts = []
            for place in (condition.first, condition.second):
                yield from self._moved("go_to_preset", name=place.name)
                counts.append((yield from self._counted(condition.thing.text, "current")))
            first, second = (f"{say.counted(condition.thing.text, n)}" for n in counts)
            met = counts[0] > counts[1] if condition.sense == "more" else counts[0] < counts[1]
            return met, f"I can see {first} at {condition.first.name} and {second} at {condition.second.name}"
        subject = f"the {condition.subject.text}" if condition.subject.definite else condition.subject.text
        result = yield from self._needed(
            "query_answer", question=condition.question or f"is {subject} {condition.predicate}?", view="current"
        )
        answer = result["answer"].strip().lower()
        if not result.get("known", True) or not answer.startswith(("yes", "no")):
            return False, f"I cannot tell whether {subject} is {condition.predicate}: {result['answer']}"
        return answer.startswith("yes") == condition.wanted, result["answer"]

    def _joined(self, condition: ast.Joined) -> Run:
        reasons = []
        for part in condition.parts:
            met, why = yield from self._test(part)
            reasons.append(why)
            if met != (condition.mode == "all"):
                return met, ", ".join(reasons)
        return condition.mode == "all", ", ".join(reasons)

    def _counted(self, description: str, view: View | None) -> Run:
        result = yield from self._needed("count_objects", description=description, view=view or "current")
        return int(result["count"])


def reading(thing: str) -> str:
    """Return the question that asks for a thing's text."""
    plural = say.noun(thing, 1) != thing
    return f"What {'do' if plural else 'does'} the {thing} say?"
