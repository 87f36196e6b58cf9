"""Tools for instructions and long-running work: run an instruction and wait, or start it, query its state and cancel it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import anyio
from mcp_types import CallToolResult, ContentBlock, ToolAnnotations
from pydantic import BaseModel, Field

from scope_ptz.errors import ToolCallError
from scope_ptz.serve.http.models import Identifier, Instruction
from scope_ptz.serve.mcp.pictures import MAX_PICTURE_BYTES, PICTURE_WIDTH, convert_to_limited_jpeg, image_content
from scope_ptz.serve.mcp.reports import PLANNER_OUTCOMES, RunReport, run_report
from scope_ptz.serve.mcp.run_progress import follow
from scope_ptz.serve.mcp.tool import CallContext, McpTool, ToolArguments, input_schema, output_schema, parse_arguments, reply
from scope_ptz.serve.mcp.tools.camera_tools import is_panorama, picture_link, run_link
from scope_ptz.serve.mcp.untrusted import enclose_in_markers
from scope_ptz.serve.site.start_runs import start_instruction, start_tool_call
from scope_ptz.serve.site.stored_runs import stored_picture
from scope_ptz.store.conversations import add_conversation
from scope_ptz.store.rows import UNFINISHED
from scope_ptz.tools.registry import TOOLS, parse_call

MAX_WAIT_S = 30.0
"""Maximum time, in seconds, for which ``run_status`` waits for a run to end. Many clients abort a call after 60 s."""

MAX_LINES = 10
"""Maximum number of steps and answers in a report's plain text. The structured result contains all of them."""

_HAS_EFFECTS = ToolAnnotations(read_only_hint=False, destructive_hint=False, idempotent_hint=False, open_world_hint=True)
_READ_ONLY = ToolAnnotations(read_only_hint=True, destructive_hint=False, idempotent_hint=True, open_world_hint=True)


class Ask(ToolArguments):
    """The arguments of ``ask``."""

    camera: str = Field(max_length=120)
    instruction: Instruction = Field(description="The instruction in plain language.")
    conversation: Identifier | None = Field(None, description="Conversation to continue, as start_conversation reports it.")
    pair: Identifier | None = Field(None, description="Pair of models; by default the conversation's, or the server's first.")
    dry_run: bool = Field(False, description="Whether moves are only reported and not made.")
    picture: bool = Field(True, description="Whether the result contains the last picture of the run.")


class StartRun(ToolArguments):
    """The arguments of ``start_run``."""

    camera: str = Field(max_length=120)
    instruction: Instruction | None = Field(None, description="Instruction in plain language; or give tool instead.")
    tool: str | None = Field(None, description="One of the nine camera tools; or give instruction instead.")
    arguments: dict[str, Any] = Field(default_factory=dict, description="Arguments of the tool.")
    conversation: Identifier | None = Field(None, description="Conversation that an instruction continues.")
    pair: Identifier | None = Field(None, description="Pair of models; by default the conversation's, or the server's first.")
    dry_run: bool = Field(False, description="Whether the moves of an instruction are only reported and not made.")


class RunStatus(ToolArguments):
    """The arguments of ``run_status``."""

    run: Identifier = Field(description="The id of the run, as start_run reports it.")
    wait_s: float = Field(0.0, ge=0.0, le=MAX_WAIT_S, allow_inf_nan=False, description="Seconds to wait for the end of the run.")


class CancelRun(ToolArguments):
    """The arguments of ``cancel_run``."""

    run: Identifier = Field(description="The id of the run, as start_run reports it.")


class StartConversation(ToolArguments):
    """The arguments of ``start_conversation``."""

    camera: str = Field(max_length=120)
    title: str = Field("", max_length=120, description="A title for people.")
    pair: Identifier | None = Field(None, description="Pair of models; by default the server's first.")


class Conversation(BaseModel):
    """A conversation about a camera."""

    conversation: str = Field(description="The handle, for ask and start_run.")
    camera: str
    pair: str
    title: str


def run_tools(cameras: Sequence[str]) -> list[McpTool]:
    """Return the tools for instructions, runs and conversations."""
    report_schema = output_schema(RunReport)
    return [
        McpTool(
            "ask", "Give an instruction",
            "Run an instruction in plain language, such as 'sweep the scene and count all cars', and return when it has ended. "
            "The camera's own planner decides on the steps. For work that may take longer than a minute, use start_run.",
            input_schema(Ask, cameras), report_schema, _HAS_EFFECTS, needs_operator=True, kind="run", run=_ask,
        ),
        McpTool(
            "start_run", "Start long work",
            "Start an instruction, or a call of one camera tool such as track_object or a count with view='full', and return "
            "immediately. Follow it with run_status, and end it with cancel_run.",
            _start_schema(cameras), report_schema, _HAS_EFFECTS, needs_operator=True, kind="run", run=_start,
        ),
        McpTool(
            "run_status", "State of a run",
            "Return the state of a run: its steps so far and, when it has ended, its outcome, answer or result, and pictures.",
            input_schema(RunStatus, cameras), report_schema, _READ_ONLY, needs_operator=False, kind="read", run=_status,
        ),
        McpTool(
            "cancel_run", "Cancel a run",
            "Cancel a run and stop its camera. A run that has ended does not change.",
            input_schema(CancelRun, cameras), report_schema,
            _HAS_EFFECTS.model_copy(update={"idempotent_hint": True}), needs_operator=True, kind=None, run=_cancel,
        ),
        McpTool(
            "start_conversation", "Start a conversation",
            "Start a conversation about a camera. Instructions with its handle can refer to earlier ones ('and the other one?').",
            input_schema(StartConversation, cameras), output_schema(Conversation),
            _HAS_EFFECTS.model_copy(update={"open_world_hint": False}),
            needs_operator=True, kind="command", run=_start_conversation,
        ),
    ]  # fmt: skip


