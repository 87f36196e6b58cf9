"""Find the tool steps in a cell, and the arguments that belong to none of them."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from scope_ptz.taskgen.importing.paper_names import TOOLS, normalise

_TOOL_KEYS = ("tool", "name", "tool_name", "function")


def shown(value: Any) -> str:
    """Return a part of a cell as JSON text for a finding, truncated to 120 characters."""
    return json.dumps(value, ensure_ascii=False, default=str)[:120]


def steps_in(order: Any, note: Callable[[str], None]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the tools in a cell, each with the arguments that are given together with it. Lists and objects may be nested.

    Args:
        order: The parsed content of the cell.
        note: Receives a line of text for every part that names no tool.
    """
    if isinstance(order, str):
        yield order, {}
    elif isinstance(order, dict):
        name = next((order[key] for key in _TOOL_KEYS if isinstance(order.get(key), str)), None)
        if name is not None:
            own: Mapping[str, Any] = next(
                (order[key] for key in ("args", "arguments", "parameters") if isinstance(order.get(key), dict)), {}
            )
            yield name, own
        elif any(key in order for key in _TOOL_KEYS):
            note(f"{shown(order)} names no tool")
        else:
            for key, value in order.items():
                if normalise(key) in TOOLS:
                    yield key, value if isinstance(value, dict) else {}
                else:
                    yield from steps_in(value, note)
    elif isinstance(order, list):
        for step in order:
            if step is None:
                note("null names no tool")
            yield from steps_in(step, note)
    elif order is not None:
        note(f"{shown(order)} names no tool")


def unused_arguments(given: Any, names: Sequence[str]) -> Iterator[str]:
    """Yield a line of text for every argument that belongs to no expected call.

    Arguments without the name or number of a call belong to the first call. If some of them are nested, this applies only if there
    is a single call.
    """
    if given in (None, "", [], {}):
        return
    if not names:
        yield f"{shown(given)}: no call is expected that would take it"
    elif isinstance(given, list):
        for at, one in enumerate(given):
            if one is not None and (at >= len(names) or not isinstance(one, dict)):
                yield f"{shown(one)} (number {at + 1}): arguments of no expected call"
    elif not isinstance(given, dict):
        yield f"{shown(given)}: no arguments"
    elif any(isinstance(value, dict | list) for value in given.values()) and not are_of_single_call(given, names):
        for name, value in given.items():
            yield from _unused_arguments_of(name, value, names)


def are_of_single_call(given: dict[str, Any], names: Sequence[str]) -> bool:
    """Return whether these are the arguments of a single call, and not the arguments of several calls by name or number."""
    return len(names) == 1 and not any(name in names or name == "0" or normalise(name) in TOOLS for name in given)


def _unused_arguments_of(name: str, value: Any, names: Sequence[str]) -> Iterator[str]:
    numbered = name.isdecimal() and int(name) < len(names)
    if name not in names and not numbered:
        yield f"{name}: {shown(value)}: arguments of no expected call"
    elif isinstance(value, list):
        for at, one in enumerate(value):
            if one is not None and (at >= max(names.count(name), 1) or not isinstance(one, dict)):
                yield f"{name}: {shown(one)} (number {at + 1}): arguments of no expected call"
    elif not isinstance(value, dict) and value not in (None, ""):
        yield f"{name}: {shown(value)}: no arguments"
