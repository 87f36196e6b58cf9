"""Compare the calls in a run with the calls that a task requires."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from scope_ptz.bench.answers import names_any
from scope_ptz.bench.scoring.episode import EpisodeCall
from scope_ptz.bench.tasks.task import Argument, RequiredCall
from scope_ptz.tools.registry import TOOLS

_DEFAULTS: dict[str, dict[str, Any]] = {name: tool.defaults() for name, tool in TOOLS.items()}
"""The default arguments of each tool, by tool name."""


def complete_arguments(call: EpisodeCall) -> Mapping[str, Any]:
    """Return the arguments of a call, including defaults.

    A zoom in percent is converted to ``zoom_factor``. If the call does not change the zoom, ``zoom_factor`` is 1.
    """
    arguments = {**_DEFAULTS.get(call.name, {}), **{k: v for k, v in call.arguments.items() if v is not None}}
    percent = arguments.get("zoom_percent")
    if isinstance(percent, int | float):
        arguments["zoom_factor"] = 1 + percent / 100
    elif call.name == "adjust_ptz" and "zoom_limit" not in arguments:
        arguments.setdefault("zoom_factor", 1.0)
    return arguments


def matches_required_call(required: RequiredCall, call: EpisodeCall, ignored: Collection[str] = ()) -> bool:
    """Return whether a call succeeded, matches a required call, and found its target if it was a search.

    Args:
        required: The required call.
        call: The actual call.
        ignored: Names of arguments that are not compared. With "found", a search that did not find its target also matches.
    """
    if not call.succeeded or call.name != required.tool:
        return False
    if "found" not in ignored and (call.result or {}).get("found") is False:
        return False
    given = complete_arguments(call)
    return all(_argument_matches(spec, given.get(name)) for name, spec in required.arguments.items() if name not in ignored)


def _argument_matches(spec: Argument, given: Any) -> bool:
    if spec.mentions:
        return isinstance(given, str) and names_any(given, spec.mentions)
    if isinstance(spec.equals, str):
        return isinstance(given, str) and given.strip().lower() == spec.equals.strip().lower()
    is_number = isinstance(given, int | float) and not isinstance(given, bool)
    return is_number and spec.equals is not None and abs(given - spec.equals) <= spec.within + 1e-6


def missing_in_order(required: Sequence[RequiredCall], calls: Sequence[EpisodeCall], ignored: Collection[str] = ()) -> str | None:
    """Describe the first required call that is missing or out of order; return None if all were made in order."""
    position = 0
    for spec in required:
        for number in range(spec.times):
            while position < len(calls) and not matches_required_call(spec, calls[position], ignored):
                position += 1
            if position == len(calls):
                time = f" (time {number + 1} of {spec.times})" if spec.times > 1 else ""
                return f"{_call_text(spec)} is missing{time}, or comes too early"
            position += 1
    return None


def missing_in_any_order(
    required: Sequence[RequiredCall], calls: Sequence[EpisodeCall], ignored: Collection[str] = ()
) -> str | None:
    """Describe the first missing call; return None if every required call can be matched to a different call, in any order."""
    slots = [spec for spec in required for _ in range(spec.times)]
    slot_of_call: dict[int, int] = {}

    def assign(slot: int, tried: set[int]) -> bool:
        """Assign a call to a slot, reassigning earlier slots if necessary (bipartite matching)."""
        for index, call in enumerate(calls):
            if index not in tried and matches_required_call(slots[slot], call, ignored):
                tried.add(index)
                if index not in slot_of_call or assign(slot_of_call[index], tried):
                    slot_of_call[index] = slot
                    return True
        return False

    for slot, spec in enumerate(slots):
        if not assign(slot, set()):
            return f"{_call_text(spec)} is missing"
    return None


def _call_text(spec: RequiredCall) -> str:
    arguments = ", ".join(
        f"{name}={a.equals if a.equals is not None else '/'.join(a.mentions)}" for name, a in spec.arguments.items()
    )
    return f"{spec.tool}({arguments})"
