"""Map the expected tools and arguments in a row to the calls that a run must make."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from scope_ptz.bench.answers import plain_words
from scope_ptz.bench.tasks.findings import RowFinding
from scope_ptz.bench.tasks.task import Argument, RequiredCall, ToolName
from scope_ptz.errors import ToolCallError
from scope_ptz.taskgen.importing.contradictions import argument_contradictions
from scope_ptz.taskgen.importing.paper_names import (
    DURATION_ARGUMENTS,
    TEXT_ARGUMENTS,
    TOOLS,
    VIEW_ARGUMENTS,
    ZOOM_IN,
    ZOOM_OUT,
    normalise,
    scope_of,
)
from scope_ptz.taskgen.importing.structured_cells import parse_cell
from scope_ptz.taskgen.importing.tool_steps import cell_excerpt, find_steps, find_unused_arguments, is_single_call
from scope_ptz.tools.registry import TOOLS as SCOPE_TOOLS
from scope_ptz.tools.registry import parse_call

DEGREES_TOLERANCE, ZOOM_TOLERANCE, SECONDS_TOLERANCE = 0.5, 0.03, 0.5
"""Tolerances for expected arguments: in degrees, as a fraction of the zoom factor, and in seconds."""
_UNITS_S = {"": 1.0, "s": 1.0, "sec": 1.0, "second": 1.0, "seconds": 1.0, "ms": 0.001, "min": 60.0, "minute": 60.0, "minutes": 60.0}
_STOP_WORDS = frozenset({"the", "a", "an", "all", "any", "of", "in", "on", "with", "and", "view", "scene"})
TOOL_FIELDS = {name: frozenset(tool.arguments.model_fields) for name, tool in SCOPE_TOOLS.items()}
PresetOf = Callable[[str], str | None]
"""A function that returns the scene's preset for a name in the file; None if there is no such preset."""


@dataclass
class MappedCalls:
    """A row's required calls, and findings about tools and arguments that could not be mapped."""

    calls: list[RequiredCall] = field(default_factory=list)
    findings: list[RowFinding] = field(default_factory=list)

    def add_finding(self, kind: Any, detail: str) -> None:
        """Add a finding."""
        self.findings.append(RowFinding(kind=kind, detail=detail[:300]))


def expected_calls(order_cell: str, arguments_cell: str, *, compare: bool, preset_of: PresetOf) -> MappedCalls:
    """Map a row's expected calls.

    Args:
        order_cell: The cell with the expected tools.
        arguments_cell: The cell with their arguments.
        compare: Whether the arguments of a run must match those in the file.
        preset_of: Returns the scene's preset for a name in the file.

    Returns:
        The required calls and the findings.
    """
    mapped_calls = MappedCalls()
    order, given = (
        _parse_cell(order_cell, "expected_tool_order_json", mapped_calls),
        _parse_cell(arguments_cell, "expected_tool_args_json", mapped_calls),
    )
    steps = list(find_steps(order, lambda detail: mapped_calls.add_finding("unknown-tool", detail)))
    if not steps and isinstance(given, dict) and any(normalise(name) in TOOLS for name in given):
        steps = [(name, {}) for name in given]  # the row gives only arguments, by tool
    for detail in find_unused_arguments(given, [name for name, _ in steps]):
        mapped_calls.add_finding("unchecked-argument", detail)
    for index, (name, call_arguments) in enumerate(steps):
        tool = TOOLS.get(normalise(name))
        if tool is None:
            mapped_calls.add_finding("unknown-tool", name)
            continue
        other_arguments = _arguments_of(given, name, index, [n for n, _ in steps[:index]].count(name), only_call=len(steps) == 1)
        for detail in argument_contradictions(tool, call_arguments, other_arguments):
            mapped_calls.add_finding("fields-disagree", detail)
        mapped = _map_arguments(tool, {**other_arguments, **call_arguments}, preset_of, mapped_calls)
        mapped_calls.calls.append(RequiredCall(tool=tool, arguments=mapped if compare else {}))
    return mapped_calls


