"""The grammar planner as an implementation of the planner contract."""

from __future__ import annotations

from scope_ptz.builtin_names import GRAMMAR
from scope_ptz.errors import PlannerError
from scope_ptz.planner.base import CallTools, Decision, Finish, Planner, State, ToolCall, ToolOutcome
from scope_ptz.planner.grammar.binding.understand import Understanding, understand
from scope_ptz.planner.grammar.execution.camera_history import position_history
from scope_ptz.planner.grammar.execution.program import Program

GRAMMAR_VERSION = "2"
"""Version of the plans, in traces and run cards. It is raised when an instruction can get another plan. Version 1 had no number."""


class GrammarPlanner(Planner):
    """A rule-based planner. Each step replays the program against the recorded outcomes, so no state is kept between steps."""

    name = GRAMMAR

    @property
    def details(self) -> dict[str, str]:
        return {"version": GRAMMAR_VERSION}

    async def step(self, state: State) -> Decision:
        return decide(state)


def decide(state: State) -> Decision:
    """Return the next decision, which depends only on the state."""
    meaning = understand(state.instruction, state.briefing.presets, state.conversation)
    if meaning.refusal:
        return Finish(kind="refused", text=meaning.refusal)
    if meaning.clarification:
        return Finish(kind="clarification", text=meaning.clarification)
    program = Program(state.briefing.limits, state.briefing.pose, positions=position_history(state.conversation))
    outcomes = [outcome for exchange in state.history for outcome in exchange.outcomes]
    call = _next_call(program, meaning, outcomes)
    if call is None:
        return Finish(kind="answered", text=program.answer())
    tool, arguments = call
    return CallTools(calls=(ToolCall(id=f"call-{len(outcomes) + 1}", name=tool, arguments=arguments),))


def _next_call(program: Program, meaning: Understanding, outcomes: list[ToolOutcome]) -> tuple[str, dict[str, object]] | None:
    """Replay the recorded outcomes. Return the tool and arguments of the next call, or None if the program has ended."""
    run = program.run(meaning.steps)
    try:
        call = next(run)
        for outcome in outcomes:
            if outcome.call.name != call[0]:
                raise PlannerError(f"the history contains {outcome.call.name} where this instruction calls {call[0]}")
            call = run.send(outcome)
    except StopIteration:
        return None
    return call
