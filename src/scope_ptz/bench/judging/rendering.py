"""Describe a run to a judge within a character budget.

The instruction, the expected answer and the final answer are always included. If the description is too long, first the tool
results are shortened. If that is not enough, the calls in the middle are replaced with the number of calls to each tool.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from scope_ptz.bench.judging.case import CaseCall, JudgeCase
from scope_ptz.bench.judging.quoting import quote, quote_name, shorten
from scope_ptz.bench.scoring.episode import PresetViewpoints
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.geometry import Pose

MIN_CHARS = 6_000
"""Minimum budget in characters. A shorter description cannot be judged reliably."""

_INSTRUCTION_CHARS, _EXPECTED_CHARS, _ANSWER_CHARS = 4_000, 2_000, 8_000
"""Maximum lengths of the instruction, of the expected answer and of the final answer, in characters."""
_RESULT_CHARS = (4_000, 1_200, 300)
"""Maximum lengths of a tool result in characters, tried in this order until all calls fit into the budget."""

_NAME_CHARS, _MAX_PRESETS, _NOTE_CHARS = 60, 40, 300
"""Maximum length of a name, maximum number of presets, and characters reserved for the note about omitted calls."""
_OMITTED_FIELDS = frozenset({"boxes", "box", "path", "frames", "source"})
"""Result fields that are omitted because they do not help a judge or would reveal the perception model."""

_PERCEPTION_NAME = re.compile(r" ?\(seen by [^()]*\)")
"""The note in a tool's message that names the perception model."""

_OUTCOME_TEXTS = {
    "answered": "the agent gave a final answer",
    "clarification": "the agent asked a question back",
    "refused": "the agent declined the request",
    "step_limit": "the agent was stopped at its limit of steps and gave no answer",
    "budget": "the agent ran out of its budget and gave no answer",
    "planner_error": "the agent's planner broke down and gave no answer",
    "camera_error": "the camera failed",
    "cancelled": "the run was cancelled",
}
"""Descriptions of run outcomes."""


def describe_run(facts: TaskFacts, case: JudgeCase, budget: int) -> str:
    """Describe a task and a run.

    Args:
        facts: The task's properties and expected answer.
        case: The run.
        budget: Maximum length in characters. Values below ``MIN_CHARS`` are raised to ``MIN_CHARS``.
    """
    head, tail = _task_part(facts, case), _end_part(case)
    budget_left = max(budget, MIN_CHARS) - len(head) - len(tail)
    return f"{head}\n\n{_calls_part(case.calls, max(budget_left, MIN_CHARS // 4))}\n\n{tail}"


def _task_part(facts: TaskFacts, case: JudgeCase) -> str:
    names = [_preset(name, case) for name in case.presets[:_MAX_PRESETS]]
    more = len(case.presets) - len(names)
    presets = ", ".join(names) + (f" and {more} more" if more > 0 else "") if names else "none"
    where = f" at viewpoint {quote_name(case.viewpoint, _NAME_CHARS)}" if case.viewpoint else ""
    lines = [
        f"Category: {facts.category}",
        f"Observation scope that the task is about: {facts.scope}",
        "",
        "Instruction to the agent:",
        quote(shorten(case.instruction, _INSTRUCTION_CHARS)),
        "",
        "Expected answer:",
        quote(shorten(facts.expected, _EXPECTED_CHARS)),
    ]
    if facts.demands:
        lines += ["", "What the run must have done:", quote(shorten("\n".join(facts.demands), _EXPECTED_CHARS))]
    lines += [
        "",
        f"Start: preset {quote_name(facts.preset, _NAME_CHARS)}{where}, camera at {pose_text(case.start)}.",
        f"Presets of the camera: {presets}.",
    ]
    if case.agent_saw_pictures:
        lines.append("The agent was shown the camera's picture before its steps and may answer from what it saw there.")
    return "\n".join(lines)


def _preset(name: str, case: JudgeCase) -> str:
    """Return a preset's name, followed by its viewpoint if known."""
    viewpoint = case.preset_viewpoints.presets.get(name) if case.preset_viewpoints is not None else None
    return quote_name(name, _NAME_CHARS) + (f" (viewpoint {quote_name(viewpoint, _NAME_CHARS)})" if viewpoint else "")


def _end_part(case: JudgeCase) -> str:
    viewpoint = case.calls[-1].viewpoint if case.calls else case.viewpoint
    ending = _OUTCOME_TEXTS.get(case.outcome or "", "the run was cut off before its end")
    return "\n".join(
        (
            f"How the run ended: {ending}.",
            f"Final camera pose:{_viewpoint_text(viewpoint)} {pose_text(case.final)}.",
            "",
            "What the agent said in the end:",
            quote(shorten(case.answer, _ANSWER_CHARS) if case.answer.strip() else "(nothing)"),
        )
    )