def _parse_cell(cell: str, column: str, mapped_calls: MappedCalls) -> Any:
    try:
        return parse_cell(cell)
    except ValueError as error:
        mapped_calls.add_finding("unreadable-cell", f"{column}: {error}: {cell[:120]}")
        return None


def _arguments_of(given: Any, name: str, index: int, earlier_calls: int, *, only_call: bool) -> Mapping[str, Any]:
    """Return the arguments of one expected call, from a list by position or from an object by tool.

    Args:
        given: The arguments for all calls.
        name: The tool's name in the file.
        index: Position of the call.
        earlier_calls: Number of earlier calls to the same tool.
        only_call: Whether this is the only call. Arguments without a tool name then belong to it.
    """
    if isinstance(given, list):
        item = given[index] if index < len(given) else None
        if not isinstance(item, dict):
            return {}
        inner = next((item[key] for key in ("args", "arguments", "parameters", name) if isinstance(item.get(key), dict)), None)
        return inner if inner is not None else {key: value for key, value in item.items() if key not in ("tool", "tool_name")}
    if not isinstance(given, dict):
        return {}
    call_arguments: Any = given.get(name, given.get(str(index)))
    if isinstance(call_arguments, list):
        call_arguments = call_arguments[min(earlier_calls, len(call_arguments) - 1)] if call_arguments else {}
    if isinstance(call_arguments, dict):
        return dict(call_arguments)
    is_flat = not any(isinstance(value, dict | list) for value in given.values())
    return dict(given) if index == 0 and (is_flat or (only_call and is_single_call(given, [name]))) else {}


def _map_arguments(tool: ToolName, given: Mapping[str, Any], preset_of: PresetOf, mapped_calls: MappedCalls) -> dict[str, Argument]:
    """Return the required arguments under SCOPE's names. Arguments that cannot be mapped are reported and not compared."""
    given = {normalise(name): value for name, value in given.items() if value is not None and value != ""}
    required, call, used = dict[str, Argument](), dict[str, Any](), set[str]()

    def add_argument(name: str, value: Any, argument: Argument | None) -> None:
        call[name] = value
        if argument is not None:
            required[name] = argument

    if tool == "adjust_ptz":
        _map_move(given, add_argument, used, mapped_calls)
    text = next((name for name in TEXT_ARGUMENTS.get(tool, ()) if isinstance(given.get(name), str)), None)
    if text is not None:
        used.add(text)
        _map_text(tool, str(given[text]), preset_of, add_argument, mapped_calls)
    view = next((name for name in VIEW_ARGUMENTS if name in given), None) if tool in ("count_objects", "query_answer") else None
    if view is not None:
        used.add(view)
        scope = scope_of(str(given[view]))
        if scope is None:
            mapped_calls.add_finding("wrong-arguments", f"{tool}: {view} is {given[view]!r}")
        else:
            add_argument("view", scope, Argument(equals=scope))
    if tool == "track_object":
        _map_duration(given, add_argument, used, mapped_calls)
    texts = set(TEXT_ARGUMENTS.get(tool, ()))
    for name in sorted(texts & set(given) - used):
        if not isinstance(given[name], str):
            mapped_calls.add_finding("wrong-arguments", f"{tool}: {name} is {cell_excerpt(given[name])}, which is not text")
        elif tool != "query_answer":  # any wording of a question is accepted
            mapped_calls.add_finding("unchecked-argument", f"{tool}: {name} is {cell_excerpt(given[name])}, but {text} is used")
    unused = sorted(set(given) - used - texts)
    if unused:
        mapped_calls.add_finding("wrong-arguments", f"{tool} does not take {', '.join(unused)}")
    _validate_call(tool, call, mapped_calls)
    return required


AddArgument = Callable[[str, Any, Argument | None], None]
"""A function that adds an argument to a call by its name, with its value and its requirement (None for no requirement)."""


