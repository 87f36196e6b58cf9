"""The grammar planner as an implementation of the planner contract."""

from __future__ import annotations

from functools import lru_cache

from scope_ptz.builtin_names import GRAMMAR
from scope_ptz.errors import PlannerError
from scope_ptz.planner.base import CallTools, Decision, Finish, Planner, State, ToolCall, ToolOutcome
from scope_ptz.planner.confirmations import yes_or_no
from scope_ptz.planner.grammar.binding.earlier_moves.continuations import commands_of
from scope_ptz.planner.grammar.binding.small_talk import impossible_request
from scope_ptz.planner.grammar.binding.understand import Understanding, understand
from scope_ptz.planner.grammar.consistency.check import NOT_UNDERSTOOD
from scope_ptz.planner.grammar.execution.camera_history import position_history
from scope_ptz.planner.grammar.execution.close_ups import view_before_close_ups
from scope_ptz.planner.grammar.execution.closer_look import offer_in, offer_text
from scope_ptz.planner.grammar.execution.program import Program
from scope_ptz.planner.grammar.instruction_tree import Forbid, LookCloser, Thing

GRAMMAR_VERSION = "7"
"""Version of the grammar in traces and run cards. It is raised when any instruction gets a different plan."""


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
    return decide_on(meaning_of(state), state)


def meaning_of(state: State) -> Understanding:
    """Return the meaning of an instruction, which may be the answer to an offer to go closer."""
    offer = offer_in(state.conversation[-1].reply) if state.conversation else None
    if offer is not None and (reply := yes_or_no(state.instruction)) is not None:
        thing, question = offer
        return Understanding((LookCloser(Thing(thing), question),) if reply == "yes" else (Forbid(any_move=True),))
    if state.conversation:
        return understand(state.instruction, state.briefing.presets, state.conversation)
    return _understand_first_turn(state.instruction, state.briefing.presets)


@lru_cache(maxsize=64)
def _understand_first_turn(instruction: str, presets: tuple[str, ...]) -> Understanding:
    """Return the meaning of a conversation's first instruction, cached because each step of its run needs it again."""
    return understand(instruction, presets)


def decide_on(meaning: Understanding, state: State) -> Decision:
    """Return the next decision for an instruction whose meaning is already known."""
    if meaning.refusal:
        return Finish(kind="refused", text=meaning.refusal)
    if meaning.clarification:
        # A plan quotes the words that were not understood; the reply says why they cannot be carried out, if that is known.
        is_unread = meaning.clarification.startswith(NOT_UNDERSTOOD)
        reason = impossible_request(state.instruction) if is_unread else ""
        return Finish(kind="clarification", text=reason or meaning.clarification)
    briefing = state.briefing
    viewpoint = briefing.viewpoints.current if briefing.viewpoints is not None else None
    effects = [command.effect for command in commands_of(state.conversation, briefing.presets)]
    program = Program(
        briefing.limits,
        briefing.pose,
        positions=position_history(state.conversation, effects, viewpoint),
        may_go_closer=briefing.simulated,
        viewpoint=viewpoint,
        viewpoints=briefing.viewpoints,
        wider_view=view_before_close_ups(state.conversation, briefing.pose, viewpoint),
    )
    outcomes = [outcome for exchange in state.history for outcome in exchange.outcomes]
    call = _next_call(program, meaning, outcomes)
    if call is None:
        if (offer := program.offer) is not None:
            return Finish(kind="clarification", text=f"{program.answer()} {offer_text(offer)}")
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
