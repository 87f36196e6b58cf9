"""Run the hybrid planner in the agent loop, with calls that the user must confirm."""

from __future__ import annotations

from typing import Any

import pytest

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Decided, RunResult, Started
from scope_ptz.agent.store import NoImages
from scope_ptz.endpoints.endpoint import Endpoint, Timeouts
from scope_ptz.planner.base import Finish, PastTurn
from scope_ptz.planner.chat import ChatOptions, ChatPlanner
from scope_ptz.planner.hybrid import HybridPlanner
from tests.agent.scripted import ScriptedCamera, ScriptedPerception, ScriptedPlanner, answer, calls
from tests.support.misbehaving import Misbehaving, Request, Say, good

pytestmark = pytest.mark.anyio

ODD = "florp the lens right by 20"
"""An instruction that the grammar does not understand."""


class Conversation:
    """A conversation with a hybrid planner whose model follows a script."""

    def __init__(self, *script: Any, counts: tuple[int, ...] = (4,)) -> None:
        self.model = ScriptedPlanner(*script)
        self.planner, self.camera = HybridPlanner(self.model), ScriptedCamera()
        self.turns: tuple[PastTurn, ...] = ()
        self.records: list[Any] = []
        self.perception = ScriptedPerception(*counts)

    async def say(self, text: str) -> RunResult:
        self.records = []
        agent = Agent(self.planner, self.camera, self.perception, NoImages())
        result = await agent.run(text, conversation=self.turns, listener=self.records.append)
        self.turns = (*self.turns, result.past_turn())
        return result

    @property
    def planned_by(self) -> list[str | None]:
        return [record.decision.planned_by for record in self.records if isinstance(record, Decided)]


def executed_calls(result: RunResult) -> list[tuple[str, dict[str, Any]]]:
    return [(o.call.name, o.call.arguments) for exchange in result.exchanges for o in exchange.outcomes]


async def test_the_grammar_plans_instructions_that_it_understands() -> None:
    conversation = Conversation(AssertionError("the model must not be asked"))
    result = await conversation.say("pan right 20 degrees")
    assert executed_calls(result) == [("adjust_ptz", {"pan_deg": 20})]
    assert conversation.planned_by == ["grammar", "grammar"]
    assert conversation.model.states == []


async def test_a_refusal_does_not_go_to_the_model() -> None:
    conversation = Conversation(AssertionError("the model must not be asked"))
    result = await conversation.say("Spy on the woman in the bedroom window")
    assert result.ended.outcome == "refused"


async def test_the_model_plans_other_instructions() -> None:
    conversation = Conversation(calls(("adjust_ptz", {"pan_deg": 20})), answer("I turned."))
    result = await conversation.say(ODD)
    assert executed_calls(result) == [("adjust_ptz", {"pan_deg": 20})]
    assert (result.ended.outcome, result.ended.text) == ("answered", "I turned.")
    assert conversation.planned_by == ["model", "model"]


async def test_unsupported_calls_wait_for_confirmation() -> None:
    conversation = Conversation(calls(("adjust_ptz", {"pan_deg": -90}), ("take_image", {})), answer("There."))
    asked = await conversation.say(ODD)
    assert asked.ended.outcome == "clarification"
    assert asked.ended.text == (
        "You did not mention left, 90 degrees and a picture. "
        "Shall I do this: pan left 90 degrees; then take a picture? Please answer yes or no."
    )
    assert executed_calls(asked) == []
    done = await conversation.say("Yes, please.")
    assert executed_calls(done) == [("adjust_ptz", {"pan_deg": -90}), ("take_image", {})]
    assert conversation.planned_by == ["confirmed", "model"]
    # The model continues the instruction as if the user had not been asked.
    assert [(s.instruction, len(s.history), len(s.conversation)) for s in conversation.model.states] == [(ODD, 0, 0), (ODD, 1, 0)]


async def test_declining_discards_the_calls() -> None:
    conversation = Conversation(calls(("adjust_ptz", {"pan_deg": -90})))
    await conversation.say(ODD)
    declined = await conversation.say("no")
    assert (declined.ended.outcome, declined.ended.text, executed_calls(declined)) == ("answered", "All right, I did nothing.", [])


async def test_another_instruction_instead_of_an_answer() -> None:
    conversation = Conversation(calls(("adjust_ptz", {"pan_deg": -90})))
    await conversation.say(ODD)
    other = await conversation.say("pan left 5 degrees")
    assert executed_calls(other) == [("adjust_ptz", {"pan_deg": -5})]
    assert (await conversation.say("yes")).ended.outcome != "answered" or executed_calls(other) != [
        ("adjust_ptz", {"pan_deg": -90})
    ]


async def test_agreement_without_a_question_confirms_nothing() -> None:
    conversation = Conversation(Finish(kind="clarification", text="What do you mean?"))
    assert executed_calls(await conversation.say("yes")) == []


async def test_a_confirmation_covers_only_the_named_calls() -> None:
    conversation = Conversation(calls(("adjust_ptz", {"pan_deg": -90})), calls(("adjust_ptz", {"tilt_deg": 33})), answer("Both."))
    await conversation.say(ODD)
    again = await conversation.say("yes")
    assert executed_calls(again) == [("adjust_ptz", {"pan_deg": -90})]
    assert again.ended.text.endswith("Shall I do this: tilt up 33 degrees? Please answer yes or no.")
    last = await conversation.say("yes")
    assert executed_calls(last) == [("adjust_ptz", {"tilt_deg": 33})]
    assert last.ended.text == "Both."
    assert conversation.model.states[-1].instruction == ODD


async def test_the_question_names_all_calls_of_a_step() -> None:
    conversation = Conversation(calls(("adjust_ptz", {"pan_deg": 20}), ("go_to_preset", {"name": "yard"})))
    asked = await conversation.say(ODD)
    assert executed_calls(asked) == []
    assert "pan right 20 degrees; then go to the preset" in asked.ended.text


async def test_invalid_calls_go_back_to_the_model() -> None:
    conversation = Conversation(calls(("adjust_ptz", {"pan": 90})), answer("Sorry."))
    result = await conversation.say(ODD)
    assert [o.error is not None for exchange in result.exchanges for o in exchange.outcomes] == [True]
    assert result.ended.bad_calls == 1


async def test_the_trace_names_both_planners() -> None:
    conversation = Conversation(answer())
    await conversation.say(ODD)
    started = conversation.records[0]
    assert isinstance(started, Started)
    assert started.planner == "hybrid:scripted"
    assert {"hybrid", "grammar", "model"} <= started.planner_details.keys()


async def test_a_chat_planner_behind_the_grammar() -> None:
    def mind(request: Request) -> Say:
        if request.data["messages"][-1]["role"] == "tool":
            return Say("Done.")
        return Say("", tool_calls=(("adjust_ptz", {"pan_deg": 20}),))

    with Misbehaving(then=good(mind)) as server:
        chat = ChatPlanner(Endpoint(url=server.url, model="m", timeouts=Timeouts(first_byte_s=5, total_s=10)), ChatOptions())
        planner = HybridPlanner(chat)
        agent = Agent(planner, ScriptedCamera(), ScriptedPerception(3), NoImages())
        try:
            understood = await agent.run("how many cones are there?")
            assert [r for r in server.requests if r.chat] == []
            odd = await agent.run(ODD)
        finally:
            await planner.close()
    assert understood.ended.outcome == odd.ended.outcome == "answered"
    assert executed_calls(odd) == [("adjust_ptz", {"pan_deg": 20})]
