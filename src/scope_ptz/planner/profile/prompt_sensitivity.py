"""Measure how sensitive a planner is to edits to the prompt and the instruction.

Each instruction is sent unedited, once more unedited (to measure the server's own variation), and with each edit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import anyio
from pydantic import BaseModel, ConfigDict

from scope_ptz.planner.base import Planner
from scope_ptz.planner.chat.prompts import Prompt
from scope_ptz.planner.profile.edits import INSTRUCTION_EDITS, PROMPT_EDITS, Edit
from scope_ptz.planner.profile.first_calls import InstructionRow, PlannerTrial, ask_once, load_rows, make_same_calls, use_same_tools

AGAIN = "repeated unchanged"
_Z = 1.96  # the normal quantile for a 95% interval


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True)


class Rate(_Model):
    """A count out of a total, as a fraction with its 95% Wilson interval. Fraction and interval are None if the total is zero."""

    count: int
    of: int
    share: float | None
    low: float | None
    high: float | None

    @classmethod
    def over(cls, hits: Iterable[bool]) -> Rate:
        """Return the rate of True among ``hits``."""
        values = list(hits)
        count, of = sum(values), len(values)
        if not of:
            return cls(count=0, of=0, share=None, low=None, high=None)
        share, z2 = count / of, _Z * _Z
        middle = (share + z2 / (2 * of)) / (1 + z2 / of)
        half = _Z / (1 + z2 / of) * math.sqrt(share * (1 - share) / of + z2 / (4 * of * of))
        low, high = max(0.0, middle - half), min(1.0, middle + half)
        return cls(count=count, of=of, share=round(share, 4), low=round(low, 4), high=round(high, 4))


class EditEffect(_Model):
    """The effect of an edit on a planner's calls.

    Attributes:
        tools_changed: The rate at which the planner chose different tools than without the edit.
        calls_changed: The rate at which the tools or their arguments changed.
        right: The rate at which the first call with the edit was the expected one.
        inverted: The rate of inverted moves with the edit, among the instructions that request a move.
    """

    edit: str
    where: str
    tools_changed: Rate
    calls_changed: Rate
    right: Rate
    inverted: Rate


class Sensitivity(_Model):
    """The result of a sensitivity measurement.

    ``valid``, ``right``, ``inverted`` and ``failed`` are rates over the unedited instructions. A trial in which the planner or its
    server failed counts only in ``failed``. ``noise`` is the rate at which the tools change without any edit; an edit has an effect
    only if its rate is higher. ``by_prompt`` and ``by_instruction`` are the rates at which the tools change with edits to the
    prompt and to the instruction. ``inverted_anywhere`` covers all trials with a move. ``inversions`` and ``changes`` list examples
    of inverted moves and of changed tools.
    """

    prompt: str
    instructions: int
    valid: Rate
    right: Rate
    inverted: Rate
    failed: Rate
    noise: Rate
    by_prompt: Rate
    by_instruction: Rate
    inverted_anywhere: Rate
    edits: tuple[EditEffect, ...]
    inversions: tuple[str, ...]
    changes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Case:
    """A trial to run: an instruction, and the prompt with which to send it.

    Attributes:
        edit: Name of the edit; empty or ``AGAIN`` if nothing is edited.
        where: What the edit changes: "prompt" or "instruction"; empty if nothing is edited.
        asked: The instruction as sent.
    """

    row: InstructionRow
    edit: str
    where: str
    asked: str
    prompt: Prompt


async def measure_sensitivity(
    make_planner: Callable[[Prompt], Planner],
    prompt: Prompt,
    *,
    rows: Sequence[InstructionRow] | None = None,
    edits: Sequence[Edit] = (*PROMPT_EDITS, *INSTRUCTION_EDITS),
    max_concurrent: int = 4,
    progress: Callable[[int, int], None] = lambda done, of: None,  # noqa: ARG005
) -> Sensitivity:
    """Run all instructions with all edits, and report how the calls change.

    Args:
        make_planner: Creates a planner; called once for each prompt variant.
        prompt: The unedited prompt.
        rows: The instructions; None selects the packaged ones.
        edits: The edits to try.
        max_concurrent: The maximum number of concurrent requests.
        progress: Called after each trial with the number of completed trials and the total.
    """
    rows = load_rows() if rows is None else rows
    cases = _cases(rows, prompt, edits)
    planners = {text: make_planner(variant) for text, variant in {case.prompt.text: case.prompt for case in cases}.items()}
    trials: dict[int, PlannerTrial] = {}
    limiter = anyio.CapacityLimiter(max_concurrent)

    async def ask(number: int, case: _Case) -> None:
        async with limiter:
            trials[number] = await ask_once(planners[case.prompt.text], case.row, asked=case.asked, edit=case.edit)
            progress(len(trials), len(cases))

    try:
        async with anyio.create_task_group() as group:
            for number, case in enumerate(cases):
                group.start_soon(ask, number, case)
    finally:
        with anyio.CancelScope(shield=True):
            for planner in planners.values():
                await planner.close()
    return _report(prompt, rows, cases, [trials[number] for number in range(len(cases))])


def _cases(rows: Sequence[InstructionRow], prompt: Prompt, edits: Sequence[Edit]) -> list[_Case]:
    cases = [_Case(row, edit, "", row.instruction, prompt) for edit in ("", AGAIN) for row in rows]
    for edit in edits:
        if edit.where == "prompt":
            text = edit.apply(prompt.text)
            variant = replace(prompt, name=f"{prompt.name} ({edit.name})", text=text)
            cases += [_Case(row, edit.name, "prompt", row.instruction, variant) for row in rows if text != prompt.text]
            continue
        for row in rows:
            asked = edit.apply(row.instruction)
            if asked != row.instruction:
                cases.append(_Case(row, edit.name, "instruction", asked, prompt))
    return cases


def _report(prompt: Prompt, rows: Sequence[InstructionRow], cases: Sequence[_Case], trials: Sequence[PlannerTrial]) -> Sensitivity:
    """Return the report. Each trial is the result of the case at the same position."""
    unedited = {trial.row.instruction: trial for trial in trials if not trial.edit}
    planned = [trial for trial in unedited.values() if trial.failure is None]
    pairs = _pairs(cases, trials, unedited)
    by_target = {where: [pair for pair in pairs if pair.case.where == where] for where in ("prompt", "instruction")}
    return Sensitivity(
        prompt=prompt.name,
        instructions=len(rows),
        valid=Rate.over(not t.invalid and bool(t.calls) for t in planned),
        right=Rate.over(t.right for t in planned),
        inverted=_inverted_rate(planned),
        failed=Rate.over(t.failure is not None for t in unedited.values()),
        noise=_changed_rate(pair for pair in pairs if pair.case.edit == AGAIN),
        by_prompt=_changed_rate(by_target["prompt"]),
        by_instruction=_changed_rate(by_target["instruction"]),
        inverted_anywhere=_inverted_rate(t for t in trials if t.failure is None),
        edits=_effects(cases, pairs),
        inversions=tuple(_example(t) for t in trials if t.inverted)[:20],
        changes=tuple(_example(pair.edited) for pair in pairs if pair.case.where and pair.changed)[:20],
    )


@dataclass(frozen=True, slots=True)
class _Pair:
    """An instruction's trials without and with an edit. The planner succeeded in both."""

    case: _Case
    unedited: PlannerTrial
    edited: PlannerTrial

    @property
    def changed(self) -> bool:
        return not use_same_tools(self.unedited.calls, self.edited.calls)


