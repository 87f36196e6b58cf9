"""Send an instruction to a planner without a camera, and check the calls in its first step.

The checks test whether each call is valid, whether the first call is the expected one, and whether its direction is inverted.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from time import perf_counter
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from scope_ptz.errors import InputError, PlannerError, ToolCallError
from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.base import Briefing, CallTools, Planner, State, Usage
from scope_ptz.tools.adjust_ptz import AdjustPtz
from scope_ptz.tools.registry import parse_call, schemas

PRESETS = ("gate", "highway")  # the presets that the planner's briefing lists
_TOLERANCE = 0.01  # numbers that differ by at most this count as equal


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True)


class CallRecord(_Model):
    """A tool call: the tool's name and the arguments."""

    name: str
    arguments: dict[str, Any] = {}


class InstructionRow(_Model):
    """An instruction with its expected calls.

    Attributes:
        kind: The type of instruction, such as "move".
        alternatives: Names of other tools that are also acceptable as the first call.
    """

    instruction: str
    kind: str
    calls: tuple[CallRecord, ...]
    alternatives: tuple[str, ...] = ()


class PlannerTrial(_Model):
    """A planner's first step for an instruction.

    Attributes:
        edit: Name of the edit that was applied to the instruction; empty for the original wording.
        asked: The instruction as sent, after the edit.
        calls: The valid calls.
        invalid: Number of invalid calls.
        text: The reply's text or, if the planner failed, the error message.
        failure: The failure kind; None if the planner did not fail.
        right: Whether the first call is the expected one.
        inverted: Whether the first move turns or zooms opposite to the expected direction.
    """

    row: InstructionRow
    edit: str
    asked: str
    calls: tuple[CallRecord, ...] = ()
    invalid: int = 0
    text: str = ""
    failure: str | None = None
    right: bool = False
    inverted: bool = False
    seconds: float = 0.0
    first_token_s: float | None = None
    usage: Usage = Usage()


def load_rows() -> tuple[InstructionRow, ...]:
    """Return the packaged instructions."""
    lines = (files("scope_ptz") / "data" / "profile_instructions.jsonl").read_text(encoding="utf-8").splitlines()
    return tuple(InstructionRow.model_validate(json.loads(line)) for line in lines)


def read_rows(source: Path) -> tuple[InstructionRow, ...]:
    """Read instructions with expected calls from a JSON Lines file.

    Lines without calls are skipped, because they expect a question instead of calls.

    Raises:
        InputError: The file cannot be read, a line is malformed, or there is no line with calls.
    """
    try:
        lines = source.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{source} cannot be read: {error}.") from error
    rows: list[InstructionRow] = []
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            parsed = _InstructionLine.model_validate_json(line)
            if parsed.calls:
                rows.append(InstructionRow.model_validate(parsed.model_dump()))
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            where = ".".join(str(part) for part in first["loc"])
            raise InputError(f"{source}, line {number}: {f'{where}: ' if where else ''}{first['msg']}.") from error
    if not rows:
        raise InputError(f"{source} contains no instruction with expected calls.")
    return tuple(rows)


class _InstructionLine(BaseModel):
    """A line in a file of instructions with expected calls."""

    instruction: str
    kind: str = ""
    calls: list[dict[str, Any]] = []
    alternatives: tuple[str, ...] = ()


async def ask_once(planner: Planner, row: InstructionRow, *, asked: str | None = None, edit: str = "") -> PlannerTrial:
    """Send an instruction to a planner. For an edited instruction, ``asked`` is the new wording and ``edit`` the edit's name."""
    instruction = row.instruction if asked is None else asked
    state = State(
        instruction=instruction, briefing=Briefing(presets=PRESETS, pose=Pose(), limits=Limits()), tools=tuple(schemas())
    )  # fmt: skip
    began = perf_counter()
    try:
        decision = await planner.step(state)
    except PlannerError as error:
        failure = error.kind or "planner-error"
        return PlannerTrial(row=row, edit=edit, asked=instruction, failure=failure, text=str(error), seconds=perf_counter() - began)
    seconds = perf_counter() - began
    requested = decision.calls if isinstance(decision, CallTools) else ()
    calls = tuple(
        CallRecord(name=c.name, arguments=c.arguments) for c in requested if c.problem is None and _is_valid(c.name, c.arguments)
    )
    return PlannerTrial(
        row=row,
        edit=edit,
        asked=instruction,
        calls=calls,
        invalid=len(requested) - len(calls),
        text=decision.thought if isinstance(decision, CallTools) else decision.text,
        right=bool(calls) and is_expected_call(row, calls[0]),
        inverted=is_inverted(row, calls),
        seconds=seconds,
        first_token_s=decision.served.first_token_s if decision.served else None,
        usage=decision.usage,
    )