def _calls_part(calls: Sequence[CaseCall], budget_left: int) -> str:
    if not calls:
        return "Tool calls: none."
    title = f"Tool calls, in order ({len(calls)}):"
    for max_chars in _RESULT_CHARS:
        texts = _all_calls(calls, max_chars, budget_left)
        if texts is not None:
            return "\n".join((title, *texts))
    return "\n".join((title, *_first_and_last_calls(calls, budget_left)))


def _all_calls(calls: Sequence[CaseCall], max_chars: int, budget_left: int) -> list[str] | None:
    """Return the text of every call, or None if they do not fit into ``budget_left`` characters."""
    texts = list[str]()
    for number, call in enumerate(calls, 1):
        texts.append(_call_text(number, call, max_chars))
        budget_left -= len(texts[-1]) + 1
        if budget_left < 0:
            return None
    return texts


def _first_and_last_calls(calls: Sequence[CaseCall], budget_left: int) -> list[str]:
    """Return as many of the first and last calls as fit, with a note about the calls between them."""
    front, back = list[str](), list[str]()
    budget_left -= _NOTE_CHARS
    while len(front) + len(back) < len(calls):
        index = len(front) if len(front) <= len(back) else len(calls) - 1 - len(back)
        text = _call_text(index + 1, calls[index], _RESULT_CHARS[-1])
        budget_left -= len(text) + 1
        if budget_left < 0:
            break
        (front if len(front) <= len(back) else back).append(text)
    first, last = len(front), len(calls) - len(back)
    tools = Counter(quote_name(call.name, 30) for call in calls[first:last])
    failed = sum(call.error is not None for call in calls[first:last])
    counts = ", ".join(f"{name} {number} times" for name, number in tools.most_common(9))
    note = f"[Calls {first + 1} to {last} are left out because the run is long: {counts}; {failed} of them failed.]"
    return [*front, note, *reversed(back)]


def _call_text(number: int, call: CaseCall, max_chars: int) -> str:
    arguments = shorten(_json(call.arguments), max_chars)
    result = (
        f"error: {shorten(call.error, max_chars)}"
        if call.error is not None
        else f"result: {shorten(_json(_shown_fields(call.result or {})), max_chars)}"
    )
    body = quote(f"{shorten(call.name, 80)} {arguments}\n{result}")
    return f"Call {number}:\n{body}\nCamera afterwards:{_viewpoint_text(call.viewpoint)} {pose_text(call.pose)}."


def _viewpoint_text(viewpoint: str | None) -> str:
    return f" at viewpoint {quote_name(viewpoint, _NAME_CHARS)}," if viewpoint else ""


def _shown_fields(result: Mapping[str, Any]) -> dict[str, Any]:
    fields = {name: value for name, value in result.items() if name not in _OMITTED_FIELDS and name != "pose"}
    if isinstance(fields.get("message"), str):
        fields["message"] = _PERCEPTION_NAME.sub("", fields["message"])
    return fields


def _json(content: Mapping[str, Any]) -> str:
    return json.dumps(dict(content), ensure_ascii=False, default=str)


def pose_text(pose: Pose) -> str:
    """Format a pose as text."""
    return f"pan {pose.pan_deg:.1f}, tilt {pose.tilt_deg:.1f} degrees, zoom {pose.zoom:.2f}x"


def layout_sample() -> str:
    """Return the description of an invented run that contains every part of the layout.

    The digest in the prompt version covers it, so a change to the layout changes the version.
    """
    pose = Pose(10.0, -5.0, 2.0)
    facts = TaskFacts(
        id="id", dataset="dataset", stratum="core", scene="scene", viewpoint="mast", preset="gate", instruction="Look.",
        category="counting", scope="current", difficulty="easy", expected="5", demands=("go_home()",),
    )  # fmt: skip
    calls = [CaseCall("tool", {"a": 1}, {"message": "Done.", "box": [0]}, None, pose, "mast")]
    calls += [CaseCall("tool", {}, None, "It failed.", pose)] * MIN_CHARS
    case = JudgeCase(
        "Look.", pose, "mast", ("gate",), tuple(calls), pose, "Five.", "answered", True, PresetViewpoints({"gate": "mast"}, "mast")
    )
    return "\n\n".join(
        describe_run(facts, variant, MIN_CHARS) for variant in (case, replace(case, calls=(), outcome=None, answer=""))
    )
