"""Structured results that report on runs."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel, Field

from scope_ptz.agent.records import Called
from scope_ptz.serve.http.models import RunState
from scope_ptz.serve.http.run_state import state_of, stored_state
from scope_ptz.serve.mcp.addresses import picture_uri
from scope_ptz.serve.mcp.untrusted import MAX_ITEMS, PictureText, mark_picture_text
from scope_ptz.serve.site.run_handle import Record
from scope_ptz.serve.site.site import Site
from scope_ptz.serve.site.stored_runs import records_of, trace_of_run
from scope_ptz.tools.registry import TOOLS

PLANNER_OUTCOMES = ("answered", "clarification", "refused")
"""Outcomes of runs that the planner itself ended."""


MAX_STEPS = 64  # the report on a longer run contains only the last steps
MAX_ARGUMENT_CHARS, MAX_REPORT_CHARS = 500, 1_000  # longer text in a step is truncated


class StepReport(BaseModel):
    """A tool call of a run. ``arguments`` is JSON, which the planner wrote after it had read reports about pictures."""

    tool: str
    arguments: PictureText
    report: PictureText
    failed: bool


class RunReport(BaseModel):
    """The state of a run, which may still be in progress."""

    run: str = Field(description="The id of the run, for run_status and cancel_run.")
    camera: str
    kind: str = Field(description="instruction, tool or dry_run.")
    instruction: str
    conversation: str | None
    running: bool
    outcome: str = Field(description="How the run ended: answered, clarification, refused, cancelled, or a failure.")
    answer: PictureText
    steps: list[StepReport]
    result: dict[str, Any] | None = Field(description="The result of a run that called one tool.")
    pictures: list[str] = Field(description="URIs of the pictures that perception received or that were saved.")
    preview: list[str] = Field(description="The moves that a dry run did not make.")


async def run_report(site: Site, run: str) -> RunReport:
    """Return a report on a run, whether it is in progress or stored.

    Raises:
        UnknownNameError: There is no such run.
        TraceError: The run's trace is damaged.
    """
    handle = site.runner.find(run)
    if handle is not None:
        return _report(state_of(handle), handle.records)
    return _report(await stored_state(site, run), records_of(await trace_of_run(site, run)))


def _report(state: RunState, records: Sequence[Record]) -> RunReport:
    calls = [record for record in records if isinstance(record, Called)]
    last_call = calls[-1] if calls else None
    result = None
    if state.kind == "tool" and last_call is not None and last_call.outcome.result is not None:
        result = mark_picture_text(last_call.outcome.result, perceives=perceives(last_call.outcome.call.name))
    return RunReport(
        run=state.id,
        camera=state.camera,
        kind=state.kind,
        instruction=state.instruction,
        conversation=state.conversation,
        running=state.running,
        outcome=state.outcome,
        answer=PictureText.of(state.answer),
        steps=[_step(call) for call in calls[-MAX_STEPS:]],
        result=result,
        pictures=[picture_uri(state.id, name) for name in _picture_names(calls)][-MAX_ITEMS:],
        preview=state.preview[:MAX_ITEMS],
    )


def _step(called: Called) -> StepReport:
    outcome = called.outcome
    report = outcome.error if outcome.error is not None else str((outcome.result or {}).get("message", ""))
    arguments = json.dumps(outcome.call.arguments, ensure_ascii=False, default=str)
    return StepReport(
        tool=outcome.call.name[:60],
        arguments=PictureText(untrusted_picture_text=arguments[:MAX_ARGUMENT_CHARS]),
        report=PictureText(untrusted_picture_text=report[:MAX_REPORT_CHARS]),
        failed=outcome.error is not None,
    )


def _picture_names(calls: Sequence[Called]) -> list[str]:
    names: list[str] = []
    for called in calls:
        result = called.outcome.result or {}
        names += [
            name for name in (*(result.get("frames") or ()), result.get("file"), called.frame) if isinstance(name, str) and name
        ]
    return list(dict.fromkeys(names))


def perceives(tool: str) -> bool:
    """Return whether text in a tool's result may come from a picture. For an unknown tool, return True."""
    return tool not in TOOLS or TOOLS[tool].perceives
