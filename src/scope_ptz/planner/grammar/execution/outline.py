"""Create the outline of a program: its calls, grouped into repetitions, loops and conditional branches.

The program runs against assumed results. Each loop body and each branch runs once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from scope_ptz import english
from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.execution import answer_sentences as phrases
from scope_ptz.planner.grammar.execution.move_arguments import arguments_of
from scope_ptz.planner.grammar.execution.program import Program
from scope_ptz.planner.grammar.execution.run_state import AssumedOutcome, CallGenerator

MAX_LINES = 200  # further lines are omitted
AssumedResult = Callable[[str, Mapping[str, Any]], dict[str, Any]]
"""A function that returns the assumed result of a call, given its tool and arguments."""


@dataclass(frozen=True, slots=True)
class OutlineCall:
    """A call that the program would make."""

    name: str
    arguments: dict[str, Any]


@dataclass(slots=True)
class OutlineBlock:
    """The lines under a heading, such as the body of a loop. The outermost block has no heading."""

    heading: str = ""
    lines: list[OutlineCall | OutlineBlock] = field(default_factory=list)


def outline(steps: Sequence[ast.Step], limits: Limits, pose: Pose, assumed_result: AssumedResult) -> OutlineBlock:
    """Return the outline of steps.

    Args:
        steps: The steps, with all names resolved.
        limits: The camera's limits.
        pose: The camera's pose at the start.
        assumed_result: Returns the assumed result of a call.
    """
    program = _OutlineProgram(limits, pose, assumed_result)
    for _ in program.run(steps):
        raise AssertionError("an outlined program makes no calls")
    return program.outermost


class _OutlineProgram(Program):
    """A program that records its calls instead of making them."""

    def __init__(self, limits: Limits, pose: Pose, assumed_result: AssumedResult) -> None:
        super().__init__(limits, pose, assume_met=True)
        self._assumed_result = assumed_result
        self.outermost = self._block = OutlineBlock()
        self._lines = 0

    def _call(self, tool: str, **arguments: Any) -> CallGenerator:
        yield from ()
        self._add(OutlineCall(tool, arguments))
        result = self._assumed_result(tool, arguments)
        self.pose = Pose(**result["pose"])
        return AssumedOutcome(result)

    def _add(self, line: OutlineCall | OutlineBlock) -> None:
        self._lines += 1
        if self._lines <= MAX_LINES:
            self._block.lines.append(line)

    @contextmanager
    def _block_under(self, heading: str) -> Iterator[None]:
        """Record the calls made inside this context in a block under a heading."""
        outer, self._block = self._block, OutlineBlock(heading)
        try:
            yield
        finally:
            inner, self._block = self._block, outer
            self._add(inner)

    def _repeat(self, step: ast.Repeat) -> CallGenerator:
        if step.times == 1:
            yield from self._run_steps(step.body)
            return
        with self._block_under(f"{step.times} times:"):
            yield from self._run_steps(step.body)

    def _if(self, step: ast.If) -> CallGenerator:
        yield from self._test(step.condition)
        pose = self.pose
        with self._block_under(f"if {condition_text(step.condition)}:"):
            yield from self._run_steps(step.then)
        if step.otherwise:
            after, self.pose = self.pose, pose
            with self._block_under("otherwise:"):
                yield from self._run_steps(step.otherwise)
            self.pose = after

    def _loop(self, step: ast.Loop) -> CallGenerator:
        limit = self._move_limit(step)
        with self._block_under(f"repeat until {condition_text(step.until)}, at most {limit} {'time' if limit == 1 else 'times'}:"):
            yield from self._test(step.until)
            for inner in step.body:
                if isinstance(inner, ast.Move):
                    yield from self._camera_call("adjust_ptz", **arguments_of(inner, self.pose, self.limits, in_loop=True))
                else:
                    yield from self._run_steps([inner])
        with self._block_under("if that never happens:" if step.otherwise else "if that never happens: stop and report it"):
            yield from self._run_steps(step.otherwise)

    def _joined(self, condition: ast.Joined) -> CallGenerator:
        for part in condition.parts:
            yield from self._test(part)
        return True, ""


def condition_text(condition: ast.Condition) -> str:
    """Return a condition in the present tense: "at least 6 cones are visible"."""
    match condition:
        case ast.Seen(thing=thing, quantity=quantity, view=view):
            is_one = quantity.number == 1 and quantity != ast.Quantity()
            verb = "is" if is_one or phrases.is_uncountable(thing.text) else "are"
            return f"{phrases.quantity_text(quantity, thing.text)} {verb} visible{' in the whole scene' if view == 'full' else ''}"
        case ast.Readable(thing=thing):
            return f"the {thing.text} can be read"
        case ast.Statement(subject=subject, predicate=predicate, expected=expected, question=question):
            if question:
                return f"the answer to “{question}” is {'yes' if expected else 'no'}"
            return f"{'the ' if subject.definite else ''}{subject.text} is {'' if expected else 'not '}{predicate}"
        case ast.Outnumbers(first=first, second=second, comparison=comparison):
            return f"{comparison} {first.text} than {second.text} are visible"
        case ast.PresetOutnumbers(thing=thing, first=first, second=second, comparison=comparison):
            return f"{comparison} {thing.text} are visible at {first.name} than at {second.name}"
        case ast.Negated(part=ast.Answered()):
            return "the answer was no, or nothing was found"
        case ast.Negated(part=ast.Seen(thing=thing, quantity=quantity)) if quantity == ast.Quantity():
            return f"no {phrases.noun(thing.text, 2)} are visible"
        case ast.Negated(part=part):
            return f"it is not the case that {condition_text(part)}"
        case ast.Joined(parts=parts, mode=mode):
            return english.listing([condition_text(part) for part in parts], "and" if mode == "all" else "or")
    return "the answer was yes, or something was found"
