"""The steps that a cell names, and the arguments that belong to none of them: what is read nowhere is told."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from scope_ptz.taskgen.importing.paper_names import TOOLS, spelled

_TOOL_KEYS = ("tool", "name", "tool_name", "function")


def plain(value: Any) -> str:
    """A piece of a cell as it is shown."""
    return json.dumps(value, ensure_ascii=False, default=str)[:120]


def steps_in(order: Any, odd: Callable[[str], None]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Tool names with arguments of their own, from a list of names, of objects, or of lists of these. ``odd`` is told what names no
    tool."""
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
            odd(f"{plain(order)} names no tool")
        else:
            for key, value in order.items():
                if spelled(key) in TOOLS:
                    yield key, value if isinstance(value, dict) else {}
                else:
                    yield from steps_in(value, odd)
    elif isinstance(order, list):
        for step in order:
            if step is None:
                odd("null names no tool")
            yield from steps_in(step, odd)
    elif order is not None:
        odd(f"{plain(order)} names no tool")


def spare_arguments(given: Any, names: Sequence[str]) -> Iterator[str]:
    """What of the arguments of a row goes to none of the calls that are named, in words. Arguments without a call's name or number
    are those of the first one (of the only one, where some have parts)."""
    if given in (None, "", [], {}):
        return
    if not names:
        yield f"{plain(given)}: no call is expected that would take it"
    elif isinstance(given, list):
        for at, one in enumerate(given):
            if one is not None and (at >= len(names) or not isinstance(one, dict)):
                yield f"{plain(one)} (number {at + 1}): arguments of no expected call"
    elif not isinstance(given, dict):
        yield f"{plain(given)}: no arguments"
    elif any(isinstance(value, dict | list) for value in given.values()) and not without_names(given, names):
        for name, value in given.items():
            yield from _of_one(name, value, names)


def without_names(given: dict[str, Any], names: Sequence[str]) -> bool:
    """Whether these are the arguments of the only call, and not arguments by the names or numbers of calls."""
    return len(names) == 1 and not any(name in names or name == "0" or spelled(name) in TOOLS for name in given)


def _of_one(name: str, value: Any, names: Sequence[str]) -> Iterator[str]:
    numbered = name.isdecimal() and int(name) < len(names)
    if name not in names and not numbered:
        yield f"{name}: {plain(value)}: arguments of no expected call"
    elif isinstance(value, list):
        for at, one in enumerate(value):
            if one is not None and (at >= max(names.count(name), 1) or not isinstance(one, dict)):
                yield f"{name}: {plain(one)} (number {at + 1}): arguments of no expected call"
    elif not isinstance(value, dict) and value not in (None, ""):
        yield f"{name}: {plain(value)}: no arguments"
