"""The hybrid planner as an implementation of the planner contract."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.errors import ToolCallError
from scope_ptz.planner.base import CallTools, Decision, Exchange, Finish, Planner, State, ToolCall
from scope_ptz.planner.confirmations import yes_or_no
from scope_ptz.planner.grammar.planner import GRAMMAR_VERSION, decide_on, meaning_of
from scope_ptz.planner.hybrid.call_words import call_in_words
from scope_ptz.planner.hybrid.confirmation import (
    Proposal,
    confirmation_question,
    pending_proposal,
)
from scope_ptz.planner.hybrid.evidence import collect_evidence
from scope_ptz.planner.hybrid.support import unsupported_parts
from scope_ptz.tools.registry import TOOLS

HYBRID_VERSION = "1"
"""Version of the rules that decide which of the model's calls need confirmation, for traces and run cards."""

GRAMMAR_PART, MODEL_PART, USER_PART = "grammar", "model", "confirmed"
"""The values of ``planned_by`` in decisions: the grammar, the language model, and calls that the user confirmed."""


class HybridPlanner(Planner):
    """A planner that asks a language model only about instructions that the grammar does not understand.

    The model's calls are carried out without confirmation only if the instruction or earlier results support every part of them.
    Otherwise, the planner asks the user, and carries the calls out if the user replies "yes" in the next turn.
    """

    def __init__(self, model: Planner, name: str | None = None) -> None:
        """Create the planner.

        Args:
            model: The planner that asks the language model.
            name: The planner's name in traces and results; None to derive it from the model's name.
        """
        self.model = model
        self.name = name or f"hybrid:{model.name}"
        self.sees = model.sees

    @property
    def details(self) -> dict[str, str]:
        return {**self.model.details, "hybrid": HYBRID_VERSION, "grammar": GRAMMAR_VERSION, "model": self.model.name}

    async def step(self, state: State) -> Decision:
        proposal = pending_proposal(state.conversation)
        if proposal is not None and (reply := yes_or_no(state.instruction)) is not None:
            if reply == "no":
                return Finish(kind="answered", text="All right, I did nothing.", planned_by=USER_PART)
            if not state.history:
                return CallTools(calls=proposal.calls, planned_by=USER_PART)
            return await self._model_step(_resumed_state(state, proposal), _confirmed_texts(proposal))
        meaning = meaning_of(state)
        if meaning.clarification is None:
            return decide_on(meaning, state).model_copy(update={"planned_by": GRAMMAR_PART})
        return await self._model_step(state, (state.instruction,))

    async def _model_step(self, state: State, user_texts: Sequence[str]) -> Decision:
        """Return the model's decision, or a question if its calls need confirmation."""
        decision = await self.model.step(state)
        if isinstance(decision, Finish):
            return decision.model_copy(update={"planned_by": MODEL_PART})
        earlier = [exchange for turn in state.conversation for exchange in turn.exchanges]
        evidence = collect_evidence(user_texts, [*earlier, *state.history])
        earlier_calls, unsupported = _successful_calls(state.history), list[str]()
        valid = [call for call in decision.calls if _is_valid(call, state)]
        for call in valid:
            unsupported += unsupported_parts(call, evidence, earlier_calls)
            earlier_calls.append(call)
        if not unsupported:
            return decision.model_copy(update={"planned_by": MODEL_PART})
        text = confirmation_question(valid, unsupported)
        return Finish(
            kind="clarification",
            text=text,
            usage=decision.usage,
            reasoning=decision.reasoning,
            served=decision.served,
            planned_by=MODEL_PART,
        )

    async def close(self) -> None:
        await self.model.close()


def _is_valid(call: ToolCall, state: State) -> bool:
    """Return whether a call can be carried out. Invalid calls do nothing and return an error to the model."""
    if call.problem is not None:
        return False
    if call.name not in TOOLS:
        return any(tool.get("function", {}).get("name") == call.name for tool in state.tools)
    try:
        TOOLS.parse_call(call.name, call.arguments)
    except ToolCallError:
        return False
    return True


def _successful_calls(history: Sequence[Exchange]) -> list[ToolCall]:
    return [outcome.call for exchange in history for outcome in exchange.outcomes if outcome.error is None]


def _confirmed_texts(proposal: Proposal) -> tuple[str, ...]:
    return (*proposal.texts, *(call_in_words(call) for call in proposal.calls))


def _resumed_state(state: State, proposal: Proposal) -> State:
    """Return a state in which the model continues the confirmed instruction as if the user had not been asked."""
    start = state.conversation[proposal.instruction_index].start
    briefing = state.briefing if start is None else state.briefing.model_copy(update={"pose": start})
    return state.model_copy(
        update={
            "instruction": proposal.instruction,
            "briefing": briefing,
            "history": (*proposal.exchanges, *state.history),
            "conversation": state.conversation[: proposal.instruction_index],
        }
    )
