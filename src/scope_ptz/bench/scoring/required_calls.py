"""Compare the calls that a task requires with the calls that a run made."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from scope_ptz.bench.answers import names_any
from scope_ptz.bench.scoring.episode import EpisodeCall
from scope_ptz.bench.tasks.task import Argument, RequiredCall
from scope_ptz.tools.registry import TOOLS

_DEFAULTS: dict[str, dict[str, Any]] = {name: tool.defaults() for name, tool in TOOLS.items()}


def arguments_of(call: EpisodeCall) -> Mapping[str, Any]:
    """Return the arguments of a call with defaults filled in.

    A zoom in percent is also given as ``zoom_factor``. An unchanged zoom has the factor 1.
    """
    arguments = {**_DEFAULTS.get(call.name, {}), **{k: v for k, v in call.arguments.items() if v is not None}}
    percent = arguments.get("zoom_percent")
    if isinstance(percent, int | float):
        arguments["zoom_factor"] = 1 + percent / 100
    elif call.name == "adjust_ptz" and "zoom_limit" not in arguments:
        arguments.setdefault("zoom_factor", 1.0)
    return arguments


def call_matches(required: RequiredCall, call: EpisodeCall, leave_out: Collection[str] = ()) -> bool:
    """Return whether a call is the required one, succeeded, and found its target if it has one.

    Args:
        required: The required call.
        call: The call that was made.
        leave_out: Names of arguments that are not compared; "found" accepts a call that did not find its target.
    """
    if not call.succeeded or call.name != required.tool:
        return False
    if "found" not in leave_out and (call.result or {}).get("found") is False:
        return False
    given = arguments_of(call)
    return all(_fits_argument(spec, given.get(name)) for name, spec in required.arguments.items() if name not in leave_out)


def _fits_argument(spec: Argument, given: Any) -> bool:
    if spec.mentions:
        return isinstance(given, str) and names_any(given, spec.mentions)
    if isinstance(spec.equals, str):
        return isinstance(given, str) and given.strip().lower() == spec.equals.strip().lower()
    is_number = isinstance(given, int | float) and not isinstance(given, bool)
    return is_number and spec.equals is not None and abs(given - spec.equals) <= spec.within + 1e-6


def missing_in_order(required: Sequence[RequiredCall], calls: Sequence[EpisodeCall], leave_out: Collection[str] = ()) -> str | None:
    """Return which required call is missing when the order counts; None if all were made in order."""
    at = 0
    for spec in required:
        for number in range(spec.times):
            while at < len(calls) and not call_matches(spec, calls[at], leave_out):
                at += 1
            if at == len(calls):
                time = f" (time {number + 1} of {spec.times})" if spec.times > 1 else ""
                return f"{_words(spec)} is missing{time}, or comes too early"
            at += 1
    return None


def missing_in_any_order(
    required: Sequence[RequiredCall], calls: Sequence[EpisodeCall], leave_out: Collection[str] = ()
) -> str | None:
    """Return which required call is missing in any order; None if a different call matches each of them."""
    slots = [spec for spec in required for _ in range(spec.times)]
    taken: dict[int, int] = {}

    def place(slot: int, tried: set[int]) -> bool:
        for number, call in enumerate(calls):
            if number not in tried and call_matches(slots[slot], call, leave_out):
                tried.add(number)
                if number not in taken or place(taken[number], tried):
                    taken[number] = slot
                    return True
        return False

    for slot, spec in enumerate(slots):
        if not place(slot, set()):
            return f"{_words(spec)} is missing"
    return None


def _words(spec: RequiredCall) -> str:
    arguments = ", ".join(
        f"{name}={a.equals if a.equals is not None else '/'.join(a.mentions)}" for name, a in spec.arguments.items()
    )
    return f"{spec.tool}({arguments})"
