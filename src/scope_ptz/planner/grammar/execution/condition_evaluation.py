"""Evaluate the conditions of an instruction with perception calls."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.execution import answer_sentences as phrases
from scope_ptz.planner.grammar.execution.closer_look import CloserLook, reading_question
from scope_ptz.planner.grammar.execution.run_state import CallGenerator, HaltedError
from scope_ptz.planner.grammar.execution.visible_counts import VisibleCount

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View


class ConditionEvaluation(CloserLook):
    """The part of a run that evaluates conditions."""

    def _test(self, condition: ast.Condition) -> CallGenerator:
        """Return whether a condition is met or assumed to be met, and a sentence that states what was observed.

        The first value is None if the observation is inconclusive. In that case, neither branch of the condition may run.
        """
        met, reason = yield from self._evaluate(condition)
        return (True if self.assume_met else met), reason

    def _evaluate(self, condition: ast.Condition) -> CallGenerator:
        if isinstance(condition, ast.Answered):
            return self._last_was_yes, "" if self._last_was_yes is not None else "I cannot tell whether that is so"
        if isinstance(condition, ast.Negated):
            met, reason = yield from self._evaluate(condition.part)
            return None if met is None else not met, reason
        if isinstance(condition, ast.Joined):
            return (yield from self._joined(condition))
        if isinstance(condition, ast.Seen):
            count = yield from self._visible_count(condition.thing.text, condition.view)
            self._last_count = count
            return condition.quantity.matches(count), f"I can see {phrases.counted(condition.thing.text, count)}"
        if isinstance(condition, ast.Outnumbers):
            first = yield from self._visible_count(condition.first.text, "current")
            second = yield from self._visible_count(condition.second.text, "current")
            met = first > second if condition.comparison == "more" else first < second
            seen = f"{phrases.counted(condition.first.text, first)} and {phrases.counted(condition.second.text, second)}"
            return met, f"I can see {seen}"
        if isinstance(condition, ast.Readable):
            result = yield from self._required_perception_call(
                "query_answer", question=reading_question(condition.thing.text), view="current"
            )
            return bool(result.get("known")), result["answer"]
        if isinstance(condition, ast.PresetOutnumbers):
            counts = []
            for place in (condition.first, condition.second):
                yield from self._camera_call("go_to_preset", name=place.name)
                counts.append((yield from self._visible_count(condition.thing.text, "current")))
            first, second = (f"{phrases.counted(condition.thing.text, n)}" for n in counts)
            met = counts[0] > counts[1] if condition.comparison == "more" else counts[0] < counts[1]
            return met, f"I can see {first} at {condition.first.name} and {second} at {condition.second.name}"
        subject = f"the {condition.subject.text}" if condition.subject.definite else condition.subject.text
        question = condition.question or f"is {subject} {condition.predicate}?"
        result = yield from self._answer_to(question, "current", condition.subject.text)
        if result is None:
            raise HaltedError("I stopped there, because the next step depends on the answer")
        answer = result["answer"].strip().lower()
        if not result.get("known", True) or not answer.startswith(("yes", "no")):
            return None, f"I cannot tell whether {subject} is {condition.predicate}: {phrases.with_lower_initial(result['answer'])}"
        return answer.startswith("yes") == condition.expected, result["answer"]

    def _joined(self, condition: ast.Joined) -> CallGenerator:
        reasons = []
        is_known = True
        for part in condition.parts:
            met, reason = yield from self._test(part)
            reasons.append(reason)
            if met is None:
                is_known = False
            elif met != (condition.mode == "all"):
                return met, ", ".join(reasons)
        return (condition.mode == "all") if is_known else None, ", ".join(reasons)

    def _visible_count(self, description: str, view: View | None) -> CallGenerator:
        result = yield from self._required_perception_call("count_objects", description=description, view=view or "current")
        return VisibleCount(int(result["count"]), complete=bool(result.get("complete", True)))
