"""The measurement: every instruction as it is, again as it is (what the server varies by itself), and under each edit."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import anyio
from pydantic import BaseModel, ConfigDict

from scope_ptz.planner.base import Planner
from scope_ptz.planner.chat.prompts import Prompt
from scope_ptz.planner.profile.edits import INSTRUCTION_EDITS, PROMPT_EDITS, Edit
from scope_ptz.planner.profile.first_calls import Row, Trial, ask_once, load_rows, same_calls, same_choice

AGAIN = "asked again unchanged"
_Z = 1.96


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True)


class Rate(_Model):
    """``count`` of ``of``, with Wilson's 95% interval; all None when nothing was asked."""

    count: int
    of: int
    share: float | None
    low: float | None
    high: float | None

    @classmethod
    def over(cls, hits: Iterable[bool]) -> Rate:
        found = list(hits)
        count, of = sum(found), len(found)
        if not of:
            return cls(count=0, of=0, share=None, low=None, high=None)
        share, z2 = count / of, _Z * _Z
        middle = (share + z2 / (2 * of)) / (1 + z2 / of)
        half = _Z / (1 + z2 / of) * math.sqrt(share * (1 - share) / of + z2 / (4 * of * of))
        low, high = max(0.0, middle - half), min(1.0, middle + half)
        return cls(count=count, of=of, share=round(share, 4), low=round(low, 4), high=round(high, 4))


class EditEffect(_Model):
    """What an edit did. ``tools_changed``: another tool was chosen than without it; ``calls_changed``: that, or other arguments."""

    edit: str
    where: str
    tools_changed: Rate
    calls_changed: Rate
    right: Rate
    inverted: Rate


class Sensitivity(_Model):
    """The report.

    ``valid``, ``right``, ``inverted``, ``failed`` are of the instructions as they are. A trial in which the planner or its server
    failed counts in ``failed`` only: it chose nothing, so its choice did not change. ``noise`` is how often the tools change
    when nothing was edited: what edits do is what exceeds it. ``inverted_anywhere`` is over all trials with a move in them.
    ``inversions`` and ``changes`` are examples.
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
    row: Row
    edit: str
    where: str
    asked: str
    prompt: Prompt


async def measure_sensitivity(
    make_planner: Callable[[Prompt], Planner],
    prompt: Prompt,
    *,
    rows: Sequence[Row] | None = None,
    edits: Sequence[Edit] = (*PROMPT_EDITS, *INSTRUCTION_EDITS),
    at_once: int = 4,
    progress: Callable[[int, int], None] = lambda done, of: None,  # noqa: ARG005
) -> Sensitivity:
    """Ask everything, ``at_once`` requests at a time. ``make_planner`` is called once for each edited prompt; ``progress``:
    done, of."""
    rows = load_rows() if rows is None else rows
    cases = _cases(rows, prompt, edits)
    planners = {text: make_planner(variant) for text, variant in {case.prompt.text: case.prompt for case in cases}.items()}
    trials: dict[int, Trial] = {}
    limiter = anyio.CapacityLimiter(at_once)

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


def _cases(rows: Sequence[Row], prompt: Prompt, edits: Sequence[Edit]) -> list[_Case]:
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


def _report(prompt: Prompt, rows: Sequence[Row], cases: Sequence[_Case], trials: Sequence[Trial]) -> Sensitivity:
    plain = {trial.row.instruction: trial for trial in trials if not trial.edit}
    chose = {words: trial for words, trial in plain.items() if trial.failure is None}
    pairs = [
        (case, trial)
        for case, trial in zip(cases, trials, strict=True)
        if trial.edit and trial.failure is None and trial.row.instruction in chose
    ]

    def changed(trial: Trial) -> bool:
        return not same_choice(plain[trial.row.instruction].calls, trial.calls)

    def effect(name: str, where: str) -> EditEffect:
        edited = [trial for case, trial in pairs if (case.edit, case.where) == (name, where)]
        return EditEffect(
            edit=name,
            where=where,
            tools_changed=Rate.over(changed(t) for t in edited),
            calls_changed=Rate.over(not same_calls(plain[t.row.instruction].calls, t.calls) for t in edited),
            right=Rate.over(t.right for t in edited),
            inverted=Rate.over(t.inverted for t in edited if _moves(t)),
        )

    names = list(dict.fromkeys((case.edit, case.where) for case in cases if case.where))
    return Sensitivity(
        prompt=prompt.name,
        instructions=len(rows),
        valid=Rate.over(not t.invalid and bool(t.calls) for t in chose.values()),
        right=Rate.over(t.right for t in chose.values()),
        inverted=Rate.over(t.inverted for t in chose.values() if _moves(t)),
        failed=Rate.over(t.failure is not None for t in plain.values()),
        noise=Rate.over(changed(t) for case, t in pairs if case.edit == AGAIN),
        by_prompt=Rate.over(changed(t) for case, t in pairs if case.where == "prompt"),
        by_instruction=Rate.over(changed(t) for case, t in pairs if case.where == "instruction"),
        inverted_anywhere=Rate.over(t.inverted for t in trials if t.failure is None and _moves(t)),
        edits=tuple(effect(name, where) for name, where in names),
        inversions=tuple(_example(t) for t in trials if t.inverted)[:20],
        changes=tuple(_example(t) for case, t in pairs if case.where and changed(t))[:20],
    )


def _moves(trial: Trial) -> bool:
    return any(call.name == "adjust_ptz" for call in trial.row.calls)


def _example(trial: Trial) -> str:
    calls = "; ".join(f"{c.name}({', '.join(f'{k}={v!r}' for k, v in c.arguments.items())})" for c in trial.calls)
    return f"{trial.asked!r} ({trial.edit or 'as it is'}): {calls or trial.failure or 'no call'}"
