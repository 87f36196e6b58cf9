"""The hybrid planner as an implementation of the planner contract."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.errors import ToolCallError
from scope_ptz.planner.base import CallTools, Decision, Exchange, Finish, Planner, State, ToolCall
from scope_ptz.planner.confirmations import yes_or_no
from scope_ptz.planner.grammar.planner import GRAMMAR_VERSION, decide_on, meaning_of
from scope_ptz.planner.hybrid.call_words import named
from scope_ptz.planner.hybrid.confirmation import (
    Proposal,
    confirmation_question,
    open_proposal,
)
from scope_ptz.planner.hybrid.grounding import without_grounds
from scope_ptz.planner.hybrid.grounds import grounds_of
from scope_ptz.tools.registry import TOOLS

HYBRID_VERSION = "1"
"""Version of the rules that decide which calls of the model need a confirmation, in traces and run cards."""

GRAMMAR_PART, MODEL_PART, USER_PART = "grammar", "model", "confirmed"
"""The values of ``planned_by`` in decisions: the grammar, the language model, and calls that the user confirmed."""


class HybridPlanner(Planner):
    """A planner that asks a language model only about instructions that the grammar does not understand.

    Calls of the model are carried out without a confirmation only if everything that they state stands in the instruction or in
    earlier results. Otherwise, the planner asks the user, and a "yes" in the next turn of the conversation carries them out.
    """

    def __init__(self, model: Planner, name: str | None = None) -> None:
        """Set up the planner.

        Args:
            model: The planner that asks the language model.
            name: The planner's name in traces and results; None to derive it from that of the model.
        """
        self.model = model
        self.name = name or f"hybrid:{model.name}"
        self.sees = model.sees

    @property
    def details(self) -> dict[str, str]:
        return {**self.model.details, "hybrid": HYBRID_VERSION, "grammar": GRAMMAR_VERSION, "model": self.model.name}

    async def step(self, state: State) -> Decision:
        proposal = open_proposal(state.conversation)
        if proposal is not None and (reply := yes_or_no(state.instruction)) is not None:
            if reply == "no":
                return Finish(kind="answered", text="All right, I did nothing.", planned_by=USER_PART)
            if not state.history:
                return CallTools(calls=proposal.calls, planned_by=USER_PART)
            return await self._by_model(_continued(state, proposal), _said(proposal))
        meaning = meaning_of(state)
        if meaning.clarification is None:
            return decide_on(meaning, state).model_copy(update={"planned_by": GRAMMAR_PART})
        return await self._by_model(state, (state.instruction,))

    async def _by_model(self, state: State, said: Sequence[str]) -> Decision:
        """Return the model's decision, or a question about those of its calls that need a confirmation."""
        decision = await self.model.step(state)
        if isinstance(decision, Finish):
            return decision.model_copy(update={"planned_by": MODEL_PART})
        earlier = [exchange for turn in state.conversation for exchange in turn.exchanges]
        grounds = grounds_of(said, [*earlier, *state.history])
        made, missing = _calls_made(state.history), list[str]()
        valid = [call for call in decision.calls if _is_valid(call, state)]
        for call in valid:
            missing += without_grounds(call, grounds, made)
            made.append(call)
        if not missing:
            return decision.model_copy(update={"planned_by": MODEL_PART})
        text = confirmation_question(valid, missing)
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


def _calls_made(history: Sequence[Exchange]) -> list[ToolCall]:
    return [outcome.call for exchange in history for outcome in exchange.outcomes if outcome.error is None]


def _said(proposal: Proposal) -> tuple[str, ...]:
    return (*proposal.texts, *(named(call) for call in proposal.calls))


def _continued(state: State, proposal: Proposal) -> State:
    """Return the state in which the model continues the confirmed instruction, as if the user had not been asked."""
    start = state.conversation[proposal.first].start
    briefing = state.briefing if start is None else state.briefing.model_copy(update={"pose": start})
    return state.model_copy(
        update={
            "instruction": proposal.instruction,
            "briefing": briefing,
            "history": (*proposal.exchanges, *state.history),
            "conversation": state.conversation[: proposal.first],
        }
    )