def _pairs(cases: Sequence[_Case], trials: Sequence[PlannerTrial], unedited: Mapping[str, PlannerTrial]) -> list[_Pair]:
    """Pair every edited trial with the unedited trial for the same instruction, unless the planner failed in one of them."""
    return [
        _Pair(case, unedited[case.row.instruction], trial)
        for case, trial in zip(cases, trials, strict=True)
        if trial.edit and trial.failure is None and unedited[case.row.instruction].failure is None
    ]


def _changed_rate(pairs: Iterable[_Pair]) -> Rate:
    return Rate.over(pair.changed for pair in pairs)


def _effects(cases: Sequence[_Case], pairs: Sequence[_Pair]) -> tuple[EditEffect, ...]:
    """Return the effect of each edit, in the order in which the edits were tried."""
    names = dict.fromkeys((case.edit, case.where) for case in cases if case.where)
    return tuple(_effect(name, where, [p for p in pairs if (p.case.edit, p.case.where) == (name, where)]) for name, where in names)


def _effect(name: str, where: str, pairs: Sequence[_Pair]) -> EditEffect:
    return EditEffect(
        edit=name,
        where=where,
        tools_changed=_changed_rate(pairs),
        calls_changed=Rate.over(not make_same_calls(pair.unedited.calls, pair.edited.calls) for pair in pairs),
        right=Rate.over(pair.edited.right for pair in pairs),
        inverted=_inverted_rate(pair.edited for pair in pairs),
    )


def _inverted_rate(trials: Iterable[PlannerTrial]) -> Rate:
    """Return the rate of inverted moves among the instructions that request a move."""
    return Rate.over(t.inverted for t in trials if _requests_move(t))


def _requests_move(trial: PlannerTrial) -> bool:
    return any(call.name == "adjust_ptz" for call in trial.row.calls)


def _example(trial: PlannerTrial) -> str:
    calls = "; ".join(f"{c.name}({', '.join(f'{k}={v!r}' for k, v in c.arguments.items())})" for c in trial.calls)
    return f"{trial.asked!r} ({trial.edit or 'unedited'}): {calls or trial.failure or 'no call'}"
