"""The grammar as a planner."""

from __future__ import annotations

from scope_ptz.builtin_names import GRAMMAR
from scope_ptz.errors import PlannerError
from scope_ptz.planner.base import CallTools, Decision, Finish, Planner, State, ToolCall, ToolOutcome
from scope_ptz.planner.grammar.binding.understand import Understanding, understand
from scope_ptz.planner.grammar.execution.camera_history import whereabouts
from scope_ptz.planner.grammar.execution.program import Program


class GrammarPlanner(Planner):
    """A planner that follows rules. Each step replays the program against the recorded outcomes, so no state is kept between
    steps.
    """

    name = GRAMMAR

    async def step(self, state: State) -> Decision:
        return decide(state)


def decide(state: State) -> Decision:
    """Return the next decision, which depends only on the state."""
    meaning = understand(state.instruction, state.briefing.presets, state.conversation)
    if meaning.refusal:
        return Finish(kind="refused", text=meaning.refusal)
    if meaning.clarification:
        return Finish(kind="clarification", text=meaning.clarification)
    program = Program(state.briefing.limits, state.briefing.pose, been=whereabouts(state.conversation))
    outcomes = [outcome for exchange in state.history for outcome in exchange.outcomes]
    wanted = _replay(program, meaning, outcomes)
    if wanted is None:
        return Finish(kind="answered", text=program.answer())
    tool, arguments = wanted
    return CallTools(calls=(ToolCall(id=f"call-{len(outcomes) + 1}", name=tool, arguments=arguments),))


def _replay(program: Program, meaning: Understanding, outcomes: list[ToolOutcome]) -> tuple[str, dict[str, object]] | None:
    run = program.run(meaning.steps)
    try:
        wanted = next(run)
        for outcome in outcomes:
            if outcome.call.name != wanted[0]:
                raise PlannerError(f"the history holds {outcome.call.name} where this instruction calls {wanted[0]}")
            wanted = run.send(outcome)
    except StopIteration:
        return None
    return wanted
