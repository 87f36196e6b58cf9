"""The hybrid planner in the agent loop: which part plans, and which calls the user must confirm."""

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


class Talk:
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


def made(result: RunResult) -> list[tuple[str, dict[str, Any]]]:
    return [(o.call.name, o.call.arguments) for exchange in result.exchanges for o in exchange.outcomes]


async def test_the_grammar_plans_what_it_understands() -> None:
    talk = Talk(AssertionError("the model must not be asked"))
    result = await talk.say("pan right 20 degrees")
    assert made(result) == [("adjust_ptz", {"pan_deg": 20})]
    assert talk.planned_by == ["grammar", "grammar"]
    assert talk.model.states == []


async def test_a_refusal_does_not_go_to_the_model() -> None:
    talk = Talk(AssertionError("the model must not be asked"))
    result = await talk.say("Spy on the woman in the bedroom window")
    assert result.ended.outcome == "refused"


async def test_the_model_plans_the_rest() -> None:
    talk = Talk(calls(("adjust_ptz", {"pan_deg": 20})), answer("I turned."))
    result = await talk.say(ODD)
    assert made(result) == [("adjust_ptz", {"pan_deg": 20})]
    assert (result.ended.outcome, result.ended.text) == ("answered", "I turned.")
    assert talk.planned_by == ["model", "model"]


async def test_calls_without_grounds_wait_for_a_yes() -> None:
    talk = Talk(calls(("adjust_ptz", {"pan_deg": -90}), ("take_image", {})), answer("There."))
    asked = await talk.say(ODD)
    assert asked.ended.outcome == "clarification"
    assert asked.ended.text == (
        "You did not mention left, 90 degrees and a picture. "
        "Shall I do this: pan left 90 degrees; then take a picture? Please answer yes or no."
    )
    assert made(asked) == []
    done = await talk.say("Yes, please.")
    assert made(done) == [("adjust_ptz", {"pan_deg": -90}), ("take_image", {})]
    assert talk.planned_by == ["confirmed", "model"]
    # The model continues the instruction as if the user had not been asked.
    assert [(s.instruction, len(s.history), len(s.conversation)) for s in talk.model.states] == [(ODD, 0, 0), (ODD, 1, 0)]


async def test_a_no_ends_it() -> None:
    talk = Talk(calls(("adjust_ptz", {"pan_deg": -90})))
    await talk.say(ODD)
    declined = await talk.say("no")
    assert (declined.ended.outcome, declined.ended.text, made(declined)) == ("answered", "All right, I did nothing.", [])


async def test_another_instruction_instead_of_an_answer() -> None:
    talk = Talk(calls(("adjust_ptz", {"pan_deg": -90})))
    await talk.say(ODD)
    other = await talk.say("pan left 5 degrees")
    assert made(other) == [("adjust_ptz", {"pan_deg": -5})]
    assert (await talk.say("yes")).ended.outcome != "answered" or made(other) != [("adjust_ptz", {"pan_deg": -90})]


async def test_a_yes_without_a_question_confirms_nothing() -> None:
    talk = Talk(Finish(kind="clarification", text="What do you mean?"))
    assert made(await talk.say("yes")) == []


async def test_a_confirmation_covers_only_what_it_names() -> None:
    talk = Talk(calls(("adjust_ptz", {"pan_deg": -90})), calls(("adjust_ptz", {"tilt_deg": 33})), answer("Both."))
    await talk.say(ODD)
    again = await talk.say("yes")
    assert made(again) == [("adjust_ptz", {"pan_deg": -90})]
    assert again.ended.text.endswith("Shall I do this: tilt up 33 degrees? Please answer yes or no.")
    last = await talk.say("yes")
    assert made(last) == [("adjust_ptz", {"tilt_deg": 33})]
    assert last.ended.text == "Both."
    assert talk.model.states[-1].instruction == ODD


async def test_a_compound_step_is_asked_about_whole() -> None:
    talk = Talk(calls(("adjust_ptz", {"pan_deg": 20}), ("go_to_preset", {"name": "yard"})))
    asked = await talk.say(ODD)
    assert made(asked) == []
    assert "pan right 20 degrees; then go to the preset" in asked.ended.text


async def test_invalid_calls_go_back_to_the_model() -> None:
    talk = Talk(calls(("adjust_ptz", {"pan": 90})), answer("Sorry."))
    result = await talk.say(ODD)
    assert [o.error is not None for exchange in result.exchanges for o in exchange.outcomes] == [True]
    assert result.ended.bad_calls == 1


async def test_the_trace_names_both_planners() -> None:
    talk = Talk(answer())
    await talk.say(ODD)
    started = talk.records[0]
    assert isinstance(started, Started)
    assert started.planner == "hybrid:scripted"
    assert {"hybrid", "grammar", "model"} <= started.planner_details.keys()


async def test_a_chat_server_behind_the_grammar() -> None:
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
    assert made(odd) == [("adjust_ptz", {"pan_deg": 20})]