def _start_schema(cameras: Sequence[str]) -> dict[str, Any]:
    schema = input_schema(StartRun, cameras)
    tool = schema["properties"]["tool"]
    schema["properties"]["tool"] = {**tool, "anyOf": [{"type": "string", "enum": list(TOOLS)}, {"type": "null"}]}
    return schema


async def _ask(call: CallContext, arguments: dict[str, Any]) -> CallToolResult:
    parsed = parse_arguments(Ask, "ask", arguments)
    station, fields = call.site.station(parsed.camera), parsed.model_dump(exclude={"picture"})
    handle = await follow(call, station, start_instruction(call.site, call.client, **fields))
    if handle.failure is not None:
        raise handle.failure
    return await _run_result(call, handle.id, picture=parsed.picture)


async def _start(call: CallContext, arguments: dict[str, Any]) -> CallToolResult:
    parsed = parse_arguments(StartRun, "start_run", arguments)
    if (parsed.instruction is None) == (parsed.tool is None):
        raise ToolCallError("Wrong arguments for start_run: give either instruction or tool.")
    if parsed.instruction is not None:
        fields = parsed.model_dump(include={"camera", "conversation", "pair", "dry_run"})
        handle = await start_instruction(call.site, call.client, instruction=parsed.instruction, **fields)
        return await _run_result(call, handle.id, picture=False)
    if parsed.conversation is not None or parsed.dry_run:
        raise ToolCallError("Wrong arguments for start_run: conversation and dry_run apply to instructions, not to tools.")
    station, tool = call.site.station(parsed.camera), str(parsed.tool)
    parse_call(tool, parsed.arguments)
    handle = await start_tool_call(call.site, call.client, station, tool, parsed.arguments, parsed.pair)
    return await _run_result(call, handle.id, picture=False)


async def _status(call: CallContext, arguments: dict[str, Any]) -> CallToolResult:
    parsed = parse_arguments(RunStatus, "run_status", arguments)
    handle = call.site.runner.find(parsed.run)
    if handle is not None and parsed.wait_s > 0:
        with anyio.move_on_after(parsed.wait_s):
            await handle.done.wait()
    return await _run_result(call, parsed.run, picture=handle is None or handle.done.is_set())


async def _cancel(call: CallContext, arguments: dict[str, Any]) -> CallToolResult:
    parsed = parse_arguments(CancelRun, "cancel_run", arguments)
    if (handle := call.site.runner.find(parsed.run)) is not None:
        handle.cancel()
        with anyio.move_on_after(MAX_WAIT_S):
            await handle.done.wait()
    return await _run_result(call, parsed.run, picture=False)


async def _start_conversation(call: CallContext, arguments: dict[str, Any]) -> CallToolResult:
    parsed = parse_arguments(StartConversation, "start_conversation", arguments)
    site = call.site
    camera, pair = site.station(parsed.camera).name, site.pairs.check(parsed.pair)
    title = parsed.title.encode("utf-8", "replace").decode()
    add = partial(add_conversation, site.library.store.database, camera=camera, pair=pair, owner=call.client.name, title=title)
    conversation = await site.library.in_thread(add)
    text = f"Started the conversation {conversation.id} about {camera}. Pass conversation='{conversation.id}' to ask or start_run."
    return reply(
        text,
        Conversation(conversation=conversation.id, camera=conversation.camera, pair=conversation.pair, title=conversation.title),
    )


async def _run_result(call: CallContext, run: str, *, picture: bool) -> CallToolResult:
    """Return a run's state with links and, if requested, its last picture."""
    report = await run_report(call.site, run)
    content: list[ContentBlock] = [run_link(run)]
    names = [uri.partition(f"{run}/")[2] for uri in report.pictures]
    content += [picture_link(run, name) for name in names if is_panorama(name)]
    plain_pictures = [name for name in names if not is_panorama(name)]
    if picture and plain_pictures:
        stored = await stored_picture(call.site, run, plain_pictures[-1])
        content += [
            picture_link(run, plain_pictures[-1]),
            image_content(await convert_to_limited_jpeg(stored, MAX_PICTURE_BYTES, PICTURE_WIDTH)),
        ]
    failed = not report.running and report.outcome not in (*PLANNER_OUTCOMES, "cancelled", UNFINISHED)
    return reply(_text(report), report, *content, failed=failed)


def _text(report: RunReport) -> str:
    count = f"{len(report.steps)} tool call{'' if len(report.steps) == 1 else 's'}"
    if report.running:
        head = f"The run {report.run} on {report.camera} is in progress, with {count} so far."
    else:
        head = f"The run {report.run} on {report.camera} has ended: {report.outcome}, after {count}."
    lines = [
        f"{number}. {step.tool} {step.arguments.untrusted_picture_text}: {step.report.untrusted_picture_text}"
        for number, step in enumerate(report.steps, 1)
    ]
    if answer := report.answer.untrusted_picture_text:
        lines.append(f"Answer: {answer}")
    return f"{head}\n{enclose_in_markers(chr(10).join(lines[-MAX_LINES:]))}" if lines else head