def _map_move(given: Mapping[str, Any], add_argument: AddArgument, used: set[str], mapped_calls: MappedCalls) -> None:
    for name in ("pan_deg", "tilt_deg"):
        if name in given:
            used.add(name)
            degrees = _parse_number(given[name])
            if degrees is None:
                mapped_calls.add_finding("wrong-arguments", f"adjust_ptz: {name} is {given[name]!r}")
            else:
                add_argument(name, degrees, Argument(equals=degrees, within=DEGREES_TOLERANCE))
    if "zoom_factor" in given and "zoom_percent" in given:
        mapped_calls.add_finding("wrong-arguments", "adjust_ptz takes zoom_factor or zoom_percent, not both; zoom_percent is used")
    for name in ("zoom_factor", "zoom_percent"):
        if name in given:
            used.add(name)
            amount = _parse_number(given[name])
            factor = 1 + amount / 100 if amount is not None and name == "zoom_percent" else amount
            if factor is None or factor <= 0:
                mapped_calls.add_finding("wrong-arguments", f"adjust_ptz: {name} is {given[name]!r}")
            else:
                add_argument("zoom_factor", factor, Argument(equals=factor, within=factor * ZOOM_TOLERANCE))
    limit_name = next((name for name in ("zoom_full", "zoom_limit") if name in given), None)
    if limit_name is not None:
        used.add(limit_name)
        word = "-1" if str(given[limit_name]).strip() == "-1" else normalise(str(given[limit_name]))
        limit = "in" if word in ZOOM_IN else "out" if word in ZOOM_OUT else None
        if limit is not None:
            add_argument("zoom_limit", limit, Argument(equals=limit))
        elif given[limit_name] is not False:
            mapped_calls.add_finding(
                "unchecked-argument", f"adjust_ptz: {limit_name} is {given[limit_name]!r}, which does not say whether in or out"
            )
    used.update(
        name for name in ("unit", "units") if normalise(str(given.get(name, ""))) in ("deg", "degree", "degrees", "percent", "x")
    )


def _map_text(tool: ToolName, text: str, preset_of: PresetOf, add_argument: AddArgument, mapped_calls: MappedCalls) -> None:
    if tool == "go_to_preset":
        preset = preset_of(text)
        if preset is None:
            mapped_calls.add_finding("wrong-arguments", f"go_to_preset: there is no preset {text!r}")
        else:
            add_argument("name", preset, Argument(equals=preset))
    elif tool == "query_answer":
        add_argument("question", text, None)  # any wording of a question is accepted
    else:
        words = [word for word in plain_words(text) if word not in _STOP_WORDS and any(c.isalpha() or c.isdecimal() for c in word)]
        head = words[-1:]
        add_argument("description", text, Argument(mentions=tuple(dict.fromkeys((" ".join(words), *head)))) if words else None)


def _map_duration(given: Mapping[str, Any], add_argument: AddArgument, used: set[str], mapped_calls: MappedCalls) -> None:
    name = next((name for name in DURATION_ARGUMENTS if name in given), None)
    used.add("unit")
    if name is None:
        return
    used.add(name)
    amount, unit = _parse_number(given[name]), _UNITS_S.get(normalise(str(given.get("unit", ""))))
    if amount is None or unit is None:
        mapped_calls.add_finding("wrong-arguments", f"track_object: {name} is {given[name]!r} {given.get('unit', '')}".rstrip())
    else:
        add_argument("duration_s", amount * unit, Argument(equals=amount * unit, within=SECONDS_TOLERANCE))


def _validate_call(tool: ToolName, call: Mapping[str, Any], mapped_calls: MappedCalls) -> None:
    """Report a call that the tool would reject. Missing text arguments are ignored, because files often omit them."""
    filled = dict(call)
    for name in ("name", "description", "question"):
        if name in TOOL_FIELDS[tool] and name not in filled:
            filled[name] = "x"
    try:
        parse_call(tool, filled)
    except ToolCallError as error:
        mapped_calls.add_finding("wrong-arguments", str(error))


def _parse_number(value: Any) -> float | None:
    if isinstance(value, bool):
        return None
    try:
        number = float(str(value).strip().rstrip("°%x"))
    except ValueError:
        return None
    return number if math.isfinite(number) and abs(number) < 1e6 else None