def _is_valid(name: str, arguments: dict[str, Any]) -> bool:
    try:
        parse_call(name, arguments)
    except ToolCallError:
        return False
    return True


def is_expected_call(row: InstructionRow, call: CallRecord) -> bool:
    """Return whether a call may be the first: it uses an alternative tool, or is equivalent to the expected first call."""
    expected = row.calls[0]
    if call.name in row.alternatives:
        return True
    return call.name == expected.name and have_equivalent_arguments(expected, call)


def have_equivalent_arguments(one: CallRecord, other: CallRecord) -> bool:
    """Return whether two calls to the same tool have equivalent arguments.

    Numbers may differ by ``_TOLERANCE``. Descriptions must consist of the same words, apart from articles, "all", "any" and a final
    "s". Question texts are not compared. If ``one`` is an expected call, it may contain ``{"contains": [words, ...]}`` instead of a
    text; the other call's text must then contain these words, in any order.
    """
    required_words = {
        key: value["contains"] for key, value in one.arguments.items() if isinstance(value, dict) and "contains" in value
    }
    expected_call = CallRecord(
        name=one.name, arguments=one.arguments | {key: " ".join(words) for key, words in required_words.items()}
    )
    try:
        a, b = (parse_call(call.name, call.arguments)[1].model_dump(exclude={"question"}) for call in (expected_call, other))
    except ToolCallError:
        return False
    return all(set(_words(a[key])) <= set(_words(b[key])) if key in required_words else _is_equivalent(a[key], b[key]) for key in a)


def _is_equivalent(one: Any, other: Any) -> bool:
    if isinstance(one, str) and isinstance(other, str):
        return _words(one) == _words(other)
    if isinstance(one, int | float) and isinstance(other, int | float):
        return abs(one - other) <= _TOLERANCE
    return bool(one == other)


def _words(text: str) -> list[str]:
    return [w.removesuffix("s") for w in re.findall(r"\w+", text.lower()) if w not in ("the", "a", "an", "all", "any")]


def use_same_tools(one: Sequence[CallRecord], other: Sequence[CallRecord]) -> bool:
    """Return whether two sequences of calls use the same tools, up to the length of the shorter one."""
    if not one or not other:
        return not one and not other
    return all(a.name == b.name for a, b in zip(one, other, strict=False))


def make_same_calls(one: Sequence[CallRecord], other: Sequence[CallRecord]) -> bool:
    """Return whether two sequences of calls use the same tools and equivalent arguments, up to the length of the shorter one."""
    return use_same_tools(one, other) and all(have_equivalent_arguments(a, b) for a, b in zip(one, other, strict=False))


def is_inverted(row: InstructionRow, calls: Sequence[CallRecord]) -> bool:
    """Return whether the first move is opposite to the expected one: right for left, up for down, or in for out."""
    expected = next((_directions(c) for c in row.calls if c.name == "adjust_ptz"), None)
    actual = next((_directions(c) for c in calls if c.name == "adjust_ptz"), None)
    return expected is not None and actual is not None and any(e * a < 0 for e, a in zip(expected, actual, strict=True))


def _directions(call: CallRecord) -> tuple[float, float, float]:
    """Return the pan, tilt and zoom of a move, whose signs are its directions. An invalid call gives zeros."""
    try:
        move = AdjustPtz.model_validate(call.arguments)
    except ValidationError:
        return 0.0, 0.0, 0.0
    zoom = 0.0
    if move.zoom_factor is not None:
        zoom = move.zoom_factor - 1.0
    elif move.zoom_percent is not None:
        zoom = move.zoom_percent
    elif move.zoom_limit is not None:
        zoom = 1.0 if move.zoom_limit == "in" else -1.0
    return move.pan_deg, move.tilt_deg, zoom
