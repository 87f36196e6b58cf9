"""Check whether a server's model can plan: tool calls, and answers based on their results, with and without streaming."""

from __future__ import annotations

from collections.abc import AsyncIterator, Sequence
from typing import Any

from scope_ptz.endpoints.chat_server_checks import Finding, ServerCheck, run_check
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.base import Briefing, CallTools, Decision, Exchange, Finish, State, ToolCall, ToolOutcome
from scope_ptz.planner.chat.planner import ChatOptions, ChatPlanner

PICTURE_INSTRUCTION, TURN_INSTRUCTION = "Take a picture.", "Pan right by 20 degrees."
_PICTURE_RESULT = {
    "message": "The picture is saved.",
    "pose": {"pan_deg": 0.0, "tilt_deg": 0.0, "zoom": 1.0},
    "file": "frame-0001.jpg",
}
_MAX_DETAIL_CHARS = 160


async def check_planning(
    endpoint: Endpoint, tools: Sequence[dict[str, Any]], options: ChatOptions | None = None
) -> AsyncIterator[ServerCheck]:
    """Check whether a server's model can plan.

    Args:
        endpoint: The server.
        tools: The schemas for the nine tools.
        options: Options for planning; ``stream`` and ``sees`` are ignored.
    """
    options = options or ChatOptions()
    for stream in (False, True):
        suffix = ", streamed" if stream else ""
        planner = ChatPlanner(
            endpoint.model_copy(update={"retries": 1}), options.model_copy(update={"stream": stream, "sees": False})
        )
        try:
            yield await run_check(f"a tool call{suffix}", lambda p=planner: _check_call(p, tools))  # type: ignore[misc]
            yield await run_check(f"arguments of the right type{suffix}", lambda p=planner: _check_arguments(p, tools))  # type: ignore[misc]
            yield await run_check(f"an answer from a tool's result{suffix}", lambda p=planner: _check_answer(p, tools))  # type: ignore[misc]
        finally:
            await planner.close()


def state_for(instruction: str, tools: Sequence[dict[str, Any]], *history: Exchange) -> State:
    """Return the planner's state for an instruction and its history so far."""
    briefing = Briefing(presets=("gate", "highway"), pose=Pose(), limits=Limits())
    return State(instruction=instruction, briefing=briefing, history=history, tools=tuple(tools))


def picture_exchange() -> Exchange:
    """Return a step in which a picture was taken."""
    return Exchange(outcomes=(ToolOutcome(call=ToolCall(id="call-1", name="take_image"), result=_PICTURE_RESULT),))


async def _check_call(planner: ChatPlanner, tools: Sequence[dict[str, Any]]) -> Finding:
    decision = await planner.step(state_for(PICTURE_INSTRUCTION, tools))
    if not isinstance(decision, CallTools):
        return "failed", f"no call; the model answered: {_describe_briefly(decision)}"
    if "take_image" not in [call.name for call in decision.calls]:
        return "partly", f"an unexpected call: {_describe_briefly(decision)}"
    source = decision.served.calls_from if decision.served else ""
    if source != "native":
        return "partly", f"the server does not parse this model's calls; SCOPE parses them from the text (notation: {source})"
    return "ok", _describe_briefly(decision)


async def _check_arguments(planner: ChatPlanner, tools: Sequence[dict[str, Any]]) -> Finding:
    decision = await planner.step(state_for(TURN_INSTRUCTION, tools))
    if not isinstance(decision, CallTools):
        return "partly", f"no call; the model answered: {_describe_briefly(decision)}"
    call = decision.calls[0]
    if call.name != "adjust_ptz" or call.arguments.get("pan_deg") != 20:
        return "partly", f"adjust_ptz(pan_deg=20) was expected; the model called {_describe_briefly(decision)}"
    return "ok", _describe_briefly(decision)


async def _check_answer(planner: ChatPlanner, tools: Sequence[dict[str, Any]]) -> Finding:
    decision = await planner.step(state_for(PICTURE_INSTRUCTION, tools, picture_exchange()))
    if not isinstance(decision, Finish):
        return "partly", f"the model makes another call although the task is done: {_describe_briefly(decision)}"
    if "<think" in decision.text:
        return "failed", f"the answer contains the reasoning: {_describe_briefly(decision)}"
    if not (decision.usage.input_tokens and decision.usage.output_tokens):
        return "partly", f"the server does not report token counts; the model answered: {_describe_briefly(decision)}"
    return "ok", _describe_briefly(decision)


def _describe_briefly(decision: Decision) -> str:
    if isinstance(decision, Finish):
        text = " ".join(decision.text.split())
        return f"'{text[:_MAX_DETAIL_CHARS]}{'…' if len(text) > _MAX_DETAIL_CHARS else ''}'"
    calls = (f"{call.name}({', '.join(f'{k}={v!r}' for k, v in call.arguments.items())})" for call in decision.calls)
    return "; ".join(calls)[:_MAX_DETAIL_CHARS]
